//! Solids of upright walls and level floors, such as a part with a pocket, as triangles.
//!
//! # Method
//! A solid is a stack of slabs, from the top down. Each outline of a slab makes a wall. Where two slabs meet,
//! what only the lower one covers is a face that looks up, and what only the upper one covers looks down.
//! Faces are cut into triangles by ears (`earcut`).
//!
//! # Guarantees
//! * Each wall lies within the chord of its outline, and its ends lie on it.
//! * Triangles turn counterclockwise seen from outside.
//!
//! # Degenerate input
//! Slabs without height or without area add nothing.
//!
//! # Cost
//! O(n) for the walls of n elements, and one region for each pair of slabs whose regions differ. Triangles of
//! a face with n corners take O(n log n) mostly, and O(n^2) at worst; larger faces are refused.

use earcut::Earcut;
use nalgebra::{Point2, Point3, Vector2, Vector3};

use crate::gltf::Triangles;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::region::{Face, Outline, Region, RegionError};
use toolpathd_core::geometry::segment::Segment;

/// The most corners of a face. The cutting of ears may take time with the square of their number.
const MOST_CORNERS: usize = 50_000;

/// The largest turn of the part of an arc that becomes one line, radians, however wide the chord is.
const LARGEST_TURN: f64 = 0.5;

/// A part of a solid that has the same outlines at all its heights.
#[derive(Debug, Clone)]
pub struct Slab {
    pub top_z_mm: f64,
    pub bottom_z_mm: f64,
    /// Where there is material.
    pub region: Region,
}

/// The surface of a stack of slabs, given from the top down, each on top of the next one.
///
/// # Errors
/// When two regions cannot be compared, a face has too many corners, and the budget's stop.
pub fn triangles(slabs: &[Slab], chord_mm: f64, budget: &Budget) -> Result<Triangles, RegionError> {
    let mut solid = Solid { chord_mm, triangles: Triangles::default() };
    let empty = Region::empty();
    let mut above = &empty;
    for slab in slabs {
        for outline in slab.region.outlines() {
            solid.wall(outline, [slab.top_z_mm, slab.bottom_z_mm]);
        }
        solid.step(above, &slab.region, slab.top_z_mm, budget)?;
        above = &slab.region;
    }
    if let Some(lowest) = slabs.last() {
        solid.step(above, &empty, lowest.bottom_z_mm, budget)?;
    }
    Ok(solid.triangles)
}

/// A level region at a height, seen from above.
///
/// # Errors
/// When a face has too many corners, and the budget's stop.
pub fn flat(region: &Region, z_mm: f64, chord_mm: f64, budget: &Budget) -> Result<Triangles, RegionError> {
    let mut solid = Solid { chord_mm, triangles: Triangles::default() };
    for face in region.faces() {
        budget.check()?;
        solid.face(face, z_mm, Vector3::z())?;
    }
    Ok(solid.triangles)
}

/// A block between two corners.
pub fn block(low: Point3<f64>, high: Point3<f64>) -> Triangles {
    let mut triangles = Triangles::default();
    for axis in 0..3 {
        for (end, sign) in [(low, -1.0), (high, 1.0)] {
            let first = index(triangles.points.len());
            let [mut u, mut v] = [(axis + 1) % 3, (axis + 2) % 3];
            if sign < 0.0 {
                (u, v) = (v, u);
            }
            for [along_u, along_v] in [[false, false], [true, false], [true, true], [false, true]] {
                let mut corner = end;
                corner[u] = if along_u { high[u] } else { low[u] };
                corner[v] = if along_v { high[v] } else { low[v] };
                triangles.points.push(corner);
                triangles.normals.push(Vector3::ith(axis, sign));
            }
            triangles.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    triangles
}

/// Triangles under way.
struct Solid {
    chord_mm: f64,
    triangles: Triangles,
}

impl Solid {
    /// The wall of an outline that has the material to its left.
    fn wall(&mut self, outline: &Outline, [top, bottom]: [f64; 2]) {
        for element in outline.elements() {
            let first = self.next();
            let count = count(element, self.chord_mm);
            for k in 0..=count {
                let t = f64::from(k) / f64::from(count);
                let along: Vector2<f64> = element.direction(t);
                for z in [bottom, top] {
                    self.push(element.at(t), z, Vector3::new(along.y, -along.x, 0.0));
                }
            }
            for low in (0..count).map(|k| first + 2 * k) {
                self.triangles.triangles.extend([[low, low + 2, low + 3], [low, low + 3, low + 1]]);
            }
        }
    }

    /// The faces at the height where the region `above` ends and the region `below` begins.
    fn step(&mut self, above: &Region, below: &Region, z: f64, budget: &Budget) -> Result<(), RegionError> {
        if above.faces() == below.faces() {
            return Ok(());
        }
        for (upper, lower, outward) in [(above, below, Vector3::z()), (below, above, -Vector3::z())] {
            for face in lower.difference(upper, budget)?.faces() {
                budget.check()?;
                self.face(face, z, outward)?;
            }
        }
        Ok(())
    }

    /// A level face that looks up or down.
    fn face(&mut self, face: &Face, z: f64, outward: Vector3<f64>) -> Result<(), RegionError> {
        let first = self.next();
        let mut corners: Vec<[f64; 2]> = polygon(&face.outer, self.chord_mm).map(Into::into).collect();
        let mut holes = Vec::with_capacity(face.islands.len());
        for island in &face.islands {
            holes.push(index(corners.len()));
            corners.extend(polygon(island, self.chord_mm).map(<[f64; 2]>::from));
        }
        if corners.len() > MOST_CORNERS {
            return Err(RegionError::TooMany { limit: MOST_CORNERS });
        }
        let mut found = Vec::new();
        Earcut::new().earcut_slice(&corners, &holes, &mut found);
        for corner in &corners {
            self.push(Point2::from(*corner), z, outward);
        }
        for [a, b, c] in found.as_chunks::<3>().0 {
            let [p, q, r] = [a, b, c].map(|k: &u32| Vector2::from(corners[*k as usize]));
            let is_turned = ((q - p).perp(&(r - p)) < 0.0) != (outward.z < 0.0);
            let [b, c] = if is_turned { [c, b] } else { [b, c] };
            self.triangles.triangles.push([first + a, first + b, first + c]);
        }
        Ok(())
    }

    fn push(&mut self, at: Point2<f64>, z: f64, normal: Vector3<f64>) {
        self.triangles.points.push(Point3::new(at.x, at.y, z));
        self.triangles.normals.push(normal);
    }

    /// The index of the next point.
    fn next(&self) -> u32 {
        index(self.triangles.points.len())
    }
}

fn index(k: usize) -> u32 {
    u32::try_from(k).unwrap_or(u32::MAX)
}

/// The number of lines that stay within the chord of an element.
fn count(element: &Segment, chord_mm: f64) -> u32 {
    let radius_mm = 1.0 / element.curvature().abs();
    let turn = if chord_mm < radius_mm { 2.0 * (1.0 - chord_mm / radius_mm).acos() } else { LARGEST_TURN };
    let least = turn.clamp(1e-5, LARGEST_TURN);
    (element.turn().abs() / least).ceil().max(1.0) as u32
}

/// The corners of a closed polygon, each once.
fn polygon(outline: &Outline, chord_mm: f64) -> impl Iterator<Item = Point2<f64>> {
    outline.elements().iter().flat_map(move |element| {
        let count = count(element, chord_mm);
        (0..count).map(move |k| element.at(f64::from(k) / f64::from(count)))
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    fn outline(elements: &[Segment]) -> Outline {
        Outline::new(elements, &Budget::unlimited()).unwrap()
    }

    fn square(low: f64, high: f64) -> Outline {
        let corners = [[low, low], [high, low], [high, high], [low, high]].map(Point2::from);
        outline(&[0, 1, 2, 3].map(|k| Segment::Line { start: corners[k], end: corners[(k + 1) % 4] }))
    }

    fn circle(radius: f64) -> Outline {
        let ends = [[-radius, 0.0], [radius, 0.0]].map(Point2::from);
        outline(&[0, 1].map(|k| Segment::about(Point2::origin(), radius, [ends[k], ends[1 - k]], PI)))
    }

    fn region(outlines: &[Outline], islands: &[Outline]) -> Region {
        Region::new(outlines, islands, &Budget::unlimited()).unwrap()
    }

    /// The volume by the divergence theorem; it is right only where all triangles turn alike and close the
    /// solid.
    fn volume(Triangles { points, triangles, .. }: &Triangles) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|k| points[k as usize].coords);
        triangles.iter().map(corners).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
    }

    #[test]
    fn a_block_with_a_round_pocket_and_a_boss_has_its_volume_and_normals_that_look_outside() {
        let block = region(&[square(-20.0, 20.0)], &[]);
        let pocket = region(&[circle(10.0)], &[square(-2.0, 2.0)]);
        let around = block.difference(&pocket, &Budget::unlimited()).unwrap();
        let slabs = [
            Slab { top_z_mm: 0.0, bottom_z_mm: -2.0, region: around.clone() },
            Slab { top_z_mm: -2.0, bottom_z_mm: -5.0, region: around },
            Slab { top_z_mm: -5.0, bottom_z_mm: -8.0, region: block },
        ];
        let solid = triangles(&slabs, 1e-3, &Budget::unlimited()).unwrap();
        let exact = 1600.0 * 8.0 - (100.0 * PI - 16.0) * 5.0;
        // A chord of a micrometre takes less than its length times two thirds of a micrometre.
        assert!((volume(&solid) - exact).abs() < TAU * 10.0 * 5.0 * 1e-3, "{}", volume(&solid));
        for triangle in &solid.triangles {
            let [a, b, c] = triangle.map(|k| solid.points[k as usize]);
            let normal = (b - a).cross(&(c - a));
            for k in triangle {
                assert!(solid.normals[*k as usize].dot(&normal) >= 0.99 * normal.norm(), "{triangle:?}");
            }
        }
    }

    #[test]
    fn a_block_is_closed_and_looks_outside() {
        let solid = block([-1.0, 0.0, 2.0].into(), [1.0, 5.0, 6.0].into());
        assert!((volume(&solid) - 40.0).abs() < 1e-12);
        for [a, b, c] in &solid.triangles {
            let [p, q, r] = [a, b, c].map(|k| solid.points[*k as usize]);
            let normal = (q - p).cross(&(r - p)).normalize();
            assert!((normal - solid.normals[*a as usize]).norm() < 1e-12);
        }
    }

    #[test]
    fn what_hangs_over_has_a_face_that_looks_down() {
        let slabs = [
            Slab { top_z_mm: 4.0, bottom_z_mm: 2.0, region: region(&[square(0.0, 10.0)], &[]) },
            Slab { top_z_mm: 2.0, bottom_z_mm: 0.0, region: region(&[square(0.0, 3.0)], &[]) },
        ];
        let solid = triangles(&slabs, 1e-3, &Budget::unlimited()).unwrap();
        assert!((volume(&solid) - 218.0).abs() < 1e-9);
        assert!(triangles(&[], 1e-3, &Budget::unlimited()).unwrap().triangles.is_empty());
    }
}
