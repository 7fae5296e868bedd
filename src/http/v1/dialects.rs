//! The dialects in which programs can be written.

use serde::Serialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};

use crate::http::error::ApiError;
use crate::http::output::Encoded;

pub const DEFAULT: &str = "linuxcnc";

/// The names of the dialects.
pub fn names() -> Vec<&'static str> {
    vec!["linuxcnc"]
}

pub fn is_known(name: &str) -> bool {
    names().contains(&name)
}

/// The name of one of them.
pub fn schema() -> Schema {
    ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some(names()))
        .default(Some(DEFAULT.into()))
        .description(Some("A name listed by `/v1/dialects`."))
        .into()
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Dialects {
    default: &'static str,
    dialects: Vec<Dialect>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Dialect {
    /// The value of `program.dialect`.
    name: &'static str,
}

/// The dialects in which programs can be written.
#[utoipa::path(get, path = "/v1/dialects", operation_id = "listDialects", tag = "service",
    responses((status = 200, description = "All of them.", body = Dialects)))]
pub async fn list_dialects() -> Result<Encoded, ApiError> {
    let dialects = names().into_iter().map(|name| Dialect { name }).collect();
    Encoded::json(&Dialects { default: DEFAULT, dialects })
}
