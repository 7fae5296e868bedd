//! Finds the exact CL curves of a ball cutter in parallel planes, by root finding along parameter lines of
//! the surface.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::spline::Spline;

/// Parameter lines of each direction on which roots are sought.
const LINES: usize = 1600;

/// Intervals of each cell of the surface in which a root is sought along a line.
const BRACKETS_PER_CELL: usize = 8;

/// All positions of the tip at which the cutter touches the surface.
pub struct Locus<'a> {
    surface: &'a Spline,
    radius: f64,
    /// The coordinate that is constant on a plane.
    normal: usize,
    /// The horizontal coordinate that changes along a plane.
    along: usize,
    /// The normal coordinate of the tip at samples, by the kept direction, the parameter line and the sample.
    tables: [Vec<Vec<f64>>; 2],
    borders: Vec<Border>,
}

/// A parameter line along the border of the surface, with dense samples of the tip's normal coordinate.
struct Border {
    kept: usize,
    line: f64,
    values: Vec<f64>,
}

/// Parameters of a CC point, and the position of the tip that touches there.
type Touch = ([f64; 2], Point3<f64>);

/// The CL curves in one plane: points, in buckets by their place along the plane.
pub struct Section<'a> {
    locus: &'a Locus<'a>,
    pub offset: f64,
    buckets: BTreeMap<i64, Vec<Touch>>,
}

/// Width of a bucket.
const BUCKET_MM: f64 = 0.1;

impl<'a> Locus<'a> {
    pub fn new(surface: &'a Spline, radius: f64, normal: usize) -> Self {
        let size = surface.size();
        let tables = [0, 1].map(|kept| {
            let brackets = size[1 - kept] as usize * BRACKETS_PER_CELL;
            let line = |l: usize| {
                let at = |b: usize| pair(kept, line_at(l, size[kept]), b as f64 / BRACKETS_PER_CELL as f64);
                (0..=brackets).map(|b| surface.tip(at(b), radius).point[normal]).collect()
            };
            (0..=LINES).map(line).collect()
        });
        let borders = [(0, 0.0), (0, size[0]), (1, 0.0), (1, size[1])].map(|(kept, line)| {
            let at = |l: usize| pair(kept, line, line_at(l, size[1 - kept]));
            let values = (0..=LINES).map(|l| surface.tip(at(l), radius).point[normal]).collect();
            Border { kept, line, values }
        });
        Self { surface, radius, normal, along: 1 - normal, tables, borders: borders.into() }
    }

    /// The least and the largest normal coordinate of CL points, to about 1e-6 mm.
    pub fn extent(&self) -> [f64; 2] {
        let size = self.surface.size();
        [1.0, -1.0].map(|sign| {
            let mut best = (f64::INFINITY, [0.0; 2]);
            for (l, line) in self.tables[0].iter().enumerate() {
                for (b, &value) in line.iter().enumerate() {
                    if sign * value < best.0 {
                        best = (sign * value, [line_at(l, size[0]), b as f64 / BRACKETS_PER_CELL as f64]);
                    }
                }
            }
            // A pattern search refines the best sample. The extent usually lies on the border.
            let mut reach = 1.0 / BRACKETS_PER_CELL as f64;
            while reach > 1e-7 {
                let around = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].map(|(u, v)| {
                    let at = [0, 1].map(|k| (best.1[k] + [u, v][k] * reach).clamp(0.0, size[k]));
                    (sign * self.surface.tip(at, self.radius).point[self.normal], at)
                });
                let least = around.into_iter().fold(best, |a, b| if b.0 < a.0 { b } else { a });
                if least.0 < best.0 { best = least } else { reach *= 0.5 }
            }
            sign * best.0
        })
    }

    /// The CL curves in the plane at `offset`.
    pub fn section(&'a self, offset: f64) -> Section<'a> {
        let size = self.surface.size();
        let mut buckets: BTreeMap<i64, Vec<Touch>> = BTreeMap::new();
        for (kept, table) in self.tables.iter().enumerate() {
            for (l, line) in table.iter().enumerate() {
                for (b, ends) in line.windows(2).enumerate() {
                    if (ends[0] <= offset) == (ends[1] <= offset) {
                        continue;
                    }
                    let range = [b, b + 1].map(|b| b as f64 / BRACKETS_PER_CELL as f64);
                    let at = self.root(kept, line_at(l, size[kept]), range, offset);
                    let tip = self.surface.tip(at, self.radius).point;
                    buckets.entry(bucket(tip[self.along])).or_default().push((at, tip));
                }
            }
        }
        for at in self.border_roots(offset) {
            let tip = self.surface.tip(at, self.radius).point;
            buckets.entry(bucket(tip[self.along])).or_default().push((at, tip));
        }
        Section { locus: self, offset, buckets }
    }

    /// Parameters of the ends of the curves on the border. Extremes between samples are searched too, so that
    /// no two ends are too near to each other to be found.
    fn border_roots(&self, offset: f64) -> Vec<[f64; 2]> {
        let size = self.surface.size();
        let mut roots = Vec::new();
        for Border { kept, line, values } in &self.borders {
            let place = |l: usize| line_at(l, size[1 - kept]);
            let tip = |s: f64| self.surface.tip(pair(*kept, *line, s), self.radius).point[self.normal];
            let mut stops: Vec<_> = values.iter().enumerate().map(|(l, v)| (place(l), v - offset)).collect();
            for l in 0..=LINES {
                let (before, after) = (l.saturating_sub(1), (l + 1).min(LINES));
                let [a, b, c] = [before, l, after].map(|l| (values[l] - offset).abs());
                if b <= a && b <= c && b < 0.01 {
                    let sign = (values[l] - offset).signum();
                    let s = lowest(|s| sign * tip(s), place(before), place(after));
                    stops.push((s, tip(s) - offset));
                }
            }
            stops.sort_by(|a, b| a.0.total_cmp(&b.0));
            for two in stops.windows(2) {
                if (two[0].1 <= 0.0) != (two[1].1 <= 0.0) {
                    roots.push(self.root(*kept, *line, [two[0].0, two[1].0], offset));
                }
            }
        }
        roots
    }

    /// The parameters on a kept line at which the tip crosses the plane, by Newton steps inside a bracket.
    fn root(&self, kept: usize, line: f64, [mut low, mut high]: [f64; 2], offset: f64) -> [f64; 2] {
        let value = |s: f64| {
            let tip = self.surface.tip(pair(kept, line, s), self.radius);
            let slope = if kept == 0 { tip.v } else { tip.u };
            (tip.point[self.normal] - offset, slope[self.normal])
        };
        let is_rising = value(low).0 <= 0.0;
        let mut s = 0.5 * (low + high);
        for _ in 0..60 {
            let (error, slope) = value(s);
            if (error <= 0.0) == is_rising {
                low = s
            } else {
                high = s
            }
            let newton = s - error / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - s).abs() < 1e-14 {
                break;
            }
            s = next;
        }
        pair(kept, line, s)
    }
}

impl Section<'_> {
    pub fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.buckets.values().flatten().map(|(_, tip)| tip)
    }

    /// Whether the chain through `p` is no longer than `size`: no point is between `size` and 0.3 mm more
    /// from `p`.
    pub fn is_speck(&self, p: &Point3<f64>, size: f64) -> bool {
        let reach = size + 0.3;
        let near = bucket(p[self.locus.along] - reach)..=bucket(p[self.locus.along] + reach);
        let mut around = self.buckets.range(near).flat_map(|(_, touches)| touches);
        around.all(|(_, tip)| !(size..reach).contains(&(tip - p).norm()))
    }

    /// The distance from `p` to the curves, mm.
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        let middle = bucket(p[self.locus.along]);
        let mut nearest = (f64::INFINITY, [0.0; 2]);
        let mut ring = 0;
        while ring < 10_000 && (f64::from(ring) - 1.0) * BUCKET_MM < nearest.0 {
            for key in if ring == 0 {
                vec![middle]
            } else {
                vec![middle - i64::from(ring), middle + i64::from(ring)]
            } {
                for (at, tip) in self.buckets.get(&key).into_iter().flatten() {
                    let distance = (p - tip).norm();
                    if distance < nearest.0 {
                        nearest = (distance, *at);
                    }
                }
            }
            ring += 1;
        }
        nearest.0.min(self.polished(p, nearest.1))
    }

    /// The distance from `p` to its foot on the curve near `at`, mm: there the curve is perpendicular to the
    /// line to `p`. Infinite if no foot is found on the surface.
    fn polished(&self, p: &Point3<f64>, mut at: [f64; 2]) -> f64 {
        let Locus { surface, radius, normal, .. } = *self.locus;
        let size = surface.size();
        for _ in 0..12 {
            let tip = surface.tip(at, radius);
            let (nu, nv) = (tip.u[normal], tip.v[normal]);
            let tangent: Vector3<f64> = tip.u * nv - tip.v * nu;
            let off_plane = self.offset - tip.point[normal];
            let off_foot = tangent.dot(&(p - tip.point));
            if off_plane.abs() < 1e-10 && off_foot.abs() < 1e-10 * tangent.norm() {
                return (p - tip.point).norm();
            }
            let (tu, tv) = (tangent.dot(&tip.u), tangent.dot(&tip.v));
            let det = nu * tv - nv * tu;
            let step = [(off_plane * tv - nv * off_foot) / det, (nu * off_foot - off_plane * tu) / det];
            at = [at[0] + step[0], at[1] + step[1]];
            if !(0..2).all(|k| (-1e-9..=size[k] + 1e-9).contains(&at[k])) {
                return f64::INFINITY;
            }
        }
        f64::INFINITY
    }
}

/// The place of a minimum in an interval, by golden sections.
fn lowest(value: impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    while to - from > 1e-7 {
        let [p, q] = [0.382, 0.618].map(|t| from + t * (to - from));
        if value(p) < value(q) { to = q } else { from = p }
    }
    0.5 * (from + to)
}

fn bucket(x: f64) -> i64 {
    (x / BUCKET_MM).floor() as i64
}

fn line_at(line: usize, size: f64) -> f64 {
    size * line as f64 / LINES as f64
}

/// The parameters with `line` in the direction `kept` and `s` in the other.
fn pair(kept: usize, line: f64, s: f64) -> [f64; 2] {
    if kept == 0 { [line, s] } else { [s, line] }
}
