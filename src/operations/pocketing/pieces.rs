//! The pieces of a stroke that meet material.

use super::PocketError;
use super::router::Router;
use crate::geometry::element::Element;

/// Pieces with smaller angles are not followed, radians: what they leave is thinner than a hundredth of the
/// radius.
const SLIVER: f64 = 0.1;

/// Pieces that are nearer to each other are cut as one, in cutter radii.
const JOINED: f64 = 1.0;

/// How a stroke meets material.
pub enum Pieces {
    /// All along.
    Whole,
    /// In these pieces.
    Some(Vec<Vec<Element>>),
}

/// The pieces of a stroke along which there is material. Each begins `lead_mm` before its material, as far as
/// the stroke does.
pub fn pieces(router: &mut Router, stroke: &[Element], lead_mm: f64) -> Result<Pieces, PocketError> {
    let mut parts: Vec<(Element, bool)> = Vec::new();
    for element in stroke {
        for stretch in router.survey(element, SLIVER)? {
            let part = element.part(stretch.from, stretch.to);
            if part.length() > 0.0 {
                parts.push((part, stretch.angle > SLIVER));
            }
        }
    }
    if parts.iter().all(|(_, meets)| *meets) {
        return Ok(Pieces::Whole);
    }
    let is_loop = stroke[0].start() == stroke[stroke.len() - 1].end();
    if is_loop && let Some(k) = parts.iter().position(|(_, meets)| !meets) {
        // No piece of a loop is divided where the loop begins.
        let after = parts[k..].iter().position(|(_, meets)| *meets).map_or(k, |n| k + n);
        parts.rotate_left(after.saturating_sub(1).max(k));
    }
    Ok(Pieces::Some(joined(&parts, JOINED * router.conditions.radius_mm, lead_mm)))
}

fn joined(parts: &[(Element, bool)], gap_mm: f64, lead_mm: f64) -> Vec<Vec<Element>> {
    let mut pieces: Vec<Vec<Element>> = Vec::new();
    let mut clear: Vec<Element> = Vec::new();
    for (part, meets) in parts {
        if !meets {
            clear.push(*part);
            continue;
        }
        match pieces.last_mut() {
            Some(piece) if length(&clear) < gap_mm => piece.append(&mut clear),
            _ => pieces.push(tail(&clear, lead_mm)),
        }
        clear.clear();
        if let Some(piece) = pieces.last_mut() {
            piece.push(*part);
        }
    }
    pieces
}

fn length(elements: &[Element]) -> f64 {
    elements.iter().map(Element::length).sum()
}

/// The last `length_mm` of a chain.
fn tail(chain: &[Element], length_mm: f64) -> Vec<Element> {
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
