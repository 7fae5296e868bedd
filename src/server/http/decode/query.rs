//! Reads the parameters of a query, each by its type.

use axum::extract::Query;
use axum::http::Uri;
use serde::de::DeserializeOwned;
use serde::de::value::{Error, StrDeserializer};
use utoipa::PartialSchema;
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::Schema;

use super::words;

/// The parameters that an endpoint reads besides the shared ones.
pub trait FromQuery: Sized {
    /// The names of the parameters.
    const NAMES: &'static [&'static str];

    /// # Errors
    /// A sentence that names the parameter at fault and what to send.
    fn read(sent: &Parameters) -> Result<Self, String>;
}

/// The query of an endpoint without parameters of its own.
pub struct NoQuery;

impl FromQuery for NoQuery {
    const NAMES: &'static [&'static str] = &[];

    fn read(_: &Parameters) -> Result<Self, String> {
        Ok(Self)
    }
}

/// The parameters of a query, as texts.
pub struct Parameters(Vec<(String, String)>);

impl Parameters {
    /// The parameters of a query that may have `known` parameters. A misspelt parameter must not silently do
    /// nothing, so any other parameter is refused.
    ///
    /// # Errors
    /// A sentence that names the unknown parameter.
    pub fn among(known: &[&str], uri: &Uri) -> Result<Self, String> {
        let Query(sent) = Query::<Vec<(String, String)>>::try_from_uri(uri)
            .map_err(|_| "the query cannot be read: send `name=value`, separated by `&`")?;
        match sent.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            None => Ok(Self(sent)),
            Some((name, _)) => Err(format!(
                "the query parameter `{name}` is unknown here; use one of `{}`",
                known.join("`, `")
            )),
        }
    }

    /// The text of a parameter. `None` where the query does not have the parameter.
    ///
    /// # Errors
    /// When the parameter stands twice.
    pub fn text(&self, name: &str) -> Result<Option<&str>, String> {
        let mut found = self.0.iter().filter(|(own, _)| own == name).map(|(_, value)| value.as_str());
        match (found.next(), found.next()) {
            (value, None) => Ok(value),
            (_, Some(_)) => Err(format!("the query parameter `{name}` stands twice: send `{name}` once")),
        }
    }

    /// A number.
    ///
    /// # Errors
    /// When the parameter is no number or stands twice.
    pub fn number(&self, name: &str) -> Result<Option<f64>, String> {
        let number = self.text(name)?.map(str::parse).transpose();
        number.map_err(|_| format!("the query parameter `{name}` must be a number"))
    }

    /// `true` or `false`.
    ///
    /// # Errors
    /// When the parameter is another text or stands twice.
    pub fn flag(&self, name: &str) -> Result<Option<bool>, String> {
        let flag = self.text(name)?.map(str::parse).transpose();
        flag.map_err(|_| format!("the query parameter `{name}` must be `true` or `false`"))
    }

    /// One of the names of `T`.
    ///
    /// # Errors
    /// When the parameter is no name of `T` or stands twice.
    pub fn name<T: DeserializeOwned + PartialSchema>(&self, name: &str) -> Result<Option<T>, String> {
        let Some(sent) = self.text(name)? else { return Ok(None) };
        let found = T::deserialize(StrDeserializer::<Error>::new(sent));
        found.map(Some).map_err(|_| match T::schema() {
            RefOr::T(Schema::Object(object)) => unknown(name, sent, &words::names(&object)),
            _ => unknown(name, sent, &[]),
        })
    }
}

/// The sentence about a parameter whose value is not in `names`.
pub fn unknown(parameter: &str, sent: &str, names: &[&str]) -> String {
    format!("the query parameter `{parameter}`: {}", words::unknown(sent, names))
}

/// The sentence about a parameter that is missing.
pub fn required(parameter: &str) -> String {
    format!("the query parameter `{parameter}` is required")
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;
    use utoipa::ToSchema;

    use super::*;

    #[derive(Debug, PartialEq, Deserialize, ToSchema)]
    #[serde(rename_all = "snake_case")]
    enum Side {
        Left,
        FarRight,
    }

    fn sent(query: &str) -> Parameters {
        Parameters::among(&["a", "b"], &format!("/?{query}").parse().expect("a path")).expect("known names")
    }

    #[test]
    fn a_parameter_is_read_by_its_type() {
        let parameters = sent("a=far_right&b=%31e-3");
        assert_eq!(parameters.name("a"), Ok(Some(Side::FarRight)));
        assert_eq!(parameters.number("b"), Ok(Some(1e-3)));
        assert_eq!(parameters.flag("c"), Ok(None));
        assert_eq!(sent("a=true").flag("a"), Ok(Some(true)));
    }

    #[test]
    fn faults_of_a_query_name_the_parameter_and_what_to_send() {
        for (fault, words) in [
            (sent("a=fine").number("a").err(), "the query parameter `a` must be a number"),
            (sent("a=").number("a").err(), "the query parameter `a` must be a number"),
            (sent("a=maybe").flag("a").err(), "the query parameter `a` must be `true` or `false`"),
            (sent("a=1&a=1").flag("a").err(), "the query parameter `a` stands twice: send `a` once"),
            (
                sent("a=up").name::<Side>("a").err(),
                "the query parameter `a`: `up` is unknown; use one of `left`, `far_right`",
            ),
            (
                Parameters::among(&["a", "b"], &"/?c=1".parse().expect("a path")).err(),
                "the query parameter `c` is unknown here; use one of `a`, `b`",
            ),
        ] {
            assert_eq!(fault.as_deref(), Some(words));
        }
    }
}
