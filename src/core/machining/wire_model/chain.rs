//! Chains of stretches: wires, with no more points than they need.

use nalgebra::{Point3, Vector2, Vector3};

use super::Wire;
use super::section::{End, Section};

/// Ends of wires that are at most this far apart are one place, mm: there the surface meets itself along a
/// seam. It is the largest gap of neighbouring patches.
const SEAM_MM: f64 = crate::geometry::surface::joints::GAP_LIMIT_MM;

/// The largest part of a normal along the axis of the planes at which a point is moved from its plane to one
/// next to it, along the surface. Where the normal points along the axis, the way would be long.
const MOST_ALONG_AXIS: f64 = 0.9;

/// A point of a wire, and whether it has to stay.
#[derive(Debug, Clone, Copy)]
struct Node {
    point: Point3<f64>,
    stays: bool,
}

/// The wires of a section. Points may be left out while the wire leaves the chain of all points by at most
/// `spare_mm`. Points are moved by `shift_mm` along `axis`, on the surface.
pub(super) fn wires(section: &Section, axis: usize, shift_mm: f64, spare_mm: f64) -> Vec<Wire> {
    let chains = with_seams(chains(section, axis, shift_mm));
    chains.iter().map(|chain| thinned(chain, axis, spare_mm)).collect()
}

fn chains(section: &Section, axis: usize, shift_mm: f64) -> Vec<Vec<Node>> {
    let Section { ends } = section;
    let mut taken = vec![false; ends.len()];
    let mut chains = Vec::new();
    let open = (0..ends.len()).filter(|k| ends[*k].mate.is_none());
    // What the open ends do not lead to is closed.
    for first in open.chain(0..ends.len()) {
        if taken[first] {
            continue;
        }
        let mut chain = vec![node(&ends[first], axis, shift_mm)];
        let mut at = first;
        loop {
            let other = at ^ 1;
            (taken[at], taken[other]) = (true, true);
            chain.push(node(&ends[other], axis, shift_mm));
            match ends[other].mate {
                Some(mate) if !taken[mate] => at = mate,
                _ => break,
            }
        }
        chains.push(chain);
    }
    chains
}

fn node(end: &End, axis: usize, shift_mm: f64) -> Node {
    let stays = end.is_corner || end.mate.is_none();
    Node { point: end.point + along_surface(&end.normal, axis) * shift_mm, stays }
}

/// The shortest vector along the surface that advances by 1 along the axis; the axis itself where the surface
/// hardly leads there.
fn along_surface(normal: &Vector3<f64>, axis: usize) -> Vector3<f64> {
    let unit = Vector3::ith(axis, 1.0);
    if normal[axis].abs() > MOST_ALONG_AXIS {
        return unit;
    }
    let way = unit - normal * normal[axis];
    way / way[axis]
}

/// The chains, joined where their ends coincide.
fn with_seams(chains: Vec<Vec<Node>>) -> Vec<Vec<Node>> {
    let is_near = |a: &Node, b: &Node| (a.point - b.point).norm() <= SEAM_MM;
    let mut joined: Vec<Vec<Node>> = Vec::with_capacity(chains.len());
    for mut chain in chains {
        // Each round takes one chain from the others, so the loop ends.
        loop {
            let [first, last] = [chain[0], chain[chain.len() - 1]];
            if is_near(&first, &last) && chain.len() > 2 {
                break;
            }
            let meets = |other: &Vec<Node>| {
                let ends = [other[0], other[other.len() - 1]];
                ends.iter().any(|end| is_near(end, &first) || is_near(end, &last))
            };
            let Some(k) = joined.iter().position(meets) else { break };
            let mut other = joined.remove(k);
            if !(is_near(&other[0], &last) || is_near(&other[other.len() - 1], &last)) {
                chain.reverse();
            }
            if !is_near(&other[0], &chain[chain.len() - 1]) {
                other.reverse();
            }
            chain.extend(other.into_iter().skip(1));
        }
        joined.push(chain);
    }
    joined
}

/// The chain without points that the lines between the remaining points pass within `spare_mm`.
///
/// The directions of all lines from the last kept point that pass the points after it are a cone. A point
/// outside the cone, or nearer than the point before it, starts the next line at that point before it.
fn thinned(chain: &[Node], axis: usize, spare_mm: f64) -> Wire {
    let mut wire = vec![chain[0].point];
    let mut anchor = chain[0].point;
    let mut cone: Option<Cone> = None;
    for (k, node) in chain.iter().enumerate().skip(1) {
        let before = &chain[k - 1];
        let arm = in_plane(&(node.point - anchor), axis);
        let goes_on = match &cone {
            _ if before.stays && k > 1 => None,
            None => Some(Cone::around(arm, spare_mm)),
            Some(cone) => cone.through(arm, spare_mm),
        };
        cone = Some(goes_on.unwrap_or_else(|| {
            if before.point != anchor {
                wire.push(before.point);
            }
            anchor = before.point;
            Cone::around(in_plane(&(node.point - anchor), axis), spare_mm)
        }));
    }
    wire.push(chain[chain.len() - 1].point);
    wire
}

fn in_plane(way: &Vector3<f64>, axis: usize) -> Vector2<f64> {
    Vector2::new(way[1 - axis], way.z)
}

/// The directions from an anchor of all lines that pass the points so far within the spare; angles are from
/// `first`, radians.
#[derive(Debug, Clone, Copy)]
struct Cone {
    first: Vector2<f64>,
    reach: f64,
    low: f64,
    high: f64,
}

impl Cone {
    fn around(arm: Vector2<f64>, spare_mm: f64) -> Self {
        let half = half_angle(arm.norm(), spare_mm);
        Self { first: arm, reach: arm.norm(), low: -half, high: half }
    }

    /// The cone with one more point; `None` if the line to this point does not pass the others.
    fn through(&self, arm: Vector2<f64>, spare_mm: f64) -> Option<Self> {
        let distance = arm.norm();
        let angle = self.first.perp(&arm).atan2(self.first.dot(&arm));
        if distance < self.reach || angle < self.low || angle > self.high {
            return None;
        }
        let half = half_angle(distance, spare_mm);
        let (low, high) = (self.low.max(angle - half), self.high.min(angle + half));
        Some(Self { first: self.first, reach: distance, low, high })
    }
}

/// Half the angle of the spare, seen from this distance, radians. A nearer point allows a quarter turn.
fn half_angle(distance: f64, spare_mm: f64) -> f64 {
    if distance > spare_mm { (spare_mm / distance).asin() } else { std::f64::consts::FRAC_PI_2 }
}
