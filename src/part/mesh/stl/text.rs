//! STL as text.

use toolpathd_core::budget::Budget;

use super::add;
use crate::fault::Unreadable;
use crate::mesh::STEPS_PER_CHECK;
use crate::mesh::welding::Welding;
use crate::mesh::words::{Words, number};

/// A text without the mark of UTF-8 at its beginning.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Reads solids up to the end of the text.
pub fn read(bytes: &[u8], welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    let mut words = Words::new(without_mark(bytes), 1);
    loop {
        match words.next() {
            None => return Ok(()),
            Some(word) if word.eq_ignore_ascii_case(b"solid") => solid(&mut words, welding, budget)?,
            found => return Err(words.fault(found, "solid")),
        }
    }
}

/// The facets of a solid, behind the word `solid`.
fn solid(words: &mut Words, welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    words.skip_line();
    for k in 0_usize.. {
        if k.is_multiple_of(STEPS_PER_CHECK) {
            budget.check()?;
        }
        match words.next() {
            Some(word) if word.eq_ignore_ascii_case(b"facet") => facet(words, welding)?,
            Some(word) if word.eq_ignore_ascii_case(b"endsolid") => break,
            found => return Err(words.fault(found, "facet or endsolid")),
        }
    }
    words.skip_line();
    Ok(())
}

/// A facet, behind the word `facet`.
fn facet(words: &mut Words, welding: &mut Welding) -> Result<(), Unreadable> {
    let place = words.place();
    words.expect("normal")?;
    let normal = [normal(words)?, normal(words)?, normal(words)?];
    words.expect("outer")?;
    words.expect("loop")?;
    let mut corners = [0; 3];
    for corner in &mut corners {
        words.expect("vertex")?;
        let point = point(words)?;
        *corner = welding.vertex(point, words.place())?;
    }
    words.expect("endloop")?;
    words.expect("endfacet")?;
    add(normal, corners, place, welding)
}

/// A coordinate of a normal. Programs write `nan`, `-nan(ind)` or `-1.#IND` for the normal of a triangle
/// without area.
fn normal(words: &mut Words) -> Result<f64, Unreadable> {
    let word = words.next().ok_or_else(|| words.fault(None, "a number"))?;
    Ok(number(word).unwrap_or(f64::NAN))
}

fn point(words: &mut Words) -> Result<[f64; 3], Unreadable> {
    Ok([words.number()?, words.number()?, words.number()?])
}
