//! Finds how deep a ball cutter with its shank enters a surface, by dense samples and local minimisation.
//!
//! The cutter is all points within its radius of the axis, the ray that goes up from the centre of the ball.
//! So the depth at a tip is the radius minus the least distance from the axis to the surface.
//!
//! 1. At places at most a quarter of a millimetre apart along the path, the local minima of this distance are
//!    collected over a grid of surface points.
//! 2. At every sample of the path, the distance is minimised from each of these minima.
//!
//! Local minima are found to 1e-9 mm, and the largest depth between samples to about 1e-6 mm.

use nalgebra::{Point3, Vector3};

use super::motion::Motion;
use super::spline::Spline;

/// Largest distance of the samples along a path.
const PATH_STEP_MM: f64 = 0.05;

/// Largest distance of the places along a path at which local minima are collected.
const ANCHOR_STEP_MM: f64 = 0.25;

/// Side of the square buckets in x and y that hold the surface points.
const BUCKET_MM: f64 = 1.0;

/// A local minimum is followed if it exceeds the least one by less than this plus [`ANCHOR_STEP_MM`], mm.
const SLACK_MM: f64 = 0.1;

/// A ball cutter over a surface, with a grid of surface points.
pub struct Cutter<'a> {
    surface: &'a Spline,
    radius: f64,
    counts: [usize; 2],
    points: Vec<Point3<f64>>,
    corner: [f64; 2],
    buckets: [usize; 2],
    members: Vec<Vec<u32>>,
}

/// The deepest penetration, mm, and the tip at which it was found. A negative depth is the least clearance,
/// if the surface was near.
#[derive(Debug, Clone, Copy)]
pub struct Depth {
    pub mm: f64,
    pub tip: Point3<f64>,
}

impl Depth {
    pub const NONE: Self = Self { mm: f64::NEG_INFINITY, tip: Point3::new(0.0, 0.0, 0.0) };
}

impl<'a> Cutter<'a> {
    /// Samples the surface. The points are about a twelfth of the radius apart, and at most about 0.4 mm.
    pub fn new(surface: &'a Spline, radius: f64) -> Self {
        let size = surface.size();
        let corners = [[0.0, 0.0], [size[0], 0.0], [0.0, size[1]]].map(|at| surface.jet(at).point);
        let spacing = (radius / 12.0).min(0.4);
        let counts = [1, 2].map(|k| ((corners[k] - corners[0]).norm() / spacing).ceil() as usize + 1);
        let points: Vec<_> =
            (0..counts[0] * counts[1]).map(|k| surface.jet(parameter(k, counts, size)).point).collect();
        let extreme = |k: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).reduce(pick).unwrap();
        let corner = [extreme(0, f64::min), extreme(1, f64::min)];
        let far = [extreme(0, f64::max), extreme(1, f64::max)];
        let buckets = [0, 1].map(|k| ((far[k] - corner[k]) / BUCKET_MM) as usize + 1);
        let mut members = vec![Vec::new(); buckets[0] * buckets[1]];
        for (index, p) in points.iter().enumerate() {
            let [i, j] = [0, 1].map(|k| ((p[k] - corner[k]) / BUCKET_MM) as usize);
            members[i * buckets[1] + j].push(index as u32);
        }
        Self { surface, radius, counts, points, corner, buckets, members }
    }

    /// The highest surface point, mm.
    pub fn top(&self) -> f64 {
        self.points.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Replaces `depth` if `motion` penetrates deeper.
    pub fn follow(&self, motion: &Motion, depth: &mut Depth) {
        let length = motion.length();
        let anchors = (length / ANCHOR_STEP_MM).ceil().max(1.0) as usize;
        let per_anchor = (length / anchors as f64 / PATH_STEP_MM).ceil().max(1.0) as usize;
        let step = 1.0 / (anchors * per_anchor) as f64;
        for a in 0..anchors {
            let starts = self.minima(&motion.at((a as f64 + 0.5) / anchors as f64));
            if starts.is_empty() {
                continue;
            }
            for k in 0..=per_anchor {
                let t = (a * per_anchor + k) as f64 * step;
                let before = depth.mm;
                self.deepen(motion, t, &starts, depth);
                if depth.mm > before {
                    self.refine(motion, [t - step, t + step], &starts, depth);
                }
            }
        }
    }

    /// Golden section for the largest depth in an interval of the motion.
    fn refine(&self, motion: &Motion, [mut from, mut to]: [f64; 2], starts: &[[f64; 2]], depth: &mut Depth) {
        (from, to) = (from.max(0.0), to.min(1.0));
        while (to - from) * motion.length() > 1e-3 {
            let [p, q] = [0.382, 0.618].map(|s| from + s * (to - from));
            let [at_p, at_q] = [p, q].map(|t| {
                let mut here = Depth::NONE;
                self.deepen(motion, t, starts, &mut here);
                if here.mm > depth.mm {
                    *depth = here;
                }
                here.mm
            });
            if at_p > at_q { to = q } else { from = p }
        }
    }

    fn deepen(&self, motion: &Motion, t: f64, starts: &[[f64; 2]], depth: &mut Depth) {
        let tip = motion.at(t);
        for start in starts {
            let mm = self.radius - self.least_distance(&self.center(&tip), *start);
            if mm > depth.mm {
                *depth = Depth { mm, tip };
            }
        }
    }

    fn center(&self, tip: &Point3<f64>) -> Point3<f64> {
        tip + Vector3::z() * self.radius
    }

    /// Parameters of the local minima of the distance over the grid, for tips within half an anchor step of
    /// `tip`. Empty if the surface is farther away than the radius and a margin.
    fn minima(&self, tip: &Point3<f64>) -> Vec<[f64; 2]> {
        let center = self.center(tip);
        let margin = ANCHOR_STEP_MM + SLACK_MM;
        let reach = self.radius + margin;
        let [rows, columns] = [0, 1].map(|k| {
            let bucket = |x: f64| ((x - self.corner[k]) / BUCKET_MM).floor();
            let last = self.buckets[k] as f64 - 1.0;
            let (from, to) = (bucket(center[k] - reach), bucket(center[k] + reach));
            if to < 0.0 || from > last { 0..0 } else { from.max(0.0) as usize..to.min(last) as usize + 1 }
        });
        let mut near = Vec::new();
        let mut least = reach;
        for i in rows {
            for &index in columns.clone().flat_map(|j| &self.members[i * self.buckets[1] + j]) {
                let distance = to_axis(&self.points[index as usize], &center).norm();
                if distance < least + margin {
                    near.push((index as usize, distance));
                    least = least.min(distance);
                }
            }
        }
        near.retain(|&(index, distance)| {
            distance < least + margin && self.is_minimum(index, distance, &center)
        });
        near.into_iter().map(|(index, _)| parameter(index, self.counts, self.surface.size())).collect()
    }

    fn is_minimum(&self, index: usize, distance: f64, center: &Point3<f64>) -> bool {
        let (i, j) = (index / self.counts[1], index % self.counts[1]);
        let around = |k: usize, n: usize| k.saturating_sub(1)..=(k + 1).min(n - 1);
        around(i, self.counts[0]).all(|i| {
            around(j, self.counts[1])
                .all(|j| to_axis(&self.points[i * self.counts[1] + j], center).norm() >= distance)
        })
    }

    /// The local minimum of the distance between the axis and the surface, by descent from `at`, mm.
    fn least_distance(&self, center: &Point3<f64>, mut at: [f64; 2]) -> f64 {
        let size = self.surface.size();
        let mut jet = self.surface.jet(at);
        let mut square = to_axis(&jet.point, center).norm_squared();
        for _ in 0..50 {
            let apart = to_axis(&jet.point, center);
            let flat = |d: Vector3<f64>| if apart.z == 0.0 { Vector3::new(d.x, d.y, 0.0) } else { d };
            let (du, dv) = (flat(jet.u), flat(jet.v));
            let slope = [apart.dot(&du), apart.dot(&dv)];
            let bend = [du.norm_squared(), du.dot(&dv), dv.norm_squared()];
            let full =
                [bend[0] + apart.dot(&jet.uu), bend[1] + apart.dot(&jet.uv), bend[2] + apart.dot(&jet.vv)];
            let is_free =
                [0, 1].map(|k| !(at[k] <= 0.0 && slope[k] > 0.0 || at[k] >= size[k] && slope[k] < 0.0));
            let step = downhill(slope, full, is_free).or_else(|| downhill(slope, bend, is_free));
            let Some(step) = step else { break };
            let mut scale = 1.0;
            let better = loop {
                let to = [0, 1].map(|k| (at[k] + scale * step[k]).clamp(0.0, size[k]));
                let there = self.surface.jet(to);
                let value = to_axis(&there.point, center).norm_squared();
                if value < square {
                    break Some((to, there, value));
                }
                scale *= 0.5;
                if scale < 1e-6 {
                    break None;
                }
            };
            let Some((to, there, value)) = better else { break };
            let is_done = square - value < 1e-15 * square;
            (at, jet, square) = (to, there, value);
            if is_done {
                break;
            }
        }
        square.sqrt()
    }
}

/// The shortest vector from the axis above `center` to `p`.
fn to_axis(p: &Point3<f64>, center: &Point3<f64>) -> Vector3<f64> {
    let mut apart = p - center;
    apart.z = apart.z.min(0.0);
    apart
}

fn parameter(index: usize, counts: [usize; 2], size: [f64; 2]) -> [f64; 2] {
    let along = |k: usize, i: usize| size[k] * i as f64 / (counts[k] - 1) as f64;
    [along(0, index / counts[1]), along(1, index % counts[1])]
}

/// The Newton step in the free parameters. `None` if the quadratic form has no minimum.
fn downhill(slope: [f64; 2], [a, b, c]: [f64; 3], is_free: [bool; 2]) -> Option<[f64; 2]> {
    match is_free {
        [true, true] => {
            let det = a * c - b * b;
            let is_convex = a > 0.0 && det > 1e-12 * a * c;
            is_convex.then(|| [(b * slope[1] - c * slope[0]) / det, (b * slope[0] - a * slope[1]) / det])
        }
        [true, false] => (a > 0.0).then(|| [-slope[0] / a, 0.0]),
        [false, true] => (c > 0.0).then(|| [0.0, -slope[1] / c]),
        [false, false] => None,
    }
}

#[cfg(test)]
mod tests {
    use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};

    use super::*;

    fn surface(height: impl Fn(f64, f64) -> f64) -> Spline {
        let nodes: Vec<f64> = (0..31).map(|k| f64::from(k) - 15.0).collect();
        let row = |&x: &f64| nodes.iter().map(|&y| Point3::new(x, y, height(x, y))).collect();
        let points = nodes.iter().map(row).collect();
        Spline::through(&PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot })
    }

    fn depth(surface: &Spline, from: [f64; 3], to: [f64; 3]) -> f64 {
        let mut depth = Depth::NONE;
        let motion = Motion::Straight { from: Point3::from(from), to: Point3::from(to) };
        Cutter::new(surface, 4.0).follow(&motion, &mut depth);
        depth.mm
    }

    #[test]
    fn sampled_depths_equal_closed_forms() {
        let plane = surface(|x, _| 0.75 * x);
        // A point is 0.8 (z - 0.75 x) away from the plane.
        let sunk = depth(&plane, [-5.0, 1.0, -2.9], [5.0, -1.0, 4.6]);
        assert!((sunk - (4.0 - 0.8 * 4.85)).abs() < 1e-9, "the depth is {sunk}");
        let clear = depth(&plane, [3.0, 0.0, 3.5], [3.0, 2.0, 3.5]);
        assert!((clear - (4.0 - 0.8 * 5.25)).abs() < 1e-9, "the depth is {clear}");
        // Beside the edge x = -15 only the shank reaches the plane, 3 mm from the axis.
        let beside = depth(&plane, [-18.0, -4.0, -40.0], [-18.0, 4.0, -40.0]);
        assert!((beside - 1.0).abs() < 1e-9, "the depth is {beside}");
        assert_eq!(depth(&plane, [0.0, 0.0, 20.0], [5.0, 0.0, 20.0]), f64::NEG_INFINITY);

        // A straight path is deepest where the ridge is highest, which is between two samples.
        let ridges = surface(|x, y| 0.05 * x * x - 0.02 * (y - 0.123) * (y - 0.123));
        let deepest = depth(&ridges, [0.0, -6.0, -0.25], [0.0, 6.0, -0.25]);
        assert!((deepest - 0.25).abs() < 1e-7, "the depth is {deepest}");
    }
}
