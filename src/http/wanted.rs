//! How an answer is wanted: by the query, by `Accept`, and among what its endpoint offers.

use std::marker::PhantomData;
use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::App;
use super::error::{ApiError, Code};
use super::extract::StrictQuery;
use super::output::{self, Representation, accept};
use super::request_id::RequestId;

/// What the endpoints of one kind answer in, the default first.
pub trait Offers {
    const OFFERS: &'static [Representation];
}

/// A job that ends in a toolpath, whose program can be written.
pub enum Toolpaths {}

impl Offers for Toolpaths {
    const OFFERS: &'static [Representation] = &[
        Representation::Json,
        Representation::Gcode,
        Representation::Svg,
        Representation::Html,
        Representation::Events,
    ];
}

/// A job that ends in the text of a program.
pub enum Programs {}

impl Offers for Programs {
    const OFFERS: &'static [Representation] = &[
        Representation::Gcode,
        Representation::Json,
        Representation::Svg,
        Representation::Html,
        Representation::Events,
    ];
}

/// A program that is rewritten as a stream, or only counted.
pub const STREAMS: &[Representation] = &[Representation::Gcode, Representation::Json];

/// A surface that is looked at.
pub enum Models {}

impl Offers for Models {
    const OFFERS: &'static [Representation] =
        &[Representation::Json, Representation::Svg, Representation::Html, Representation::Events];
}

/// The query of every computing endpoint.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AnswerQuery {
    format: Option<Representation>,
    toolpath: Option<bool>,
    nc: Option<bool>,
}

/// The form of one answer.
#[derive(Debug, Clone)]
pub struct Form {
    pub representation: Representation,
    /// One of the representation's, as it was asked for.
    pub media_type: &'static str,
    /// Whether the JSON answer holds the toolpath, where the caller says.
    pub with_toolpath: Option<bool>,
    /// Whether the JSON answer holds the program's text too.
    pub with_nc: bool,
    pub with_gzip: bool,
    pub request_id: RequestId,
}

/// The form in which the caller wants the answer of an endpoint that offers `O`.
pub struct Wanted<O> {
    pub form: Form,
    offers: PhantomData<O>,
}

impl<O: Offers> FromRequestParts<Arc<App>> for Wanted<O> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, app: &Arc<App>) -> Result<Self, ApiError> {
        let request_id = RequestId::from_request_parts(parts, app).await?;
        let StrictQuery(query) = StrictQuery::<AnswerQuery>::from_request_parts(parts, app).await?;
        let (representation, media_type) = output::choose(O::OFFERS, &parts.headers, query.format)?;
        let with_gzip = accept::takes_gzip(&parts.headers);
        let with_toolpath = query.toolpath;
        let with_nc = query.nc.unwrap_or(false);
        if with_nc && !O::OFFERS.contains(&Representation::Gcode) {
            return Err(ApiError::new(
                Code::InvalidRequest,
                "there is no program here: `nc` is for toolpaths",
            ));
        }
        let form = Form { representation, media_type, with_toolpath, with_nc, with_gzip, request_id };
        Ok(Self { form, offers: PhantomData })
    }
}

/// The query as the endpoint's own offers leave it.
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
        let mut parameters = vec![
            parameter("format", "Overrides `Accept`.", format),
            parameter(
                "toolpath",
                "Whether the JSON answer holds the toolpath. Default: unless it holds the program's text.",
                yes_or_no(),
            ),
        ];
        if O::OFFERS.contains(&Representation::Gcode) {
            let nc = "Whether the JSON answer, or the event `result`, holds the program's text in `nc`: program, report and \
                      progress of one computation. Default: where the answer is about its text.";
            parameters.push(parameter("nc", nc, yes_or_no()));
        }
        parameters
    }
}
