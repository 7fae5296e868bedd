//! Written, read and written again, a program stays what it is, in every dialect that is read.
//!
//! Rounding gives an arc two radii, and a reader moves its centre until they are equal. So a centre may come back as
//! the next number; all other words are the same. A helix of Klartext has an angle about its centre in place of an end,
//! so that helices are left out there.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::{Curve, Direction};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::{Coolant, Cutting, CuttingRequest};
use toolpathd_core::toolpath::program::{Program, Resolution, Units};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Move, Role, Toolpath};
use toolpathd_nc::ReadJob;
use toolpathd_nc::control::{CONTROLS, Control};
use toolpathd_post::{ProgramJob, dialect};

/// Toolpaths of each dialect.
const TOOLPATHS: u64 = 1_000;

/// What a centre that is moved may change in the middle of an arc, mm.
const CENTER_MM: f64 = 0.006;

/// What may change in an end, mm: nothing but rounding.
const END_MM: f64 = 1e-9;

/// What rounding and chords may change in the length of all cuts, as a share of it.
const LENGTH_SHARE: f64 = 1e-3;

/// Random numbers of a seed: the generator SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// A number from `low` to `high`.
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
}

/// Rapids, plunges, lines, and arcs and helices of all planes, with feeds that change.
fn toolpath(random: &mut Random, has_helices: bool) -> Toolpath {
    let place =
        |random: &mut Random, z: f64| Point3::new(random.within(-80.0, 80.0), random.within(-80.0, 80.0), z);
    let mut builder = Toolpath::builder(place(random, 12.0));
    let feed = |random: &mut Random| FeedRate::from_mm_per_min(100.0 * (1 + random.below(20)) as f64);
    for _ in 0..1 + random.below(3) {
        builder.rapid(place(random, 12.0)).unwrap();
        let depth = random.within(-8.0, -0.5);
        let down = Point3::new(builder.at().x, builder.at().y, depth);
        builder.line(down, feed(random), Role::Plunge).unwrap();
        for _ in 0..random.below(8) {
            match random.below(4) {
                0 => builder.dwell(0.5).unwrap(),
                1 => arc(&mut builder, random, feed, has_helices),
                _ => {
                    let to = place(random, builder.at().z);
                    builder.line(to, feed(random), Role::Cut).unwrap();
                }
            }
        }
        let up = Point3::new(builder.at().x, builder.at().y, 12.0);
        builder.rapid_unless_there(up).unwrap();
    }
    builder.finish().unwrap()
}

/// An arc from where the tool is, sometimes a helix.
fn arc(
    builder: &mut toolpathd_core::toolpath::Builder,
    random: &mut Random,
    feed: impl Fn(&mut Random) -> Option<FeedRate>,
    has_helices: bool,
) {
    let plane = [Plane::Xy, Plane::Zx, Plane::Yz][random.below(3) as usize];
    let direction = [Direction::Cw, Direction::Ccw][random.below(2) as usize];
    let (radius, first, turn) =
        (random.within(2.0, 30.0), random.within(0.0, TAU), random.within(0.3, TAU - 0.3));
    let turn = if direction == Direction::Cw { -turn } else { turn };
    let local = plane.to_local(&builder.at());
    let center = Vector3::new(local.x - radius * first.cos(), local.y - radius * first.sin(), local.z);
    let rise = if has_helices && random.below(3) == 0 { random.within(-1.0, 1.0) } else { 0.0 };
    let (sin, cos) = (first + turn).sin_cos();
    let to = Vector3::new(center.x + radius * cos, center.y + radius * sin, local.z + rise);
    let (to, center) = (plane.to_workpiece(&to), plane.to_workpiece(&center));
    let rate = feed(random);
    builder.arc(to, center, (plane, direction), rate, Role::Cut).unwrap();
}

fn cutting() -> Cutting {
    let feed = FeedRate::from_mm_per_min(800.0).unwrap();
    let request = CuttingRequest {
        spindle_rpm: Some(9_000.0),
        coolant: Coolant::Flood,
        ..CuttingRequest::at_feed(feed)
    };
    request.at_heights(20.0, 12.0)
}

/// A program, the bound that it states for its rounding in mm, and the toolpath that its control runs.
struct Written {
    text: String,
    bound_mm: f64,
    read: Toolpath,
}

fn written(toolpath: &Toolpath, control: &'static Control, units: Units) -> Written {
    let decimals = if units == Units::Mm { 3 } else { 4 };
    let program = Program::plain(Resolution { units, decimals });
    let cutting = cutting();
    let job = ProgramJob::plain(&program, &cutting, dialect(control.name).expect("a dialect"));
    let budget = Budget::unlimited();
    let program = toolpathd_post::write(toolpath, &job, &budget).expect("a program");
    let (text, bound_mm) = (program.text, program.max_displacement_mm);
    let job = ReadJob { in_inches: units == Units::Inch, ..ReadJob::plain(text.as_bytes(), control) };
    let read = toolpathd_nc::read(&job, &budget).unwrap_or_else(|error| panic!("{error}\n{text}"));
    Written { text, bound_mm, read: read.toolpath }
}

/// The feed moves of a toolpath.
fn cuts(toolpath: &Toolpath) -> Vec<(Curve, f64)> {
    let feed = |own: &Move| match own {
        Move::Feed { along, rate, .. } => Some((*along, rate.map_or(0.0, |rate| rate.mm_per_min()))),
        _ => None,
    };
    toolpath.moves().filter_map(feed).collect()
}

/// The lines of a program without remarks, and without the words of centres and radii of arcs.
fn without_centers(text: &str) -> Vec<String> {
    let is_kept = |word: &&str| !word.starts_with(['I', 'J', 'K', 'R']) || word.starts_with("R0");
    let lines = text.lines().filter(|line| !line.contains(['(', ';']));
    let words = |line: &str| line.split(' ').filter(is_kept).collect::<Vec<_>>().join(" ");
    lines.filter(|line| !line.contains("CC ")).map(words).collect()
}

#[test]
fn a_program_that_is_read_and_written_again_is_the_same() {
    for (n, control) in CONTROLS.iter().enumerate() {
        let mut random = Random(n as u64);
        for k in 0..TOOLPATHS {
            let units = if k % 5 == 4 { Units::Inch } else { Units::Mm };
            let sent = toolpath(&mut random, control.name != "heidenhain");
            let Written { text: first, bound_mm, read } = written(&sent, control, units);
            let Written { text: second, read: again, .. } = written(&read, control, units);
            let third = written(&again, control, units).text;
            let at = format!("{} {k}\n{first}\n----\n{second}", control.name);
            assert_eq!(without_centers(&second), without_centers(&third), "{at}");
            assert_eq!(cuts(&read).len(), cuts(&again).len(), "{at}");
            for ((one, feed), (other, feed_again)) in cuts(&read).iter().zip(&cuts(&again)) {
                assert_eq!(feed, feed_again, "{at}");
                let apart = (one.start() - other.start()).norm().max((one.end() - other.end()).norm());
                assert!(apart < END_MM, "{apart} {at}");
                let apart = (one.point_at(0.5) - other.point_at(0.5)).norm();
                assert!(apart < CENTER_MM, "{apart} {at}");
            }
            let (own, found) = (cuts(&sent), cuts(&read));
            let ends = |cuts: &[(Curve, f64)]| cuts.last().map(|(along, _)| along.end());
            let apart = ends(&own).zip(ends(&found)).map(|(one, other)| (one - other).norm());
            assert!(apart.is_some_and(|apart| apart <= bound_mm + 1e-9), "{apart:?} {at}");
            let length = |cuts: &[(Curve, f64)]| cuts.iter().map(|(along, _)| along.length()).sum::<f64>();
            let share = (length(&own) - length(&found)).abs() / length(&own);
            assert!(share < LENGTH_SHARE, "{share} {at}");
        }
    }
}
