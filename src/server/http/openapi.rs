//! The contract, generated from the handlers and the wire types, and the routes that the contract describes.

mod additions;
mod directions;
mod examples;

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use axum::http::{HeaderMap, HeaderValue, Method, StatusCode};
use serde_json::{Map, Value};
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::answer::encoded::Encoded;
use super::app::App;
use super::error::{ApiError, Problem};
use super::request::accept;
use super::request::representation::JSON;
use super::service::{health, metrics};
use super::v1;
pub use examples::{example, folder as example_folder};

#[derive(OpenApi)]
#[openapi(
    info(
        title = "toolpathd",
        description = "Turns part data into CNC toolpaths and NC programs. Lengths are in mm, feeds in mm/min, spindle speeds \
            in 1/min, angles in degrees, times in s. A request may carry a body in gzip (`Content-Encoding: gzip`), and the service \
            answers in gzip where `Accept-Encoding` asks for gzip. A member of a request that is `null` counts as absent."
    ),
    servers(
        (url = ".", description = "The service that answered this contract."),
        (url = "http://127.0.0.1:8080", description = "A service on this machine with its default settings.")
    ),
    tags(
        (name = "curves", description = "Curves in the plane, and points"),
        (name = "surfaces", description = "Sculptured surfaces"),
        (name = "pockets", description = "Pockets and islands"),
        (name = "parts", description = "Files of parts"),
        (name = "five-axis", description = "Tips and tool axes"),
        (name = "programs", description = "NC programs"),
        (name = "dnc", description = "Programs sent to controls"),
        (name = "service", description = "What this server accepts, and its contract"),
        (name = "operation", description = "For supervisors and load balancers")
    ),
    components(schemas(Problem, super::answer::events::Progress))
)]
struct Document;

/// Every route with its documentation.
pub fn routes() -> OpenApiRouter<Arc<App>> {
    OpenApiRouter::with_openapi(Document::openapi())
        .routes(routes!(v1::arcs_fit::fit_arcs, v1::arcs_fit::put_arcs))
        .routes(routes!(v1::curves_interpolate::interpolate_curve))
        .routes(routes!(v1::five_axis_smooth::smooth_path))
        .routes(routes!(v1::surfaces_drop::drop_cutter))
        .routes(routes!(v1::surfaces_mill::mill_surface))
        .routes(routes!(v1::surfaces_model::model_surface))
        .routes(routes!(v1::parts_inspect::inspect_part))
        .routes(routes!(v1::pockets_plan::plan_pocket))
        .routes(routes!(v1::programs_read::read_program))
        .routes(routes!(v1::programs_verify::verify_program))
        .routes(routes!(v1::programs_write::write_program))
        .routes(routes!(v1::dnc::list_controls))
        .routes(routes!(v1::dnc::send_program))
        .routes(routes!(v1::limits::get_limits))
        .routes(routes!(v1::dialects::list_dialects))
        .routes(routes!(v1::machines::list_machines))
        .routes(routes!(health::livez))
        .routes(routes!(health::readyz))
        .routes(routes!(metrics::get_metrics))
        .routes(routes!(get_contract))
}

/// Every path of the contract.
fn paths() -> Vec<&'static str> {
    static PATHS: LazyLock<Vec<String>> =
        LazyLock::new(|| routes().into_openapi().paths.paths.into_keys().collect());
    PATHS.iter().map(String::as_str).collect()
}

/// The methods that a path answers; none for a path that the contract does not name.
fn methods(path: &str) -> Vec<String> {
    static METHODS: LazyLock<BTreeMap<String, Vec<String>>> = LazyLock::new(|| {
        let document = serde_json::to_value(routes().into_openapi().paths).unwrap_or_default();
        let of = |item: &Value| {
            item.as_object().into_iter().flat_map(Map::keys).map(|key| key.to_uppercase()).collect()
        };
        document.as_object().into_iter().flatten().map(|(path, item)| (path.clone(), of(item))).collect()
    });
    METHODS.get(path).cloned().unwrap_or_default()
}

/// What the contract says of a path that no handler has answered: the paths or methods there are.
pub fn unanswered(status: StatusCode, method: &Method, path: &str) -> Option<String> {
    match status {
        StatusCode::NOT_FOUND => {
            Some(format!("there is nothing at this path; there are {}", paths().join(", ")))
        }
        StatusCode::METHOD_NOT_ALLOWED => {
            let allowed = match methods(path) {
                none if none.is_empty() => "another method".to_owned(),
                methods => methods.join(" and "),
            };
            Some(format!("`{path}` does not answer {method}, but {allowed}"))
        }
        _ => None,
    }
}

/// Answer this contract.
///
/// The OpenAPI document of this version, as JSON.
#[utoipa::path(get, path = "/openapi.json", operation_id = "getContract", tag = "service",
    responses((status = 200, description = "OpenAPI 3.1.", body = Object)))]
async fn get_contract(headers: HeaderMap) -> Result<Encoded, ApiError> {
    static CODED: LazyLock<[Result<Encoded, ApiError>; 2]> = LazyLock::new(|| {
        [false, true].map(|with_gzip| {
            Encoded::plain(HeaderValue::from_static(JSON), contract().into()).sealed(with_gzip)
        })
    });
    CODED[usize::from(accept::takes_gzip(&headers))].clone()
}

/// The contract as formatted JSON.
pub fn contract() -> String {
    format!("{:#}", document())
}

/// The contract.
pub fn document() -> Value {
    let mut openapi = routes().into_openapi();
    // No licence is chosen.
    openapi.info.license = None;
    let mut document = serde_json::to_value(openapi).unwrap_or_default();
    additions::add(&mut document);
    additions::tidy(&mut document);
    directions::tell_apart(&mut document);
    examples::add(&mut document);
    document
}
