//! Every written arc keeps the rules of its control for ends, centre and radii, and a control that runs it
//! about a centre of its own stays as near to the toolpath as the program states.

pub mod control;

use self::control::{Cut, Stated, apart, cuts_of_klartext, cuts_of_words};
use super::*;
use crate::dialect::Arcs;
use crate::dialects::siemens::SIEMENS;
use crate::read::Fault;

/// Numbers from 0 to 1 in an order that looks random.
pub struct Dice(u64);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// One arc as a toolpath.
#[derive(Debug)]
struct Source {
    plane: Plane,
    direction: Direction,
    center: Vector3<f64>,
    radius: f64,
    angle: f64,
    sweep: f64,
    rise: f64,
}

impl Source {
    /// Of a radius of 0.05 to 5 mm. Half turns and whole turns, and what is near them, come often.
    fn random(dice: &mut Dice, k: usize) -> Self {
        let gap = 10f64.powf(-4.0 + 3.5 * dice.roll());
        let sweep = match k % 5 {
            0 => TAU / 2.0,
            1 => TAU / 2.0 + if dice.roll() < 0.5 { gap } else { -gap },
            2 => TAU - gap,
            3 if k.is_multiple_of(2) => TAU,
            _ => 0.01 + (TAU - 0.01) * dice.roll(),
        };
        Self {
            plane: Plane::ALL[k % 3],
            direction: if dice.roll() < 0.5 { Direction::Ccw } else { Direction::Cw },
            center: Vector3::new(dice.roll(), dice.roll(), dice.roll()) * 40.0,
            radius: 0.05 * 100f64.powf(dice.roll()),
            angle: if k.is_multiple_of(7) { 0.0 } else { TAU * dice.roll() },
            sweep,
            rise: if k.is_multiple_of(4) { dice.roll() - 0.5 } else { 0.0 },
        }
    }

    fn sense(&self) -> f64 {
        if self.direction == Direction::Ccw { 1.0 } else { -1.0 }
    }

    fn at(&self, t: f64) -> Point3<f64> {
        let angle =
            self.angle + if t == 1.0 && self.sweep == TAU { 0.0 } else { self.sense() * self.sweep * t };
        let spoke = Vector3::new(self.radius * angle.cos(), self.radius * angle.sin(), self.rise * t);
        self.plane.to_workpiece(&(self.center + spoke))
    }

    fn path(&self) -> Toolpath {
        let mut path = Toolpath::builder(self.at(0.0));
        let center = self.plane.to_workpiece(&self.center);
        path.arc(self.at(1.0), center, (self.plane, self.direction), feed(500.0), Role::Cut).unwrap();
        path.finish().unwrap()
    }

    /// As a control would read it.
    fn way(&self) -> control::Way {
        control::Way {
            center: [self.center.x, self.center.y],
            radius: self.radius,
            begins: self.angle,
            sweep: self.sense() * self.sweep,
            height: self.center.z,
            axes: self.plane.axes(),
        }
    }
}

fn written_as(dialect: &Dialect, path: &Toolpath, resolution: Resolution) -> NcProgram {
    let (program, cutting) = (Program::plain(resolution), Cutting { coolant: Coolant::Off, ..cutting() });
    write(path, &ProgramJob::plain(&program, &cutting, dialect), &Budget::unlimited()).unwrap()
}

fn cuts(dialect: &Dialect, text: &str) -> Vec<Cut> {
    if dialect.syntax == Syntax::Klartext { cuts_of_klartext(text) } else { cuts_of_words(text) }
}

fn arcs(dialect: &Dialect, text: &str) -> Vec<Stated> {
    let arc = |cut| if let Cut::Arc(stated) = cut { Some(stated) } else { None };
    cuts(dialect, text).into_iter().filter_map(arc).collect()
}

/// The point of the grid of a program that is nearest to a point, mm.
fn grid_point(at: &Point3<f64>, resolution: Resolution) -> [f64; 3] {
    [at.x, at.y, at.z].map(|mm| (mm / resolution.step_mm()).round() * resolution.step_mm())
}

/// The largest distance between the source and what the control may run, mm, both ways.
fn deviation(source: &Source, cuts: &[Cut], control: &str) -> f64 {
    let (way, n) = (source.way(), 24);
    let parts = || (0..=n).map(|k| f64::from(k) / f64::from(n));
    let mut farthest: f64 = 0.0;
    for cut in cuts {
        match cut {
            Cut::Line { from, to } => {
                let at = |t: f64| [0, 1, 2].map(|k| from[k] + (to[k] - from[k]) * t);
                farthest = parts().map(|t| way.distance(at(t))).fold(farthest, f64::max);
            }
            Cut::Arc(stated) => {
                for run in stated.ways(control) {
                    farthest = parts().map(|t| way.distance(run.at(t))).fold(farthest, f64::max);
                }
            }
        }
    }
    for t in parts() {
        let p = way.at(t);
        let near = |cut: &Cut| match cut {
            Cut::Line { from, to } => {
                let along = [0, 1, 2].map(|k| to[k] - from[k]);
                let square: f64 = along.iter().map(|x| x * x).sum();
                let dot: f64 = (0..3).map(|k| along[k] * (p[k] - from[k])).sum();
                let t = if square > 0.0 { (dot / square).clamp(0.0, 1.0) } else { 0.0 };
                apart([0, 1, 2].map(|k| from[k] + along[k] * t), p)
            }
            Cut::Arc(stated) => stated.ways(control).iter().map(|run| run.distance(p)).fold(0.0, f64::max),
        };
        farthest = farthest.max(cuts.iter().map(near).fold(f64::INFINITY, f64::min));
    }
    farthest
}

#[test]
fn a_small_half_circle_of_odd_length_becomes_two_quarters_on_siemens() {
    let mut path = Toolpath::builder(Point3::origin());
    let about = (Plane::Xy, Direction::Cw);
    path.arc(Point3::new(0.9994, 0.0, 0.0), Point3::new(0.4997, 0.0, 0.0), about, feed(500.0), Role::Cut)
        .unwrap();
    let text = written_as(&SIEMENS, &path.finish().unwrap(), MM).text;
    assert!(text.contains("\nG2 X0.500 Y0.500 I0.500 J0.000 F500\nX0.999 Y0.000 I"), "{text}");
    let arcs = arcs(&SIEMENS, &text);
    assert_eq!(arcs.len(), 2, "{text}");
    for arc in arcs {
        assert!(arc.strain("siemens") < 1.0, "{arc:?}");
    }
}

#[test]
fn every_written_arc_keeps_the_rules_of_its_control_and_the_stated_deviation() {
    let has_arcs = |dialect: &&&Dialect| dialect.curves.arcs != Arcs::AsLines;
    for (seed, dialect) in DIALECTS.iter().filter(has_arcs).enumerate() {
        let mut dice = Dice::new(seed as u64 + 1);
        let (mut n_sources, mut n_arcs) = (0, 0);
        for decimals in [3, 4] {
            for &units in dialect.abilities.units {
                let resolution = Resolution { units, decimals: decimals.min(dialect.max_decimals) };
                for k in 0..75 {
                    let source = Source::random(&mut dice, k);
                    let written = written_as(dialect, &source.path(), resolution);
                    let mut cuts = cuts(dialect, &written.text);
                    if cuts.is_empty() {
                        // Both ends round to one point, and the program has no block for the arc.
                        let at = grid_point(&source.at(0.0), resolution);
                        cuts.push(Cut::Line { from: at, to: at });
                    }
                    let arcs = arcs(dialect, &written.text);
                    for arc in &arcs {
                        let strain = arc.strain(dialect.name);
                        assert!(strain < 1.0, "{} {strain} {arc:?}\n{}", dialect.name, written.text);
                    }
                    n_arcs += arcs.len();
                    n_sources += 1;
                    assert!(written.max_displacement_mm <= 1.5 * resolution.step_mm());
                    if source.rise == 0.0 {
                        let off = deviation(&source, &cuts, dialect.name);
                        let stated = written.max_displacement_mm;
                        assert!(
                            off <= stated + 1e-9,
                            "{} {off} {stated} {source:?}\n{}",
                            dialect.name,
                            written.text
                        );
                    }
                }
            }
        }
        // Most sources are written as arcs. Those of a few units of the last decimal become lines.
        assert!(2 * n_arcs >= n_sources, "{} {n_arcs} {n_sources}", dialect.name);
    }
}

/// A good program with another arc in place of its own.
fn with_arc(end: [f64; 2], center: [f64; 2]) -> String {
    let mut path = Toolpath::builder(Point3::origin());
    let about = (Plane::Xy, Direction::Ccw);
    path.arc(Point3::new(1.0, 0.0, 0.0), Point3::new(0.5, 0.0, 0.0), about, feed(500.0), Role::Cut).unwrap();
    let text = written_as(&SIEMENS, &path.finish().unwrap(), MM).text;
    let own = "X1.000 Y0.000 I0.500 J0.000";
    assert!(text.contains(own), "{text}");
    // No number of a program is a negative zero.
    let [[x, y], [i, j]] = [end, center].map(|p| p.map(|at| (at * 1000.0).round() / 1000.0 + 0.0));
    text.replacen(own, &format!("X{x:.3} Y{y:.3} I{i:.3} J{j:.3}"), 1)
}

fn fault(text: &str) -> Option<Fault> {
    Reader::new(text, &SIEMENS, 1.0).find_map(Result::err).map(|error| error.fault)
}

#[test]
fn the_reader_refuses_the_arcs_that_a_control_refuses_and_no_others() {
    let mut dice = Dice::new(7);
    let [mut accepted, mut refused] = [0, 0];
    for _ in 0..600 {
        let radius = 0.02 * 500f64.powf(dice.roll());
        let (from, turn) = (TAU * dice.roll(), TAU * dice.roll());
        let jitter = 0.06 * dice.roll() * radius.min(0.3);
        let center = [-radius * from.cos(), -radius * from.sin()].map(|at| at + jitter * (dice.roll() - 0.5));
        let end = [radius * ((from + turn).cos() - from.cos()), radius * ((from + turn).sin() - from.sin())];
        let text = with_arc(end, center);
        let [arc] = arcs(&SIEMENS, &text)[..] else { panic!("{text}") };
        let strain = arc.strain("siemens");
        if arc.is_closed() || (strain - 1.0).abs() < 1e-4 {
            continue;
        }
        let found = fault(&text);
        let is_rule = matches!(
            found,
            Some(Fault::RadiusMismatch { .. } | Fault::NoOwnCenter | Fault::TurnedCenter { .. })
        );
        assert_eq!(is_rule, strain > 1.0, "{strain} {found:?} {arc:?}");
        *(if is_rule { &mut refused } else { &mut accepted }) += 1;
    }
    assert!(accepted > 80 && refused > 80, "{accepted} {refused}");
}

#[test]
fn a_centre_that_is_shifted_by_a_few_units_fails_the_check() {
    let mut path = Toolpath::builder(Point3::origin());
    let about = (Plane::Xy, Direction::Ccw);
    path.arc(Point3::new(1.0, 0.0, 0.0), Point3::new(0.5, 0.0, 0.0), about, feed(500.0), Role::Cut).unwrap();
    let path = path.finish().unwrap();
    let (program, cutting) = (Program::plain(MM), cutting());
    let job = ProgramJob::plain(&program, &cutting, &SIEMENS);
    let text = write(&path, &job, &Budget::unlimited()).unwrap().text;
    let check = |text: &str| check_text(text, &path, &job).map(|_| ());
    assert_eq!(check(&text), Ok(()));
    for offset in ["I0.501", "I0.499", "I0.503"] {
        let spoiled = text.replace("I0.500", offset);
        assert!(matches!(check(&spoiled), Err(WriteError::Unreadable(_))), "{spoiled}");
        assert!(arcs(&SIEMENS, &spoiled)[0].strain("siemens") > 1.0, "{spoiled}");
    }
    // This centre is as far from both ends, but it is not the centre of the toolpath.
    let moved = text.replace("J0.000", "J0.020");
    assert!(matches!(check(&moved), Err(WriteError::Differs { what: "centre", .. })), "{moved}");
    assert_eq!(fault(&with_arc([0.999, 0.0], [0.499, 0.0])), Some(Fault::NoOwnCenter));
    let turned = fault(&with_arc([0.999, 0.0], [0.5, 0.0]));
    assert!(
        matches!(turned, Some(Fault::TurnedCenter { degrees }) if (degrees - 2.5626).abs() < 1e-3),
        "{turned:?}"
    );
}

/// A dialect writes radii that differ by no more than its control accepts.
#[test]
fn no_dialect_writes_a_difference_of_the_radii_that_its_control_refuses() {
    for dialect in DIALECTS {
        let curves = dialect.curves;
        assert!(curves.radius_mismatch_mm <= curves.accepts.mismatch_mm, "{}", dialect.name);
        assert!(curves.accepts.mismatch_mm <= curves.accepts.most_mismatch_mm, "{}", dialect.name);
    }
}
