//! STL: triangles with a normal each, as text or binary.
//!
//! # Method
//! A file is binary if its length is that of as many triangles as the number behind its first 80 bytes tells;
//! many programs begin these 80 bytes with `solid`, as a text begins. Else it is a text if `facet` or
//! `endsolid` follows the first line, which begins with `solid`. All other files are binary.
//!
//! All solids of a file become one mesh. The order of the corners tells where outside is; a normal that
//! contradicts the order is counted as left out.

mod text;

use toolpathd_core::budget::Budget;

use super::STEPS_PER_CHECK;
use super::bytes::{Bytes, Order};
use super::welding::{Welding, dot};
use super::words::Words;
use crate::fault::{Place, Unreadable};

/// The bytes before the number of triangles.
const HEADER: usize = 80;

/// The bytes before the first triangle.
const START: usize = HEADER + 4;

/// The bytes of a triangle: twelve numbers and an attribute.
const TRIANGLE: usize = 50;

pub fn read(bytes: &[u8], welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    if !is_binary_by_length(bytes) && is_text(bytes) {
        return text::read(bytes, welding, budget);
    }
    binary(bytes, welding, budget)
}

/// Whether a file has just the length of a binary one.
pub fn is_binary_by_length(bytes: &[u8]) -> bool {
    let mut head = Bytes::new(bytes, HEADER, Order::LittleEndian);
    head.u32().is_ok_and(|n| n as usize == head.n_left() / TRIANGLE && head.n_left().is_multiple_of(TRIANGLE))
}

/// Whether a file begins as a text of solids.
pub fn is_text(bytes: &[u8]) -> bool {
    let mut words = Words::new(text::without_mark(bytes), 1);
    if words.expect("solid").is_err() {
        return false;
    }
    words.skip_line();
    let is = |word: &[u8], name: &str| word.eq_ignore_ascii_case(name.as_bytes());
    words.next().is_some_and(|word| is(word, "facet") || is(word, "endsolid"))
}

fn binary(bytes: &[u8], welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    let mut rest = Bytes::new(bytes, HEADER, Order::LittleEndian);
    if bytes.len() < START {
        let detail = "it is neither a text of solids, nor long enough for a binary STL file";
        return Err(Unreadable::at(Place::File, detail));
    }
    let n_stated = rest.u32()? as usize;
    let n_held = rest.n_left() / TRIANGLE;
    if n_stated > n_held {
        let detail = format!("{n_stated} triangles were to follow byte {START}; the file has {n_held}");
        return Err(Unreadable::at(Place::Byte(bytes.len() as u64), detail));
    }
    for k in 0..n_stated {
        if k.is_multiple_of(STEPS_PER_CHECK) {
            budget.check()?;
        }
        let place = rest.place();
        let mut point = || -> Result<[f64; 3], Unreadable> {
            Ok([rest.little()?, rest.little()?, rest.little()?].map(|x| f64::from(f32::from_le_bytes(x))))
        };
        let [normal, a, b, c] = [point()?, point()?, point()?, point()?];
        let corners = [welding.vertex(a, place)?, welding.vertex(b, place)?, welding.vertex(c, place)?];
        add(normal, corners, place, welding)?;
        if rest.u16()? != 0 {
            welding.left_out.add("attribute", "attributes of triangles are not read", place);
        }
    }
    let n_behind = rest.n_left();
    welding.left_out.add_many("byte", "it stands behind the last triangle", n_behind, rest.place());
    Ok(())
}

/// Adds a triangle with a normal.
fn add(normal: [f64; 3], corners: [u32; 3], place: Place, welding: &mut Welding) -> Result<(), Unreadable> {
    if dot(welding.normal(corners), normal) < 0.0 {
        let reason = "it points against the order of the corners, which tells where outside is";
        welding.left_out.add("normal", reason, place);
    }
    welding.triangle(corners, place)
}
