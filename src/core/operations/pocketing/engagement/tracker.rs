//! The cutter that keeps its angle in the material.

mod steering;

use super::super::PocketError;
use super::super::chain::SHORTEST_MM;
use super::super::links::Pose as State;
use super::super::router::{Purpose, Router};
use super::wall::{OnWall, Wall};
use crate::budget::Budget;
use crate::geometry::region::{Containment, Region};
use crate::geometry::segment::Segment;

/// The radius of the tightest turn to the right, in cutter radii.
const TIGHTEST_RIGHT: f64 = 0.8;

/// Larger angles count as material, radians: thin ridges are left to the end.
const MATERIAL: f64 = 0.2;

/// The first, the shortest and the longest arc, in cutter radii.
const LENGTHS: [f64; 3] = [0.3, 0.05, 2.0];

/// How far ahead material is looked for, in cutter radii.
const AHEAD: f64 = 1.0;

/// Places at which material is looked for are this far apart, in cutter radii.
const LOOKED_AT: f64 = 0.1;

/// How near the boundary the centre of a turn may be, mm.
const ON_EDGE_MM: f64 = 1e-7;

/// A rest of the wall that is no longer is not searched for material, mm.
const REST_MM: f64 = 1e-5;

/// A pass that gets no farther than this is stuck, mm: it then follows the wall although the angle there is
/// too large, or it would not end.
const STUCK_MM: f64 = 1e-3;

/// The most arcs.
const MOST_ARCS: usize = 1_000_000;

pub struct Tracker<'a, 'b> {
    router: &'b mut Router<'a>,
    wall: &'b Wall,
    /// Where the centre of the tightest turn may be.
    turning: &'b Region,
    tight_mm: f64,
    target: f64,
    /// The length of the next arc, mm, and the curvature of the last.
    length_mm: f64,
    curvature: f64,
    /// Places on the wall after which material may begin.
    begins: Vec<OnWall>,
    /// Places on the wall from which there is none up to the next of both lists.
    passed: Vec<OnWall>,
    arcs: usize,
    budget: &'b Budget,
}

/// What a part of a pass ended at.
enum End {
    Wall(OnWall),
    Inside,
    Air,
}

impl<'a, 'b> Tracker<'a, 'b> {
    pub fn new(
        router: &'b mut Router<'a>,
        wall: &'b Wall,
        turning: &'b Region,
        tight_mm: f64,
        budget: &'b Budget,
    ) -> Self {
        let conditions = router.conditions;
        Self {
            target: conditions.target_angle(),
            length_mm: LENGTHS[0] * conditions.radius_mm,
            router,
            wall,
            turning,
            tight_mm,
            curvature: 0.0,
            begins: Vec::new(),
            passed: Vec::new(),
            arcs: 0,
            budget,
        }
    }

    /// Cuts from the end of the helix until no place on the wall has material ahead.
    pub fn clear(&mut self) -> Result<(), PocketError> {
        if let Some(state) = self.router.heading() {
            self.curvature = 0.0;
            self.pass(state)?;
        }
        self.clear_from_wall()
    }

    /// Cuts beside loops that have been cut, the last first, until no place on the wall has material
    /// ahead.
    pub fn clear_beside(&mut self, loops: &[&[Segment]]) -> Result<(), PocketError> {
        for elements in loops.iter().rev() {
            if self.router.come_to(elements)? {
                self.curvature = 0.0;
                self.length_mm = LENGTHS[0] * self.router.conditions.radius_mm;
                self.pass(State::before(&elements[0]))?;
            }
        }
        self.clear_from_wall()
    }

    fn clear_from_wall(&mut self) -> Result<(), PocketError> {
        let radius = self.router.conditions.radius_mm;
        while let Some(start) = self.next_start()? {
            let (arcs, begins) = (self.arcs, self.begins.len());
            if self.has_material_on_wall(start, AHEAD * radius) {
                self.pass_from(start)?;
            }
            if self.arcs == arcs {
                // The material is narrower than the places looked at are apart. It is left to the end.
                self.count_arc()?;
                self.begins.truncate(begins);
                self.passed.push(start);
                self.begins.push(self.wall.onward(start, LENGTHS[0] * radius));
            }
        }
        Ok(())
    }

    /// Cuts from a place on the wall on.
    fn pass_from(&mut self, start: OnWall) -> Result<(), PocketError> {
        let first = self.wall.part(start, self.router.conditions.radius_mm);
        let state = State::before(&first);
        if !self.router.lead_to(&[first], state.center(self.tight_mm))? {
            return Ok(());
        }
        match self.slide(start, false)? {
            End::Inside => self.pass_on(),
            _ => {
                self.leave();
                Ok(())
            }
        }
    }

    fn pass_on(&mut self) -> Result<(), PocketError> {
        match self.router.heading() {
            Some(state) => self.pass(state),
            None => Ok(()),
        }
    }

    /// Says where the cutter may turn away.
    fn leave(&mut self) {
        if let Some(state) = self.router.heading() {
            self.router.leave_about(state.center(self.tight_mm));
        }
    }

    /// Cuts until there is no material ahead.
    fn pass(&mut self, mut state: State) -> Result<(), PocketError> {
        let mut is_stuck = false;
        loop {
            let before = state.at;
            match self.track(state)? {
                End::Wall(place) => match self.slide(place, is_stuck)? {
                    End::Inside => {
                        let Some(heading) = self.router.heading() else { return Ok(()) };
                        state = heading;
                        is_stuck = (state.at - before).norm() < STUCK_MM;
                    }
                    _ => break,
                },
                _ => break,
            }
        }
        self.leave();
        Ok(())
    }

    fn cut(&mut self, element: Segment) -> Result<(), PocketError> {
        self.count_arc()?;
        self.router.follow(&[element], Purpose::Cut)
    }

    fn count_arc(&mut self) -> Result<(), PocketError> {
        self.arcs += 1;
        if self.arcs > MOST_ARCS {
            return Err(PocketError::TooMuchWork { what: "arcs", limit: MOST_ARCS });
        }
        Ok(self.budget.check()?)
    }

    /// Follows arcs at the target angle, to the wall or into the air.
    fn track(&mut self, mut state: State) -> Result<End, PocketError> {
        let radius = self.router.conditions.radius_mm;
        loop {
            let arc = self.arc(state);
            let end = State::after(&arc);
            if self.has_room(&arc) {
                if self.router.angle_at(end.at, end.along) <= MATERIAL {
                    let onward = end.arc(-1.0 / (TIGHTEST_RIGHT * radius), AHEAD * radius);
                    if !self.has_material(&arc) && !self.has_material(&onward) {
                        return Ok(End::Air);
                    }
                }
                self.cut(arc)?;
                state = end;
                continue;
            }
            // To where the tightest turn touches the wall.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if self.has_room(&arc.part(0.0, middle)) { low = middle } else { high = middle }
            }
            let before = arc.part(0.0, low);
            if before.length() > SHORTEST_MM {
                self.cut(before)?;
                state = State::after(&before);
            }
            let center = state.center(self.tight_mm);
            let (place, q) = self.wall.nearest(center);
            let spoke = state.at - center;
            let to = (q - center).normalize() * spoke.norm();
            let turn = spoke.perp(&to).atan2(spoke.dot(&to));
            if turn > State::LEAST_TURN {
                self.cut(Segment::about(center, spoke.norm(), [state.at, center + to], turn))?;
            }
            return Ok(End::Wall(place));
        }
    }

    fn has_material(&mut self, element: &Segment) -> bool {
        let count = (element.length() / (LOOKED_AT * self.router.conditions.radius_mm)).ceil().max(1.0);
        (0..=count as usize).any(|k| self.is_material(element, k as f64 / count))
    }

    fn is_material(&mut self, element: &Segment, t: f64) -> bool {
        self.router.angle_at(element.at(t), element.direction(t)) > MATERIAL
    }

    /// Whether the tightest turn fits at the middle and the end of an arc.
    fn has_room(&self, arc: &Segment) -> bool {
        let has_turn = |t: f64| {
            let center = State { at: arc.at(t), along: arc.direction(t) }.center(self.tight_mm);
            self.turning.place(center, ON_EDGE_MM) != Containment::Outside
        };
        has_turn(1.0) && has_turn(0.5) && self.router.is_allowed(&[*arc])
    }

    /// Follows the wall while there is material and the angle is at most the target.
    fn slide(&mut self, mut place: OnWall, is_stuck: bool) -> Result<End, PocketError> {
        let radius = self.router.conditions.radius_mm;
        let step = LENGTHS[0] * radius;
        let mut gone = 0.0;
        let whole = self.wall.length(place.index);
        let end = loop {
            if gone > whole || !self.has_material_on_wall(place, AHEAD * radius) {
                break End::Air;
            }
            let part = self.wall.part(place, step);
            let fits = |tracker: &mut Self, t: f64| {
                [0.5 * t, t]
                    .into_iter()
                    .all(|t| tracker.router.angle_at(part.at(t), part.direction(t)) <= tracker.target)
            };
            let length = part.length();
            if fits(self, 1.0) || is_stuck && gone == 0.0 {
                self.cut(part)?;
                place = self.wall.onward(place, length);
                gone += length;
                continue;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..8 {
                let middle = 0.5 * (low + high);
                if fits(self, middle) { low = middle } else { high = middle }
            }
            if low * length > SHORTEST_MM {
                self.cut(part.part(0.0, low))?;
                place = self.wall.onward(place, low * length);
            }
            self.curvature = 0.0;
            self.length_mm = step;
            break End::Inside;
        };
        self.begins.push(place);
        Ok(end)
    }

    fn has_material_on_wall(&mut self, from: OnWall, length_mm: f64) -> bool {
        let (mut place, mut left) = (from, length_mm);
        while left > REST_MM {
            let part = self.wall.part(place, left);
            if self.has_material(&part) {
                return true;
            }
            let length = part.length();
            place = self.wall.onward(place, length);
            left -= length;
        }
        false
    }

    /// Where the nearest pass begins.
    fn next_start(&mut self) -> Result<Option<OnWall>, PocketError> {
        loop {
            let Some(at) = self.router.at() else { return Ok(None) };
            let distance = |place: &OnWall| (self.wall.part(*place, 1.0).start() - at).norm();
            let nearest = (0..self.begins.len())
                .min_by(|a, b| distance(&self.begins[*a]).total_cmp(&distance(&self.begins[*b])));
            let Some(k) = nearest else { return Ok(None) };
            let from = self.begins.swap_remove(k);
            if let Some(start) = self.first_material(from) {
                return Ok(Some(start));
            }
            self.passed.push(from);
        }
    }

    /// The first place with material from a place on, before the next place in question.
    fn first_material(&mut self, from: OnWall) -> Option<OnWall> {
        let whole = self.wall.length(from.index);
        let ahead = |other: &OnWall| (other.length_mm - from.length_mm).rem_euclid(whole);
        let limit =
            self.begins.iter().chain(&self.passed).filter(|other| other.index == from.index).map(ahead);
        let limit = limit.fold(whole, f64::min);
        let step = LOOKED_AT * self.router.conditions.radius_mm;
        let mut gone = 0.0;
        while gone < limit {
            let part = self.wall.part(self.wall.onward(from, gone), step.min(limit - gone));
            if self.is_material(&part, 1.0) {
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..8 {
                    let middle = 0.5 * (low + high);
                    if self.is_material(&part, middle) { high = middle } else { low = middle }
                }
                return Some(self.wall.onward(from, gone + low * part.length()));
            }
            gone += part.length().max(SHORTEST_MM);
        }
        None
    }
}
