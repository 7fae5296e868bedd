//! `GET /v1/dialects`: the dialects in which programs can be written.

use crate::http::answer::encoded::Encoded;
use crate::http::dto::capabilities::Dialects;
use crate::http::error::ApiError;

/// List the dialects in which programs can be written.
///
/// Each dialect has the name that `program.dialect` takes, what programs in the dialect can state, and what
/// has verified such programs.
#[utoipa::path(get, path = "/v1/dialects", operation_id = "listDialects", tag = "service",
    responses((status = 200, description = "All dialects.", body = Dialects)))]
pub async fn list_dialects() -> Result<Encoded, ApiError> {
    Encoded::json(&Dialects::all())
}
