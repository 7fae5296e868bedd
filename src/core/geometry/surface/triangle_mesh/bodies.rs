//! The bodies of a closed mesh, and which way their triangles are turned.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::TRIANGLES_BETWEEN_CHECKS;
use crate::budget::{Budget, Stopped};
use crate::geometry::surface::patch::Bounds;

/// A connected part of a mesh.
struct Body {
    /// Six times the enclosed volume; negative where the normals point inwards.
    volume: f64,
    bounds: Bounds,
    /// A point of the body. Volumes are computed near it, so that large coordinates do not hide them.
    near: Vector3<f64>,
}

/// For each triangle of a closed mesh, whether its normal by the order of its corners points inwards. A body
/// within the box of the largest one is turned as that is, so that voids of it keep their normals.
///
/// # Errors
/// Only the budget's stop.
pub(super) fn turned(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    budget: &Budget,
) -> Result<Vec<bool>, Stopped> {
    let mut roots = Roots((0..points.len() as u32).collect());
    for (k, &[a, b, c]) in triangles.iter().enumerate() {
        if k % TRIANGLES_BETWEEN_CHECKS == 0 {
            budget.check()?;
        }
        roots.join(a, b);
        roots.join(b, c);
    }
    let mut bodies: BTreeMap<u32, Body> = BTreeMap::new();
    for triangle in triangles {
        let corners = triangle.map(|corner| points[corner as usize].coords);
        let root = roots.of(triangle[0]);
        let new = || Body { volume: 0.0, bounds: Bounds::EMPTY, near: points[root as usize].coords };
        let body = bodies.entry(root).or_insert_with(new);
        let [p, q, r] = corners.map(|corner| corner - body.near);
        body.volume += p.dot(&q.cross(&r));
        corners.iter().for_each(|corner| body.bounds.include(corner));
    }
    budget.check()?;
    let largest = bodies.values().max_by(|a, b| a.volume.abs().total_cmp(&b.volume.abs()));
    let is_turned = |body: &Body| match largest {
        Some(largest) if is_within(&body.bounds, &largest.bounds) => largest.volume < 0.0,
        _ => body.volume < 0.0,
    };
    let turned: BTreeMap<u32, bool> = bodies.iter().map(|(root, body)| (*root, is_turned(body))).collect();
    Ok(triangles.iter().map(|triangle| turned[&roots.of(triangle[0])]).collect())
}

fn is_within(inner: &Bounds, outer: &Bounds) -> bool {
    (0..3).all(|c| inner.min[c] >= outer.min[c] && inner.max[c] <= outer.max[c])
}

/// For each point, one that is connected with it: the least one in the end.
struct Roots(Vec<u32>);

impl Roots {
    fn of(&mut self, mut point: u32) -> u32 {
        while self.0[point as usize] != point {
            // Halves the way for the next one who asks.
            let next = self.0[self.0[point as usize] as usize];
            self.0[point as usize] = next;
            point = next;
        }
        point
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.of(one), self.of(other));
        self.0[one.max(other) as usize] = one.min(other);
    }
}
