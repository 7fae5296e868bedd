//! Rails for Siemens: read back as the same polynomials, and near the toolpath.

use super::*;
use crate::dialects::siemens::SIEMENS;
use crate::read::RailStep;
use toolpathd_core::machine::Straying;
use toolpathd_core::toolpath::rail::{ORDER, Rail};

/// A pass whose rails bend and lean, each with a few chords.
fn railed(rails: &[Rail]) -> Toolpath {
    let mut path = Toolpath::builder(rails[0].tip[0] + Vector3::z() * 5.0);
    let unit = |v: Vector3<f64>| nalgebra::Unit::new_normalize(v);
    path.begin_leaning_pass(None, unit(rails[0].to_second[0]));
    path.line(rails[0].tip[0], feed(400.0), Role::LeadIn).unwrap();
    for rail in rails {
        let first = path.n_moves_of_pass();
        for k in 1..=4 {
            let t = f64::from(k) / 4.0;
            path.turn_next(unit(at(&rail.to_second, t))).unwrap();
            let tip = if k == 4 { rail.tip[5] } else { at(&rail.tip.map(|p| p.coords), t).into() };
            path.line(tip, feed(800.0 + 10.0 * f64::from(k)), Role::Cut).unwrap();
        }
        path.rail(Rail { moves: first..path.n_moves_of_pass(), ..rail.clone() });
    }
    path.turn(unit(Vector3::new(0.1, 0.2, 1.0)), Some(0.5), Role::Cut).unwrap();
    path.line(path.at() + Vector3::z() * 3.0, feed(400.0), Role::LeadOut).unwrap();
    path.finish().unwrap()
}

/// A polynomial by its Bernstein coefficients.
fn at(points: &[Vector3<f64>; ORDER], t: f64) -> Vector3<f64> {
    let mut row = *points;
    for left in (1..ORDER).rev() {
        for k in 0..left {
            row[k] = row[k].lerp(&row[k + 1], t);
        }
    }
    row[0]
}

/// A polynomial as a control runs it: from its start to its end, with the higher powers that were read.
fn run(start: [f64; 3], end: [f64; 3], powers: [[f64; 3]; 4], t: f64) -> Vector3<f64> {
    let [start, end] = [start, end].map(Vector3::from);
    let powers = powers.map(Vector3::from);
    let first = end - start - powers.iter().sum::<Vector3<f64>>();
    powers.iter().zip(2..).fold(start + first * t, |sum, (power, k)| sum + power * t.powi(k))
}

fn in_siemens(path: &Toolpath, resolution: Resolution) -> Result<NcProgram, WriteError> {
    let (program, cutting) = (Program::plain(resolution), cutting());
    let allowed = Straying { tip_mm: 0.01, axis: 1e-3 };
    let five_axes =
        Some(FiveAxes { output: AxisOutput::Rails, machine: None, allowed, speeds: [f64::INFINITY; 5] });
    let job = ProgramJob { tool: Some(&TOOL), five_axes, ..ProgramJob::plain(&program, &cutting, &SIEMENS) };
    write(path, &job, &Budget::unlimited())
}

fn rail(tips: [[f64; 3]; ORDER], tops: [[f64; 2]; ORDER], height: f64) -> Rail {
    Rail {
        moves: 0..0,
        tip: tips.map(Point3::from),
        to_second: tops.map(|[x, y]| Vector3::new(x, y, 1.0) * height),
    }
}

#[test]
fn a_rail_is_written_as_a_polynomial_of_two_points() {
    let tips = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0].map(|x: f64| [x, 0.04 * x * x, 0.0]);
    let tops = [0.0, 0.02, 0.04, 0.06, 0.08, 0.1].map(|x: f64| [x, 0.0]);
    let text = in_siemens(&railed(&[rail(tips, tops, 40.0)]), MM).unwrap().text;
    let body: Vec<&str> = text.lines().skip_while(|line| *line != "TRAORI").collect();
    assert_eq!(
        body[..14],
        [
            "TRAORI",
            "ORIWKS",
            "ORIVECT",
            "POLYPATH(\"AXES\",\"VECT\")",
            "G0 X0.000 Y0.000 A3=0.0000000 B3=0.0000000 C3=1.0000000",
            "Z45.000 A3=0.0000000 B3=0.0000000 C3=1.0000000",
            "Z5.000 A3=0.0000000 B3=0.0000000 C3=1.0000000",
            "G1 Z0.000 A3=0.0000000 B3=0.0000000 C3=1.0000000 F400",
            "ORICURVE",
            "X0.000 Y0.000 Z0.000 XH=0.000000 YH=0.000000 ZH=40.000000 F810",
            "POLY PO[X]=(10.000) PO[Y]=(4.000,3.200000) PO[Z]=(0.000) PO[XH]=(14.000000) PO[YH]=(4.000000,3.200000) \
             PO[ZH]=(40.000000) PL=1",
            "ORIVECT",
            "G93 G1 A3=0.0975900 B3=0.1951800 C3=0.9759001 F120",
            "G94 Z3.000 A3=0.0975900 B3=0.1951800 C3=0.9759001 F400",
        ],
        "{text}"
    );
    for (from, to) in [
        ("3.200000)", "3.200001)"),
        ("PO[X]=(10.000)", "PO[X]=(10.001)"),
        ("XH=0.000000", "XH=0.000001"),
        ("PO[ZH]=(40", "PO[ZH]=(41"),
        ("PL=1", "PL=2"),
        ("ORICURVE\n", ""),
        ("POLYPATH", "; POLYPATH"),
        ("\"AXES\",", ""),
        ("\nORIVECT\nG93", "\nG93"),
        ("F810", "F811"),
    ] {
        let spoiled = text.replacen(from, to, 1);
        assert!(spoiled != text);
        let read: Result<Vec<Step>, _> =
            Reader::new(&spoiled, &SIEMENS, 0.0015).map(|placed| placed.map(|placed| placed.step)).collect();
        let meant: Vec<Step> =
            Reader::new(&text, &SIEMENS, 0.0015).map(|placed| placed.unwrap().step).collect();
        assert!(read.is_err() || read.unwrap() != meant, "{from} {to}");
    }
}

/// A rail runs at the slowest of its feeds, and the program says how long it takes.
#[test]
fn a_rail_takes_the_time_of_its_slowest_feed() {
    let mut path = Toolpath::builder(Point3::origin());
    let up = nalgebra::Unit::new_normalize(Vector3::new(0.1, 0.0, 1.0));
    path.begin_leaning_pass(None, up);
    let first = path.n_moves_of_pass();
    for (x, rate) in [(50.0, 300.0), (100.0, 3000.0)] {
        path.line(Point3::new(x, 0.0, 0.0), feed(rate), Role::Cut).unwrap();
    }
    let tip = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0].map(|x| Point3::new(x, 0.0, 0.0));
    path.rail(Rail { moves: first..path.n_moves_of_pass(), tip, to_second: [up.into_inner() * 50.0; ORDER] });
    let text = in_siemens(&path.finish().unwrap(), MM).unwrap().text;
    assert!(text.contains("F300\n") && text.contains("TIME = 20 S"), "{text}");
}

fn rails() -> impl Strategy<Value = Vec<Rail>> {
    let hop = (
        prop::array::uniform5(prop::array::uniform3(-8.0..8.0f64)),
        prop::array::uniform5(prop::array::uniform2(-0.2..0.2f64)),
    );
    (prop::collection::vec(hop, 1..6), 5.0..200.0f64).prop_map(|(hops, height)| {
        let (mut tip, mut top) = ([3.0, -2.0, 4.0], [0.1, 0.0]);
        let mut rails = Vec::new();
        for (tips, tops) in hops {
            let mut all = [tip; ORDER];
            let mut leans = [top; ORDER];
            for k in 0..5 {
                tip = [0, 1, 2].map(|axis| tip[axis] + tips[k][axis]);
                top = [0, 1].map(|axis| (top[axis] + tops[k][axis]).clamp(-0.8, 0.8));
                (all[k + 1], leans[k + 1]) = (tip, top);
            }
            rails.push(rail(all, leans, height));
        }
        rails
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// The control runs the polynomials of the rails, to half a unit for the tip and 1e-4 degrees for the
    /// axis.
    #[test]
    fn rails_read_back_are_the_rails(rails in rails(), inch: bool) {
        let resolution = if inch { INCH } else { MM };
        let written = in_siemens(&railed(&rails), resolution).unwrap();
        let steps: Vec<RailStep> = Reader::new(&written.text, &SIEMENS, 0.01)
            .filter_map(|placed| match placed.unwrap().step {
                Step::Rail(rail) => Some(rail),
                _ => None,
            })
            .collect();
        // The first states where the second point is.
        prop_assert_eq!(steps.len(), rails.len() + 1);
        let half_unit = 0.5 * 3f64.sqrt() * resolution.step_mm() + 2e-5 * resolution.units.mm();
        for (rail, step) in rails.iter().zip(&steps[1..]) {
            for k in 0..=20 {
                let t = f64::from(k) / 20.0;
                let tip = run(step.from, step.to, step.powers[0], t);
                let second = run(step.second_from, step.second, step.powers[1], t);
                let off = (tip - at(&rail.tip.map(|p| p.coords), t)).norm();
                prop_assert!(off <= half_unit && off <= written.max_displacement_mm + 1e-9, "{off}");
                let turned = (second - tip).angle(&at(&rail.to_second, t));
                prop_assert!(turned <= written.max_displacement_axis + 1e-9);
                // A short distance of the two points magnifies the rounding of the coefficients.
                prop_assert!(turned.to_degrees() <= 1e-4 * (40.0 / rail.height_mm()).max(1.0) * resolution.units.mm(), "{turned}");
            }
        }
    }
}
