//! Web pages at `/docs` to read the contract and to try requests. The binary contains all files of the pages.

use axum::Router;
use axum::http::{HeaderValue, header};
use axum::middleware::map_response;
use axum::response::Response;
use utoipa_swagger_ui::{Config, SwaggerUi};

/// The pages load files from this origin only. Their script sets styles on elements, which count as inline.
const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
    img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The routes of `/docs` and of the files that the pages load.
pub fn routes<S: Clone + Send + Sync + 'static>() -> Router<S> {
    // The relative path also works behind a proxy that adds a prefix. `none` keeps the pages from sending the
    // contract to a validator on another host.
    let config = Config::from("../openapi.json").validator_url("none").try_it_out_enabled(true);
    Router::from(SwaggerUi::new("/docs").config(config)).layer(map_response(guarded))
}

async fn guarded(mut response: Response) -> Response {
    let policy = HeaderValue::from_static(CONTENT_SECURITY_POLICY);
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
    response
}
