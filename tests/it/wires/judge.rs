//! Compares wires with sections that are found by sampling.

use nalgebra::{Point3, Vector3};

use super::exact::Exact;
use toolpathd_core::machining::wire_model::Wire;

/// Samples across a cell, each way.
const SAMPLES: usize = 32;

/// Points of a section from which the nearest place of the surface is searched. Where the surface is folded,
/// the nearest points may lie on another sheet.
const NEAR: usize = 40;

/// Rounding of judge and wires, mm.
const SLACK_MM: f64 = 2e-6;

/// A point of the exact section.
struct Hit {
    cell: [usize; 2],
    place: [f64; 2],
    point: Point3<f64>,
}

/// The faults of `wires` in planes at right angles to `axis`.
pub fn judge(exact: &Exact, wires: &[Wire], axis: usize, pitch_mm: f64, height_mm: f64) -> Vec<String> {
    let mut faults = Vec::new();
    let [low, high] = extent(exact, axis);
    let mut planes: Vec<f64> = wires.iter().map(|wire| wire[0][axis]).collect();
    planes.sort_by(f64::total_cmp);
    planes.dedup();
    // The extent by samples is not exact.
    let (spaces, needed) = (planes.len() as f64 - 1.0, (high - low) / pitch_mm);
    if !(needed - 1e-3..needed + 1.0 + 1e-3).contains(&spaces) {
        faults.push(format!("{spaces} spaces of {pitch_mm} mm for {} mm", high - low));
    }
    for k in 1..spaces as usize {
        let at = low + (high - low) * k as f64 / spaces;
        let in_plane: Vec<&Wire> = wires.iter().filter(|wire| (wire[0][axis] - at).abs() < 1e-2).collect();
        // The extent by samples is not exact; the wires tell their plane.
        let at = in_plane.first().map_or(at, |wire| wire[0][axis]);
        let hits = section(exact, axis, at);
        for hit in &hits {
            let off = in_plane.iter().map(|wire| distance(wire, &hit.point)).fold(f64::INFINITY, f64::min);
            if off > height_mm + SLACK_MM {
                faults.push(format!("{} is {off} mm from the wires at {at}", hit.point));
                break;
            }
            if is_on_edge(exact, hit) {
                let nearest = in_plane.iter().copied().flatten().map(|p| (p - hit.point).norm());
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                if nearest > SLACK_MM {
                    faults.push(format!("no point at the edge {}: {nearest} mm", hit.point));
                    break;
                }
            }
        }
        for wire in in_plane {
            let worst = samples(wire).map(|p| (off_surface(exact, &hits, &p), p));
            let (off, at) = worst.fold((0.0, wire[0]), |a, b| if b.0 > a.0 { b } else { a });
            if off > height_mm + SLACK_MM {
                faults.push(format!("the wire is {off} mm off the surface at {at}"));
            }
        }
    }
    faults
}

fn cells(exact: &Exact) -> impl Iterator<Item = [usize; 2]> {
    let [nu, nv] = exact.cells;
    (0..nu).flat_map(move |i| (0..nv).map(move |j| [i, j]))
}

fn extent(exact: &Exact, axis: usize) -> [f64; 2] {
    let at = |k: usize| k as f64 / 40.0;
    let points = cells(exact).flat_map(|cell| (0..41 * 41).map(move |k| (cell, [at(k / 41), at(k % 41)])));
    points
        .map(|(cell, place)| exact.point(cell, place)[axis])
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// Points of the section along lines of constant u and of constant v, the sides of cells among them.
fn section(exact: &Exact, axis: usize, at: f64) -> Vec<Hit> {
    let mut hits = Vec::new();
    for cell in cells(exact) {
        for line in 0..=SAMPLES {
            for along_v in [true, false] {
                let fixed = line as f64 / SAMPLES as f64;
                let place = |t: f64| if along_v { [fixed, t] } else { [t, fixed] };
                let off = |t: f64| exact.point(cell, place(t))[axis] - at;
                let mut before = off(0.0);
                for k in 1..=SAMPLES {
                    let [from, to] = [k - 1, k].map(|k| k as f64 / SAMPLES as f64);
                    let after = off(to);
                    if (before < 0.0) != (after < 0.0) {
                        let t = root([from, to], before < 0.0, off);
                        hits.push(Hit { cell, place: place(t), point: exact.point(cell, place(t)) });
                    }
                    before = after;
                }
            }
        }
    }
    hits
}

fn root([mut low, mut high]: [f64; 2], rises: bool, off: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if (off(middle) < 0.0) == rises { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Whether the hit is on the side of a cell where the surface has an edge.
fn is_on_edge(exact: &Exact, hit: &Hit) -> bool {
    (0..2).any(|side| {
        let [t, cell] = [hit.place[side], hit.cell[side] as f64];
        let neighbour = if t == 0.0 { cell - 1.0 } else { cell + 1.0 };
        if !(t == 0.0 || t == 1.0) || neighbour < 0.0 || neighbour >= exact.cells[side] as f64 {
            return false;
        }
        let (mut other, mut place) = (hit.cell, hit.place);
        other[side] = neighbour as usize;
        place[side] = 1.0 - t;
        let [a, b] = [normal(exact, hit.cell, hit.place), normal(exact, other, place)];
        (a - b).norm() > 0.01
    })
}

fn derivatives(exact: &Exact, cell: [usize; 2], place: [f64; 2]) -> [Vector3<f64>; 2] {
    const STEP: f64 = 1e-6;
    [0, 1].map(|side| {
        let [mut low, mut high] = [place, place];
        low[side] = (low[side] - STEP).max(0.0);
        high[side] = (high[side] + STEP).min(1.0);
        (exact.point(cell, high) - exact.point(cell, low)) / (high[side] - low[side])
    })
}

fn normal(exact: &Exact, cell: [usize; 2], place: [f64; 2]) -> Vector3<f64> {
    let [du, dv] = derivatives(exact, cell, place);
    du.cross(&dv).normalize()
}

fn distance(wire: &Wire, p: &Point3<f64>) -> f64 {
    let to_line = |pair: &[Point3<f64>]| {
        let way = pair[1] - pair[0];
        let share = ((p - pair[0]).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        (pair[0] + way * share - p).norm()
    };
    wire.windows(2).map(to_line).fold(f64::INFINITY, f64::min)
}

/// Points along the wire, a few in each line.
fn samples(wire: &Wire) -> impl Iterator<Item = Point3<f64>> {
    wire.windows(2).flat_map(|pair| (0..=4).map(|k| pair[0] + (pair[1] - pair[0]) * (f64::from(k) / 4.0)))
}

/// The distance from the exact surface, by Gauss and Newton from the nearest hits.
fn off_surface(exact: &Exact, hits: &[Hit], p: &Point3<f64>) -> f64 {
    let mut near: Vec<(f64, &Hit)> = hits.iter().map(|hit| ((hit.point - p).norm(), hit)).collect();
    let n = near.len().min(NEAR);
    if n == 0 {
        return f64::INFINITY;
    }
    near.select_nth_unstable_by(n - 1, |a, b| a.0.total_cmp(&b.0));
    near[..n].iter().map(|(_, hit)| from(exact, hit, p)).fold(f64::INFINITY, f64::min)
}

fn from(exact: &Exact, hit: &Hit, p: &Point3<f64>) -> f64 {
    let mut place = hit.place;
    let mut best = (hit.point - p).norm();
    for _ in 0..8 {
        let off = p - exact.point(hit.cell, place);
        let [du, dv] = derivatives(exact, hit.cell, place);
        let (a, b, c) = (du.norm_squared(), du.dot(&dv), dv.norm_squared());
        let det = a * c - b * b;
        let (x, y) = (off.dot(&du), off.dot(&dv));
        let mut next = [place[0] + (c * x - b * y) / det, place[1] + (a * y - b * x) / det];
        for side in 0..2 {
            if !(0.0..=1.0).contains(&next[side]) {
                // On the side, only the other parameter is free.
                next[side] = next[side].clamp(0.0, 1.0);
                let other = 1 - side;
                let along = if other == 0 { (x, a) } else { (y, c) };
                next[other] = (place[other] + along.0 / along.1).clamp(0.0, 1.0);
            }
        }
        if next.iter().any(|t| !t.is_finite()) {
            break;
        }
        place = next;
        best = best.min((exact.point(hit.cell, place) - p).norm());
    }
    best
}
