//! Cuts faces of more than three corners into triangles.
//!
//! # Method
//! 1. The normal of the face is that of Newell: the sum of the cross products of neighbouring corners. The
//!    face is seen along the axis nearest to the normal.
//! 2. A face that turns left at each corner, and once round in all, is cut by lines from its first corner.
//! 3. Else, and if no edges cross each other, ears are cut off: a corner that turns left and whose triangle
//!    holds no other corner, not even on its edges. So corners on straight edges get triangles with an area
//!    too.
//!
//! # Degenerate input
//! A face without area, or with edges that cross each other, is left out.
//!
//! # Cost
//! O(n) for a face of step 2, else O(n²) where most corners are ears, and O(n³) at most.
//!
//! # Reference
//! G. H. Meisters, "Polygons have ears", The American Mathematical Monthly 82 (1975), 648-651.

use toolpathd_core::budget::Budget;

use super::welding::{Welding, cross, dot, sub};
use crate::fault::{Place, Unreadable};

/// Most corners of a face that is not convex. One search for an ear may look at each pair of corners, and the
/// budget is checked between two searches; they take some 30 ms.
const MOST_CORNERS: usize = 5000;

/// Most corners of any face. A face takes some 60 bytes for each of its corners while it is cut.
const MOST_CORNERS_OF_ANY: usize = 100_000;

/// Adds the triangles of a face with these corners, by the numbers of vertices.
pub fn add(corners: &[u32], place: Place, welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    if let &[a, b, c] = corners {
        return welding.triangle([a, b, c], place);
    }
    if corners.len() < 3 {
        welding.left_out.add("face", "it has fewer than three corners", place);
        return Ok(());
    }
    if corners.len() > MOST_CORNERS_OF_ANY {
        let detail = format!("a face has {} corners; at most {MOST_CORNERS_OF_ANY} are read", corners.len());
        return Err(Unreadable::at(place, detail));
    }
    let mut corners = corners.to_vec();
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    let points: Vec<[f64; 3]> = corners.iter().map(|corner| welding.point(*corner)).collect();
    let normal = newell(&points);
    let length = dot(normal, normal).sqrt();
    if corners.len() < 3 || length == 0.0 {
        welding.left_out.add("face", "its area is 0", place);
        return Ok(());
    }
    let flat = seen_along(&points, normal);
    if corners.len() > MOST_CORNERS && !is_convex(&flat) {
        let detail = format!(
            "a face that is not convex has {} corners; at most {MOST_CORNERS} are read",
            corners.len()
        );
        return Err(Unreadable::at(place, detail));
    }
    let Some(triangles) = triangles(&flat, budget)? else {
        welding.left_out.add("face", "its edges cross each other", place);
        return Ok(());
    };
    welding.n_polygons += usize::from(corners.len() > 3);
    let middle = points.iter().fold([0.0; 3], |sum, point| [0, 1, 2].map(|k| sum[k] + point[k]));
    let middle = middle.map(|sum| sum / points.len() as f64);
    let off = points.iter().map(|point| (dot(sub(*point, middle), normal) / length).abs());
    welding.off_plane_max = off.fold(welding.off_plane_max, f64::max);
    triangles.into_iter().try_for_each(|own| welding.triangle(own.map(|k| corners[k]), place))
}

/// Twice the area of a closed chain, in the direction of its normal.
fn newell(points: &[[f64; 3]]) -> [f64; 3] {
    let first = points[0];
    let from_first = |point: &[f64; 3]| sub(*point, first);
    let pairs = points.windows(2).map(|pair| (from_first(&pair[0]), from_first(&pair[1])));
    pairs.map(|(a, b)| cross(a, b)).fold([0.0; 3], |sum, own| [0, 1, 2].map(|k| sum[k] + own[k]))
}

/// The points as seen against the axis nearest to the normal, so that they go round counterclockwise.
fn seen_along(points: &[[f64; 3]], normal: [f64; 3]) -> Vec<[f64; 2]> {
    let size = normal.map(f64::abs);
    let axis = if size[0] >= size[1] && size[0] >= size[2] { 0 } else { 1 + usize::from(size[2] > size[1]) };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (u, v) = if normal[axis] > 0.0 { (u, v) } else { (v, u) };
    points.iter().map(|point| [point[u], point[v]]).collect()
}

/// The triangles of a closed chain that goes round counterclockwise; `None` where no ear is left.
fn triangles(points: &[[f64; 2]], budget: &Budget) -> Result<Option<Vec<[usize; 3]>>, Unreadable> {
    let n = points.len();
    if is_convex(points) {
        return Ok(Some((2..n).map(|k| [0, k - 1, k]).collect()));
    }
    if crosses_itself(points, budget)? {
        return Ok(None);
    }
    let mut left: Vec<usize> = (0..n).collect();
    let mut found = Vec::with_capacity(n - 2);
    let mut at = 0;
    while left.len() > 3 {
        budget.check()?;
        let m = left.len();
        let Some(ear) = (0..m).map(|k| (at + k) % m).find(|&k| is_ear(points, &left, k)) else {
            return Ok(None);
        };
        found.push([left[(ear + m - 1) % m], left[ear], left[(ear + 1) % m]]);
        left.remove(ear);
        // The next search begins one corner on, so that ears are not all cut at one place.
        at = (ear + 1) % left.len();
    }
    found.push([left[0], left[1], left[2]]);
    let [a, b, c] = [left[0], left[1], left[2]].map(|corner| points[corner]);
    Ok((turn(a, b, c) >= 0.0).then_some(found))
}

/// Whether a chain turns left at each corner, and once round in all.
fn is_convex(points: &[[f64; 2]]) -> bool {
    let n = points.len();
    let turns_left = |k: usize| turn(points[k], points[(k + 1) % n], points[(k + 2) % n]) > 0.0;
    // A chain that goes round more than once rises more than once.
    let rises = |k: usize| points[(k + 1) % n] > points[k];
    let n_lowest = (0..n).filter(|&k| !rises(k) && rises((k + 1) % n)).count();
    (0..n).all(turns_left) && n_lowest == 1
}

/// Whether two edges of a closed chain cross. Edges that touch do not: a seam leads to a hole and back.
fn crosses_itself(points: &[[f64; 2]], budget: &Budget) -> Result<bool, Unreadable> {
    let edges: Vec<_> = points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| (*a, *b)).collect();
    let divides = |(a, b), (p, q)| turn(a, b, p) * turn(a, b, q) < 0.0;
    for (k, &edge) in edges.iter().enumerate() {
        budget.check()?;
        if edges[k + 1..].iter().any(|other| divides(edge, *other) && divides(*other, edge)) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Whether a corner of those that are left is an ear.
fn is_ear(points: &[[f64; 2]], left: &[usize], k: usize) -> bool {
    let m = left.len();
    let [a, b, c] = [left[(k + m - 1) % m], left[k], left[(k + 1) % m]].map(|corner| points[corner]);
    let is_within = |p: [f64; 2]| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    let others = left.iter().map(|&corner| points[corner]).filter(|p| *p != a && *p != b && *p != c);
    turn(a, b, c) > 0.0 && !others.into_iter().any(is_within)
}

/// Twice the area of a triangle; positive if it goes round counterclockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
