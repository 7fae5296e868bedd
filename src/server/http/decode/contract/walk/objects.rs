//! Objects whose member `kind` says which other members they have.

use serde::de::DeserializeSeed;
use serde_json::Value;
use serde_json::value::RawValue;
use utoipa::openapi::schema::{Discriminator, Schema};

use super::super::Asked;
use super::super::outline::{names_of, tag_of};
use super::{Unchecked, ValueCheck, Walk};
use crate::http::decode::path::Path;
use crate::http::decode::words;
use crate::http::error::FieldCode;

/// The member that tells objects apart.
const KIND: &str = "kind";

/// The union, and its kinds that reports count and this version cannot read yet.
const PLANNED: (&str, &[&str]) = ("SentMove", &["spline"]);

impl<'c> Walk<'c> {
    /// An object that is one of several, of which one at most has no member `kind`.
    pub(super) fn choice(
        &mut self,
        at: &Path,
        objects: &[(Option<&'c str>, Asked<'c>)],
        sent: &RawValue,
    ) -> serde_json::Result<()> {
        let tag = tag_of(sent, KIND)?.filter(|tag| !tag.is_null());
        let kind = tag.as_ref().and_then(Value::as_str);
        if tag.is_none() && self.lacks_kind(objects, sent)? {
            self.missing(&Path::Member(at, KIND), KIND);
            return Unchecked(self).deserialize(&mut serde_json::Deserializer::from_str(sent.get()));
        }
        match objects.iter().find(|(own, _)| *own == kind && (kind.is_some() || tag.is_none())) {
            Some((_, asked)) => {
                let mut reader = serde_json::Deserializer::from_str(sent.get());
                let check = ValueCheck { walk: self, at, asked: *asked, is_member: false };
                check.deserialize(&mut reader).map(|_| ())
            }
            None => {
                let names: Vec<&str> = objects.iter().filter_map(|(kind, _)| *kind).collect();
                let sent_kind = tag.unwrap_or_default();
                self.blame(&Path::Member(at, KIND), FieldCode::UnknownValue, || match sent_kind.as_str() {
                    Some(kind) => words::unknown(kind, &names),
                    None => words::wrong(&words::one_of(&names), &sent_kind),
                });
                Unchecked(self).deserialize(&mut serde_json::Deserializer::from_str(sent.get()))
            }
        }
    }

    /// Whether an object without a kind has a member that only objects with a kind have.
    fn lacks_kind(
        &self,
        objects: &[(Option<&'c str>, Asked<'c>)],
        sent: &RawValue,
    ) -> serde_json::Result<bool> {
        let members = |asked: &Asked<'c>| match asked.usual {
            Some((_, Schema::Object(object))) => Some(&object.properties),
            _ => None,
        };
        let has = |with_kind: bool, name: &str| {
            let chosen = objects.iter().filter(|(kind, _)| kind.is_some() == with_kind);
            chosen.filter_map(|(_, asked)| members(asked)).any(|members| members.contains_key(name))
        };
        Ok(names_of(sent)?.iter().any(|name| has(true, name) && !has(false, name)))
    }

    /// An object whose member `kind` says which other members the object has.
    pub(super) fn union(
        &mut self,
        at: &Path,
        name: &str,
        kinds: &'c Discriminator,
        sent: &RawValue,
    ) -> serde_json::Result<()> {
        let tag = kinds.property_name.as_str();
        let at_tag = Path::Member(at, tag);
        let names = || kinds.mapping.keys().map(String::as_str).collect::<Vec<_>>();
        match tag_of(sent, tag)? {
            None | Some(Value::Null) => self.missing(&at_tag, tag),
            Some(Value::String(kind)) => match kinds.mapping.get(&kind) {
                Some(target) => {
                    let asked = Asked { usual: self.contract.at(target), choices: &[] };
                    let mut reader = serde_json::Deserializer::from_str(sent.get());
                    let check = ValueCheck { walk: self, at, asked, is_member: false };
                    return check.deserialize(&mut reader).map(|_| ());
                }
                None if name == PLANNED.0 && PLANNED.1.contains(&kind.as_str()) => {
                    self.blame(&at_tag, FieldCode::Unsupported, || {
                        format!("`{kind}` is not supported yet; use {}", words::one_of(&names()))
                    });
                }
                None => self.blame(&at_tag, FieldCode::UnknownValue, || words::unknown(&kind, &names())),
            },
            Some(other) => {
                self.blame(&at_tag, FieldCode::WrongType, || words::wrong(&words::one_of(&names()), &other));
            }
        }
        // Of an object without a known kind nothing else can be checked.
        Unchecked(self).deserialize(&mut serde_json::Deserializer::from_str(sent.get()))
    }
}
