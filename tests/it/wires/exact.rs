//! Swept surfaces by their definitions, without patches: points from the curves themselves.

use nalgebra::{Point2, Point3, Vector2};
use toolpathd_core::geometry::profile::{Profile, Shape};
use toolpathd_core::geometry::surface::normal_sweep::NormalSweep;
use toolpathd_core::geometry::surface::parallel_sweep::ParallelSweep;
use toolpathd_core::geometry::surface::ruled::Ruled;

type Of = Box<dyn Fn(usize, f64, usize, f64) -> Point3<f64>>;

/// A surface of smooth cells. A point is given by the cell along u and the place in it, and likewise along v.
pub struct Exact {
    pub cells: [usize; 2],
    of: Of,
}

impl Exact {
    pub fn point(&self, [i, j]: [usize; 2], [u, v]: [f64; 2]) -> Point3<f64> {
        (self.of)(i, u, j, v)
    }

    pub fn parallel(sweep: &ParallelSweep) -> Self {
        let ParallelSweep { basic, drive } = sweep.clone();
        let start = drive.start().expect("a curve");
        Self {
            cells: [basic.pieces().len(), drive.pieces().len()],
            of: Box::new(move |i, u, j, v| {
                basic.pieces()[i].shape.point(u) + (drive.pieces()[j].shape.point(v) - start)
            }),
        }
    }

    /// The plane of the drive curve stands on the basic curve, or halves its sharp corners.
    pub fn normal(sweep: &NormalSweep) -> Self {
        let NormalSweep { basic, drive } = sweep.clone();
        let basic: Profile<2> = basic.mapped(|p| p.xy());
        let ends: Vec<[Vector2<f64>; 2]> =
            basic.pieces().iter().map(|p| [left(&p.shape, 0.0), left(&p.shape, 1.0)]).collect();
        let mitre = |a: Vector2<f64>, b: Vector2<f64>| (a + b) / (1.0 + a.dot(&b));
        let n = ends.len();
        let mitred: Vec<[Vector2<f64>; 2]> = (0..n)
            .map(|k| {
                let before = if k > 0 { mitre(ends[k - 1][1], ends[k][0]) } else { ends[k][0] };
                let after = if k + 1 < n { mitre(ends[k][1], ends[k + 1][0]) } else { ends[k][1] };
                [before, after]
            })
            .collect();
        Self {
            cells: [n, drive.pieces().len()],
            of: Box::new(move |i, u, j, v| {
                let shape = &basic.pieces()[i].shape;
                let normal = match shape {
                    Shape::Line(_) => mitred[i][0] * (1.0 - u) + mitred[i][1] * u,
                    _ => left(shape, u),
                };
                let (p, q) = (shape.point(u), drive.pieces()[j].shape.point(v));
                let at = p + normal * q.x;
                Point3::new(at.x, at.y, q.y)
            }),
        }
    }

    /// Lines between points at equal fractions of the lengths.
    pub fn ruled(ruled: &Ruled) -> Self {
        let curves = [Measured::new(&ruled.first), Measured::new(&ruled.second)];
        let mut joints: Vec<f64> = curves.iter().flat_map(|c| c.joints.iter().copied()).collect();
        joints.sort_by(f64::total_cmp);
        joints.dedup_by(|a, b| *a - *b < 1e-9);
        Self {
            cells: [joints.len() - 1, 1],
            of: Box::new(move |i, u, _, v| {
                let s = joints[i] * (1.0 - u) + joints[i + 1] * u;
                let [a, b] = [0, 1].map(|k| curves[k].point(s));
                a + (b - a) * v
            }),
        }
    }
}

/// The unit normal to the left of a plane curve.
fn left(shape: &Shape<2>, t: f64) -> Vector2<f64> {
    let way = match shape {
        Shape::Line([a, b]) => b - a,
        Shape::Arc { points: [a, b, c], weight } => {
            // The derivative of the quotient, but for a factor.
            let s = 1.0 - t;
            (b - a) * (weight * s * s) + (c - a) * (s * t) + (c - b) * (weight * t * t)
        }
        Shape::Cubic([a, b, c, d]) => {
            let s = 1.0 - t;
            (b - a) * (s * s) + (c - b) * (2.0 * s * t) + (d - c) * (t * t)
        }
    };
    Vector2::new(-way.y, way.x).normalize()
}

/// A curve by fractions of its length, by a table of chords.
struct Measured {
    profile: Profile<3>,
    /// For each piece, lengths from its start at equal parameters.
    tables: Vec<Vec<f64>>,
    joints: Vec<f64>,
}

const CHORDS: usize = 4000;

impl Measured {
    fn new(profile: &Profile<3>) -> Self {
        let table = |shape: &Shape<3>| {
            let mut length = 0.0;
            let at = |k: usize| shape.point(k as f64 / CHORDS as f64);
            let rest = (1..=CHORDS).map(|k| {
                length += (at(k) - at(k - 1)).norm();
                length
            });
            std::iter::once(0.0).chain(rest).collect::<Vec<f64>>()
        };
        let tables: Vec<_> = profile.pieces().iter().map(|piece| table(&piece.shape)).collect();
        let mut joints = vec![0.0];
        for table in &tables {
            joints.push(joints[joints.len() - 1] + table[CHORDS]);
        }
        let whole = joints[joints.len() - 1];
        joints.iter_mut().for_each(|joint| *joint /= whole);
        Self { profile: profile.clone(), tables, joints }
    }

    fn point(&self, s: f64) -> Point3<f64> {
        let k = self.joints.partition_point(|joint| *joint < s).clamp(1, self.tables.len()) - 1;
        let table = &self.tables[k];
        let share = (s - self.joints[k]) / (self.joints[k + 1] - self.joints[k]);
        let length = share * table[CHORDS];
        let at = table.partition_point(|l| *l < length).clamp(1, CHORDS);
        let t = at as f64 - 1.0 + (length - table[at - 1]) / (table[at] - table[at - 1]);
        self.profile.pieces()[k].shape.point(t / CHORDS as f64)
    }
}

/// A curve in the plane of x and z, or of y and z.
pub fn upright(curve: &Profile<2>, axis: usize) -> Profile<3> {
    curve.mapped(|p: Point2<f64>| {
        let mut q = Point3::new(0.0, 0.0, p.y);
        q[axis] = p.x;
        q
    })
}

/// A curve in the plane of x and y.
pub fn flat(curve: &Profile<2>) -> Profile<3> {
    curve.mapped(|p: Point2<f64>| Point3::new(p.x, p.y, 0.0))
}
