//! Tests of interpolated curves. Their evaluator shares no code with the library.

mod bounds;
mod crumbs;
mod evaluator;
mod hyun_1992;
mod least;
mod one_sided;
mod refused;

use serde_json::Value;

use crate::api::support::{Answer, app, post};

pub const PATH: &str = "/v1/curves/interpolate";

/// Posts a body to `/v1/curves/interpolate`.
pub async fn ask(body: &Value) -> Answer {
    post(&app(&["--workers", "1"]), PATH, body.to_string(), &[]).await
}

/// The JSON answer to a legal body. Fails if the service refuses the body.
pub async fn answer(body: &Value) -> Value {
    let answer = ask(body).await;
    assert_eq!(answer.status, 200, "{}\n{body}", answer.text());
    answer.json()
}
