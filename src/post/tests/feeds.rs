//! The F of every dialect states the feed that was asked for, or the program says that it is slower.

use super::posed::text_of;
use super::*;
use crate::dialects::deckel::DECKEL;
use crate::dialects::heidenhain::HEIDENHAIN;
use crate::dialects::okuma::OKUMA;
use crate::read::PosedFeed;
use nalgebra::{Unit, UnitVector3};
use toolpathd_core::machine::{Straying, named};

/// Largest part by which a word may be slower without a word about the difference.
const CLOSE: f64 = 0.01;

/// Largest part by which a word may be faster: the rounding to the nearest number.
const FASTER: f64 = 5e-4;

/// A plunge and a cut, each with its feed in mm/min.
fn plunge_and_cut(plunge: f64, cut: f64) -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 12.0));
    path.line(Point3::new(0.0, 0.0, -1.0), feed(plunge), Role::Plunge).unwrap();
    path.line(Point3::new(30.0, 0.0, -1.0), feed(cut), Role::Cut).unwrap();
    path.finish().unwrap()
}

fn written_with(dialect: &Dialect, units: Units, path: &Toolpath) -> Result<NcProgram, WriteError> {
    let decimals = match units {
        Units::Mm => dialect.default_decimals_mm,
        Units::Inch => dialect.default_decimals_inch,
    };
    let program = Program::plain(Resolution { units, decimals });
    let cutting = Cutting { coolant: Coolant::Off, ..cutting() };
    let tool = Tool { length_offset: None, ..TOOL };
    let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
    write(path, &job, &Budget::unlimited())
}

/// The feeds of the cutting moves of a program in mm/min, as its control reads them.
fn feeds_of(text: &str, dialect: &Dialect) -> Vec<f64> {
    let read = Reader::new(text, dialect, 0.05).filter_map(|placed| match placed.unwrap().step {
        Step::Feed { rate, .. } => Some(rate.mm_per_min()),
        _ => None,
    });
    read.collect()
}

/// The smallest number above zero that F can state, mm/min.
fn smallest_mm_per_min(dialect: &Dialect, units: Units) -> f64 {
    let tenths = if dialect.name == "heidenhain" && units == Units::Inch { 0.1 } else { 1.0 };
    units.mm() * tenths / 10f64.powi(i32::from(dialect.numbers.max_feed_decimals))
}

/// Fails unless a program states these feeds, or says that it does not.
fn judge(dialect: &Dialect, units: Units, [plunge, cut]: [f64; 2]) {
    let path = plunge_and_cut(plunge, cut);
    let told = format!("{} {units:?} {plunge} {cut}", dialect.name);
    let smallest = smallest_mm_per_min(dialect, units);
    let program = match written_with(dialect, units, &path) {
        Err(WriteError::Feed { mm_per_min }) => {
            assert!(mm_per_min < smallest && [plunge, cut].contains(&mm_per_min), "{told}: {mm_per_min}");
            return;
        }
        program => program.unwrap(),
    };
    let read = feeds_of(&program.text, dialect);
    assert_eq!(read.len(), 2, "{told}\n{}", program.text);
    let mut n_coarse = 0;
    for (read, asked) in read.into_iter().zip([plunge, cut]) {
        assert!(read > 0.0 && read <= (1.0 + FASTER) * asked, "{told}: {read}");
        // No number in between is nearer from below.
        assert!(read > 0.998 * asked - smallest * 1.000_001, "{told}: {read}");
        n_coarse += usize::from(read < (1.0 - CLOSE) * asked);
    }
    let coarse = coarse_feeds(&path, dialect, units, None);
    assert_eq!(coarse.map_or(0, |coarse| coarse.moves), n_coarse, "{told}");
    let is_said = says_slow(&program.text);
    assert_eq!(is_said, n_coarse > 0 && dialect.abilities.has_comments, "{told}\n{}", program.text);
}

/// Whether a program says that F cannot state a feed.
fn says_slow(text: &str) -> bool {
    ["FEEDS ARE", "FEED IS"]
        .iter()
        .any(|feeds| text.contains(&format!("{feeds} TOO SLOW FOR THE DECIMALS OF F")))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_dialect_states_a_feed_within_a_hundredth_or_says_so(
        plunge in -1.7f64..4.3, cut in -1.7f64..4.3,
    ) {
        for dialect in DIALECTS {
            for units in dialect.abilities.units {
                judge(dialect, *units, [plunge, cut].map(|power| 10f64.powf(power)));
            }
        }
    }
}

#[test]
fn a_slow_feed_in_inches_is_written_by_every_dialect() {
    for (dialect, asked, word) in [
        (&OKUMA, 7.8, "F0.307"),
        (&OKUMA, 7.772_4, "F0.306"),
        // 0.0305 inches: the nearest number would be 1.6 % too fast.
        (&OKUMA, 0.774_7, "F0.030"),
        (&OKUMA, 0.026, "F0.001"),
        (&HEIDENHAIN, 7.8, "F3.071"),
        (&HEIDENHAIN, 0.026, "F0.010"),
        (&FANUC, 0.02, "F0.000787"),
        (&LINUXCNC, 7.8, "F0.3071"),
    ] {
        let text = written_with(dialect, Units::Inch, &plunge_and_cut(asked, 500.0)).unwrap().text;
        let has = text.lines().any(|line| line.split(' ').any(|part| part == word));
        assert!(has, "{asked} {word}\n{text}");
    }
}

#[test]
fn a_program_says_how_slow_feeds_are_written_and_counts_their_time() {
    let path = plunge_and_cut(0.0283, 0.001_9);
    let text = written_with(&OKUMA, Units::Mm, &path).unwrap().text;
    assert!(text.contains("F0.028") && text.contains("F0.001"), "{text}");
    let said = "2 FEEDS ARE TOO SLOW FOR THE DECIMALS OF F - 0.001900 MM PER MIN IS WRITTEN AS 0.0010";
    assert!(text.replace(")\n(WARNING = ", " ").contains(said), "{text}");
    // 13 mm at 0.028 and 30 mm at 0.001 mm/min.
    let coarse = coarse_feeds(&path, &OKUMA, Units::Mm, None).unwrap();
    let late_s = 60.0 * (13.0 / 0.028 - 13.0 / 0.0283 + 30.0 / 0.001 - 30.0 / 0.0019);
    assert!((coarse.by_s - late_s).abs() < 1e-6 * late_s, "{coarse:?}");
    let hours = (60.0 * (13.0 / 0.028 + 30.0 / 0.001) / 3600.0) as u64;
    assert!(text.contains(&format!("TIME = {hours} H ")), "{text}");
}

#[test]
fn a_feed_below_the_smallest_number_is_refused() {
    for (dialect, units, least) in [
        (&OKUMA, Units::Mm, 0.001),
        (&OKUMA, Units::Inch, 0.0254),
        (&HEIDENHAIN, Units::Inch, 0.002_54),
        (&DECKEL, Units::Mm, 0.001),
    ] {
        let at =
            |mm_per_min: f64| written_with(dialect, units, &plunge_and_cut(mm_per_min, 500.0)).map(|_| ());
        assert_eq!(at(1.001 * least), Ok(()), "{} {units:?}", dialect.name);
        let low = 0.99 * least;
        assert_eq!(at(low), Err(WriteError::Feed { mm_per_min: low }), "{} {units:?}", dialect.name);
    }
}

#[test]
fn slow_feeds_of_a_leaning_tool_are_written_for_heidenhain() {
    let table = named::by_name("table_table_ac").unwrap();
    let coarse = Straying { tip_mm: 1.0, axis: 1.0 };
    for mm_per_min in [0.0283, 0.1237, 3.333_3, 800.0] {
        let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 12.0));
        let axis: UnitVector3<f64> = Unit::new_normalize(Vector3::new(0.0, 0.6, 0.8));
        path.begin_leaning_pass(None, axis);
        path.line(Point3::new(20.0, 0.0, 12.0), feed(mm_per_min), Role::Cut).unwrap();
        // A turn of a hundredth of a degree in a minute.
        let turned = Unit::new_normalize(Vector3::new(0.0, 0.600_14, 0.799_9));
        path.turn(turned, Some(60.0), Role::Cut).unwrap();
        let path = path.finish().unwrap();
        for output in [AxisOutput::Angles, AxisOutput::Vectors] {
            let program = text_of(&HEIDENHAIN, &path, output, Some(&table), coarse).unwrap();
            let posed = Reader::new(&program.text, &HEIDENHAIN, 0.0015).filter_map(|placed| {
                match placed.unwrap().step {
                    Step::Posed(posed) => Some(posed.feed),
                    _ => None,
                }
            });
            let feeds: Vec<PosedFeed> = posed.filter(|feed| *feed != PosedFeed::Rapid).collect();
            let [PosedFeed::Feed(tip), PosedFeed::DegreesPerMinute(turn)] = feeds[..] else {
                panic!("{feeds:?}\n{}", program.text)
            };
            let read = tip.mm_per_min();
            assert!((0.008..=0.012).contains(&turn), "{turn}");
            let is_said = says_slow(&program.text);
            assert!(read > 0.0 && read <= (1.0 + FASTER) * mm_per_min, "{read} {}", program.text);
            assert_eq!(read < (1.0 - CLOSE) * mm_per_min, is_said, "{read} {}", program.text);
        }
    }
}
