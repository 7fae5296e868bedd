//! The dialects in which programs can be written.

use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, Schema, SchemaType, Type};

use crate::http::error::ApiError;
use crate::http::output::Encoded;
use crate::post::{self, DIALECTS};

/// The dialect of a program that names none: the first of the table.
pub const DEFAULT: &post::Dialect = DIALECTS[0];

fn names() -> impl Iterator<Item = &'static str> {
    DIALECTS.iter().map(|dialect| dialect.name)
}

/// The dialect called `name`, or else what is wrong with it.
pub fn find(name: Option<&str>) -> Result<&'static post::Dialect, String> {
    let Some(name) = name else { return Ok(DEFAULT) };
    post::dialect(name).ok_or_else(|| {
        let known: Vec<_> = names().collect();
        let shown: String = name.chars().take(40).collect();
        format!("`{shown}` is unknown, expected `{}`", known.join("`, `"))
    })
}

/// The name of one of them.
pub fn schema() -> Schema {
    ObjectBuilder::new()
        .schema_type(SchemaType::from_iter([Type::String, Type::Null]))
        .enum_values(Some(names().map(Value::from).chain([Value::Null])))
        .default(Some(DEFAULT.name.into()))
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
    description: &'static str,
    /// Of a program's file, without the dot.
    file_extension: &'static str,
    /// Decimals of a written coordinate where none are asked for.
    default_decimals: DefaultDecimals,
    max_decimals: u8,
    /// The largest `program.number`; absent where a program is known by its file alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_program_number: Option<u32>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct DefaultDecimals {
    mm: u8,
    inch: u8,
}

impl From<&post::Dialect> for Dialect {
    fn from(dialect: &post::Dialect) -> Self {
        Self {
            name: dialect.name,
            description: dialect.description,
            file_extension: dialect.file_extension,
            default_decimals: DefaultDecimals {
                mm: dialect.default_decimals_mm,
                inch: dialect.default_decimals_inch,
            },
            max_decimals: dialect.max_decimals,
            max_program_number: dialect.program_number.map(|number| number.max),
        }
    }
}

/// The dialects in which programs can be written.
#[utoipa::path(get, path = "/v1/dialects", operation_id = "listDialects", tag = "service",
    responses((status = 200, description = "All of them.", body = Dialects)))]
pub async fn list_dialects() -> Result<Encoded, ApiError> {
    let dialects = DIALECTS.iter().map(|&dialect| dialect.into()).collect();
    Encoded::json(&Dialects { default: DEFAULT.name, dialects })
}
