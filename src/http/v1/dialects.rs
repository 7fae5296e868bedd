//! `GET /v1/dialects`: the dialects in which programs can be written.

use crate::http::dto::dialect::Dialects;
use crate::http::error::ApiError;
use crate::http::output::Encoded;

/// List the dialects in which programs can be written.
///
/// Each dialect has the name that `program.dialect` takes, and the decimals and program numbers that the
/// dialect can write.
#[utoipa::path(get, path = "/v1/dialects", operation_id = "listDialects", tag = "service",
    responses((status = 200, description = "All dialects.", body = Dialects)))]
pub async fn list_dialects() -> Result<Encoded, ApiError> {
    Encoded::json(&Dialects::all())
}
