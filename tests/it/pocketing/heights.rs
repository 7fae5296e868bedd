//! Parts that are given by measured heights. The tests compute the heights between the measured ones
//! themselves.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::plane::{P, apart};
use super::samples::Part;
use super::service::Region;

/// Places at which the material on slopes is measured.
const PLACES: usize = 100_000;

/// Multiples of this number, less their integer parts, are spread evenly between 0 and 1.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Heights that differ by less are the same, mm.
const SAME_MM: f64 = 1e-6;

/// Measured heights: `z[j][i]` at `origin + spacing (i, j)`, mm.
#[derive(Debug)]
pub struct Heights {
    origin: P,
    spacing: f64,
    z: Vec<Vec<f64>>,
}

impl Heights {
    /// The heights of a function over so many cells along x and along y, from zero on.
    fn new([columns, rows]: [usize; 2], spacing: f64, height: impl Fn(f64, f64) -> f64) -> Self {
        let row = |j: usize| {
            (0..=columns).map(|i| height(spacing * i as f64, spacing * j as f64)).collect::<Vec<f64>>()
        };
        Self { origin: [0.0, 0.0], spacing, z: (0..=rows).map(row).collect() }
    }

    pub fn json(&self) -> Value {
        json!({ "origin": self.origin, "spacing_mm": self.spacing, "z": self.z })
    }

    /// The numbers of cells along x and along y.
    fn cells(&self) -> [usize; 2] {
        [self.z[0].len() - 1, self.z.len() - 1]
    }

    fn bounds(&self) -> [P; 2] {
        let cells = self.cells();
        [self.origin, [0, 1].map(|axis| self.origin[axis] + self.spacing * cells[axis] as f64)]
    }

    /// The height, mm, and the cosine of the slope; none beside the heights. In each cell four triangles join
    /// the corners with the middle, which has the mean height of the corners.
    fn at(&self, p: P) -> Option<[f64; 2]> {
        let cells = self.cells();
        let [u, v] = [0, 1].map(|axis| (p[axis] - self.origin[axis]) / self.spacing);
        if !(0.0..=cells[0] as f64).contains(&u) || !(0.0..=cells[1] as f64).contains(&v) {
            return None;
        }
        let (i, j) = ((u as usize).min(cells[0] - 1), (v as usize).min(cells[1] - 1));
        // From the middle of the cell, in cells.
        let (u, v) = (u - i as f64 - 0.5, v - j as f64 - 0.5);
        let [a, b, c, d] = [self.z[j][i], self.z[j][i + 1], self.z[j + 1][i + 1], self.z[j + 1][i]];
        let middle = 0.25 * (a + b + c + d);
        let (along_u, along_v) = if u.abs() < v.abs() {
            if v < 0.0 { (b - a, 2.0 * middle - a - b) } else { (c - d, c + d - 2.0 * middle) }
        } else if u < 0.0 {
            (2.0 * middle - a - d, d - a)
        } else {
            (b + c - 2.0 * middle, c - b)
        };
        let steepness = along_u.hypot(along_v) / self.spacing;
        Some([middle + u * along_u + v * along_v, 1.0 / steepness.hypot(1.0)])
    }

    /// The part inside a region, or over all heights. What is beside stays.
    pub fn part<'a>(&'a self, region: Option<&'a Region>) -> Part<'a> {
        let is_inside = move |p: P| region.is_none_or(|region| region.contains(p));
        Part::new(self.bounds(), move |p| match self.at(p) {
            Some([z, _]) if is_inside(p) => z,
            _ => f64::INFINITY,
        })
    }

    /// The thickest material that a level from `top` down to `z` leaves above the part, at a right angle to
    /// the part, mm.
    pub fn leftover_mm(&self, top: f64, z: f64) -> f64 {
        let [low, high] = self.bounds();
        let place = |k: usize| {
            let parts = [(k as f64 * GOLDEN).fract(), (k as f64 + 0.5) / PLACES as f64];
            [0, 1].map(|axis| low[axis] + parts[axis] * (high[axis] - low[axis]))
        };
        let left = |p: P| {
            let [height, cosine] = self.at(p)?;
            (height > z + SAME_MM).then(|| (top - height).max(0.0) * cosine)
        };
        (0..PLACES).filter_map(|k| left(place(k))).fold(0.0, f64::max)
    }

    /// The same heights with x negated.
    pub fn mirrored(&self) -> Self {
        let [_, [right, _]] = self.bounds();
        let backward = |row: &Vec<f64>| row.iter().rev().copied().collect();
        let z = self.z.iter().map(backward).collect();
        Self { origin: [-right, self.origin[1]], spacing: self.spacing, z }
    }

    /// The same heights, turned to the left by a right angle.
    pub fn turned(&self) -> Self {
        let [_, [_, above]] = self.bounds();
        let column = |i: usize| self.z.iter().rev().map(|row| row[i]).collect();
        let z = (0..self.z[0].len()).map(column).collect();
        Self { origin: [-above, self.origin[0]], spacing: self.spacing, z }
    }
}

/// Three bumps with the profile of a cosine on a floor at -15 mm. The highest has its top at zero.
pub fn bumps() -> Heights {
    let bumps = [([28.0, 26.0], 20.0, 15.0), ([72.0, 30.0], 18.0, 13.0), ([50.0, 62.0], 14.0, 11.0)];
    Heights::new([50, 40], 2.0, |x, y| {
        let rise = |(middle, radius, height): &(P, f64, f64)| {
            let way = apart(*middle, [x, y]).min(*radius) / radius;
            0.5 * height * (1.0 + (PI * way).cos())
        };
        -15.0 + bumps.iter().map(rise).sum::<f64>()
    })
}

/// A block with its top at zero, and a step at -10 mm along the right side, on a floor at -15 mm. All slopes
/// are one cell of 5 mm wide.
pub fn block_and_step() -> Heights {
    Heights::new([16, 12], 5.0, |x, y| {
        if (20.0..=35.0).contains(&x) && (20.0..=40.0).contains(&y) {
            0.0
        } else if x >= 60.0 {
            -10.0
        } else {
            -15.0
        }
    })
}

/// A channel along x, 24 mm wide at its bottom at -10 mm, with sides of 45 degrees.
pub fn channel() -> Heights {
    Heights::new([50, 30], 2.0, |_, y| (((y - 30.0).abs() - 12.0).max(0.0) - 10.0).min(0.0))
}

/// A plane that falls by 45 degrees along x from zero to a floor at -12 mm.
pub fn slope() -> Heights {
    Heights::new([30, 20], 2.0, |x, _| -x.min(12.0))
}

/// Terraces at 0, -3, -7 and -12 mm along x. The slopes between them are 1 mm wide.
pub fn terraces() -> Heights {
    let terraces = [(8.5, 0.0), (25.5, -3.0), (42.5, -7.0), (f64::INFINITY, -12.0)];
    Heights::new([60, 30], 1.0, |x, _| {
        terraces.iter().find(|(end, _)| x < *end).map_or(0.0, |(_, height)| *height)
    })
}
