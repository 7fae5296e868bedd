//! Whether places are within polygons.
//!
//! # Method
//! The sides are sorted into strips of v. A place is inside if a ray along u crosses an odd number of sides.

use super::surface_bounds::{Rectangle, rectangle};

/// The most strips.
const MOST_STRIPS: usize = 1 << 14;

/// The strips that a side touches on the average, about.
const TOUCHED: f64 = 8.0;

/// Polygons, ready to be asked about many places.
pub struct Inside {
    sides: Vec<[[f64; 2]; 2]>,
    /// The sides that touch each strip.
    strips: Vec<Vec<u32>>,
    range: [f64; 2],
}

impl Inside {
    pub fn new(polygons: &[Vec<[f64; 2]>]) -> Self {
        let sides: Vec<[[f64; 2]; 2]> = polygons
            .iter()
            .flat_map(|polygon| (0..polygon.len()).map(|k| [polygon[k], polygon[(k + 1) % polygon.len()]]))
            .collect();
        let range = rectangle(&polygons.concat())[1];
        // Long sides touch many strips: there are so few of these that all lists together stay short.
        let height = range[1] - range[0];
        let climbed: f64 = sides.iter().map(|[a, b]| (b[1] - a[1]).abs()).sum::<f64>() / height;
        let most = TOUCHED * sides.len() as f64 / climbed;
        let most = if most.is_finite() { most as usize } else { 1 };
        let n = (sides.len() / 2).min(most).clamp(1, MOST_STRIPS);
        let mut inside = Self { sides, strips: vec![Vec::new(); n], range };
        for k in 0..inside.sides.len() {
            let [a, b] = inside.sides[k];
            let [first, last] = [a[1].min(b[1]), a[1].max(b[1])].map(|v| inside.strip(v));
            (first..=last).for_each(|strip| inside.strips[strip].push(k as u32));
        }
        inside
    }

    fn strip(&self, v: f64) -> usize {
        let [low, high] = self.range;
        let n = self.strips.len();
        ((((v - low) / (high - low)) * n as f64).max(0.0) as usize).min(n - 1)
    }

    pub fn contains(&self, at: [f64; 2]) -> bool {
        if at[1] < self.range[0] || at[1] > self.range[1] {
            return false;
        }
        let is_crossed = |k: &&u32| {
            let [a, b] = self.sides[**k as usize];
            (a[1] > at[1]) != (b[1] > at[1]) && at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1])
        };
        self.strips[self.strip(at[1])].iter().filter(is_crossed).count() % 2 == 1
    }

    /// Whether a rectangle may have places within the polygons: false only if it has none.
    pub fn may_touch(&self, ranges: Rectangle) -> bool {
        let [us, vs] = ranges;
        if self.contains([us[0], vs[0]]) {
            return true;
        }
        let strips = &self.strips[self.strip(vs[0])..=self.strip(vs[1])];
        strips.iter().flatten().any(|k| {
            let [a, b] = self.sides[*k as usize];
            let touches =
                |k: usize, range: [f64; 2]| a[k].min(b[k]) <= range[1] && a[k].max(b[k]) >= range[0];
            touches(0, us) && touches(1, vs)
        })
    }
}
