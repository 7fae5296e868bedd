//! Finds the centre with which an arc is written. Its coordinates have the decimals of the output.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};

use super::bound::{self, Circular, Family};
use super::{
    ACCEPTED_STEPS, ArcPart, Curves, Form, Grid, MAX_MISMATCH_STEPS, MIN_SAGITTA_STEPS, QuantizeError,
    Written,
};
use crate::geometry::curve::{Arc, Curve};
use crate::toolpath::arc_rule::ArcRule;

/// Factor by which a written radius may exceed [`Curves::largest_radius_mm`], because that limit is meant for
/// the source's radius.
const RADIUS_MARGIN: f64 = 1.01;

/// A piece with its ends rounded, in coordinates of its plane: (first, second, normal), mm.
struct Rounded<'a> {
    piece: &'a ArcPart<'a>,
    grid: &'a Grid,
    start_units: [i64; 3],
    end_units: [i64; 3],
    start: Vector3<f64>,
    end: Vector3<f64>,
    source: Circular,
    /// The largest difference of the radii at the ends that is written, mm.
    mismatch_mm: f64,
    /// What the control demands of an arc.
    accepts: ArcRule,
    /// The largest bound of the distance from the source that is accepted, mm.
    accepted_mm: f64,
    /// The largest radius that is written, mm.
    largest_radius_mm: f64,
}

/// The arc nearest to `piece` among those with rounded ends and a centre on the grid, if one is near enough.
/// The centre of the source is projected onto the perpendicular bisector of the rounded ends. The nine grid
/// points around it are tried as centres. Only arcs that the control accepts count.
pub fn best(piece: &ArcPart, grid: &Grid, runs: &Curves) -> Result<Option<Written>, QuantizeError> {
    let rounded = Rounded::new(piece, grid, runs)?;
    let [a, b] = rounded.in_plane(rounded.start_units);
    let [to_a, to_b] = rounded.in_plane(rounded.end_units);
    let closes = a == to_a && b == to_b;
    if closes != piece.is_full_turn() {
        return Ok(None);
    }
    let wanted = rounded.wanted_center();
    let (i, j) = (grid.units(wanted.x - rounded.start.x)?, grid.units(wanted.y - rounded.start.y)?);
    let mut best: Option<Written> = None;
    for (di, dj) in (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (di, dj))) {
        let Some(written) = rounded.with_offsets([i + di, j + dj]) else { continue };
        if best.is_none_or(|found| written.displacement_mm < found.displacement_mm) {
            best = Some(written);
        }
    }
    Ok(best)
}

impl<'a> Rounded<'a> {
    fn new(piece: &'a ArcPart<'a>, grid: &'a Grid, runs: &Curves) -> Result<Self, QuantizeError> {
        let plane = piece.arc.plane();
        let (start, end) = (piece.start(), piece.end());
        let (start_units, end_units) = (grid.round(&start)?, grid.round(&end)?);
        let source = Circular {
            start: plane.to_local(&start),
            end: plane.to_local(&end),
            sweep: piece.sweep(),
            ..Circular::of(piece.arc)
        };
        Ok(Self {
            piece,
            grid,
            start_units,
            end_units,
            start: plane.to_local(&grid.point(start_units)),
            end: plane.to_local(&grid.point(end_units)),
            source,
            mismatch_mm: runs.radius_mismatch_mm,
            accepts: runs.accepts,
            accepted_mm: (ACCEPTED_STEPS - runs.reserved_steps(piece.arc)) * grid.step_mm(),
            largest_radius_mm: RADIUS_MARGIN * runs.largest_radius_mm,
        })
    }

    fn in_plane(&self, units: [i64; 3]) -> [i64; 2] {
        let [a, b, _] = self.piece.arc.plane().axes();
        [units[a], units[b]]
    }

    /// The source's centre, projected onto the bisector of the rounded ends.
    fn wanted_center(&self) -> Vector2<f64> {
        let chord = (self.end - self.start).xy();
        let length = chord.norm();
        if length == 0.0 {
            return self.source.center;
        }
        let along = chord / length;
        let middle = (self.start + self.end).xy() / 2.0;
        self.source.center - along * (self.source.center - middle).dot(&along)
    }

    /// The arc about the point at `offsets` units from the start, if it may stand for the piece.
    fn with_offsets(&self, offsets: [i64; 2]) -> Option<Written> {
        let (arc, grid, step) = (self.piece.arc, self.grid, self.grid.step_mm());
        let [i, j] = offsets;
        let ([a, b], [to_a, to_b]) = (self.in_plane(self.start_units), self.in_plane(self.end_units));
        let (to_i, to_j) = (to_a - a - i, to_b - b - j);
        let mismatch_units = mismatch([i, j], [to_i, to_j])?;
        if mismatch_units > MAX_MISMATCH_STEPS || mismatch_units * step > self.mismatch_mm {
            return None;
        }
        let stated = Vector2::new(grid.mm(i), grid.mm(j));
        let chord = Vector2::new(grid.mm(to_a - a), grid.mm(to_b - b));
        if !self.accepts.may_write(&stated, &chord) {
            return None;
        }
        let family = self.family(
            Vector2::new(grid.mm(a + i), grid.mm(b + j)),
            -stated,
            Vector2::new(grid.mm(to_i), grid.mm(to_j)),
        );
        let of_family = bound::distance(&family, &self.source)?;
        if of_family > self.accepted_mm {
            return None;
        }
        let plane = arc.plane();
        let [start, end] = [self.start, self.end].map(|p| plane.to_workpiece(&p));
        let near = plane.to_workpiece(&Vector3::new(family.center.x, family.center.y, self.start.z));
        let exact = Arc::with_center_near(plane, arc.direction(), start, end, near).ok()?;
        let sagitta = 2.0 * exact.radius() * (exact.sweep() / 4.0).sin().powi(2);
        if sagitta < MIN_SAGITTA_STEPS * step || exact.radius() > self.largest_radius_mm {
            return None;
        }
        let exactly = Circular::of(&exact);
        let displacement_mm = of_family.max(bound::distance(&Family::of(&exactly), &self.source)?);
        let slack_mm = bound::distance(&family, &exactly)?;
        let [own_displacement_mm, own_slack_mm] = match self.accepts.own_center(&stated, &chord) {
            Some(own) => {
                let own = self.family(self.start.xy() + own, -own, chord - own);
                [bound::distance(&own, &self.source)?, bound::distance(&own, &exactly)?]
            }
            None => [0.0; 2],
        };
        // The slack keeps the bound too: the exact arc, rounded again, finds the same centre.
        if displacement_mm.max(own_displacement_mm).max(own_slack_mm) > self.accepted_mm {
            return None;
        }
        Some(Written {
            curve: Curve::Arc(exact),
            end_units: self.end_units,
            form: Form::Arc { center: offsets },
            radius_mismatch_mm: mismatch_units * step,
            slack_mm: slack_mm.max(own_slack_mm),
            displacement_mm: displacement_mm.max(own_displacement_mm),
        })
    }

    /// The paths about `center` from the rounded start to the rounded end, as the arc turns.
    fn family(&self, center: Vector2<f64>, to_start: Vector2<f64>, to_end: Vector2<f64>) -> Family {
        let sense = bound::sense(self.piece.arc.direction());
        let sweep = if self.piece.is_full_turn() {
            TAU
        } else {
            (sense * bound::angle(&to_start, &to_end)).rem_euclid(TAU)
        };
        Family { center, start: self.start, end: self.end, to_start, to_end, sweep, sense }
    }
}

/// The difference of the lengths of two vectors of integers, from the exact difference of their squares;
/// `None` if a vector has length zero.
fn mismatch(from: [i64; 2], to: [i64; 2]) -> Option<f64> {
    let squared = |v: [i64; 2]| v.iter().map(|&x| i128::from(x) * i128::from(x)).sum::<i128>();
    let (s, e) = (squared(from), squared(to));
    (s > 0 && e > 0).then(|| (s - e).unsigned_abs() as f64 / ((s as f64).sqrt() + (e as f64).sqrt()))
}
