//! The pieces of a stroke that meet material.

use super::chain::first_part;
use crate::budget::Stopped;
use crate::geometry::segment::Segment;
use crate::machining::engagement::{Stretch, straight_angle};

/// Material beside a stroke that is thinner is left, mm, or as a part of the radius where that is less.
const THINNEST_MM: f64 = 0.01;
const THINNEST: f64 = 0.005;

/// Beside arcs thinner material cannot be told from none, as a part of the radius: the chords that stand for
/// arcs leave a thousandth.
const TOLD_APART: f64 = 0.0015;

/// Two pieces with a shorter way between them are cut as one piece, in cutter radii.
const JOINED: f64 = 1.0;

/// Material beside a stroke that is thinner is left, mm. All that is thicker is cut.
pub fn thinnest_mm(radius_mm: f64) -> f64 {
    THINNEST_MM.min(THINNEST * radius_mm).max(TOLD_APART * radius_mm)
}

/// How a stroke meets material.
pub enum Pieces {
    /// Everywhere.
    Whole,
    /// Only along these pieces.
    Some(Vec<Vec<Segment>>),
}

/// The pieces of a stroke along which there is material. Each piece begins `ahead` radii before its material
/// and goes on `beyond` radii behind it, or less if the stroke has less way without material there. `survey`
/// finds the angles along an element,
/// and need not be exact below the angle that it is given.
pub fn pieces(
    stroke: &[Segment],
    radius_mm: f64,
    [ahead, beyond]: [f64; 2],
    mut survey: impl FnMut(&Segment, f64) -> Result<Vec<Stretch>, Stopped>,
) -> Result<Pieces, Stopped> {
    let sliver = straight_angle(radius_mm, thinnest_mm(radius_mm));
    let mut parts: Vec<(Segment, bool)> = Vec::new();
    for element in stroke {
        for stretch in survey(element, sliver)? {
            let part = element.part(stretch.from, stretch.to);
            if part.length() > 0.0 {
                parts.push((part, stretch.angle > sliver));
            }
        }
    }
    if parts.iter().all(|(_, meets)| *meets) {
        return Ok(Pieces::Whole);
    }
    let is_loop = stroke[0].start() == stroke[stroke.len() - 1].end();
    if is_loop && let Some(k) = parts.iter().position(|(_, meets)| !meets) {
        // The loop begins at a place without material, so that its beginning divides no piece.
        let after = parts[k..].iter().position(|(_, meets)| *meets).map_or(k, |n| k + n);
        parts.rotate_left(after.saturating_sub(1).max(k));
    }
    Ok(Pieces::Some(joined(&parts, JOINED * radius_mm, [ahead, beyond].map(|part| part * radius_mm))))
}

fn joined(parts: &[(Segment, bool)], gap_mm: f64, [ahead_mm, beyond_mm]: [f64; 2]) -> Vec<Vec<Segment>> {
    let mut pieces: Vec<Vec<Segment>> = Vec::new();
    let mut clear: Vec<Segment> = Vec::new();
    for (part, meets) in parts {
        if !meets {
            clear.push(*part);
            continue;
        }
        match pieces.last_mut() {
            Some(piece) if length(&clear) < gap_mm => piece.append(&mut clear),
            last => {
                if let Some(piece) = last {
                    piece.extend(first_part(&clear, beyond_mm));
                }
                pieces.push(tail(&clear, ahead_mm));
            }
        }
        clear.clear();
        if let Some(piece) = pieces.last_mut() {
            piece.push(*part);
        }
    }
    if let Some(piece) = pieces.last_mut() {
        piece.extend(first_part(&clear, beyond_mm));
    }
    pieces
}

fn length(elements: &[Segment]) -> f64 {
    elements.iter().map(Segment::length).sum()
}

/// The last `length_mm` of a chain.
fn tail(chain: &[Segment], length_mm: f64) -> Vec<Segment> {
    let mut left = length_mm;
    let mut tail = Vec::new();
    for element in chain.iter().rev() {
        let own = element.length();
        if own >= left {
            if left > 0.0 {
                tail.push(element.part(1.0 - left / own, 1.0));
            }
            break;
        }
        tail.push(*element);
        left -= own;
    }
    tail.reverse();
    tail
}
