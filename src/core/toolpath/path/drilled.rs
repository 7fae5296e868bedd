//! The moves of canned cycles.

use nalgebra::{Point2, Point3, Vector3};

use super::super::cycle::{Cycle, CycleError, CycleKind, Hole, PECK_CLEARANCE_MM};
use super::{Builder, PathError, Role};

impl Builder {
    /// A canned cycle at `places`, in their order. The tool goes across at its height, down to the retract
    /// plane as a rapid, and makes the hole.
    ///
    /// # Errors
    /// When the cycle is none ([`CycleError`]), or there would be too many moves.
    pub fn cycle(&mut self, hole: Hole, places: Vec<Point2<f64>>) -> Result<(), PathError> {
        let start_z_mm = self.at().z;
        hole.check(start_z_mm)?;
        if self.axis != Vector3::z_axis() || self.next_axis.is_some() {
            return Err(CycleError::Leans.into());
        }
        if places.is_empty() {
            return Err(CycleError::NoHoles.into());
        }
        let hole = hole.simplified();
        self.check_room(hole.n_moves(places.len()))?;
        let first = self.n_moves_of_pass();
        let mut cycle = Cycle { moves: first..first, hole, start_z_mm, places };
        let return_z_mm = cycle.return_z_mm();
        for place in &cycle.places {
            self.hole(&hole, place, return_z_mm)?;
        }
        if let Some(pass) = self.passes.last_mut() {
            cycle.moves.end = pass.moves.len();
            pass.cycles.push(cycle);
        }
        Ok(())
    }

    fn hole(&mut self, hole: &Hole, place: &Point2<f64>, return_z_mm: f64) -> Result<(), PathError> {
        let Hole { kind, retract_z_mm, bottom_z_mm, peck_mm, dwell_s, rate, .. } = *hole;
        let at = |z| Point3::new(place.x, place.y, z);
        self.rapid_unless_there(at(self.at().z))?;
        self.rapid_unless_there(at(retract_z_mm))?;
        if let Some(peck) = peck_mm {
            for k in 1..=hole.n_pecks() as u64 {
                let depth = retract_z_mm - k as f64 * peck;
                self.line(at(depth), rate, Role::Plunge)?;
                if kind == CycleKind::Peck {
                    self.rapid(at(retract_z_mm))?;
                }
                self.rapid_unless_there(at((depth + PECK_CLEARANCE_MM).min(retract_z_mm)))?;
            }
        }
        self.line(at(bottom_z_mm), rate, Role::Plunge)?;
        if dwell_s > 0.0 {
            self.dwell(dwell_s)?;
        }
        if kind == CycleKind::Ream {
            self.line(at(retract_z_mm), rate, Role::LeadOut)?;
        }
        self.rapid_unless_there(at(return_z_mm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::cycle::ReturnTo;
    use crate::toolpath::units::FeedRate;
    use crate::toolpath::{Move, Toolpath};

    fn hole(kind: CycleKind, peck_mm: Option<f64>, return_to: ReturnTo) -> Hole {
        let rate = FeedRate::from_mm_per_min(200.0).unwrap();
        let heights = (0.0, 2.0, -7.0);
        let (top_z_mm, retract_z_mm, bottom_z_mm) = heights;
        Hole { kind, top_z_mm, retract_z_mm, bottom_z_mm, peck_mm, dwell_s: 0.0, rate, return_to }
    }

    /// The moves of one hole at 10, 20 from z = 30: `r` or `f` with the height at the end.
    fn heights(hole: Hole) -> Vec<(char, f64)> {
        let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 30.0));
        path.cycle(hole, vec![Point2::new(10.0, 20.0)]).unwrap();
        let path = path.finish().unwrap();
        assert_eq!(path.passes()[0].cycles()[0].moves, 0..path.moves().count());
        path.moves()
            .map(|step| match step {
                Move::Rapid { line } => ('r', line.end.z),
                Move::Feed { along, .. } => ('f', along.end().z),
                Move::Dwell { seconds } => ('d', *seconds),
                Move::Turn { .. } => unreachable!(),
            })
            .collect()
    }

    #[test]
    fn each_kind_drills_as_controls_do() {
        let (r, f, d) = ('r', 'f', 'd');
        let drilled = heights(hole(CycleKind::Drill, None, ReturnTo::Start));
        assert_eq!(drilled, [(r, 30.0), (r, 2.0), (f, -7.0), (r, 30.0)]);
        let pecked = heights(hole(CycleKind::Peck, Some(4.0), ReturnTo::RetractPlane));
        let first = [(r, 30.0), (r, 2.0), (f, -2.0), (r, 2.0), (r, -1.5)];
        let second = [(f, -6.0), (r, 2.0), (r, -5.5), (f, -7.0), (r, 2.0)];
        assert_eq!(pecked, [first, second].concat());
        let broken = heights(hole(CycleKind::ChipBreak, Some(5.0), ReturnTo::RetractPlane));
        assert_eq!(broken, [(r, 30.0), (r, 2.0), (f, -3.0), (r, -2.5), (f, -7.0), (r, 2.0)]);
        let reamed = heights(Hole { dwell_s: 0.5, ..hole(CycleKind::Ream, None, ReturnTo::Start) });
        assert_eq!(reamed, [(r, 30.0), (r, 2.0), (f, -7.0), (d, 0.5), (f, 2.0), (r, 30.0)]);
    }

    #[test]
    fn a_peck_that_reaches_the_bottom_is_no_peck() {
        let pecked = heights(hole(CycleKind::Peck, Some(7.0), ReturnTo::Start));
        assert_eq!(pecked, heights(hole(CycleKind::Drill, None, ReturnTo::Start)));
    }

    #[test]
    fn a_sum_that_is_rounded_adds_no_peck_and_the_count_of_moves_bounds_them() {
        let rate = FeedRate::from_mm_per_min(200.0).unwrap();
        for k in 1..200_u32 {
            let (peck, pecks) = (0.1 * f64::from(k % 37 + 1), k % 11 + 2);
            let retract_z_mm = 0.1 * f64::from(k);
            let bottom_z_mm = retract_z_mm - peck * f64::from(pecks);
            let top_z_mm = retract_z_mm - 0.5 * peck;
            for (kind, return_to) in [CycleKind::Peck, CycleKind::ChipBreak]
                .into_iter()
                .flat_map(|kind| [ReturnTo::Start, ReturnTo::RetractPlane].map(|to| (kind, to)))
            {
                let peck_mm = Some(peck);
                let hole = Hole {
                    kind,
                    top_z_mm,
                    retract_z_mm,
                    bottom_z_mm,
                    peck_mm,
                    dwell_s: 0.0,
                    rate,
                    return_to,
                };
                let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 30.0));
                path.cycle(hole, vec![Point2::new(1.0, 0.0), Point2::new(2.0, 0.0)]).unwrap();
                let path = path.finish().unwrap();
                let fed = path.moves().filter(|step| matches!(step, Move::Feed { .. })).count();
                assert_eq!(fed, 2 * pecks as usize, "{k}");
                let count = path.moves().count() as f64;
                assert!(count <= hole.n_moves(2), "{k}");
                // A small peck comes back to the retract plane.
                assert!(hole.n_moves(2) <= count + 3.0 || peck <= PECK_CLEARANCE_MM, "{k}");
            }
        }
    }

    #[test]
    fn the_tool_stays_at_the_retract_plane_between_holes() {
        let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 30.0));
        let places = vec![Point2::new(1.0, 0.0), Point2::new(2.0, 0.0)];
        path.cycle(hole(CycleKind::Drill, None, ReturnTo::RetractPlane), places).unwrap();
        let path = path.finish().unwrap();
        let across: Vec<f64> = path
            .moves()
            .filter_map(|step| match step {
                Move::Rapid { line } if line.start.z == line.end.z => Some(line.end.z),
                _ => None,
            })
            .collect();
        assert_eq!(across, [30.0, 2.0]);
    }

    #[test]
    fn what_is_no_cycle_is_refused() {
        let drill = hole(CycleKind::Drill, None, ReturnTo::Start);
        let place = || vec![Point2::origin()];
        let refused = |hole: Hole, z: f64, places| {
            let mut path = Toolpath::builder(Point3::new(0.0, 0.0, z)).with_limit(100);
            let error = path.cycle(hole, places).unwrap_err();
            assert!(!path.has_passes());
            error
        };
        assert_eq!(refused(drill, 30.0, Vec::new()), CycleError::NoHoles.into());
        assert!(matches!(refused(drill, 1.0, place()), PathError::Cycle(CycleError::StartsBelow { .. })));
        for (bottom_z_mm, top_z_mm) in [(0.0, 0.0), (-7.0, 3.0), (-7.0, 2.0), (f64::NAN, 0.0)] {
            let wrong = Hole { bottom_z_mm, top_z_mm, ..drill };
            assert_eq!(refused(wrong, 30.0, place()), CycleError::Heights.into());
        }
        for (kind, peck_mm) in [
            (CycleKind::Drill, Some(1.0)),
            (CycleKind::Peck, None),
            (CycleKind::Peck, Some(0.0)),
            (CycleKind::ChipBreak, Some(f64::NAN)),
        ] {
            assert_eq!(refused(Hole { kind, peck_mm, ..drill }, 30.0, place()), CycleError::Peck.into());
        }
        let pecks = Hole { dwell_s: 1.0, ..hole(CycleKind::Peck, Some(1.0), ReturnTo::Start) };
        assert_eq!(refused(pecks, 30.0, place()), CycleError::Dwell.into());
        let tiny = hole(CycleKind::Peck, Some(1e-9), ReturnTo::Start);
        assert_eq!(refused(tiny, 30.0, place()), PathError::TooManyMoves { limit: 100 });
    }
}
