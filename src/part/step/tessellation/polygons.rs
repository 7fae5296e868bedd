//! The bounds of one face as polygons in its parameters, whose corners are vertices.
//!
//! # Method
//! 1. A part of an edge has the places of the edge as its corners.
//! 2. A side that is a pole has one vertex and many corners. A seam without an edge is divided once; the side
//!    that it closes has its corners a whole number of periods away.
//! 3. Short steps between edges that do not quite meet are left out.

use nalgebra::Point3;
use toolpathd_core::budget::{Budget, Stopped};

use super::edges::Edges;
use super::surface_bounds::Rectangle;
use super::trimmed_face::{TrimmedFace, place};
use crate::step::parameter_search::ParameterSearch;
use crate::step::piece::{BoundPiece, Sample, Sampler};
use crate::step::surface::PolarSide;

/// Two parameters are one if they differ by less than this part of the range of the face.
const SAME: f64 = 1e-9;

/// The most sides of a pole.
const MOST_POLE_SIDES: f64 = 65_536.0;

/// The most sides of a seam.
const MOST_SEAM_SIDES: usize = 1 << 16;

/// A vertex of the face: of an edge, or its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Node {
    Shared(u32),
    Own(u32),
}

/// A corner of a polygon, with the side from it to the next corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    pub at: [f64; 2],
    pub node: Node,
    pub side: Side,
}

/// What a side of a polygon is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Side {
    /// Between two neighbouring parameters of an edge of the face, in the direction of the loop: a part of a
    /// record, by the number of its lower place.
    Edge { edge: usize, t: [f64; 2], part: [usize; 2] },
    /// A line of the parameters: a seam or a pole.
    Line,
}

/// The bounds of a face. The face lies to the left.
#[derive(Debug, Clone, Default)]
pub struct Polygons {
    pub loops: Vec<Vec<Corner>>,
    /// The face's own vertices.
    pub own: Vec<Point3<f64>>,
}

/// Why a face has no polygons.
#[derive(Debug, Clone, PartialEq)]
pub enum Unbounded {
    Open(&'static str),
    Stopped(Stopped),
}

impl From<Stopped> for Unbounded {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
    }
}

/// A seam that has been divided: its corners with their vertices.
type Seam = Vec<([f64; 2], Node)>;

/// Builds the polygons of one face.
struct Builder<'a> {
    face: &'a TrimmedFace<'a>,
    sampler: Sampler<'a>,
    all: &'a Edges,
    poles: Vec<PolarSide>,
    periods: [Option<f64>; 2],
    /// The ranges of the outer bound.
    ranges: Rectangle,
    /// What counts as one parameter along u and v.
    near: [f64; 2],
    allowed_mm: f64,
    /// How often the seams are halved more than their deviation asks for.
    halvings: u32,
    own: Vec<Point3<f64>>,
    /// Own vertices with their parameters.
    free: Vec<([f64; 2], Node)>,
    seams: Vec<Seam>,
}

impl TrimmedFace<'_> {
    /// The polygons of the face with the places of its edges. Chords of seams are within `allowed_mm` of the
    /// surface.
    ///
    /// # Errors
    /// The bounds are not closed, or the budget has ended.
    pub fn polygons(
        &self,
        all: &Edges,
        allowed_mm: f64,
        halvings: u32,
        budget: &Budget,
    ) -> Result<Polygons, Unbounded> {
        let surface = self.bounds.surface;
        let search = ParameterSearch::new(surface);
        let first = self.trim.chains[0].box_of();
        let mut builder = Builder {
            face: self,
            sampler: Sampler::new(&search, 0.0),
            all,
            poles: surface.poles(),
            periods: surface.periods(),
            ranges: first,
            near: first.map(|[low, high]| SAME * (high - low).max(f64::MIN_POSITIVE)),
            allowed_mm,
            halvings,
            own: Vec::new(),
            free: Vec::new(),
            seams: Vec::new(),
        };
        let mut loops = Vec::new();
        for chain in &self.trim.chains {
            builder.find_poles(&chain.pieces)?;
        }
        for chain in &self.trim.chains {
            loops.push(builder.polygon(&chain.pieces, budget)?);
        }
        merge_places(&mut loops, builder.near);
        Ok(Polygons { loops, own: builder.own })
    }
}

impl Polygons {
    pub fn point(&self, node: Node, all: &Edges) -> Point3<f64> {
        match node {
            Node::Shared(vertex) => all.vertices[vertex as usize],
            Node::Own(vertex) => self.own[vertex as usize],
        }
    }
}

impl Builder<'_> {
    fn polygon(&mut self, pieces: &[BoundPiece], budget: &Budget) -> Result<Vec<Corner>, Unbounded> {
        let mut corners: Vec<Corner> = Vec::new();
        let n = pieces.len();
        for (k, piece) in pieces.iter().enumerate() {
            budget.check()?;
            match piece {
                BoundPiece::Curve { edge, samples } => corners.extend(self.curve(*edge, samples)?),
                BoundPiece::Straight(ends) => {
                    let before = self.end_of(&pieces[(k + n - 1) % n])?;
                    let after = self.start_of(&pieces[(k + 1) % n])?;
                    corners.extend(self.straight(*ends, before, after)?);
                }
            }
        }
        if corners.is_empty() {
            return Err(Unbounded::Open("a bound has no sides"));
        }
        Ok(corners)
    }

    /// Makes the vertices of edges that meet poles those of the poles.
    fn find_poles(&mut self, pieces: &[BoundPiece]) -> Result<(), Unbounded> {
        let n = pieces.len();
        for (k, piece) in pieces.iter().enumerate() {
            let BoundPiece::Straight(ends) = piece else { continue };
            if self.pole(*ends).is_none() {
                continue;
            }
            let before = self.end_of(&pieces[(k + n - 1) % n])?;
            if let Some(node) = before.or(self.start_of(&pieces[(k + 1) % n])?) {
                self.free.push((ends[0], node));
            }
        }
        Ok(())
    }

    /// The corners of a piece of an edge, without its end.
    fn curve(&self, edge: usize, samples: &[Sample]) -> Result<Vec<Corner>, Unbounded> {
        let used = self.face.uses[edge];
        let record = &self.all.records[used.record];
        let ends = [samples[0].t, samples[samples.len() - 1].t];
        let [first, last] = [self.number(edge, ends[0])?, self.number(edge, ends[1])?];
        let numbers: Vec<usize> =
            if first <= last { (first..=last).collect() } else { (last..=first).rev().collect() };
        let n = numbers.len();
        let t = |k: usize| match k {
            0 => ends[0],
            k if k + 1 == n => ends[1],
            k => record.turned(record.places[numbers[k]].t, used.is_turned),
        };
        let mut corners = Vec::with_capacity(n);
        for (k, number) in numbers[..n - 1].iter().enumerate() {
            let at = if k == 0 {
                samples[0].at
            } else {
                place(&self.sampler, &self.face.edges[edge], samples, t(k))
            };
            let node = Node::Shared(record.places[*number].vertex);
            corners.push(Corner {
                at,
                node,
                side: Side::Edge {
                    edge,
                    t: [t(k), t(k + 1)],
                    part: [used.record, (*number).min(numbers[k + 1])],
                },
            });
        }
        Ok(corners)
    }

    /// The number of the place of an edge of the face at a parameter.
    fn number(&self, edge: usize, t: f64) -> Result<usize, Unbounded> {
        let at = self.face.uses[edge];
        let record = &self.all.records[at.record];
        record.find(record.turned(t, at.is_turned)).ok_or(Unbounded::Open("an edge has no place at its end"))
    }

    fn node(&self, edge: usize, sample: &Sample) -> Result<Node, Unbounded> {
        let number = self.number(edge, sample.t)?;
        Ok(Node::Shared(self.all.records[self.face.uses[edge].record].places[number].vertex))
    }

    /// The vertex at the end of a piece of an edge.
    fn end_of(&self, piece: &BoundPiece) -> Result<Option<Node>, Unbounded> {
        match piece {
            BoundPiece::Curve { edge, samples } => self.node(*edge, &samples[samples.len() - 1]).map(Some),
            BoundPiece::Straight(_) => Ok(None),
        }
    }

    /// The vertex at the start of a piece of an edge.
    fn start_of(&self, piece: &BoundPiece) -> Result<Option<Node>, Unbounded> {
        match piece {
            BoundPiece::Curve { edge, samples } => self.node(*edge, &samples[0]).map(Some),
            BoundPiece::Straight(_) => Ok(None),
        }
    }

    /// The corners of a straight piece without its end, between the vertices of edges before and after it.
    fn straight(
        &mut self,
        ends: [[f64; 2]; 2],
        before: Option<Node>,
        after: Option<Node>,
    ) -> Result<Vec<Corner>, Unbounded> {
        let of_line = |at: [f64; 2], node: Node| Corner { at, node, side: Side::Line };
        let is_short = (0..2).all(|k| (ends[1][k] - ends[0][k]).abs() <= self.near[k]);
        if is_short && (before == after || before.is_none() || after.is_none()) {
            return Ok(Vec::new());
        }
        if let Some(pole) = self.pole(ends) {
            let node = match before.or(after) {
                Some(node) => node,
                None => self.free_node(ends[0], Some(pole)),
            };
            let other = 1 - pole.along;
            let step = self.face.bounds.step_at_pole(self.ranges, pole.along, pole.at, self.allowed_mm);
            let n = ((ends[1][other] - ends[0][other]).abs() / step).ceil().clamp(1.0, MOST_POLE_SIDES);
            let place = |k: usize| [0, 1].map(|i| ends[0][i] + (ends[1][i] - ends[0][i]) * k as f64 / n);
            return Ok((0..n as usize).map(|k| of_line(place(k), node)).collect());
        }
        let is_turn =
            |k: usize| self.periods[k].is_some_and(|period| (ends[1][k] - ends[0][k]).abs() > period / 2.0);
        if before.is_some() && before == after && !is_turn(0) && !is_turn(1) {
            // Two edges that meet in space within what the file allows.
            return Ok(Vec::new());
        }
        let seam = match self.known_seam(ends) {
            Some(seam) => seam,
            None => self.new_seam(ends, before, after)?,
        };
        Ok(seam[..seam.len() - 1].iter().map(|(at, node)| of_line(*at, *node)).collect())
    }

    /// The pole that both ends are at.
    fn pole(&self, ends: [[f64; 2]; 2]) -> Option<PolarSide> {
        let is_at = |pole: &&PolarSide| {
            ends.iter().all(|at| {
                let gap = at[pole.along] - pole.at;
                let gap =
                    self.periods[pole.along].map_or(gap, |period| gap - (gap / period).round() * period);
                gap.abs() <= 1e-7_f64.max(self.near[pole.along])
            })
        };
        self.poles.iter().find(is_at).copied()
    }

    /// A vertex of the face alone at a place, or at a pole.
    fn free_node(&mut self, at: [f64; 2], pole: Option<PolarSide>) -> Node {
        let is_one = |a: &[f64; 2]| {
            (0..2).all(|k| {
                let gap = a[k] - at[k];
                let gap = self.periods[k].map_or(gap, |period| gap - (gap / period).round() * period);
                gap.abs() <= self.near[k].max(1e-9) || pole.is_some_and(|pole| pole.along != k)
            })
        };
        if let Some((_, node)) = self.free.iter().find(|(a, _)| is_one(a)) {
            return *node;
        }
        self.own.push(pole.map_or_else(|| self.face.bounds.surface.point(at), |pole| pole.point));
        let node = Node::Own((self.own.len() - 1) as u32);
        self.free.push((at, node));
        node
    }

    /// The seam that a side closes, passed the other way, moved to the side.
    fn known_seam(&self, ends: [[f64; 2]; 2]) -> Option<Seam> {
        for seam in &self.seams {
            let [first, last] = [seam[0].0, seam[seam.len() - 1].0];
            let shift = [0, 1].map(|k| {
                let gap = ends[0][k] - last[k];
                self.periods[k].map_or(0.0, |period| (gap / period).round() * period)
            });
            let is_near = |a: [f64; 2], b: [f64; 2]| {
                (0..2).all(|k| (a[k] + shift[k] - b[k]).abs() <= self.near[k].max(1e-7 * shift[k].abs()))
            };
            if is_near(last, ends[0]) && is_near(first, ends[1]) {
                let moved = seam.iter().rev().map(|(at, node)| ([at[0] + shift[0], at[1] + shift[1]], *node));
                let mut moved: Seam = moved.collect();
                let end = moved.len() - 1;
                (moved[0].0, moved[end].0) = (ends[0], ends[1]);
                return Some(moved);
            }
        }
        None
    }

    /// A seam, divided.
    fn new_seam(
        &mut self,
        ends: [[f64; 2]; 2],
        before: Option<Node>,
        after: Option<Node>,
    ) -> Result<Seam, Unbounded> {
        let surface = self.face.bounds.surface;
        let place =
            |k: usize, n: usize| [0, 1].map(|i| ends[0][i] + (ends[1][i] - ends[0][i]) * k as f64 / n as f64);
        let is_fine = |n: usize| {
            (0..n).all(|k| {
                let at = [place(k, n), place(k + 1, n)];
                self.face.bounds.of_chord(at, at.map(|at| surface.point(at))) <= self.allowed_mm
            })
        };
        let mut n = 1;
        while !is_fine(n) {
            n *= 2;
            if n > MOST_SEAM_SIDES {
                return Err(Unbounded::Open("its seam needs too many sides"));
            }
        }
        n = (n << self.halvings).min(MOST_SEAM_SIDES);
        let mut seam = Vec::with_capacity(n + 1);
        for k in 0..=n {
            let at = place(k, n);
            let known = if k == 0 {
                before
            } else if k == n {
                after
            } else {
                None
            };
            let node = match known {
                Some(node) => node,
                None if k == 0 || k == n => {
                    let pole = self.pole([at, at]);
                    self.free_node(at, pole)
                }
                None => {
                    self.own.push(surface.point(at));
                    Node::Own((self.own.len() - 1) as u32)
                }
            };
            seam.push((at, node));
        }
        self.seams.push(seam.clone());
        Ok(seam)
    }
}

/// Gives corners of one vertex whose parameters differ by rounding the same parameters.
fn merge_places(loops: &mut [Vec<Corner>], near: [f64; 2]) {
    let mut known: std::collections::BTreeMap<Node, Vec<[f64; 2]>> = std::collections::BTreeMap::new();
    for corner in loops.iter_mut().flatten() {
        let places = known.entry(corner.node).or_default();
        let found = places.iter().find(|at| (0..2).all(|k| (at[k] - corner.at[k]).abs() <= near[k]));
        match found {
            Some(at) => corner.at = *at,
            None => places.push(corner.at),
        }
    }
}
