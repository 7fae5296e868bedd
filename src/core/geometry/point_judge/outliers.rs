//! Points that leave the surface of their neighbours.
//!
//! # Method
//! 1. Each point is left out of the fit of its window ([`window`]). Its residual is measured along the normal
//!    of the fit: points that lie unevenly along the surface are no outliers.
//! 2. The scale of the residual is what the fit leaves of the other points of the window: the noise, or how
//!    rough the surface is there. Steps, creases and steep features make it large, so a point near them has
//!    to be farther off. The scale is at least the noise of the quieter windows, and at least what the
//!    rounding of the numbers makes.
//! 3. A point is an outlier where the residual is many times its scale. A second outlier in the window would
//!    hide the first; so the fit is also made without the point that disturbs it most.
//! 4. A point that lies far away from all of its neighbours is an outlier, too, in any direction.

use nalgebra::{Point3, Vector3};

use super::Fault;
use super::window::{Fit, MOST, WIDEST, dot, fits};

/// Scales beyond which a residual makes an outlier, by the points of the window beyond its coefficients. Few
/// of them may fit by chance. The largest ratio of good surfaces with steps and cones is about 7; a smaller
/// bound would refuse them, a larger one would miss points.
const fn bound(freedom: usize) -> f64 {
    match freedom {
        0..6 => 25.0,
        6..9 => 20.0,
        9..13 => 15.0,
        _ => 11.0,
    }
}

/// The same where a second point is left out.
const PAIR_BOUND: f64 = 25.0;

/// The least scale, mm. Residuals of some micrometres are never mistakes.
const LEAST_SCALE_MM: f64 = 0.001;

/// The least scale, in units of the last decimal of all heights. An isolated point may be one unit off by
/// rounding alone.
const LEAST_SCALE_UNITS: f64 = 0.15;

/// Fewest windows that tell the noise of the grid. In a smaller grid one outlier is in most windows.
const LEAST_WINDOWS: usize = 400;

/// The part of the windows that is quieter than the noise of the grid.
const QUIET_PART: f64 = 0.25;

/// In a window with fewer rows or columns than this, the residual of an outlier is also at least as long as
/// the distance to the nearest neighbour. A dome of nine points looks like an outlier otherwise.
const SURE_WIDTH: usize = 4;

/// Least length of a residual that lies along the surface, in distances to the nearest neighbour.
const LEAST_SHIFT: f64 = 0.5;

/// A point is far off when the distance to its nearest neighbour is more than this many times the largest
/// distance of its neighbours from their other neighbours.
const FAR_FACTOR: f64 = 5.0;

/// The residual of a point, and its scale; mm.
#[derive(Clone, Copy)]
struct Residual {
    along_normal: f64,
    scale: f64,
    /// The same without the point that disturbs the fit most.
    without: f64,
    scale_without: f64,
    /// The length of the residual in any direction.
    whole: f64,
}

/// The outliers of a grid with equally long rows, in the order of the rows.
pub fn outliers(rows: &[Vec<Point3<f64>>], work: &mut usize) -> Vec<Fault> {
    let size = [rows.len(), rows[0].len()];
    let window = size.map(|n| n.min(WIDEST));
    let mut faults = Vec::new();
    if let Some(fits) = fits(window) {
        *work += size[0] * size[1] * window[0] * window[1];
        let judge = Judge { rows, size, window, fits };
        let residuals: Vec<Option<Residual>> = judge.places().map(|place| judge.residual(place)).collect();
        let least = LEAST_SCALE_MM.max(LEAST_SCALE_UNITS * unit(rows)).max(quiet(&residuals));
        for (place, residual) in judge.places().zip(residuals) {
            if let Some(residual) = residual
                && let Some(off_mm) = judge.off(place, residual, least)
            {
                faults.push(Fault::Outlier { place, off_mm, usual_mm: residual.scale.max(least) });
            }
        }
    }
    *work += 16 * size[0] * size[1];
    if faults.is_empty() && size.iter().all(|n| *n >= 3) {
        faults.extend(far(rows, size));
    }
    faults
}

struct Judge<'a> {
    rows: &'a [Vec<Point3<f64>>],
    size: [usize; 2],
    window: [usize; 2],
    fits: Vec<Fit>,
}

impl Judge<'_> {
    fn places(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [n, m] = self.size;
        (0..n).flat_map(move |i| (0..m).map(move |j| [i, j]))
    }

    /// The fit of the point at `place`, and the first row and column of its window.
    fn fit(&self, place: [usize; 2]) -> (&Fit, [usize; 2]) {
        let first = [0, 1].map(|k| {
            let most = self.size[k] - self.window[k];
            place[k].saturating_sub(self.window[k] / 2).min(most)
        });
        let within = (place[0] - first[0]) * self.window[1] + place[1] - first[1];
        (&self.fits[within], first)
    }

    /// `None` where the surface has no normal.
    fn residual(&self, place: [usize; 2]) -> Option<Residual> {
        let (fit, first) = self.fit(place);
        let point = self.rows[place[0]][place[1]];
        let mut from = [Vector3::zeros(); MOST];
        for a in 0..self.window[0] {
            let row = &self.rows[first[0] + a][first[1]..first[1] + self.window[1]];
            row.iter().enumerate().for_each(|(b, p)| from[a * self.window[1] + b] = p - point);
        }
        let sum = |weights: &[f64; MOST]| {
            weights.iter().zip(&from).fold(Vector3::zeros(), |sum: Vector3<f64>, (w, p)| sum + p * *w)
        };
        let normal = sum(&fit.along[0]).cross(&sum(&fit.along[1])).try_normalize(0.0)?;
        let heights = from.map(|p| p.dot(&normal));
        let whole = sum(&fit.value).norm();
        let predicted = dot(&fit.value, &heights);
        let parts: Vec<f64> = fit.basis.iter().map(|column| dot(column, &heights)).collect();
        let mut rest = heights;
        for (part, column) in parts.iter().zip(&fit.basis) {
            rest.iter_mut().zip(column).for_each(|(x, y)| *x -= part * y);
        }
        let squares = dot(&rest, &rest);
        let scale = |squares: f64, leverage: f64, freedom: usize| {
            (squares.max(0.0) / freedom as f64 * (1.0 + leverage)).sqrt()
        };
        // The point whose removal makes the rest of the fit least.
        let free = |k: usize| 1.0 - fit.basis.iter().map(|column| column[k] * column[k]).sum::<f64>();
        let mut worst = (0, 0.0, 1.0);
        for (k, rest) in rest.iter().enumerate().take(self.window[0] * self.window[1]) {
            if rest * rest > worst.1 {
                let free = free(k).max(1e-6);
                let gain = rest * rest / free;
                if gain > worst.1 {
                    worst = (k, gain, free);
                }
            }
        }
        let (k, gain, free) = worst;
        Some(Residual {
            along_normal: predicted.abs(),
            scale: scale(squares, fit.leverage, fit.freedom),
            without: (predicted - fit.value[k] * rest[k] / free).abs(),
            scale_without: scale(
                squares - gain,
                fit.leverage + fit.value[k] * fit.value[k] / free,
                fit.freedom - 1,
            ),
            whole,
        })
    }

    /// How far the point is off, mm. `None` where it is no outlier.
    fn off(&self, place: [usize; 2], residual: Residual, least: f64) -> Option<f64> {
        let (fit, first) = self.fit(place);
        let Residual { along_normal, scale, without, scale_without, whole } = residual;
        let least = least * (1.0 + fit.leverage).sqrt();
        let bound = bound(fit.freedom);
        let is_sure = |off: f64| self.window.iter().all(|n| *n >= SURE_WIDTH) || off >= self.pitch(place);
        if along_normal > bound * scale.max(least) && is_sure(along_normal) {
            return Some(along_normal);
        }
        let is_wide = self.window == [WIDEST; 2];
        if is_wide && without > PAIR_BOUND * scale_without.max(least) && is_sure(without) {
            return Some(without);
        }
        let is_shifted = whole > LEAST_SHIFT * self.pitch(place)
            && whole > bound * self.whole_scale(fit, first).max(least);
        (is_shifted && is_sure(whole)).then_some(whole)
    }

    /// The scale of residuals in any direction, mm.
    fn whole_scale(&self, fit: &Fit, first: [usize; 2]) -> f64 {
        let mut squares = 0.0;
        for axis in 0..3 {
            let mut values = [0.0; MOST];
            for a in 0..self.window[0] {
                for b in 0..self.window[1] {
                    values[a * self.window[1] + b] =
                        self.rows[first[0] + a][first[1] + b][axis] - self.rows[first[0]][first[1]][axis];
                }
            }
            // The basis is zero at the left-out point, and so must be the values.
            let left_out = (0..MOST).find(|k| fit.basis[0][*k] == 0.0).unwrap_or(0);
            values[left_out] = 0.0;
            for column in &fit.basis {
                let part = dot(column, &values);
                values.iter_mut().zip(column).for_each(|(x, y)| *x -= part * y);
            }
            squares += dot(&values, &values);
        }
        (squares / fit.freedom as f64 * (1.0 + fit.leverage)).sqrt()
    }

    /// The distance to the nearest neighbour, mm.
    fn pitch(&self, place: [usize; 2]) -> f64 {
        let here = self.rows[place[0]][place[1]];
        let away = |[a, b]: [usize; 2]| (self.rows[a][b] - here).xy().norm();
        neighbours(self.size, place).map(away).fold(f64::INFINITY, f64::min)
    }
}

/// The scale that a quarter of the windows stay below, mm; zero for a small grid.
fn quiet(residuals: &[Option<Residual>]) -> f64 {
    if residuals.len() < LEAST_WINDOWS {
        return 0.0;
    }
    let mut scales: Vec<f64> = residuals.iter().flatten().map(|residual| residual.scale).collect();
    if scales.is_empty() {
        return 0.0;
    }
    let k = (QUIET_PART * (scales.len() - 1) as f64) as usize;
    *scales.select_nth_unstable_by(k, f64::total_cmp).1
}

/// The largest power of ten, from 1 to a millionth, of which all heights are multiples; zero if there
/// is none.
fn unit(rows: &[Vec<Point3<f64>>]) -> f64 {
    let mut decimals = 0;
    for p in rows.iter().flatten() {
        while decimals < 7 {
            let scaled = p.z * 10f64.powi(decimals);
            if (scaled - scaled.round()).abs() <= 1e-6 {
                break;
            }
            decimals += 1;
        }
    }
    if decimals < 7 { 10f64.powi(-decimals) } else { 0.0 }
}

fn neighbours(size: [usize; 2], [i, j]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    let rows = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter(move |i| *i < size[0]);
    let columns = [j.checked_sub(1), Some(j + 1)].into_iter().flatten().filter(move |j| *j < size[1]);
    rows.map(move |row| [row, j]).chain(columns.map(move |column| [i, column]))
}

/// The first point that lies far away from all of its neighbours.
fn far(rows: &[Vec<Point3<f64>>], size: [usize; 2]) -> Option<Fault> {
    let apart = |[a, b]: [usize; 2], [c, d]: [usize; 2]| (rows[a][b] - rows[c][d]).norm();
    let places = (0..size[0]).flat_map(|i| (0..size[1]).map(move |j| [i, j]));
    for place in places {
        let nearest = neighbours(size, place).map(|other| apart(place, other)).fold(f64::INFINITY, f64::min);
        let others = neighbours(size, place).flat_map(|other| {
            neighbours(size, other).filter(move |next| *next != place).map(move |next| apart(other, next))
        });
        let usual_mm = others.fold(0.0, f64::max);
        if nearest > FAR_FACTOR * usual_mm {
            return Some(Fault::Outlier { place, off_mm: nearest, usual_mm });
        }
    }
    None
}
