//! The way from a body to one of its values, while the body is read.

use crate::http::pointer::Pointer;

/// Longest name in a pointer, in bytes. For a member with a longer name the pointer names its object instead.
const MAX_NAME_BYTES: usize = 200;

/// The way to a value. Only a value with a violation gets a [`Pointer`], because a body has very many values.
pub enum Path<'a> {
    Body,
    /// A member of an object, by its name.
    Member(&'a Path<'a>, &'a str),
    /// An element of an array, by its index.
    Element(&'a Path<'a>, usize),
}

impl Path<'_> {
    pub fn pointer(&self) -> Pointer {
        match self {
            Self::Body => Pointer::root(),
            Self::Member(object, name) if name.len() > MAX_NAME_BYTES => object.pointer(),
            Self::Member(object, name) => object.pointer().field(name),
            Self::Element(array, index) => array.pointer().index(*index),
        }
    }
}
