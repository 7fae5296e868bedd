//! Places beside the corners of a polyline at which arcs of the mean radius may meet.
//!
//! The corners of a polygon lie on a circle, and its lines lie inside that circle by up to the sagitta. The
//! circle that is as far from the corners as from the lines runs inside the corners by half the sagitta. It
//! needs half the tolerance of the circle through the corners. Elements that meet on the corners cannot
//! follow it: their ends have to lie on it.

use nalgebra::Vector2;

use super::optimal::Node;

/// Places nearer to their point, or to each other, than this part of the tolerance count as one.
const SAME: f64 = 0.05;

/// The distance of the farthest place from its point, as a part of the tolerance.
const FARTHEST: f64 = 0.999;

/// The places beside the point `index`: for each circle through it and two of its neighbours, the place of
/// the point moved towards the centre by half of the larger sagitta of the two lines, mm. Places outside the
/// tolerance are left out. In a ring, the last point equals the first.
pub fn beside(points: &[Vector2<f64>], index: usize, tolerance: f64, is_ring: bool) -> Vec<Node> {
    let n = points.len();
    let neighbour = |offset: isize| {
        let k = index as isize + offset;
        match usize::try_from(k) {
            Ok(k) if k < n => Some(points[k]),
            // The last point is the first.
            Ok(k) => (is_ring && k < 2 * n - 1).then(|| points[k + 1 - n]),
            Err(_) => (is_ring && k + n as isize > 1).then(|| points[(k + n as isize - 1) as usize]),
        }
    };
    let mut places: Vec<Node> = Vec::new();
    for first in [-1, -2, 0] {
        let three = [first, first + 1, first + 2].map(neighbour);
        let [Some(a), Some(b), Some(c)] = three else { continue };
        let Some(offset) = inward([a, b, c], points[index]) else { continue };
        let at = points[index] + offset;
        let is_new = places.iter().all(|other| (other.at - at).norm() > SAME * tolerance);
        if (SAME * tolerance..=FARTHEST * tolerance).contains(&offset.norm()) && is_new {
            places.push(Node { index, at });
        }
    }
    places
}

/// The way from a point of the circle through three points towards the centre, by half of the larger sagitta
/// of the two lines between the three; `None` if the three lie on a line.
fn inward([a, b, c]: [Vector2<f64>; 3], from: Vector2<f64>) -> Option<Vector2<f64>> {
    let (u, v) = (b - a, c - a);
    let twice_area = u.perp(&v);
    let center = a + Vector2::new(
        v.y * u.norm_squared() - u.y * v.norm_squared(),
        u.x * v.norm_squared() - v.x * u.norm_squared(),
    ) / (2.0 * twice_area);
    let radius = (a - center).norm();
    let longest = (b - a).norm().max((c - b).norm());
    // r - sqrt(r^2 - s^2) without cancellation, for half a line s.
    let square = 0.25 * longest * longest;
    let sagitta = square / (radius + (radius * radius - square).max(0.0).sqrt());
    let toward = (center - from).try_normalize(0.0)?;
    (twice_area != 0.0 && sagitta.is_finite()).then(|| toward * (0.5 * sagitta))
}
