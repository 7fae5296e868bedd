//! Lines and arcs by their bulges: their areas, lengths and segments.

use toolpathd_core::geometry::segment::Segment;

/// Below this bulge the area beside a chord is computed by its series, because the closed form would lose
/// digits. The first neglected term is below 1e-14 of the result.
const SMALL_BULGE: f64 = 0.01;

/// The element from a vertex to the next. Core counts bulges positive to the left of the chord.
pub fn segment(from: [f64; 3], to: [f64; 3]) -> Segment {
    Segment::bulging([from[0], from[1]].into(), [to[0], to[1]].into(), -from[2])
}

/// The elements of a chain; of a loop, the last leads back to the first vertex.
pub fn segments(vertices: &[[f64; 3]], is_closed: bool) -> impl Iterator<Item = Segment> + '_ {
    pairs(vertices, is_closed).map(|[from, to]| segment(from, to))
}

/// The signed area that a loop encloses, positive if the loop runs counterclockwise.
pub fn area(vertices: &[[f64; 3]]) -> f64 {
    // Measured from the first vertex, the triangles of a small loop far from the origin lose no digits.
    vertices.first().map_or(0.0, |[x, y, _]| swept(vertices, true, [*x, *y]))
}

/// The signed area between a place and a chain, positive if the chain runs counterclockwise around the place.
pub fn swept(vertices: &[[f64; 3]], is_closed: bool, [x, y]: [f64; 2]) -> f64 {
    let twice: f64 = pairs(vertices, is_closed)
        .map(|[from, to]| {
            let [a, b] = [from, to].map(|p| [p[0] - x, p[1] - y]);
            a[0] * b[1] - a[1] * b[0] + 2.0 * area_beside_chord(from, to)
        })
        .sum();
    0.5 * twice
}

pub fn length(vertices: &[[f64; 3]], is_closed: bool) -> f64 {
    pairs(vertices, is_closed).map(|[from, to]| length_of(from, to)).sum()
}

/// The chain in the other direction. A loop keeps its first vertex.
pub fn reversed(vertices: &[[f64; 3]], is_closed: bool) -> Vec<[f64; 3]> {
    let n = vertices.len();
    let shift = usize::from(is_closed);
    (0..n)
        .map(|k| {
            let at = (2 * n - 1 - k + shift) % n;
            let bulge = match is_closed || at > 0 {
                true => -vertices[(at + n - 1) % n][2],
                false => 0.0,
            };
            // Without the sum, a bulge of zero would become minus zero.
            [vertices[at][0], vertices[at][1], bulge + 0.0]
        })
        .collect()
}

/// Whether a place lies inside a loop. Within rounding of the loop either answer may come.
pub fn is_inside(vertices: &[[f64; 3]], [x, y]: [f64; 2]) -> bool {
    // Crossings of the ray along x with the chords, and places between an arc and its chord.
    let mut is_inside = false;
    for [from, to] in pairs(vertices, true) {
        if (from[1] > y) != (to[1] > y) && x < from[0] + (y - from[1]) / (to[1] - from[1]) * (to[0] - from[0])
        {
            is_inside = !is_inside;
        }
        is_inside ^= is_beside_chord(from, to, [x, y]);
    }
    is_inside
}

/// Whether a place lies between an arc and its chord.
fn is_beside_chord(from: [f64; 3], to: [f64; 3], [x, y]: [f64; 2]) -> bool {
    let bulge = from[2];
    let chord = [to[0] - from[0], to[1] - from[1]];
    let squared = chord[0] * chord[0] + chord[1] * chord[1];
    if bulge == 0.0 || squared == 0.0 {
        return false;
    }
    let at = [x - from[0], y - from[1]];
    // A positive bulge lies to the right of the chord.
    let left = chord[0] * at[1] - chord[1] * at[0];
    if (left < 0.0) != (bulge > 0.0) {
        return false;
    }
    // From a place inside the circle, on the arc's side, the chord is seen under a larger angle than from the
    // arc.
    let [a, b] = [[-at[0], -at[1]], [to[0] - x, to[1] - y]];
    let angle = (a[0] * b[1] - a[1] * b[0]).abs().atan2(a[0] * b[0] + a[1] * b[1]);
    angle > std::f64::consts::PI - 2.0 * bulge.abs().atan()
}

fn pairs(vertices: &[[f64; 3]], is_closed: bool) -> impl Iterator<Item = [[f64; 3]; 2]> + '_ {
    let n = vertices.len();
    let count = if is_closed { n } else { n.saturating_sub(1) };
    (0..count).map(move |k| [vertices[k], vertices[(k + 1) % n]])
}

fn length_of(from: [f64; 3], to: [f64; 3]) -> f64 {
    let chord = f64::hypot(to[0] - from[0], to[1] - from[1]);
    let bulge = from[2].abs();
    // A quarter of the turn is atan(bulge); the radius is the chord times (1 + bulge^2) / (4 bulge).
    if bulge == 0.0 { chord } else { chord * (1.0 + bulge * bulge) * (bulge.atan() / bulge) }
}

/// The signed area between a chord and its arc, positive where the arc lies to the right of the chord.
fn area_beside_chord(from: [f64; 3], to: [f64; 3]) -> f64 {
    let b = from[2];
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let square = b * b;
    // r^2 (turn - sin turn) / 2 with the radius and the turn as above.
    let part = if b.abs() < SMALL_BULGE {
        b / 3.0 * (1.0 + square / 5.0 * (1.0 - square / 7.0))
    } else {
        ((1.0 + square).powi(2) * b.atan() - b * (1.0 - square)) / (8.0 * square)
    };
    part * (x * x + y * y)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_8, PI};

    use super::*;

    #[test]
    fn areas_and_lengths_are_closed_forms() {
        let circle = [[7.0, 3.0, 1.0], [3.0, 3.0, 1.0]];
        assert!((area(&circle) - 4.0 * PI).abs() < 1e-14 && (length(&circle, true) - 4.0 * PI).abs() < 1e-14);
        // A square of 10 with corners rounded by a radius of 2.
        let b = FRAC_PI_8.tan();
        let corner = |x: f64, y: f64, bulge: f64| [x + 1e5, y - 1e5, bulge];
        let rounded = [
            corner(2.0, 0.0, 0.0),
            corner(8.0, 0.0, b),
            corner(10.0, 2.0, 0.0),
            corner(10.0, 8.0, b),
            corner(8.0, 10.0, 0.0),
            corner(2.0, 10.0, b),
            corner(0.0, 8.0, 0.0),
            corner(0.0, 2.0, b),
        ];
        assert!((area(&rounded) - (100.0 - 16.0 + 4.0 * PI)).abs() < 1e-12);
        assert!((length(&rounded, true) - (24.0 + 4.0 * PI)).abs() < 1e-12);
        let back = reversed(&rounded, true);
        assert_eq!(back[0][..2], rounded[0][..2]);
        assert!((area(&back) + area(&rounded)).abs() < 1e-12);
        assert_eq!(reversed(&back, true), rounded);
        let open = reversed(&rounded, false);
        assert_eq!(open[0], corner(0.0, 2.0, 0.0));
        assert!((length(&open, false) - length(&rounded, false)).abs() < 1e-12);
    }

    #[test]
    fn the_area_beside_a_flat_arc_keeps_its_digits() {
        for b in [0.009_999f64, 0.010_001, 1e-4, 1e-9] {
            // r^2 (turn - sin turn) / 2, by the series of the sine in the turn.
            let (turn, radius) = (4.0 * b.atan(), (1.0 + b * b) / (4.0 * b));
            let cube = turn.powi(3) / 6.0;
            let exact = 0.5
                * radius
                * radius
                * cube
                * (1.0 - turn.powi(2) / 20.0 * (1.0 - turn.powi(2) / 42.0 * (1.0 - turn.powi(2) / 72.0)));
            let found = area_beside_chord([0.0, 0.0, b], [1.0, 0.0, 0.0]);
            assert!((found / exact - 1.0).abs() < 1e-11, "{b} {found} {exact}");
        }
    }

    #[test]
    fn places_inside_a_loop_are_told_from_those_outside() {
        // A square with a half circle outward on the right and one inward on the top.
        let own = [[0.0, 0.0, 0.0], [10.0, 0.0, 1.0], [10.0, 10.0, -1.0], [0.0, 10.0, 0.0]];
        for ([x, y], expected) in [
            ([1.0, 1.0], true),
            ([14.0, 5.0], true),
            ([14.0, 9.0], false),
            ([5.0, 9.0], false),
            ([5.0, 4.0], true),
            ([0.5, 9.0], false),
            ([0.02, 9.0], true),
            ([-1.0, 5.0], false),
            ([5.0, 14.0], false),
        ] {
            assert_eq!(is_inside(&own, [x, y]), expected, "{x}, {y}");
        }
        let circle = [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
        assert!(is_inside(&circle, [0.1, 0.9]) && !is_inside(&circle, [0.8, 0.8]));
    }
}
