//! Features of solids: round holes and level faces.
//!
//! # Method
//! Cylindrical faces of one body that are seen from inside, with one axis and one radius, make a hole where
//! they overlap along the axis and go all the way round. An end of a hole is closed if the faces that lie
//! beyond it, joined by edges and no farther from the axis than the radius, meet the axis.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::extent::contains;
use super::frame::Frame;
use super::model::{Body, Face, Hole, LevelFaces};
use super::parameter_search::ParameterSearch;
use super::piece::spread;
use super::surface::Surface;

/// Axes and radii that differ by less are the same, mm.
const SAME_MM: f64 = 1e-4;

/// Directions whose sine differs by less are the same.
const SAME_DIRECTION: f64 = 1e-6;

/// Axes and radii are compared with those of near cells of this size, mm: far more than one axis may differ
/// over a part of some metres.
const CELL_MM: f64 = 0.1;

/// Heights of levels that differ by less are the same, mm.
const SAME_HEIGHT_MM: f64 = 1e-6;

/// How many faces lie one behind the other beyond the end of a hole.
const FACES_BEYOND: usize = 4;

/// A cylindrical face seen from inside.
struct Wall {
    face: usize,
    /// The frame of the first face of this axis and radius.
    base: Frame,
    radius_mm: f64,
    /// The range along z of this frame, mm.
    range: [f64; 2],
}

/// The holes of the solids, in the order of their first faces.
pub fn holes(bodies: &[Body], faces: &[Face]) -> Vec<Hole> {
    let mut holes = Vec::new();
    for (number, body) in bodies.iter().enumerate().filter(|(_, body)| body.is_solid) {
        let mut by_edge: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for face in body.faces.clone() {
            for edge in faces[face].loops.iter().flat_map(|one| &one.edges) {
                by_edge.entry(edge.entity).or_default().push(face);
            }
        }
        let solid = Solid { faces, by_edge };
        for walls in groups(faces, body) {
            holes.extend(solid.hole(number, &walls));
        }
    }
    holes
}

/// Walls with one axis and one radius that overlap or meet along the axis.
fn groups(faces: &[Face], body: &Body) -> Vec<Vec<Wall>> {
    let mut alike: Vec<Vec<Wall>> = Vec::new();
    let mut by_cell: BTreeMap<[i64; 4], Vec<usize>> = BTreeMap::new();
    for number in body.faces.clone() {
        let face = &faces[number];
        let Surface::Cylinder { frame, radius_mm } = &face.surface else { continue };
        if !face.is_reversed {
            continue;
        }
        let wall = |base, range| Wall { face: number, base, radius_mm: *radius_mm, range };
        let cell = cell(frame, *radius_mm);
        let near = around(cell).filter_map(|cell| by_cell.get(&cell)).flatten().copied();
        match near.into_iter().find(|k| is_alike(&alike[*k][0], frame, *radius_mm)) {
            Some(k) => {
                let base = alike[k][0].base;
                let ends = face.domain[1].map(|v| (frame.origin + frame.z * v - base.origin).dot(&base.z));
                alike[k].push(wall(base, [ends[0].min(ends[1]), ends[0].max(ends[1])]));
            }
            None => {
                by_cell.entry(cell).or_default().push(alike.len());
                alike.push(vec![wall(*frame, face.domain[1])]);
            }
        }
    }
    let mut groups = Vec::new();
    for mut walls in alike {
        walls.sort_by(|a, b| a.range[0].total_cmp(&b.range[0]));
        let mut end = f64::MIN;
        let mut group: Vec<Wall> = Vec::new();
        for wall in walls {
            if wall.range[0] > end + SAME_MM && !group.is_empty() {
                groups.push(std::mem::take(&mut group));
            }
            end = end.max(wall.range[1]);
            group.push(wall);
        }
        groups.push(group);
    }
    groups.sort_by_key(|walls| walls.iter().map(|wall| wall.face).min());
    groups
}

/// The cell of an axis and a radius: of the axis, its point nearest to the origin counts.
fn cell(frame: &Frame, radius_mm: f64) -> [i64; 4] {
    let origin = frame.origin.coords;
    let nearest = origin - frame.z * origin.dot(&frame.z);
    [nearest.x, nearest.y, nearest.z, radius_mm].map(|x| (x / CELL_MM).floor() as i64)
}

/// A cell and its neighbours.
fn around(cell: [i64; 4]) -> impl Iterator<Item = [i64; 4]> {
    (0..81).map(move |k| {
        let step = |k: i64, power: i64| k / power % 3 - 1;
        [0, 1, 2, 3].map(|m| cell[m].saturating_add(step(k, [1, 3, 9, 27][m])))
    })
}

fn is_alike(wall: &Wall, frame: &Frame, radius_mm: f64) -> bool {
    let offset = frame.origin - wall.base.origin;
    (wall.radius_mm - radius_mm).abs() < SAME_MM
        && wall.base.z.cross(&frame.z).norm() < SAME_DIRECTION
        && wall.base.z.cross(&offset).norm() < SAME_MM + SAME_DIRECTION * offset.norm()
}

/// The faces of a solid with the faces at each edge.
struct Solid<'a> {
    faces: &'a [Face],
    by_edge: BTreeMap<u64, Vec<usize>>,
}

impl Solid<'_> {
    fn hole(&self, body: usize, walls: &[Wall]) -> Option<Hole> {
        let radius_mm = walls[0].radius_mm;
        let low = walls.iter().map(|wall| wall.range[0]).fold(f64::MAX, f64::min);
        let high = walls.iter().map(|wall| wall.range[1]).fold(f64::MIN, f64::max);
        if !goes_round(self.faces, walls) {
            return None;
        }
        let frame = walls[0].base;
        let ends = [low, high].map(|v| frame.origin + frame.z * v);
        let numbers: BTreeSet<usize> = walls.iter().map(|wall| wall.face).collect();
        let closed = [
            self.is_closed(&numbers, ends[0], -frame.z, radius_mm),
            self.is_closed(&numbers, ends[1], frame.z, radius_mm),
        ];
        // A hole begins at its open end; a through hole at its upper end.
        let is_upper = match closed {
            [false, true] => false,
            [true, false] => true,
            _ => frame.z.z > 0.0,
        };
        let (start, axis) = if is_upper { (ends[1], -frame.z) } else { (ends[0], frame.z) };
        Some(Hole {
            body,
            faces: numbers.into_iter().collect(),
            start,
            axis,
            diameter_mm: 2.0 * radius_mm,
            depth_mm: high - low,
            is_through: closed == [false, false],
        })
    }
    /// Whether faces close a hole beyond its end in a direction.
    fn is_closed(
        &self,
        walls: &BTreeSet<usize>,
        end: Point3<f64>,
        along: Vector3<f64>,
        radius_mm: f64,
    ) -> bool {
        let mut reached = walls.clone();
        let mut last: Vec<usize> = walls.iter().copied().collect();
        for _ in 0..FACES_BEYOND {
            let mut next = Vec::new();
            for face in last.iter().flat_map(|face| self.neighbours(*face)) {
                if reached.insert(face) && is_beyond(&self.faces[face], end, along, radius_mm) {
                    next.push(face);
                }
            }
            if next.iter().any(|face| meets_axis(&self.faces[*face], end, along)) {
                return true;
            }
            last = next;
        }
        false
    }

    fn neighbours(&self, face: usize) -> Vec<usize> {
        let edges = self.faces[face].loops.iter().flat_map(|one| &one.edges);
        let known = edges.filter(|edge| edge.entity > 0).filter_map(|edge| self.by_edge.get(&edge.entity));
        known.flatten().copied().collect()
    }
}

/// Whether all edges of a face are beyond the end of a hole, and no farther from its axis than the radius.
fn is_beyond(face: &Face, end: Point3<f64>, along: Vector3<f64>, radius_mm: f64) -> bool {
    let mut points = face
        .loops
        .iter()
        .flat_map(|one| &one.edges)
        .flat_map(|edge| spread(edge).into_iter().map(|t| edge.curve.point(t) - end));
    points.all(|d| {
        let height = d.dot(&along);
        height > -SAME_MM && (d - along * height).norm() < radius_mm + SAME_MM
    })
}

/// Whether an axis meets a face.
fn meets_axis(face: &Face, origin: Point3<f64>, along: Vector3<f64>) -> bool {
    let meets = |at: [f64; 2]| contains(&face.trim, face.domain, face.surface.periods(), at);
    let poles = face.surface.poles();
    let has_pole_on_axis = poles.iter().any(|pole| {
        let d = pole.point - origin;
        let [from, to] = face.domain[pole.along];
        let is_covered = (pole.at - from).abs().min((pole.at - to).abs()) < SAME_DIRECTION * (to - from);
        is_covered && (d - along * d.dot(&along)).norm() < SAME_MM
    });
    has_pole_on_axis
        || match &face.surface {
            Surface::Plane { frame } => {
                let share = along.dot(&frame.z);
                let t = (frame.origin - origin).dot(&frame.z) / share;
                share.abs() > SAME_DIRECTION
                    && meets(ParameterSearch::new(&face.surface).of(&(origin + along * t), None))
            }
            Surface::Sphere { frame, radius_mm } => {
                let d = frame.origin - origin;
                let middle = d.dot(&along);
                let half = (radius_mm * radius_mm - d.norm_squared() + middle * middle).max(0.0).sqrt();
                [middle - half, middle + half].into_iter().any(|t| {
                    t > -SAME_MM && meets(ParameterSearch::new(&face.surface).of(&(origin + along * t), None))
                })
            }
            _ => false,
        }
}

/// Whether walls cover all directions from their axis.
fn goes_round(faces: &[Face], walls: &[Wall]) -> bool {
    let mut covered = [false; 64];
    for wall in walls {
        let face = &faces[wall.face];
        let Surface::Cylinder { frame, .. } = &face.surface else { continue };
        let [from, to] = face.domain[0];
        let n = 256;
        for k in 0..n {
            let out = frame.radial(from + (to - from) * (f64::from(k) + 0.5) / f64::from(n));
            let angle = out.dot(&wall.base.y).atan2(out.dot(&wall.base.x)).rem_euclid(TAU);
            covered[((angle / TAU * 64.0) as usize).min(63)] = true;
        }
    }
    covered.iter().all(|is_covered| *is_covered)
}

/// Plane faces with a normal along z, by height from the top down.
pub fn levels(faces: &[Face]) -> Vec<LevelFaces> {
    let mut found: Vec<(bool, f64, usize)> = Vec::new();
    for (number, face) in faces.iter().enumerate() {
        let Surface::Plane { frame } = &face.surface else { continue };
        if frame.z.xy().norm() <= SAME_DIRECTION {
            // A mirrored frame is left-handed: its normal is x times y.
            let is_up = (frame.x.cross(&frame.y).z > 0.0) != face.is_reversed;
            found.push((is_up, (face.bounds_mm[0].z + face.bounds_mm[1].z) / 2.0, number));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2)));
    let is_same = |a: &(bool, f64, usize), b: &(bool, f64, usize)| a.0 == b.0 && a.1 - b.1 < SAME_HEIGHT_MM;
    let mut levels: Vec<LevelFaces> = found
        .chunk_by(is_same)
        .map(|chunk| {
            let mut numbers: Vec<usize> = chunk.iter().map(|(_, _, number)| *number).collect();
            numbers.sort_unstable();
            let area_mm2 = numbers.iter().map(|number| faces[*number].area_mm2).sum();
            LevelFaces { height_mm: chunk[0].1, is_up: chunk[0].0, faces: numbers, area_mm2 }
        })
        .collect();
    levels.sort_by(|a, b| b.height_mm.total_cmp(&a.height_mm));
    levels
}
