//! Programs of leaning tools: golden texts, an evaluator of its own for random toolpaths, and faults that the
//! check has to find.

use std::cell::Cell;

use nalgebra::{Unit, UnitVector3};

use super::*;
use crate::dialects::heidenhain::HEIDENHAIN;
use crate::dialects::mach4::MACH4;
use crate::dialects::siemens::SIEMENS;
use crate::path_text::tokens::block;
use toolpathd_core::machine::{AxisPositions, Machine, Straying, named};
use toolpathd_core::toolpath::Move;
use toolpathd_core::toolpath::pose::Pose;

const ALLOWED: Straying = Straying { tip_mm: 0.002, axis: 1e-4 };

fn unit(i: f64, j: f64, k: f64) -> UnitVector3<f64> {
    Unit::new_normalize(Vector3::new(i, j, k))
}

/// Down along a leaning axis, across with a swing, a turn about the tip, and up.
pub fn leaning() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 16.0, 12.0));
    path.begin_leaning_pass(None, unit(0.0, 0.8, 0.6));
    path.line(Point3::origin(), feed(400.0), Role::LeadIn).unwrap();
    path.turn_next(unit(0.0, 0.6, 0.8)).unwrap();
    path.line(Point3::new(20.0, 0.0, 1.0), feed(800.0), Role::Cut).unwrap();
    path.turn(unit(0.6, 0.0, 0.8), Some(0.5), Role::Cut).unwrap();
    path.dwell(0.25).unwrap();
    path.line(Point3::new(32.0, 0.0, 17.0), feed(400.0), Role::LeadOut).unwrap();
    path.finish().unwrap()
}

pub fn text_of(
    dialect: &Dialect,
    toolpath: &Toolpath,
    output: AxisOutput,
    machine: Option<&Machine>,
    allowed: Straying,
) -> Result<NcProgram, WriteError> {
    let (program, cutting) = (Program::plain(MM), cutting());
    let five_axes = Some(FiveAxes { output, machine, allowed, speeds: [f64::INFINITY; 5] });
    let length_offset = TOOL.length_offset.filter(|_| dialect.abilities.length_offsets.is_some());
    let job = ProgramJob {
        tool: Some(&Tool { length_offset, ..TOOL }),
        five_axes,
        ..ProgramJob::plain(&program, &cutting, dialect)
    };
    write(toolpath, &job, &Budget::unlimited())
}

/// The lines of motion of a program.
fn body(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with(['(', '%', 'O'])).collect()
}

#[test]
fn each_output_is_written_as_its_control_reads_it() {
    let coarse = Straying { tip_mm: 1.0, axis: 1.0 };
    let table = named::by_name("table_table_ac").unwrap();
    let angles = text_of(&FANUC, &leaning(), AxisOutput::Angles, Some(&table), coarse).unwrap().text;
    assert_eq!(
        body(&angles),
        [
            "G21",
            "G17 G90 G40 G49 G80 G94",
            "T3 M6",
            "S12000 M3",
            "M8",
            "G0 A-53.1301 C-180.0000",
            "X0.000 Y26.400",
            "G43.4 H4 X0.000 Y16.000 Z45.000",
            "Z12.000",
            "G1 Y0.000 Z0.000 F400.",
            "X20.000 Z1.000 A-36.8699 F800.",
            "G93 C-90.0000 F120.",
            "G4 P250",
            "G94 X32.000 Z17.000 F400.",
            "G0 Z45.000",
            "G49",
            "M5",
            "M9",
            "M30",
        ]
    );
    let vectors = text_of(&FANUC, &leaning(), AxisOutput::Vectors, None, coarse).unwrap().text;
    assert_eq!(
        body(&vectors)[5..],
        [
            "G0 G43.5 H4 X0.000 Y16.000 I0.0000000 J0.8000000 K0.6000000",
            "Z45.000 I0.0000000 J0.8000000 K0.6000000",
            "Z12.000 I0.0000000 J0.8000000 K0.6000000",
            "G1 Y0.000 Z0.000 I0.0000000 J0.8000000 K0.6000000 F400.",
            "X20.000 Z1.000 I0.0000000 J0.6000000 K0.8000000 F800.",
            "G93 I0.6000000 J0.0000000 K0.8000000 F120.",
            "G4 P250",
            "G94 X32.000 Z17.000 I0.6000000 J0.0000000 K0.8000000 F400.",
            "G0 Z45.000 I0.6000000 J0.0000000 K0.8000000",
            "G49",
            "M5",
            "M9",
            "M30",
        ]
    );
    let machine = text_of(
        &LINUXCNC,
        &leaning(),
        AxisOutput::Machine,
        Some(&table),
        Straying { tip_mm: 10.0, axis: 1.0 },
    );
    assert_eq!(
        body(&machine.unwrap().text),
        [
            "G17 G21 G90 G40 G49 G80 G94",
            "G64 P0.001 Q0",
            "T3 M6",
            "G43 H4",
            "S12000 M3",
            "M8",
            "G0 A-53.13010 C-180.00000",
            "X0.000 Y0.000",
            "Z20.000",
            "G93 G1 Z0.000 F20",
            "X-20.000 Y0.600 Z0.800 A-36.86990 F39.95",
            // The way of the axis on the great circle is no straight way of the angles.
            "X-14.142 Y-12.025 Z7.509 A-27.93835 C-135.00000 F240",
            "X0.000 Y-15.400 Z12.800 A-36.86990 C-90.00000 F240",
            "G4 P0.250",
            "Z32.800 F20",
            "G0 Z45.000",
            "G94",
            "M5",
            "M9",
            "M30",
        ]
    );
}

#[test]
fn a_leaning_toolpath_needs_a_way_to_say_so() {
    assert_eq!(written(&leaning(), &Program::plain(MM), &cutting(), &[]), Err(WriteError::MachineMissing));
    let table = named::by_name("table_table_ac").unwrap();
    for (dialect, output, machine, error) in [
        (&FANUC, AxisOutput::Angles, None, WriteError::MachineMissing),
        (&LINUXCNC, AxisOutput::Machine, None, WriteError::MachineMissing),
        (&LINUXCNC, AxisOutput::Angles, None, WriteError::MachineMissing),
        (&MACH4, AxisOutput::Angles, Some(&table), WriteError::AxisOutput),
        (&LINUXCNC, AxisOutput::Vectors, None, WriteError::AxisOutput),
    ] {
        assert_eq!(text_of(dialect, &leaning(), output, machine, ALLOWED).unwrap_err(), error);
    }
}

#[test]
fn a_changed_block_fails_the_check() {
    let table = named::by_name("table_table_ac").unwrap();
    let (program, cutting) = (Program::plain(MM), cutting());
    let coarse = Straying { tip_mm: 1.0, axis: 1.0 };
    for (output, changes) in [
        (
            AxisOutput::Angles,
            [
                ("A-36.8699", "A-36.8698", "axis"),
                ("C-90.0000", "C-89.9999", "axis"),
                ("F120.", "F121.", "feed"),
                ("G43.4 H4 X0.000", "G43.4 H4 X0.001", "place"),
                ("G43.4", "G43", "place"),
                ("X0.000 Y26.400", "X0.000 Y26.401", "place"),
                ("X20.000 Z1.000", "X20.000 Z1.001", "place"),
                ("G93 C-90", "C-90", "feed"),
                ("G94 X32", "X32", "feed"),
            ],
        ),
        (
            AxisOutput::Vectors,
            [
                ("K0.6000000 F400", "K0.6000001 F400", "axis"),
                ("I0.6000000 J0", "I-.6000000 J0", "axis"),
                ("F120.", "F12.", "feed"),
                ("X20.000", "X20.001", "place"),
                ("X0.000 Y16.000", "X0.001 Y16.000", "place"),
                ("F800.", "F80.", "feed"),
                ("G94 X32", "X32", "feed"),
                ("G0 Z45", "G1 Z45", "feed"),
                ("G1 Y0", "G0 Y0", "feed"),
            ],
        ),
    ] {
        let five_axes =
            Some(FiveAxes { output, machine: Some(&table), allowed: coarse, speeds: [f64::INFINITY; 5] });
        let job =
            ProgramJob { tool: Some(&TOOL), five_axes, ..ProgramJob::plain(&program, &cutting, &FANUC) };
        let text = write(&leaning(), &job, &Budget::unlimited()).unwrap().text;
        for (from, to, what) in changes {
            assert!(text.contains(from), "{from} {text}");
            let changed = text.replacen(from, to, 1);
            let error = check_text(&changed, &leaning(), &job).unwrap_err();
            let found = match error {
                WriteError::Differs { what, .. } => what,
                WriteError::Unreadable(_) => "no reading",
                _ => "another error",
            };
            assert_eq!(found, what, "{from} {to} {error}");
        }
    }
}

/// The places of a program at its blocks of motion, by a reading of its own: coordinates, angles in radians,
/// the vector.
fn places(text: &str, machine: &Machine) -> Vec<([f64; 3], [f64; 2], [f64; 3])> {
    let (mut at, mut angles, mut vector) = ([0.0; 3], [0.0; 2], [0.0; 3]);
    let mut places = Vec::new();
    let mut has_begun = false;
    for line in body(text) {
        let words = block(line, true).unwrap().words;
        let mut moves = false;
        for word in &words {
            let Some(value) = word.value else { continue };
            let letter = word.name.chars().next().unwrap();
            let set = |all: &mut [f64], names: &str, value: f64| {
                names.find(letter).map(|k| all[k] = value).is_some()
            };
            moves |= set(&mut at, "XYZ", value);
            moves |= set(&mut vector, "IJK", value);
            if let Some(k) = machine.rotary().iter().position(|axis| axis.name == letter) {
                angles[k] = value.to_radians();
                moves = true;
            }
            has_begun |= word.name == "G" && value == 1.0;
        }
        if moves && has_begun {
            places.push((at, angles, vector));
        } else if moves {
            places = vec![(at, angles, vector)];
        }
    }
    places
}

/// The pose a control has at a part of the way between two places.
fn pose_at(
    output: AxisOutput,
    machine: &Machine,
    [from, to]: [&([f64; 3], [f64; 2], [f64; 3]); 2],
    part: f64,
) -> Pose {
    let mean = |a: f64, b: f64| a + (b - a) * part;
    let place = [0, 1, 2].map(|k| mean(from.0[k], to.0[k]));
    let rotary = [0, 1].map(|k| mean(from.1[k], to.1[k]));
    let pose = machine.forward(&AxisPositions { linear_mm: place, rotary });
    match output {
        AxisOutput::Machine => pose,
        AxisOutput::Angles => Pose { tip: place.into(), ..pose },
        AxisOutput::Vectors | AxisOutput::Rails => {
            let [a, b] = [from.2, to.2].map(|v| unit(v[0], v[1], v[2]));
            Pose { tip: place.into(), axis: toolpathd_core::toolpath::tool_axes::between(&a, &b, part) }
        }
    }
}

/// The poses at the ends of the straight moves of a toolpath without curves.
fn poses(toolpath: &Toolpath) -> Vec<Pose> {
    let mut all = Vec::new();
    for pass in toolpath.passes() {
        if all.is_empty() {
            all.push(Pose { tip: toolpath.start(), axis: pass.axes().start() });
        }
        for (k, step) in pass.moves().iter().enumerate() {
            let axis = pass.axes().after(k);
            let tip = match step {
                Move::Rapid { line } => line.end,
                Move::Feed { along, .. } => along.end(),
                Move::Turn { at, .. } => *at,
                Move::Dwell { .. } => continue,
            };
            all.push(Pose { tip, axis });
        }
    }
    all
}

fn random_path() -> impl Strategy<Value = Toolpath> {
    let step = (-20.0..20.0, -20.0..20.0, -20.0..20.0f64, -0.4..0.4, -0.4..0.4f64, 0u8..6);
    (proptest::collection::vec(step, 1..7), 0.2..0.7f64, -0.3..0.3f64).prop_map(|(steps, i, j)| {
        let mut axis = Vector3::new(i, j, 1.0);
        let mut at = Point3::new(5.0, -3.0, 10.0);
        let mut path = Toolpath::builder(at);
        path.begin_leaning_pass(None, Unit::new_normalize(axis));
        for (x, y, z, i, j, kind) in steps {
            axis += Vector3::new(i, j, 0.0);
            // Off the pole, where the angles of the machines are certain.
            axis.x = axis.x.max(0.15);
            let next = Unit::new_normalize(axis);
            if kind == 0 {
                path.turn(next, Some(0.3), Role::Cut).unwrap();
                continue;
            }
            at += Vector3::new(x, y, z);
            path.turn_next(next).unwrap();
            if kind == 1 {
                path.rapid(at).unwrap();
            } else {
                path.line(at, feed(500.0), Role::Cut).unwrap();
            }
        }
        path.finish().unwrap()
    })
}

/// Random paths of one test, and the fewest of them that have to be written: the others turn farther than a
/// control follows.
const PATHS: u32 = 60;
const LEAST_WRITTEN: u32 = 15;

/// Every place that a control runs through is near the toolpath, in order, and every pose of the toolpath is
/// reached.
#[test]
fn a_control_runs_near_the_toolpath() {
    let written = Cell::new(0);
    proptest!(ProptestConfig::with_cases(PATHS), |(path in random_path(), k in 0usize..6, way in 0usize..3)| {
        let machine = &named::named()[k];
        let (dialect, output) = [
            (&FANUC, AxisOutput::Angles),
            (&FANUC, AxisOutput::Vectors),
            (&LINUXCNC, AxisOutput::Machine),
        ][way];
        let found = match text_of(dialect, &path, output, Some(machine), ALLOWED) {
            Ok(found) => found,
            Err(WriteError::NotFollowed { .. } | WriteError::NearPole { .. }) => return Ok(()),
            Err(error) => panic!("{error}"),
        };
        written.set(written.get() + 1);
        // The allowance is met before the words are rounded: half a unit of each coordinate.
        prop_assert!(found.max_displacement_mm <= ALLOWED.tip_mm + MM.step_mm());
        prop_assert!(found.max_displacement_axis <= ALLOWED.axis + 1e-5);
        let places = places(&found.text, machine);
        let given = poses(&path);
        let (within, turned) = (found.max_displacement_mm + 1e-9, found.max_displacement_axis + 1e-9);
        // Along the toolpath by its legs, in order.
        let mut leg = 0;
        let is_near = |pose: &Pose, leg: usize| {
            let (from, to) = (&given[leg], &given[leg + 1]);
            (0..=400).any(|n| {
                let at = from.between(to, f64::from(n) / 400.0);
                let angle = at.axis.cross(&pose.axis).norm().atan2(at.axis.dot(&pose.axis));
                let spacing = (to.tip - from.tip).norm() / 800.0;
                let slack = from.axis.angle(&to.axis) / 800.0;
                (at.tip - pose.tip).norm() <= within + spacing && angle <= turned + slack
            })
        };
        let n = places.iter().rposition(|place| place.0[2] != 45.0).unwrap() + 1;
        for pair in places[..n].windows(2) {
            for part in [0.0, 0.3, 0.5, 0.8, 1.0] {
                let pose = pose_at(output, machine, [&pair[0], &pair[1]], part);
                while !is_near(&pose, leg) {
                    leg += 1;
                    prop_assert!(leg + 1 < given.len(), "{pose:?} is on no leg\n{}", found.text);
                }
            }
        }
        // A leg that turns back over the one before it begins where that has passed.
        let last = pose_at(output, machine, [&places[n - 1], &places[n - 1]], 1.0);
        while leg + 2 < given.len() && is_near(&last, leg + 1) {
            leg += 1;
        }
        prop_assert_eq!(leg, given.len() - 2);
    });
    assert!(written.get() >= LEAST_WRITTEN, "{} of {PATHS} paths were written", written.get());
}

/// What a control with tip control reads are the poses of the toolpath, in order: to half a unit of each
/// coordinate, and to 1e-4 degrees of the axis.
#[test]
fn a_control_reads_the_poses() {
    let written = Cell::new(0);
    proptest!(ProptestConfig::with_cases(PATHS), |(
        path in random_path(), k in 0usize..6,
        dialect in prop::sample::select(vec![&FANUC, &SIEMENS, &HEIDENHAIN]), has_vectors: bool,
    )| {
        let machine = &named::named()[k];
        let output = if has_vectors { AxisOutput::Vectors } else { AxisOutput::Angles };
        let found = match text_of(dialect, &path, output, Some(machine), ALLOWED) {
            Err(WriteError::NotFollowed { .. } | WriteError::NearPole { .. }) => return Ok(()),
            found => found.unwrap(),
        };
        written.set(written.get() + 1);
        let mut given = poses(&path).into_iter().peekable();
        for placed in Reader::new(&found.text, dialect, 0.01) {
            let Step::Posed(read) = placed.unwrap().step else { continue };
            let [Some(x), Some(y), Some(z)] = read.to else { continue };
            let axis = match (output, read.vector) {
                (AxisOutput::Vectors, Some([i, j, k])) => unit(i, j, k),
                (AxisOutput::Vectors, None) => continue,
                _ => {
                    let of_axis = |name| read.angles["ABC".find(name).unwrap()].unwrap().to_radians();
                    let rotary = machine.rotary().each_ref().map(|axis| of_axis(axis.name));
                    machine.forward(&AxisPositions { linear_mm: [0.0; 3], rotary }).axis
                }
            };
            let is_reached = |pose: &Pose| {
                let off = pose.tip - Point3::new(x, y, z);
                off.amax() <= 0.5 * MM.step_mm() + 1e-9
                    && pose.axis.cross(&axis).norm().atan2(pose.axis.dot(&axis)).to_degrees() <= 1e-4
            };
            // Poses that are the same when they are rounded stand in one block.
            while given.next_if(is_reached).is_some() {}
        }
        prop_assert!(given.peek().is_none(), "{:?} is not reached\n{}", given.peek(), found.text);
    });
    assert!(written.get() >= LEAST_WRITTEN, "{} of {PATHS} paths were written", written.get());
}
