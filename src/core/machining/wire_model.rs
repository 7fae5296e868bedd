//! Computes wire models and sketches of a surface. A sketch is a few curves of constant u and of constant v,
//! for pictures.
//!
//! A wire model is a family of curves on the surface, the wires. The distance of neighbouring wires, measured
//! as described below, is at most the pitch.
//!
//! # Method
//! * Wires along u are curves of constant v, and wires along v are curves of constant u. The distance of two
//!   neighbouring wires is measured along three curves that cross all wires: two sides of the surface, and
//!   the curve halfway between them in u or v. The largest of these three distances is at most the pitch.
//! * Wires along x or y are sections of the surface with planes at equal distances (`in_planes`). The surface
//!   may have edges, walls and overhangs.
//!
//! # Guarantees
//! * A wire leaves the chords between its points by at most the chord height asked for.
//! * A wire has a point on each edge of the surface that it crosses.
//! * A model with too many wires or points is refused.
//!
//! # Cost
//! O(n) for n points of wires.
//!
//! # Reference
//! Y. H. Koo, D. J. Lee, S. Namgung, M. S. Kang, "A Study on the Construction of CAD/CAM System for Machining
//! of Sculptured Surface of Die", 1989, section 3.3.

mod chain;
mod in_planes;
mod part;
mod section;

use nalgebra::Point3;

use crate::budget::{Budget, Stopped};
use crate::geometry::spacing::spaces;
use crate::geometry::surface::{BezierSurface, Patch, Surface, span_of};

/// A curve through points, mm.
pub type Wire = Vec<Point3<f64>>;

/// What wires run along.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = WireDirection))]
pub enum Along {
    /// A parameter of the surface.
    #[default]
    U,
    V,
    /// At constant y.
    X,
    /// At constant x.
    Y,
}

/// The wire model that is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WireJob {
    pub along: Along,
    /// Largest distance of neighbouring wires, mm.
    pub pitch_mm: f64,
    /// Largest height of a wire over the chords of its points, mm.
    pub chord_height_mm: f64,
    /// Largest number of wires; a model that needs more is refused.
    pub wire_limit: usize,
    /// Largest number of points of all wires; a model that needs more is refused.
    pub point_limit: usize,
}

impl WireJob {
    /// Whether the wires are curves of constant parameter, which any surface has.
    pub fn runs_along_a_parameter(&self) -> bool {
        matches!(self.along, Along::U | Along::V)
    }
}

/// Patches along a wire between two checks of the budget.
const PATCHES_BETWEEN_CHECKS: usize = 256;

/// Chords over one patch with which lengths across wires are measured.
const LENGTH_CHORDS: usize = 16;

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum WireError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the wire model needs {needed} wires; at most {limit} are allowed; use a larger pitch")]
    TooManyWires { needed: usize, limit: usize },
    #[error(
        "the wire model needs more than {limit} points, the most that are allowed; use a larger pitch or chord height"
    )]
    TooManyPoints { limit: usize },
    #[error("the plane section of the surface could not be traced near {at}; use wires along u or v")]
    SectionLost { at: Point3<f64> },
}

/// The wires of `surface`.
///
/// # Errors
/// One of [`WireError`].
///
/// # Example
/// ```
/// use nalgebra::Point3;
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
/// use toolpathd_core::machining::wire_model::{Along, WireJob, wires};
///
/// let points = [0.0, 30.0].map(|x| [0.0, 40.0].map(|y| Point3::new(x, y, 0.0)).to_vec()).to_vec();
/// let plane = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual }.surface().unwrap();
/// let job = WireJob {
///     along: Along::U,
///     pitch_mm: 9.0,
///     chord_height_mm: 0.01,
///     wire_limit: 100,
///     point_limit: 1000,
/// };
/// // 40 mm take five steps of 8 mm.
/// let wires = wires(&plane, &job, &Budget::unlimited()).unwrap();
/// assert_eq!(wires.len(), 6);
/// assert!((wires[1][0] - Point3::new(0.0, 8.0, 0.0)).norm() < 1e-9);
/// ```
pub fn wires(
    surface: &BezierSurface<impl Patch>,
    job: &WireJob,
    budget: &Budget,
) -> Result<Vec<Wire>, WireError> {
    match job.along {
        Along::U => along_u(surface, job, budget),
        Along::V => along_u(&surface.transposed(), job, budget),
        Along::X => in_planes::wires(surface, 1, job, budget),
        Along::Y => in_planes::wires(surface, 0, job, budget),
    }
}

/// Curves of constant v at equal distances. Distances are measured along three curves of constant u; between
/// two places the longest of the three counts.
fn along_u(
    surface: &BezierSurface<impl Patch>,
    job: &WireJob,
    budget: &Budget,
) -> Result<Vec<Wire>, WireError> {
    let rule = Rule::new(surface, budget)?;
    let n = count(rule.length(), job)?;
    let places: Vec<f64> = (0..=n).map(|k| rule.place(k as f64 / n as f64)).collect();
    check_points(surface, &places, job, budget)?;
    let mut wires = Vec::with_capacity(n + 1);
    for v in places {
        wires.push(wire_along_u(surface, v, job.chord_height_mm, budget)?);
    }
    Ok(wires)
}

/// Counts the points of all wires before the first of them is computed.
fn check_points(
    surface: &BezierSurface<impl Patch>,
    places: &[f64],
    job: &WireJob,
    budget: &Budget,
) -> Result<(), WireError> {
    let [nu, nv] = surface.spans();
    let mut points = 0.0;
    // All wires over one row of patches have the same number of points.
    let mut known: Option<(usize, f64)> = None;
    for v in places {
        let j = span_of(*v, nv);
        let of_wire = match known {
            Some((row, of_wire)) if row == j => of_wire,
            _ => {
                budget.check()?;
                1.0 + (0..nu).map(|i| chords(surface.patch(i, j), job.chord_height_mm)).sum::<f64>()
            }
        };
        known = Some((j, of_wire));
        points += of_wire;
        if points > job.point_limit as f64 {
            return Err(WireError::TooManyPoints { limit: job.point_limit });
        }
    }
    Ok(())
}

/// The number of chords over one patch along u.
fn chords(patch: &impl Patch, chord_height: f64) -> f64 {
    // A chord over a parameter step d leaves the curve by d^2 / 8 times the second derivative.
    let bend = patch.derivatives().duu.reach() / 8.0;
    (bend / chord_height).sqrt().ceil().max(1.0)
}

/// Lengths along v.
struct Rule {
    /// The length from v = 0 to each sample, mm.
    lengths: Vec<f64>,
}

impl Rule {
    fn new(surface: &dyn Surface, budget: &Budget) -> Result<Self, Stopped> {
        let [nu, nv] = surface.spans();
        let across = [0.0, 0.5 * nu as f64, nu as f64];
        let points = |k: usize| across.map(|u| surface.jet(u, k as f64 / LENGTH_CHORDS as f64).point);
        let mut lengths = vec![0.0];
        let (mut total, mut here) = (0.0, points(0));
        for k in 1..=nv * LENGTH_CHORDS {
            if k.is_multiple_of(1024) {
                budget.check()?;
            }
            let next = points(k);
            total += here.iter().zip(&next).map(|(a, b)| (b - a).norm()).fold(0.0, f64::max);
            lengths.push(total);
            here = next;
        }
        Ok(Self { lengths })
    }

    fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The parameter at a fraction of the length.
    fn place(&self, fraction: f64) -> f64 {
        let length = fraction * self.length();
        let above = self.lengths.partition_point(|known| *known < length).max(1).min(self.lengths.len() - 1);
        let [low, high] = [self.lengths[above - 1], self.lengths[above]];
        let share = if high > low { ((length - low) / (high - low)).min(1.0) } else { 0.0 };
        (above as f64 - 1.0 + share) / LENGTH_CHORDS as f64
    }
}

/// The curve of constant v from side to side.
fn wire_along_u(
    surface: &BezierSurface<impl Patch>,
    v: f64,
    chord_height: f64,
    budget: &Budget,
) -> Result<Wire, Stopped> {
    let [nu, nv] = surface.spans();
    let j = span_of(v, nv);
    let mut wire = vec![surface.jet(0.0, v).point];
    for i in 0..nu {
        let patch = surface.patch(i, j);
        if i.is_multiple_of(PATCHES_BETWEEN_CHECKS) {
            budget.check()?;
        }
        let chords = chords(patch, chord_height);
        wire.extend((1..=chords as usize).map(|k| patch.jet(k as f64 / chords, v - j as f64).point));
    }
    Ok(wire)
}

/// The number of equal spaces of at most the pitch over `length` mm.
fn count(length: f64, job: &WireJob) -> Result<usize, WireError> {
    let spaces = spaces(length, job.pitch_mm);
    if spaces >= job.wire_limit as f64 {
        return Err(WireError::TooManyWires {
            needed: (spaces as usize).saturating_add(1),
            limit: job.wire_limit,
        });
    }
    Ok(spaces as usize)
}

/// A few curves along both parameters, the sides among them, for pictures of a surface. They have about ten
/// thousand points, however large the surface is.
pub fn sketch(surface: &dyn Surface) -> Vec<Wire> {
    /// Spaces between the curves each way.
    const SPACES: usize = 16;
    /// Chords of one curve.
    const CHORDS: usize = 384;
    let at = |share: usize, of: usize, n: usize| (n * share) as f64 / of as f64;
    let [nu, nv] = surface.spans();
    let wire = |place: &dyn Fn(usize) -> (f64, f64)| -> Wire {
        (0..=CHORDS).map(place).map(|(u, v)| surface.jet(u, v).point).collect()
    };
    let along_u = (0..=SPACES).map(|k| wire(&|t| (at(t, CHORDS, nu), at(k, SPACES, nv))));
    let along_v = (0..=SPACES).map(|k| wire(&|t| (at(k, SPACES, nu), at(t, CHORDS, nv))));
    along_u.chain(along_v).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector3, Vector4};

    use super::*;
    use crate::geometry::surface::{BicubicPatch, RationalPatch};

    const PITCH: f64 = 2.5;

    fn job(along: Along) -> WireJob {
        WireJob { along, pitch_mm: PITCH, chord_height_mm: 1e-3, wire_limit: 100, point_limit: 10_000 }
    }

    /// A quarter of a cylinder of radius 20 about y, 45 degrees to each side of the top, 30 mm long along v.
    fn quarter() -> BezierSurface<RationalPatch<4>> {
        let w = 0.5f64.sqrt();
        let arc = [(-20.0 * w, 20.0 * w, 1.0), (0.0, 20.0 / w, w), (20.0 * w, 20.0 * w, 1.0)];
        BezierSurface::from_fn([1, 1], |_, _| {
            RationalPatch::from_fn([2, 1], |a, b| {
                let (x, z, w) = arc[a];
                Vector4::new(x * w, 30.0 * b as f64 * w, z * w, w)
            })
        })
        .upward()
    }

    fn lengths(wires: &[Wire]) -> Vec<f64> {
        wires.iter().map(|wire| wire.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()).collect()
    }

    #[test]
    fn wires_are_no_farther_apart_than_the_pitch_and_lie_on_the_surface() {
        let surface = quarter();
        let arc = 20.0 * std::f64::consts::FRAC_PI_2;
        let chord = 20.0 * 2f64.sqrt();
        for (along, count, length) in [
            // The width of the quarter in plan, and its length.
            (Along::Y, (chord / PITCH).ceil() as usize + 1, 30.0),
            (Along::X, (30.0 / PITCH).ceil() as usize + 1, arc),
        ] {
            let wires = wires(&surface, &job(along), &Budget::unlimited()).unwrap();
            assert_eq!(wires.len(), count, "{along:?}");
            for wire_length in lengths(&wires) {
                assert!((wire_length - length).abs() < 0.02, "{along:?}: {wire_length} {length}");
            }
            for p in wires.iter().flatten() {
                assert!((p.x.hypot(p.z) - 20.0).abs() < 1e-9, "{p}");
            }
        }
        // `upward` may have exchanged u and v. The wires along both parameters together run both ways.
        let both =
            [Along::U, Along::V].map(|along| wires(&surface, &job(along), &Budget::unlimited()).unwrap());
        let mut found = both.map(|wires| (wires.len(), lengths(&wires)[0].round()));
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        assert_eq!(found, [((arc / PITCH).ceil() as usize + 1, 30.0), (13, arc.round())]);
    }

    #[test]
    fn chords_keep_to_the_height() {
        let surface = quarter();
        for along in [Along::U, Along::V, Along::X] {
            for wire in wires(&surface, &job(along), &Budget::unlimited()).unwrap() {
                for pair in wire.windows(2) {
                    let middle = nalgebra::center(&pair[0], &pair[1]);
                    assert!(20.0 - middle.x.hypot(middle.z) <= 1.01e-3);
                }
            }
        }
    }

    #[test]
    fn limits_and_surfaces_within_one_plane_are_errors() {
        let surface = quarter();
        let many = WireJob { pitch_mm: 0.01, ..job(Along::X) };
        let error = wires(&surface, &many, &Budget::unlimited()).unwrap_err();
        assert_eq!(error, WireError::TooManyWires { needed: 3001, limit: 100 });
        let upright = BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
            net: std::array::from_fn(|a| std::array::from_fn(|b| Vector3::new(a as f64, 0.0, b as f64))),
        });
        let error = wires(&upright, &job(Along::X), &Budget::unlimited()).unwrap_err();
        assert!(matches!(error, WireError::SectionLost { .. }), "{error}");
        assert_eq!(wires(&upright, &job(Along::U), &Budget::unlimited()).unwrap().len(), 3);
        assert_eq!(sketch(&upright).len(), 34);
    }
}
