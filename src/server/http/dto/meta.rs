//! The caller's own texts about a job. The answer repeats these texts unchanged.

use std::collections::BTreeMap;

use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::check::Violations;
use super::schema::schema_of;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// Names with texts of the caller's choice, for example part id, operation and work order.
pub type Meta = BTreeMap<String, String>;

/// Most entries of `meta`.
pub const MAX_ENTRIES: usize = 32;
/// Most characters of the name of an entry.
pub const MAX_KEY_CHARACTERS: usize = 100;
/// Most characters of any text of the caller that may become a comment of a program.
pub const MAX_TEXT_CHARACTERS: usize = 1000;

schema_of!(MetaTexts, "Names with texts of the caller's choice.", {
    let text = ObjectBuilder::new().schema_type(Type::String).max_length(Some(MAX_TEXT_CHARACTERS));
    ObjectBuilder::new()
        .schema_type(Type::Object)
        .additional_properties(Some(text))
        .max_properties(Some(MAX_ENTRIES))
});

/// The entries as lines for people, one line for each entry.
pub fn notes(meta: Option<&Meta>) -> impl Iterator<Item = String> {
    meta.into_iter().flatten().map(|(key, value)| format!("{key}: {value}"))
}

/// Checks the member `meta` of a request.
pub fn check(meta: Option<&Meta>, violations: &mut Violations) {
    let Some(meta) = meta else { return };
    let at = Pointer::root().field("meta");
    if meta.len() > MAX_ENTRIES {
        let detail = format!("there are {} entries; send at most {MAX_ENTRIES}", meta.len());
        violations.add(&at, FieldCode::TooLong, detail);
        return;
    }
    for (key, value) in meta {
        violations.text(&at, key, MAX_KEY_CHARACTERS);
        if value.len() > MAX_TEXT_CHARACTERS {
            violations.text(&at.field(key), value, MAX_TEXT_CHARACTERS);
        }
    }
}
