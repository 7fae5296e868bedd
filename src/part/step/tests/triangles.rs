//! What triangles must keep: closed sides, volume, area, and distances both ways.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use crate::step::tessellation::FaceTriangles;

/// The corners of a triangle.
pub fn corners(made: &FaceTriangles, k: usize) -> [Point3<f64>; 3] {
    made.triangles[k].map(|vertex| Point3::from(made.vertices[vertex as usize]))
}

/// Sides of triangles that no other triangle has in the opposite direction.
pub fn open_sides(made: &FaceTriangles) -> usize {
    let mut sides: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for [a, b, c] in &made.triangles {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            *sides.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    sides.values().filter(|n| **n != 0).count()
}

pub fn volume(made: &FaceTriangles) -> f64 {
    let of = |k| {
        let [a, b, c] = corners(made, k);
        a.coords.dot(&b.coords.cross(&c.coords)) / 6.0
    };
    (0..made.triangles.len()).map(of).sum()
}

pub fn area(made: &FaceTriangles) -> f64 {
    let of = |k| {
        let [a, b, c] = corners(made, k);
        (b - a).cross(&(c - a)).norm() / 2.0
    };
    (0..made.triangles.len()).map(of).sum()
}

/// The distance of a point from a triangle.
pub fn distance(point: &Point3<f64>, [a, b, c]: [Point3<f64>; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let is_over =
        |from: &Point3<f64>, to: &Point3<f64>| normal.cross(&(to - from)).dot(&(point - from)) >= 0.0;
    if normal.norm() > 0.0 && is_over(&a, &b) && is_over(&b, &c) && is_over(&c, &a) {
        return (point - a).dot(&normal.normalize()).abs();
    }
    let to_side = |from: Point3<f64>, to: Point3<f64>| {
        let along = to - from;
        let share = ((point - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (point - (from + along * share)).norm()
    };
    to_side(a, b).min(to_side(b, c)).min(to_side(c, a))
}

/// Numbers from 0 to 1 that look random.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// How far the points of a face are from its triangles, at most: `point` makes a point of the face from two
/// numbers from 0 to 1.
pub fn reach(made: &FaceTriangles, face: u32, point: impl Fn(f64, f64) -> Option<[f64; 3]>) -> f64 {
    let own: Vec<[Point3<f64>; 3]> =
        (0..made.triangles.len()).filter(|k| made.face_of[*k] == face).map(|k| corners(made, k)).collect();
    let mut random = Random(7);
    let mut farthest = 0.0_f64;
    for _ in 0..1500 {
        let Some(point) = point(random.next(), random.next()) else { continue };
        let point = Point3::from(point);
        let nearest = own.iter().map(|corners| distance(&point, *corners)).fold(f64::MAX, f64::min);
        farthest = farthest.max(nearest);
    }
    farthest
}

/// How far points of the triangles of a face are from the face, at most: `miss` is the distance of a point.
pub fn miss(made: &FaceTriangles, face: u32, miss: impl Fn(Vector3<f64>) -> f64) -> f64 {
    let mut random = Random(11);
    let mut farthest = 0.0_f64;
    for k in (0..made.triangles.len()).filter(|k| made.face_of[*k] == face) {
        let [a, b, c] = corners(made, k);
        for j in 0..12 {
            // The corners, the middles of the sides, the middle, and others.
            let [r, s] = match j {
                0..3 => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][j],
                3..6 => [[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]][j - 3],
                6 => [1.0 / 3.0; 2],
                _ => {
                    let [r, s] = [random.next(), random.next()];
                    if r + s > 1.0 { [1.0 - r, 1.0 - s] } else { [r, s] }
                }
            };
            farthest = farthest.max(miss((a + (b - a) * r + (c - a) * s).coords));
        }
    }
    farthest
}

/// The distance of values from a range.
pub fn beyond(value: f64, [low, high]: [f64; 2]) -> f64 {
    (low - value).max(value - high).max(0.0)
}
