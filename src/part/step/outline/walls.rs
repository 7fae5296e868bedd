//! What stands beside the edges of level faces that look up.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::rings::{EdgeKey, HalfEdge};
use crate::step::model::{Body, Face, Loop};
use crate::step::parameter_search::ParameterSearch;
use crate::step::piece::spread;

/// Heights that differ by less are the same, mm. Kernels place the edges of one face within this.
const SAME_HEIGHT_MM: f64 = 1e-4;

/// A face rises, falls or leans beside an edge if the sine of its slope is more.
const LEAST_SINE: f64 = 1e-3;

/// What stands beside an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Beside {
    /// The face that goes up from the edge.
    pub wall: Option<usize>,
    /// Whether the wall leans over the level face.
    pub is_leaning: bool,
}

/// The faces of a body with the faces at each edge.
pub struct Surroundings<'a> {
    faces: &'a [Face],
    /// The faces of the body.
    body: Range<usize>,
    by_edge: BTreeMap<EdgeKey, Vec<usize>>,
}

impl<'a> Surroundings<'a> {
    pub fn of(body: &Body, faces: &'a [Face]) -> Self {
        let mut by_edge: BTreeMap<EdgeKey, Vec<usize>> = BTreeMap::new();
        for number in body.faces.clone() {
            for key in keys(&faces[number]) {
                by_edge.entry(key).or_default().push(number);
            }
        }
        Self { faces, body: body.faces.clone(), by_edge }
    }

    /// What stands beside a half edge of a level face at a height.
    pub fn beside(&self, half: &HalfEdge, height_mm: f64) -> Beside {
        let others = self.by_edge.get(&half.key).into_iter().flatten().filter(|face| **face != half.face);
        for number in others.copied() {
            let slopes: Vec<(f64, f64)> = half.places.iter().map(|at| self.slope(number, at)).collect();
            let rises = slopes.iter().any(|(rise, _)| *rise > LEAST_SINE);
            let [low, high] = self.faces[number].bounds_mm.map(|corner| corner.z - height_mm);
            let is_wall = match (low < -SAME_HEIGHT_MM, high > SAME_HEIGHT_MM) {
                (false, is_higher) => is_higher,
                (true, false) => false,
                (true, true) => rises,
            };
            if is_wall {
                let is_leaning = slopes.iter().any(|(_, lean)| *lean > LEAST_SINE);
                return Beside { wall: Some(number), is_leaning };
            }
        }
        Beside { wall: None, is_leaning: false }
    }

    /// The direction of a face away from an edge at a place of it: its part along z, and its part towards the
    /// level face. Where it is not known, the face is taken to go up.
    fn slope(&self, number: usize, (place, along): &(Point3<f64>, Vector3<f64>)) -> (f64, f64) {
        let face = &self.faces[number];
        let at = ParameterSearch::new(&face.surface).of(place, None);
        let (Some(normal), Some(along)) = (face.normal(at), along.try_normalize(f64::MIN_POSITIVE)) else {
            return (1.0, 0.0);
        };
        // The faces of a solid pass their edge in opposite directions, each with its inside to the left.
        let away = along.cross(&normal);
        (away.z, away.y * along.x - away.x * along.y)
    }

    /// Whether a face of the body, seen from above, lies within a box and reaches above a height.
    pub fn stands_within(&self, [low, high]: [[f64; 2]; 2], height_mm: f64) -> bool {
        self.body.clone().any(|number| {
            let [min, max] = self.faces[number].bounds_mm;
            let is_within =
                (0..2).all(|c| min[c] >= low[c] - SAME_HEIGHT_MM && max[c] <= high[c] + SAME_HEIGHT_MM);
            is_within && max.z > height_mm + SAME_HEIGHT_MM
        })
    }

    /// The height at which walls end that go up from a height, if all of them end at one.
    pub fn top(&self, walls: impl IntoIterator<Item = usize>, height_mm: f64) -> Option<f64> {
        let mut open: Vec<(usize, f64)> = walls.into_iter().map(|wall| (wall, height_mm)).collect();
        let mut is_seen: BTreeSet<usize> = open.iter().map(|(wall, _)| *wall).collect();
        let mut top: Option<f64> = None;
        while let Some((wall, low)) = open.pop() {
            let (high, rim) = self.rim(wall, low)?;
            let beyond: Vec<usize> = rim
                .iter()
                .filter_map(|key| self.by_edge.get(key))
                .flatten()
                .copied()
                .filter(|face| *face != wall && self.goes_up(*face, high))
                .collect();
            if beyond.is_empty() {
                if top.is_some_and(|top| (top - high).abs() > SAME_HEIGHT_MM) {
                    return None;
                }
                top = Some(top.map_or(high, |top| top.max(high)));
            }
            open.extend(beyond.into_iter().filter(|face| is_seen.insert(*face)).map(|face| (face, high)));
        }
        top
    }

    fn goes_up(&self, number: usize, height_mm: f64) -> bool {
        let [low, high] = self.faces[number].bounds_mm.map(|corner| corner.z - height_mm);
        low >= -SAME_HEIGHT_MM && high > SAME_HEIGHT_MM
    }

    /// The height at which a wall ends, and its edges there. `None` if it ends at no single height.
    fn rim(&self, number: usize, low: f64) -> Option<(f64, Vec<EdgeKey>)> {
        let face = &self.faces[number];
        let high = face.bounds_mm[1].z;
        let mut rim = Vec::new();
        for one in &face.loops {
            let ranges: Vec<[f64; 2]> = heights(one);
            let is_within =
                |range: &[f64; 2]| range[0] > low + SAME_HEIGHT_MM && range[1] < high - SAME_HEIGHT_MM;
            if ranges.iter().all(is_within) {
                // An opening in the wall.
                continue;
            }
            for (k, [bottom, top]) in ranges.into_iter().enumerate() {
                if bottom >= high - SAME_HEIGHT_MM {
                    rim.push(EdgeKey::of(&one.edges, k).0);
                    continue;
                }
                let is_side = bottom <= low + SAME_HEIGHT_MM && top >= high - SAME_HEIGHT_MM;
                if !is_side && top > low + SAME_HEIGHT_MM {
                    return None;
                }
            }
        }
        (!rim.is_empty()).then_some((high, rim))
    }
}

fn keys(face: &Face) -> impl Iterator<Item = EdgeKey> + '_ {
    let of_loop =
        |one: &'_ Loop| (0..one.edges.len()).map(|k| EdgeKey::of(&one.edges, k).0).collect::<Vec<_>>();
    face.loops.iter().flat_map(of_loop)
}

/// The ranges of z of the edges of a loop.
fn heights(one: &Loop) -> Vec<[f64; 2]> {
    let range = |edge: &crate::step::model::Edge| {
        let heights = spread(edge).into_iter().map(|t| edge.curve.point(t).z);
        heights.fold([f64::MAX, f64::MIN], |[low, high], z| [low.min(z), high.max(z)])
    };
    one.edges.iter().map(range).collect()
}
