//! Judges wires along x and y of random swept surfaces: section curves with corners, roundings and smooth
//! parts, as parallel sweeps, normal sweeps and ruled surfaces.
//!
//! The judge intersects the exact surface with the planes by sampling: it evaluates the curves of the sweep,
//! and no patch. It checks three laws:
//! 1. Every point of a section is near a wire of its plane.
//! 2. Every point of a wire is near the surface.
//! 3. Where a section crosses an edge, a wire has a point.

mod exact;
mod judge;

use exact::{Exact, flat, upright};
use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::profile::Profile;
use toolpathd_core::geometry::surface::any_surface::AnySurface;
use toolpathd_core::geometry::surface::normal_sweep::NormalSweep;
use toolpathd_core::geometry::surface::parallel_sweep::ParallelSweep;
use toolpathd_core::geometry::surface::ruled::Ruled;
use toolpathd_core::language::section_curve::SectionCurve;
use toolpathd_core::machining::wire_model::{Along, Wire, WireError, WireJob, wires};

const HEIGHT_MM: f64 = 0.01;

/// Numbers that look random, the same in every run.
struct Dice(u64);

impl Dice {
    fn number(&mut self, [low, high]: [f64; 2]) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        // Three decimals, and often round numbers, so that planes meet corners.
        let value = low + (high - low) * share;
        if self.0 % 5 < 2 { value.round() } else { (1000.0 * value).round() / 1000.0 }
    }

    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % n as u64) as usize
    }
}

/// The text of a curve from left to right; `fixed` coordinates follow those of the plane.
fn curve(dice: &mut Dice, steps: [f64; 2], rise: f64, in_space: bool) -> String {
    let mut x = if dice.below(3) == 0 { dice.number([-6.0, 0.0]) } else { 0.0 };
    let next = |dice: &mut Dice, x: f64| {
        let y = dice.number([-rise, rise]);
        if in_space { format!("{x},{y},{}", dice.number([-3.0, 3.0])) } else { format!("{x},{y}") }
    };
    let mut items = vec![format!("l({})", next(dice, x))];
    let n = 1 + dice.below(4);
    for k in 0..n {
        x += dice.number(steps).max(1.0);
        items.push(match dice.below(3) {
            0 if k + 1 < n => format!("r({},{})", next(dice, x), dice.number([0.2, 1.0]).max(0.2)),
            1 => {
                let rows: Vec<String> = (0..2 + dice.below(3))
                    .map(|_| {
                        x += dice.number([2.0, 5.0]).max(1.0);
                        format!("({})", next(dice, x))
                    })
                    .collect();
                format!("b({})", rows.join(","))
            }
            _ => format!("l({})", next(dice, x)),
        });
    }
    items.join(" ")
}

fn plane(text: &str) -> Option<Profile<2>> {
    match SectionCurve::parse(text) {
        Ok(SectionCurve::Plane(chain)) => Some(chain.profile()),
        _ => None,
    }
}

fn space(text: &str) -> Option<Profile<3>> {
    match SectionCurve::parse(text) {
        Ok(SectionCurve::Space(chain)) => Some(chain.profile()),
        _ => None,
    }
}

/// A random surface with its definition; `None` where the curves make none.
fn surface(dice: &mut Dice) -> Option<(String, Exact, AnySurface)> {
    match dice.below(4) {
        0 => {
            let texts = [curve(dice, [3.0, 9.0], 3.0, false), curve(dice, [3.0, 9.0], 3.0, false)];
            let sweep = ParallelSweep {
                basic: upright(&plane(&texts[0])?, 0),
                drive: upright(&plane(&texts[1])?, 1),
            };
            Some((format!("parallel {texts:?}"), Exact::parallel(&sweep), sweep.surface().ok()?))
        }
        1 => {
            let texts = [curve(dice, [3.0, 9.0], 3.0, true), curve(dice, [3.0, 9.0], 3.0, false)];
            let sweep = ParallelSweep { basic: space(&texts[0])?, drive: upright(&plane(&texts[1])?, 1) };
            Some((format!("parallel in space {texts:?}"), Exact::parallel(&sweep), sweep.surface().ok()?))
        }
        2 => {
            let texts = [curve(dice, [12.0, 20.0], 9.0, false), curve(dice, [1.0, 3.0], 3.0, false)];
            let sweep = NormalSweep { basic: flat(&plane(&texts[0])?), drive: plane(&texts[1])? };
            Some((format!("normal {texts:?}"), Exact::normal(&sweep), sweep.surface().ok()?))
        }
        _ => {
            let texts = [curve(dice, [3.0, 9.0], 3.0, true), curve(dice, [3.0, 9.0], 3.0, true)];
            let second = space(&texts[1])?.mapped(|p| p + nalgebra::Vector3::new(0.0, 15.0, 0.0));
            let ruled = Ruled { first: space(&texts[0])?, second };
            Some((format!("ruled {texts:?}"), Exact::ruled(&ruled), ruled.surface().ok()?))
        }
    }
}

fn cut(surface: &AnySurface, along: Along, pitch_mm: f64) -> Result<Vec<Wire>, WireError> {
    let job =
        WireJob { along, pitch_mm, chord_height_mm: HEIGHT_MM, wire_limit: 1000, point_limit: 1_000_000 };
    let budget = Budget::unlimited();
    match surface {
        AnySurface::Bicubic(surface) => wires(surface, &job, &budget),
        AnySurface::Rational(surface) => wires(surface, &job, &budget),
        AnySurface::HighDegree(surface) => wires(surface, &job, &budget),
    }
}

/// Judges `wanted` models from the seed; the faults found.
pub fn faults(seed: u64, wanted: usize) -> Vec<String> {
    let mut dice = Dice(seed);
    let (mut faults, mut judged) = (Vec::new(), 0);
    while judged < wanted {
        let Some((name, exact, surface)) = surface(&mut dice) else { continue };
        judged += 1;
        for (along, axis) in [(Along::X, 1), (Along::Y, 0)] {
            let pitch_mm = [5.0, 4.0, 3.7][dice.below(3)];
            match cut(&surface, along, pitch_mm) {
                Ok(wires) => {
                    let found = judge::judge(&exact, &wires, axis, pitch_mm, HEIGHT_MM);
                    faults.extend(
                        found.into_iter().map(|fault| format!("{name} {along:?} {pitch_mm}: {fault}")),
                    );
                }
                Err(error) => faults.push(format!("{name} {along:?}: {error}")),
            }
        }
    }
    faults
}

#[test]
fn wires_of_random_swept_surfaces_are_their_sections() {
    let faults = faults(20_261_128, 100);
    assert!(faults.is_empty(), "{} faults, the first: {}", faults.len(), faults[0]);
}

#[test]
fn a_wire_crosses_a_sharp_ridge_in_a_point_of_its_own() {
    // The ridge is at x = 10, z = 3 along y.
    let [basic, drive] = [("l(0,0) l(10,3) l(20,0)", 0), ("l(0,0) l(20,0)", 1)]
        .map(|(text, axis)| upright(&plane(text).expect("a curve"), axis));
    let surface = ParallelSweep { basic, drive }.surface().expect("a surface");
    let wires = cut(&surface, Along::X, 5.0).expect("wires");
    assert_eq!(wires.len(), 5);
    for (wire, y) in wires.iter().zip([0.0, 5.0, 10.0, 15.0, 20.0]) {
        let expected = [[0.0, 0.0], [10.0, 3.0], [20.0, 0.0]].map(|[x, z]| Point3::new(x, y, z));
        assert_eq!(wire.len(), 3);
        for (found, expected) in wire.iter().zip(expected) {
            assert!((found - expected).norm() < 1e-8, "{found} instead of {expected}");
        }
    }
}
