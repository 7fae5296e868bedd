//! Chooses the form of an answer from the forms that the endpoint offers. The query parameter `format`
//! decides; without it the header `Accept` decides.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use utoipa::IntoParams;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::accept;
use super::representation::{self, Representation};
use super::request_id::RequestId;
use crate::http::decode::query::{self, FromQuery, NoQuery, Parameters};
use crate::http::error::{ApiError, Code};

/// The forms in which endpoints of one kind answer, and the query parameters that they read.
pub trait Offers {
    /// The forms of the answer, the default first.
    const OFFERS: &'static [Representation];

    /// The names of the shared parameters that these endpoints read.
    const PARAMETERS: &'static [&'static str] = &["format", "toolpath", "nc", "glb", "points", "view"];

    /// Whether the JSON answer may hold a toolpath.
    const HAS_TOOLPATH: bool = has(Self::OFFERS, Representation::Gcode);

    /// The endpoint's own parameters.
    type Query: FromQuery;
}

/// Whether `form` is on offer.
const fn has(offers: &[Representation], form: Representation) -> bool {
    let mut k = 0;
    while k < offers.len() {
        if offers[k] as u8 == form as u8 {
            return true;
        }
        k += 1;
    }
    false
}

/// Endpoints that answer a toolpath, whose program can be written.
pub enum Toolpaths {}

impl Offers for Toolpaths {
    type Query = NoQuery;

    const OFFERS: &'static [Representation] = &[
        Representation::Json,
        Representation::Gcode,
        Representation::Svg,
        Representation::Html,
        Representation::Glb,
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
        Representation::Glb,
        Representation::Events,
    ];
}

/// Endpoints that answer figures or a picture, and no text of a program.
pub enum Figures {}

impl Offers for Figures {
    type Query = NoQuery;

    const OFFERS: &'static [Representation] = &[
        Representation::Json,
        Representation::Svg,
        Representation::Html,
        Representation::Glb,
        Representation::Events,
    ];
}

/// Endpoints that describe a surface and make no toolpath.
pub enum Models {}

impl Offers for Models {
    type Query = NoQuery;

    const OFFERS: &'static [Representation] = &[
        Representation::Json,
        Representation::Svg,
        Representation::Html,
        Representation::Glb,
        Representation::Stl,
        Representation::Events,
    ];
}

/// How a picture shows the part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PictureView {
    /// Plan, front and left side.
    #[default]
    Plan,
    /// One isometric view with hidden strokes left out.
    Axonometric,
}

impl PictureView {
    /// The names in the query, in the order of the variants.
    const NAMES: [&'static str; 2] = ["plan", "axonometric"];

    fn named(name: &str) -> Result<Self, String> {
        match name {
            "plan" => Ok(Self::Plan),
            "axonometric" => Ok(Self::Axonometric),
            _ => Err(query::unknown("view", name, &Self::NAMES)),
        }
    }
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
    /// Whether the JSON answer holds the binary glTF file too.
    pub with_glb: bool,
    /// Whether the JSON answer holds the path as points too.
    pub with_points: bool,
    pub view: PictureView,
    /// Whether the caller takes gzip.
    pub with_gzip: bool,
    pub request_id: RequestId,
}

impl Form {
    /// Whether the answer is, or holds, the binary glTF file.
    pub fn wants_model(&self) -> bool {
        match self.representation {
            Representation::Json | Representation::Events => self.with_glb,
            Representation::Glb => true,
            Representation::Gcode | Representation::Svg | Representation::Html | Representation::Stl => false,
        }
    }
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
        let known: Vec<&str> = O::PARAMETERS.iter().chain(O::Query::NAMES).copied().collect();
        let sent = Parameters::among(&known, &parts.uri).map_err(invalid)?;
        let format = sent.text("format").and_then(|name| name.map(named).transpose()).map_err(invalid)?;
        let with_toolpath = sent.flag("toolpath").map_err(invalid)?;
        let with_nc = sent.flag("nc").map_err(invalid)?.unwrap_or(false);
        let with_glb = sent.flag("glb").map_err(invalid)?.unwrap_or(false);
        let with_points = sent.flag("points").map_err(invalid)?.unwrap_or(false);
        let view =
            sent.text("view").and_then(|name| name.map(PictureView::named).transpose()).map_err(invalid)?;
        let query = O::Query::read(&sent).map_err(invalid)?;
        let (representation, media_type) = representation::choose(O::OFFERS, &parts.headers, format)?;
        if with_nc && !O::OFFERS.contains(&Representation::Gcode) {
            let detail = "`nc` asks for a program, and this endpoint makes none: leave `nc` out";
            return Err(ApiError::new(Code::InvalidRequest, detail));
        }
        if with_points && !O::HAS_TOOLPATH {
            let detail =
                "`points` asks for the path as points, and this endpoint makes no path: leave `points` out";
            return Err(ApiError::new(Code::InvalidRequest, detail));
        }
        let with_gzip = accept::takes_gzip(&parts.headers);
        let form = Form {
            representation,
            media_type,
            with_toolpath,
            with_nc,
            with_glb,
            with_points,
            view: view.unwrap_or_default(),
            with_gzip,
            request_id,
        };
        Ok(Self { form, query })
    }
}

/// The form that the parameter `format` names.
fn named(name: &str) -> Result<Representation, String> {
    Representation::named(name).ok_or_else(|| {
        let names: Vec<&str> = Representation::ALL.iter().filter_map(|form| form.name()).collect();
        query::unknown("format", name, &names)
    })
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
        let toolpath = if O::HAS_TOOLPATH && !makes_program {
            "Whether the JSON answer holds the toolpath. Default: `true`."
        } else if makes_program {
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
        if O::PARAMETERS.contains(&"glb") {
            let glb = "Whether the JSON answer, or the event `result`, holds the file of `?format=glb` in `glb`, in base64. Default: `false`.";
            parameters.push(parameter("glb", glb, yes_or_no()));
        }
        if O::PARAMETERS.contains(&"points") && O::HAS_TOOLPATH {
            let points = "Whether the JSON answer, or the event `result`, holds the path as points in `polyline`, without arcs. Default: `false`.";
            parameters.push(parameter("points", points, yes_or_no()));
        }
        if O::PARAMETERS.contains(&"view") {
            let view = "View of a picture. `plan`: plan, front and left side. `axonometric`: one isometric view from the front left and above, \
                        with hidden strokes left out. Diagrams have no view. Default: `plan`.";
            let names = ObjectBuilder::new().schema_type(Type::String).enum_values(Some(PictureView::NAMES));
            parameters.push(parameter("view", view, names));
        }
        parameters
    }
}
