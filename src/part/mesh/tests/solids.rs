//! Solids whose areas and volumes have closed forms.

use std::collections::HashMap;

/// Points, and triangles by the numbers of points.
#[derive(Debug, Clone, Default)]
pub struct Triangles {
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
}

impl Triangles {
    /// A corner of a box: three right angles at the origin, and edges of these lengths.
    pub fn tetrahedron([a, b, c]: [f64; 3]) -> Self {
        let points = vec![[0.0; 3], [a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]];
        Self { points, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }
    }

    /// A box from one corner to the opposite one.
    pub fn cuboid(from: [f64; 3], to: [f64; 3]) -> Self {
        let of = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { from[axis] } else { to[axis] });
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Self { points: (0..8).map(of).collect(), triangles }
    }

    /// An icosahedron within a sphere of this radius, each triangle of which is cut into four `n` times.
    pub fn icosphere(radius: f64, n: usize) -> Self {
        let long = f64::midpoint(1.0, 5.0_f64.sqrt());
        let mut points = Vec::new();
        for (a, b) in [(1.0, long), (-1.0, long), (1.0, -long), (-1.0, -long)] {
            points.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
        }
        let near = |a: usize, b: usize| distance(points[a], points[b]) < 2.1;
        let mut triangles = Vec::new();
        for a in 0..12 {
            for b in a + 1..12 {
                for c in (b + 1..12).filter(|&c| near(a, b) && near(b, c) && near(c, a)) {
                    let is_outward = determinant(points[a], points[b], points[c]) > 0.0;
                    triangles.push(if is_outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
        let mut sphere = Self { points, triangles };
        (0..n).for_each(|_| sphere.cut());
        for point in &mut sphere.points {
            let scale = radius / distance(*point, [0.0; 3]);
            *point = point.map(|x| x * scale);
        }
        sphere
    }

    /// Cuts each triangle into four, with their new corners as far out as the old ones.
    fn cut(&mut self) {
        let radius = distance(self.points[0], [0.0; 3]);
        let mut middles = HashMap::new();
        let mut triangles = Vec::new();
        for &[a, b, c] in &self.triangles {
            let points = &mut self.points;
            let mut middle = |a: usize, b: usize| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let sum = [0, 1, 2].map(|k| points[a][k] + points[b][k]);
                    let scale = radius / distance(sum, [0.0; 3]);
                    points.push(sum.map(|x| x * scale));
                    points.len() - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        self.triangles = triangles;
    }

    /// Both, side by side in one list.
    pub fn and(mut self, other: Self) -> Self {
        let n = self.points.len();
        self.points.extend(other.points);
        self.triangles.extend(other.triangles.iter().map(|own| own.map(|corner| corner + n)));
        self
    }

    /// The same surface seen from its other side.
    pub fn turned(mut self) -> Self {
        self.triangles.iter_mut().for_each(|own| own.swap(1, 2));
        self
    }

    /// With numbers that binary files of single precision hold.
    pub fn single(mut self) -> Self {
        self.points.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
        self
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3])).sum()
}
