//! Chooses the form of an answer from the forms that the endpoint offers. The query parameter `format`
//! decides; without it the header `Accept` decides.

use axum::extract::{FromRequestParts, Query};
use axum::http::Uri;
use axum::http::request::Parts;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use utoipa::IntoParams;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::accept;
use super::representation::{self, Representation};
use super::request_id::RequestId;
use crate::http::decode::words;
use crate::http::error::{ApiError, Code};

/// The forms in which endpoints of one kind answer, and the query parameters that they read.
pub trait Offers {
    /// The forms of the answer, the default first.
    const OFFERS: &'static [Representation];

    /// The names of the shared parameters that these endpoints read.
    const PARAMETERS: &'static [&'static str] = &["format", "toolpath", "nc"];

    /// The names of the endpoint's own parameters, which are the fields of `Query`.
    const OWN_PARAMETERS: &'static [&'static str] = &[];

    /// The endpoint's own parameters.
    type Query: DeserializeOwned;
}

/// The query of an endpoint without parameters of its own.
#[derive(Debug, Deserialize)]
pub struct NoQuery {}

/// Endpoints that answer a toolpath, whose program can be written.
pub enum Toolpaths {}

impl Offers for Toolpaths {
    type Query = NoQuery;

    const OFFERS: &'static [Representation] = &[
        Representation::Json,
        Representation::Gcode,
        Representation::Svg,
        Representation::Html,
        Representation::Events,
    ];
}

/// Endpoints that answer the text of a program.
pub enum Programs {}

impl Offers for Programs {
    type Query = NoQuery;

    const OFFERS: &'static [Representation] = &[
        Representation::Gcode,
        Representation::Json,
        Representation::Svg,
        Representation::Html,
        Representation::Events,
    ];
}

/// Endpoints that describe a surface and make no toolpath.
pub enum Models {}

impl Offers for Models {
    type Query = NoQuery;

    const OFFERS: &'static [Representation] =
        &[Representation::Json, Representation::Svg, Representation::Html, Representation::Events];
}

/// The parameters that endpoints share.
#[derive(Debug, Deserialize)]
struct AnswerQuery {
    format: Option<Representation>,
    toolpath: Option<bool>,
    nc: Option<bool>,
}

/// The form of one answer.
#[derive(Debug, Clone)]
pub struct Form {
    pub representation: Representation,
    /// The media type of the representation that the caller asked for.
    pub media_type: &'static str,
    /// Whether the JSON answer holds the toolpath. `None` where the caller did not say.
    pub with_toolpath: Option<bool>,
    /// Whether the JSON answer holds the program's text too.
    pub with_nc: bool,
    /// Whether the caller takes gzip.
    pub with_gzip: bool,
    pub request_id: RequestId,
}

/// The form in which the caller wants the answer of an endpoint that offers `O`, and the endpoint's own
/// parameters.
pub struct Wanted<O: Offers> {
    pub form: Form,
    pub query: O::Query,
}

impl<O: Offers, S: Sync> FromRequestParts<S> for Wanted<O> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let request_id = RequestId::from_request_parts(parts, state).await?;
        let invalid = |detail: String| ApiError::new(Code::InvalidQuery, detail);
        check_names::<O>(&parts.uri).map_err(invalid)?;
        let AnswerQuery { format, toolpath, nc } = read(&parts.uri).map_err(invalid)?;
        let query = read(&parts.uri).map_err(invalid)?;
        let (representation, media_type) = representation::choose(O::OFFERS, &parts.headers, format)?;
        let with_nc = nc.unwrap_or(false);
        if with_nc && !O::OFFERS.contains(&Representation::Gcode) {
            let detail = "`nc` asks for a program, and this endpoint makes none: leave `nc` out";
            return Err(ApiError::new(Code::InvalidRequest, detail));
        }
        let with_gzip = accept::takes_gzip(&parts.headers);
        let form =
            Form { representation, media_type, with_toolpath: toolpath, with_nc, with_gzip, request_id };
        Ok(Self { form, query })
    }
}

/// Refuses a parameter that the endpoint does not read: a misspelt parameter must not silently do nothing.
fn check_names<O: Offers>(uri: &Uri) -> Result<(), String> {
    let known: Vec<&str> = O::PARAMETERS.iter().chain(O::OWN_PARAMETERS).copied().collect();
    let sent: Vec<(String, String)> = read(uri)?;
    match sent.iter().find(|(name, _)| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some((name, _)) => {
            Err(format!("the query parameter `{name}` is unknown here; use one of `{}`", known.join("`, `")))
        }
    }
}

/// The parameters that `T` names, read from the query.
fn read<T: DeserializeOwned>(uri: &Uri) -> Result<T, String> {
    let Query(query) = Query::try_from_uri(uri).map_err(|rejection| plain(&rejection.body_text()))?;
    Ok(query)
}

/// The message of the query decoder in plain words. The decoder names the parameter and the fault, or the
/// fault alone.
fn plain(message: &str) -> String {
    let message = message.strip_prefix("Failed to deserialize query string: ").unwrap_or(message);
    let (name, fault) = message.split_once(": ").unwrap_or(("", message));
    let quoted: Vec<&str> = fault.split('`').skip(1).step_by(2).collect();
    match quoted.as_slice() {
        [missing] if fault.starts_with("missing field") => {
            format!("the query parameter `{missing}` is required")
        }
        [repeated] if fault.starts_with("duplicate field") => {
            format!("the query parameter `{repeated}` stands twice: send `{repeated}` once")
        }
        [value, names @ ..] if fault.starts_with("unknown variant") => {
            format!("the query parameter `{name}`: {}", words::unknown(value, names))
        }
        _ if fault.contains("`true`") => format!("the query parameter `{name}` must be `true` or `false`"),
        _ => format!("the query parameter `{name}` must be a number"),
    }
}

/// The shared parameters for the contract, with the values that the endpoint offers.
impl<O: Offers> IntoParams for Wanted<O> {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<Parameter> {
        let names = O::OFFERS.iter().filter_map(|offer| offer.name());
        let format = ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names));
        let yes_or_no = || ObjectBuilder::new().schema_type(Type::Boolean);
        let parameter = |name: &str, description: &str, schema: ObjectBuilder| {
            ParameterBuilder::new()
                .name(name)
                .parameter_in(ParameterIn::Query)
                .description(Some(description))
                .schema(Some(schema))
                .build()
        };
        let makes_program = O::OFFERS.contains(&Representation::Gcode);
        let toolpath = if makes_program {
            "Whether the JSON answer holds the toolpath. Default: `true` where the answer has no `nc`, else `false`."
        } else {
            "Without effect: this endpoint makes no toolpath."
        };
        let mut parameters = vec![
            parameter(
                "format",
                "Form of the answer. `format` overrides the header `Accept`. Use `format` in links and where headers cannot be set. Default: the form that `Accept` asks for, else the default form of the endpoint.",
                format,
            ),
            parameter("toolpath", toolpath, yes_or_no()),
        ];
        if makes_program {
            let nc = "Whether the JSON answer, or the event `result`, holds the text of the NC program in `nc`. Default: `false`; \
                      `/v1/programs/write` always answers `nc`.";
            parameters.push(parameter("nc", nc, yes_or_no()));
        }
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_of_a_query_name_the_parameter_and_what_to_send() {
        #[derive(Debug, Deserialize)]
        struct Own {
            _tolerance_mm: f64,
        }
        let own = |query: &str| read::<Own>(&format!("/?{query}").parse().expect("a path")).map(|_| ());
        let shared =
            |query: &str| read::<AnswerQuery>(&format!("/?{query}").parse().expect("a path")).map(|_| ());
        for (result, words) in [
            (own(""), "the query parameter `_tolerance_mm` is required"),
            (own("_tolerance_mm=fine"), "the query parameter `_tolerance_mm` must be a number"),
            (shared("nc=maybe"), "the query parameter `nc` must be `true` or `false`"),
            (shared("nc=true&nc=true"), "the query parameter `nc` stands twice: send `nc` once"),
            (
                shared("format=pdf"),
                "the query parameter `format`: `pdf` is unknown; use one of `json`, `gcode`, `svg`, `html`",
            ),
        ] {
            assert_eq!(result, Err(words.to_owned()));
        }
        let unknown = check_names::<Models>(&"/?tolpath=false".parse().expect("a path"));
        assert_eq!(
            unknown,
            Err("the query parameter `tolpath` is unknown here; use one of `format`, `toolpath`, `nc`"
                .to_owned())
        );
    }
}
