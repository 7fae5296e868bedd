//! `GET /v1/machines`: the machines that requests may name.

use crate::http::answer::encoded::Encoded;
use crate::http::dto::five_axis::Machines;
use crate::http::error::ApiError;

/// List the machines that `/v1/five-axis/smooth` knows by name.
///
/// The machines are generic examples of the usual kinds. A request may describe its own machine instead.
#[utoipa::path(get, path = "/v1/machines", operation_id = "listMachines", tag = "five-axis",
    responses((status = 200, description = "All machines.", body = Machines)))]
pub async fn list_machines() -> Result<Encoded, ApiError> {
    Encoded::json(&Machines::all())
}
