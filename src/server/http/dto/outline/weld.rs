//! Joins vertices of outlines that rounding has put apart.
//!
//! # Method
//! 1. A vertex that is nearer to the one before than [`WELD_MM`] is left out, if the element between them is
//!    as small.
//! 2. A spike is an element out and the next one back along the same line or arc. Its tip is left out.
//! 3. Both are repeated until none is left, or the outline has only two vertices.
//!
//! # Guarantees
//! The outline moves by less than [`WELD_MM`] for each vertex that is left out, but for spikes, which enclose
//! nothing.

use nalgebra::{Point2, Vector2};

use toolpathd_core::geometry::segment::Segment;

/// Vertices nearer to each other are one, mm: a hundredth of the last of three decimals.
const WELD_MM: f64 = 1e-5;

/// Bulges that differ by less are the same.
const SAME_BULGE: f64 = 1e-6;

/// A vertex of an outline, and the bulge of the element from there to the next, to the left if positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    pub at: Point2<f64>,
    pub bulge: f64,
}

/// The lines and arcs between the vertices of a closed outline, without those that are rounding.
pub fn elements(outline: &[Corner]) -> Vec<Segment> {
    edges(&welded(outline)).into_iter().filter(|element| element.start() != element.end()).collect()
}

/// The line or arc from each vertex of a closed outline to the next.
pub fn edges(outline: &[Corner]) -> Vec<Segment> {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(from, to)| Segment::bulging(from.at, to.at, -from.bulge)).collect()
}

/// The vertices of a closed outline, welded.
fn welded(outline: &[Corner]) -> Vec<Corner> {
    let mut kept: Vec<Corner> = Vec::with_capacity(outline.len());
    for vertex in outline {
        kept.push(*vertex);
        while shortened(&mut kept) {}
    }
    // The end of the outline is followed by its start.
    while kept.len() > 2 {
        let n = kept.len();
        let [first, second, before, last] = [kept[0], kept[1], kept[n - 2], kept[n - 1]];
        if is_speck(&last, &first) {
            kept.pop();
        } else if is_spike(&before, &last, &first) {
            kept.truncate(n - 1);
            kept[n - 2] = bridge(&before, &last, &first);
        } else if is_spike(&last, &first, &second) {
            kept[n - 1] = bridge(&last, &first, &second);
            kept.remove(0);
        } else {
            break;
        }
    }
    // An outline of rounding alone stays, to be refused as what it is.
    if kept.len() < 2 { outline.to_vec() } else { kept }
}

/// Leaves out the last vertex but one if it is the tip of a spike, or the last if it repeats the one before.
fn shortened(kept: &mut Vec<Corner>) -> bool {
    match kept[..] {
        [.., a, b] if is_speck(&a, &b) => {
            // The place stays that of the first; what follows is that of the second.
            kept.pop();
            if let Some(last) = kept.last_mut() {
                last.bulge = b.bulge;
            }
            false
        }
        [.., a, b, c] if is_spike(&a, &b, &c) => {
            let n = kept.len();
            kept[n - 3] = bridge(&a, &b, &c);
            kept.remove(n - 2);
            true
        }
        _ => false,
    }
}

/// Whether the element from `a` to `b` is no larger than rounding.
fn is_speck(a: &Corner, b: &Corner) -> bool {
    (b.at - a.at).norm() * a.bulge.abs().max(1.0) < WELD_MM
}

/// Whether the outline goes from `a` to `b` and back along the same way, toward `c`.
fn is_spike(a: &Corner, b: &Corner, c: &Corner) -> bool {
    let (out, back) = (b.at - a.at, c.at - b.at);
    if a.bulge != 0.0 || b.bulge != 0.0 {
        return (out + back).norm() < WELD_MM && (a.bulge + b.bulge).abs() < SAME_BULGE;
    }
    let beside = |long: Vector2<f64>, short: Vector2<f64>| {
        let length = long.norm();
        length > 0.0 && (long.perp(&short) / length).abs() < WELD_MM
    };
    let [long, short] = if out.norm() < back.norm() { [back, out] } else { [out, back] };
    out.dot(&back) < 0.0 && beside(long, short)
}

/// The vertex `a` where the spike from `a` to `b` toward `c` is left out.
fn bridge(a: &Corner, b: &Corner, c: &Corner) -> Corner {
    // Out and back along an arc ends where it began, and nothing is between `a` and `c`.
    let is_line = a.bulge == 0.0 && b.bulge == 0.0;
    Corner { at: a.at, bulge: if is_line || (c.at - a.at).norm() < WELD_MM { 0.0 } else { a.bulge } }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(points: &[[f64; 3]]) -> Vec<Corner> {
        points.iter().map(|[x, y, bulge]| Corner { at: Point2::new(*x, *y), bulge: *bulge }).collect()
    }

    fn places(outline: &[Corner]) -> Vec<[f64; 2]> {
        outline.iter().map(|vertex| [vertex.at.x, vertex.at.y]).collect()
    }

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 0.0], [0.0, 9.0, 0.0]];

    #[test]
    fn an_outline_without_rounding_stays_as_it_is() {
        let arcs = outline(&[[0.0, 0.0, 1.0], [4.0, 0.0, 1.0]]);
        assert_eq!(welded(&arcs), arcs);
        assert_eq!(welded(&outline(&SQUARE)), outline(&SQUARE));
        let apart = outline(&[[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 2e-5, 0.0], [0.0, 9.0, 0.0]]);
        assert_eq!(welded(&apart), apart);
        // From one vertex nearly all around to its neighbour.
        let circle = outline(&[[0.0, 0.0, 1000.0], [8e-6, 0.0, 0.0], [-3.0, 1.0, 0.0], [-3.0, -1.0, 0.0]]);
        assert_eq!(welded(&circle), circle);
    }

    #[test]
    fn vertices_a_hundredth_of_a_decimal_apart_are_one_wherever_the_outline_starts() {
        for gap in [[8e-6, 0.0], [-8e-6, 0.0], [0.0, 8e-6], [-5e-6, -5e-6]] {
            for (k, corner) in SQUARE.iter().enumerate() {
                let mut points = SQUARE.to_vec();
                points.insert(k + 1, [corner[0] + gap[0], corner[1] + gap[1], 0.0]);
                for _ in 0..points.len() {
                    points.rotate_left(1);
                    assert_eq!(welded(&outline(&points)).len(), 4, "{points:?}");
                }
            }
        }
    }

    #[test]
    fn a_spike_along_a_line_or_an_arc_is_left_out_wherever_the_outline_starts() {
        let mut line = SQUARE.to_vec();
        line.splice(2..2, [[14.0, 0.0, 0.0], [9.0, 0.0, 0.0]]);
        let mut beyond = SQUARE.to_vec();
        beyond[1] = [12.0, 0.0, 0.0];
        beyond.insert(2, [9.0, 0.0, 0.0]);
        let mut arc = SQUARE.to_vec();
        arc[1][2] = 0.4;
        arc.splice(2..2, [[14.0, 3.0, -0.4], [9.0, 0.0, 0.0]]);
        for points in [line, beyond, arc] {
            let mut points = points;
            for _ in 0..points.len() {
                points.rotate_left(1);
                let mut left = places(&welded(&outline(&points)));
                left.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
                assert_eq!(left, [[0.0, 0.0], [0.0, 9.0], [9.0, 0.0], [9.0, 9.0]], "{points:?}");
            }
        }
    }

    #[test]
    fn out_and_back_alone_keeps_two_vertices() {
        assert_eq!(welded(&outline(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])).len(), 2);
        assert_eq!(welded(&outline(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [4.0, 0.0, 0.0]])).len(), 2);
    }
}
