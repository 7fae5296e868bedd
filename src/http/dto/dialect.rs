//! The dialects in which programs can be written: their names in requests, and their description in answers.

use serde::Serialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::schema::schema_of;
use crate::post::{self, DIALECTS};

/// The dialect of a program whose request names none: the first dialect of the table.
pub const DEFAULT: &post::Dialect = DIALECTS[0];

fn names() -> impl Iterator<Item = &'static str> {
    DIALECTS.iter().map(|dialect| dialect.name)
}

/// The dialect called `name`, or the default without a name.
///
/// # Errors
/// A message for people, when no dialect has the name.
pub fn find(name: Option<&str>) -> Result<&'static post::Dialect, String> {
    let Some(name) = name else { return Ok(DEFAULT) };
    post::dialect(name).ok_or_else(|| {
        let known: Vec<_> = names().collect();
        let shown: String = name.chars().take(40).collect();
        format!("the dialect `{shown}` is unknown; use one of `{}`", known.join("`, `"))
    })
}

schema_of!(DialectName, "Name of a dialect, as listed by `/v1/dialects`.", {
    ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names()))
});

/// The dialects in which programs can be written.
#[derive(Debug, Serialize, ToSchema)]
pub struct Dialects {
    /// Name of the dialect that is used where `program.dialect` is absent.
    default: &'static str,
    /// All dialects.
    dialects: Vec<Dialect>,
}

/// What one dialect can write.
#[derive(Debug, Serialize, ToSchema)]
pub struct Dialect {
    /// Name of the dialect: the value of `program.dialect`.
    name: &'static str,
    /// The controls that the dialect is for.
    description: &'static str,
    /// Extension of a program's file, without the dot.
    file_extension: &'static str,
    /// Number of decimals of a written coordinate where the request has no `program.decimals`.
    default_decimals: DefaultDecimals,
    /// Largest number of decimals of a written coordinate.
    max_decimals: u8,
    /// The largest `program.number`: a plain number. Absent where the dialect has no program numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_program_number: Option<u32>,
}

/// Numbers of decimals by units.
#[derive(Debug, Serialize, ToSchema)]
pub struct DefaultDecimals {
    /// Number of decimals of a program in mm.
    mm: u8,
    /// Number of decimals of a program in inches.
    inch: u8,
}

impl Dialects {
    /// All dialects.
    pub fn all() -> Self {
        Self { default: DEFAULT.name, dialects: DIALECTS.iter().map(|&dialect| dialect.into()).collect() }
    }
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
