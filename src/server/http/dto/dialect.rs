//! The names of the dialects in which programs can be written.

use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::schema::schema_of;
use toolpathd_post::DIALECTS;

/// The dialect of a program whose request names none: the first dialect of the table.
pub const DEFAULT: &toolpathd_post::Dialect = DIALECTS[0];

fn names() -> impl Iterator<Item = &'static str> {
    DIALECTS.iter().map(|dialect| dialect.name)
}

/// The dialect called `name`, or the default without a name.
///
/// # Errors
/// A message for people, when no dialect has the name.
pub fn find(name: Option<&str>) -> Result<&'static toolpathd_post::Dialect, String> {
    let Some(name) = name else { return Ok(DEFAULT) };
    toolpathd_post::dialect(name).ok_or_else(|| {
        let known: Vec<_> = names().collect();
        let shown: String = name.chars().take(40).collect();
        format!("the dialect `{shown}` is unknown; use one of `{}`", known.join("`, `"))
    })
}

schema_of!(DialectName, "Name of a dialect, as listed by `/v1/dialects`.", {
    ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names()))
});
