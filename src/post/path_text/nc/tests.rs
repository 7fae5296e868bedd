//! Tests of the reader of NC programs.

mod controls;

use proptest::prelude::*;

use super::*;
use crate::path_text::{LeftWord, Said};
use toolpathd_core::machine::named::by_name;
use toolpathd_core::machine::{AxisPositions, Straying};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::pose::{Pace, Waypoint};
use toolpathd_core::toolpath::units::FeedRate;

fn reading() -> ReadSettings {
    ReadSettings { feed: None, limit: 1000, chords: Straying { tip_mm: 0.001, axis: 1e-4 } }
}

fn text_of(text: &str) -> Result<PathText, PathTextError> {
    let machine = by_name("table_table_ac").unwrap();
    read(text, Some(&machine), 50.0, reading())
}

fn path_of(text: &str) -> Vec<Waypoint> {
    text_of(text).unwrap_or_else(|error| panic!("{text}: {error}")).path
}

fn fault(text: &str) -> (usize, PathFault) {
    let error = text_of(text).expect_err(text);
    (error.line, error.fault)
}

fn feed(value: f64) -> Pace {
    Pace::Feed(FeedRate::from_mm_per_min(value).unwrap())
}

fn tip(at: &Waypoint) -> [f64; 3] {
    at.pose.tip.into()
}

#[test]
fn the_same_path_is_read_from_every_control() {
    let fanuc = "%\nO0001\nG21 G90 G94\nT1 M6\nG0 A-30. C0.\nG43.4 H1 X0. Y0. Z50.\nG1 Z0. F500.\nX10. Y0.5\nX20. Y1.\nG49\nG91 G28 Z0.\nM30\n%\n";
    let linuxcnc =
        "G21 G90 G94\nT1 M6\nG43 H1\nM428\nG0 X0 Y0 Z50 A-30 C0\nG1 Z0 F500\nX10 Y0.5\nX20 Y1\nM429\nM2\n";
    let vectors = "G90\nG43.5 H1\nG0 X0 Y0 Z50 I0 J-0.5 K0.8660254037844387\nG1 Z0 F500 I0 J-.5 K.8660254037844387\nX10 Y.5 I0 J-.5 K.8660254037844387\nX20 Y1 I0 J-.5 K0.8660254037844387\nM30\n";
    let siemens = "T=\"MILL 6\" D1\nTRAORI\nG0 X0 Y0 Z50 A3=0 B3=-0.5 C3=0.8660254037844387\nG1 Z0 F500\nX10 Y.5\nX20 Y1 A3=0 B3=-0.5 C3=0.8660254037844387\nTRAFOOF\nM30\n";
    let heidenhain = "0 BEGIN PGM 1 MM\n1 BLK FORM 0.1 Z X-50 Y-50 Z-20\n2 TOOL CALL 1 Z S5000\n3 LN X+0 Y+0 Z+50 TX+0 TY-0.5 TZ+0.8660254037844387 FMAX M128\n4 LN Z+0 TX+0 TY-0.5 TZ+0.8660254037844387 F500\n5 LN X+10 Y+0.5 TX+0 TY-0.5 TZ+0.8660254037844387\n6 LN X+20 Y+1 TX+0 TY-0.5 TZ+0.8660254037844387\n7 M129\n8 END PGM 1 MM\n";
    let own = path_of(fanuc);
    assert_eq!(own.len(), 4);
    for text in [linuxcnc, vectors, siemens, heidenhain] {
        let path = path_of(text);
        assert_eq!(path.len(), 4, "{text}");
        for (a, b) in own.iter().zip(&path) {
            assert_eq!((a.pose.tip, a.pace), (b.pose.tip, b.pace), "{text}");
            assert!((a.pose.axis.into_inner() - b.pose.axis.into_inner()).norm() < 1e-9, "{a:?} {b:?}");
        }
    }
}

#[test]
fn inverse_time_gives_the_feed_of_the_tip_or_of_the_top() {
    let text = "G21\nG93\nG43.4 H1\nG0 X0 Y0 Z0 A0 C0\nG1 X10 F30\nX0 A0 F60\nA-57.29577951308232 F6\n";
    let paces: Vec<_> = path_of(text).iter().map(|at| at.pace).collect();
    // 10 mm thirty times a minute, then sixty times.
    assert_eq!(paces[..3], [Pace::Rapid, feed(300.0), feed(600.0)]);
    let Pace::Feed(turn) = paces[3] else { panic!("{paces:?}") };
    assert!((turn.mm_per_min() - 50.0 * 6.0).abs() < 1e-6);
}

#[test]
fn feeds_keep_their_mode() {
    let start = "G21 G90\nG0 X0 Y0 Z0\n";
    assert_eq!(path_of(&format!("{start}G95 G1 X1 F0.1 S1000 M3"))[1].pace, feed(100.0));
    assert_eq!(fault(&format!("{start}G95 G1 X1 F0.1")), (3, PathFault::NoSpindle));
    assert_eq!(path_of(&format!("{start}G20 G1 X1 F10"))[1].pace, feed(254.0));
    // What a change of mode or units makes of a feed is not known.
    for change in ["G95", "G20"] {
        assert_eq!(fault(&format!("{start}G1 X1 F10\n{change}\nX2")).1, PathFault::NoFeed, "{change}");
    }
    assert_eq!(fault(&format!("{start}G1 X1 F10\nG93\nX2")).1, PathFault::NoBlockTime);
    // The F of other words is no feed.
    let text = format!("{start}G1 X1 F500\nG4 F2\nX2\nG52 X10\nX3\nM128 F1000\nG0 X1 Y1 Z1\n");
    let path = text_of(&text.replace("M128 F1000\nG0 X1 Y1 Z1\n", "")).unwrap().path;
    assert_eq!(
        path.iter().map(|at| at.pace).collect::<Vec<_>>(),
        [Pace::Rapid, feed(500.0), feed(500.0), feed(500.0)]
    );
    assert_eq!(tip(&path[3]), [13.0, 0.0, 0.0]);
}

#[test]
fn without_tip_control_coordinates_are_those_of_the_machine() {
    let machine = by_name("table_table_ac").unwrap();
    let path = path_of("G90 G21 G94 F100\nG0 X10 Y0 Z0 A-30 C0\nG1 X20 C45\n");
    let rotary = [-30f64.to_radians(), 45f64.to_radians()];
    let there = machine.forward(&AxisPositions { linear_mm: [20.0, 0.0, 0.0], rotary });
    assert!((path[path.len() - 1].pose.tip - there.tip).norm() < 1e-12);
}

#[test]
fn the_rotary_positions_of_the_program_are_kept_with_their_turns() {
    let path = path_of("F100\nG0 X0 Y0 Z0 A-30\nG1 C350\nC370\nG91 C10\nG90 G2 X2 I1 C420\n");
    let turns: Vec<_> =
        path.iter().map(|at| at.rotary.map(|[a, c]| [a.to_degrees(), c.to_degrees()])).collect();
    assert_eq!(turns[0], None);
    let turns: Vec<[f64; 2]> = turns[1..].iter().map(|own| own.expect("both are stated")).collect();
    assert!(turns.iter().all(|[a, _]| (a + 30.0).abs() < 1e-9), "{turns:?}");
    // Every block turns C evenly, on through 360 degrees, and the arc is the last.
    let mut from = 0.0;
    let mut rest = turns.iter().map(|[_, c]| *c);
    for end in [350.0, 370.0, 380.0, 420.0] {
        let mut block: Vec<f64> = vec![from];
        while block.last().is_none_or(|last| (last - end).abs() > 1e-9) {
            block.push(rest.next().expect("the block ends where it says"));
        }
        let step = (end - from) / (block.len() - 1) as f64;
        assert!(block.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 1e-9), "{block:?}");
        from = end;
    }
    assert_eq!(rest.next(), None);
}

#[test]
fn arcs_of_all_planes_stay_within_the_chords() {
    // The end, the middle of the arc, and the words.
    let up = 0.5f64.sqrt();
    for (words, middle, end) in [
        ("G17 G3 X0 Y10 I-10 J0", [10.0 * up, 10.0 * up, 0.0], [0.0, 10.0, 0.0]),
        ("G17 G3 X0 Y10 R10", [10.0 * up, 10.0 * up, 0.0], [0.0, 10.0, 0.0]),
        ("G2 X0 Y10 R-10", [-10.0 * up, -10.0 * up, 0.0], [0.0, 10.0, 0.0]),
        ("G2 X0 Y10 R10", [10.0 - 10.0 * up, 10.0 - 10.0 * up, 0.0], [0.0, 10.0, 0.0]),
        ("G3 X0 Y10 Z4 I-10", [10.0 * up, 10.0 * up, 2.0], [0.0, 10.0, 4.0]),
        ("G2 I-10", [-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]),
        ("G18 G2 X0 Z10 I-10 K0", [10.0 * up, 0.0, 10.0 * up], [0.0, 0.0, 10.0]),
        ("G19 G3 Y0 Z20 J0 K10", [10.0, 10.0, 10.0], [10.0, 0.0, 20.0]),
        ("G90.1 G3 X0 Y10 I0 J0", [10.0 * up, 10.0 * up, 0.0], [0.0, 10.0, 0.0]),
        ("G91 G3 X-10 Y10 I-10", [10.0 * up, 10.0 * up, 0.0], [0.0, 10.0, 0.0]),
    ] {
        let path = path_of(&format!("G21 G90 G94 F100\nG0 X10 Y0 Z0\n{words}\n"));
        let nearest = path.iter().map(|at| (at.pose.tip - nalgebra::Point3::from(middle)).norm());
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.3, "{words}: {nearest} mm from the middle");
        let off = (path[path.len() - 1].pose.tip - nalgebra::Point3::from(end)).norm();
        assert!(off < 1e-9, "{words}: the end is off by {off} mm");
        assert!(path[1..].iter().all(|at| at.pace == feed(100.0)));
    }
    let path = path_of("G21 G90 G94 F100\nG0 X10 Y0 Z0\nG3 X0 Y10 I-10 J0\n");
    for pair in path.windows(2) {
        let middle = pair[0].pose.between(&pair[1].pose, 0.5).tip;
        let off = 10.0 - middle.coords.norm();
        assert!((0.0..=0.001).contains(&off), "{off}");
    }
}

/// How long the straight ways of a path take, minutes.
fn minutes(path: &[Waypoint]) -> f64 {
    let of = |pair: &[Waypoint]| {
        let Pace::Feed(rate) = pair[1].pace else { panic!("{pair:?}") };
        (pair[1].pose.tip - pair[0].pose.tip).norm() / rate.mm_per_min()
    };
    path.windows(2).map(of).sum()
}

#[test]
fn a_block_under_inverse_time_takes_its_time_whatever_it_is_divided_into() {
    for (words, least) in [
        ("G3 X0 Y10 I-10 J0 F6", 20),
        ("G1 X5 C40 F6", 20),
        ("G1 X5 F6", 1),
        // A tip that creeps while the axis turns: 2 nm in ten seconds.
        ("M428\nG0 X0 Y0 Z0 A0 C0\nG1 X0.000002 A-30 F6", 1),
    ] {
        let path = path_of(&format!("G21 G90 G93\nG0 X10 Y0 Z0 A-30 C0\n{words}\n"));
        let cut = path.iter().rposition(|at| at.pace == Pace::Rapid).unwrap();
        assert!(path.len() - 1 - cut >= least, "{words}: {} poses", path.len());
        let took = minutes(&path[cut..]) * 6.0;
        assert!((took - 1.0).abs() < 1e-9, "{words}: {took} of its time");
    }
}

#[test]
fn a_block_of_inverse_time_that_is_faster_than_any_feed_is_refused() {
    let start = "G21 G90 G93\nG0 X0 Y0 Z0\n";
    assert_eq!(path_of(&format!("{start}G1 X100 F10000"))[1].pace, feed(1e6));
    let fault = fault(&format!("{start}G1 X100 F10001"));
    assert!(matches!(fault, (3, PathFault::TooFast { way_mm: 100.0, .. })), "{fault:?}");
}

#[test]
fn without_tip_control_a_line_follows_the_tip_that_the_axes_carry() {
    let machine = by_name("table_table_ac").unwrap();
    let chords = reading().chords;
    let stand =
        |linear_mm, [a, c]: [f64; 2]| AxisPositions { linear_mm, rotary: [a.to_radians(), c.to_radians()] };
    for (from, to) in [
        (stand([50.0, 0.0, 10.0], [-30.0, 0.0]), stand([50.0, 0.0, 10.0], [-30.0, 10.0])),
        (stand([80.0, 5.0, 0.0], [-80.0, 0.0]), stand([-20.0, 60.0, 40.0], [20.0, 400.0])),
        (stand([0.0, 0.0, 0.0], [0.0, 0.0]), stand([10.0, 0.0, 0.0], [0.0, 90.0])),
    ] {
        let words = |at: &AxisPositions| {
            let ([x, y, z], [a, c]) = (at.linear_mm, at.rotary.map(f64::to_degrees));
            format!("X{x} Y{y} Z{z} A{a} C{c}")
        };
        let path = path_of(&format!("G21 G90 G94\nG0 {}\nG1 {} F1000\n", words(&from), words(&to)));
        let count = path.len() - 1;
        for k in 0..100 * count {
            let part = k as f64 / (100 * count) as f64;
            let between = |from: f64, to: f64| from + (to - from) * part;
            let there = machine.forward(&AxisPositions {
                linear_mm: [0, 1, 2].map(|axis| between(from.linear_mm[axis], to.linear_mm[axis])),
                rotary: [0, 1].map(|axis| between(from.rotary[axis], to.rotary[axis])),
            });
            let own = path[k / 100].pose.between(&path[k / 100 + 1].pose, (k % 100) as f64 / 100.0);
            let (off, turned) = ((own.tip - there.tip).norm(), own.axis.angle(&there.axis));
            // Chords are compared at three places, and a way may leave them by a little more between.
            assert!(
                off <= 1.1 * chords.tip_mm && turned <= 1.1 * chords.axis,
                "{off} mm, {turned} of {count}"
            );
        }
    }
    // A line of the linear axes alone is one pose, and so is one that turns on the great circle.
    assert_eq!(path_of("G90 F100\nG0 X0 Y0 Z0 A-30 C0\nG1 X20\n").len(), 2);
    assert_eq!(path_of("G90 F100\nTRAORI\nORIVECT\nG0 X0 Y0 Z0 A-30 C0\nG1 X20 C90\n").len(), 2);
    // 30,000 turns far from the axis.
    let fault = fault("G90 F100\nG0 X5000 Y0 Z0 A0 C0\nG1 C9999999\n");
    assert!(matches!(fault, (3, PathFault::TooFine { .. })), "{fault:?}");
}

/// Under tip control, angles turn in step: the axis runs on a cone about the axis of C.
#[test]
fn arcs_that_are_not_certain_are_refused() {
    let after = |words: &str| fault(&format!("G21 G90 F100\nG0 X10 Y0 Z0\n{words}\n"));
    assert_eq!(after("G2 X0 Y10"), (3, PathFault::NoCenter));
    assert!(matches!(after("G3 X0 Y9 I-10 J0"), (3, PathFault::Radii { .. })));
    assert_eq!(after("G3 X0 Y10 R5"), (3, PathFault::ArcEnd));
    assert_eq!(after("G3 R5"), (3, PathFault::NoCenter));
    assert_eq!(after("G3 X0 Y10 R10 I-10"), (3, PathFault::Conflict));
    assert!(matches!(after("G3 X0 Y10 I-10 P2"), (3, PathFault::Refused { .. })));
    assert_eq!(after("G1 X0 I5"), (3, PathFault::Unused("I, J or K".into())));
    assert_eq!(after("G1 X0 R5"), (3, PathFault::Unused("R".into())));
    assert_eq!(fault("F100\nG2 X1 Y1 I1 J0"), (2, PathFault::NoStart));
}

#[test]
fn what_a_program_can_hold_is_carried_over() {
    let text = text_of(
        "%\nO0007 (SWARF)\n(FIRST SIDE)\nG21 G54\nT3 M6\nS9000 M3\nM8\nG0 X0 Y0 Z50\nG1 Z0 F500\n(ON)\nM9\nX9\nT4\nM5\nM30\n%\nG1 X5\n",
    );
    let text = text.unwrap();
    assert_eq!(text.tool, Some(Said { value: 3, line: 5 }));
    assert_eq!(text.spindle_rpm, Some(Said { value: 9000.0, line: 6 }));
    assert_eq!(text.coolant, Some(Said { value: Coolant::Flood, line: 7 }));
    assert_eq!((text.work_offset, text.name.as_deref()), (Some(54), Some("SWARF")));
    assert_eq!(text.comments, ["FIRST SIDE"]);
    let left = |word: &str, line| LeftWord { word: word.to_owned(), count: 1, line };
    assert_eq!(
        text.left_alone,
        [left("comment", 10), left("M9", 11), left("behind the end", 17), left("T", 13)]
    );
}

#[test]
fn what_one_request_cannot_hold_is_refused_where_it_stands() {
    let cut = |words: &str| {
        fault(&format!(
            "G21 G90 G94 G54\nT1 M6\nS9000 M3\nG0 X0 Y0 Z50 A0 C0\nG1 Z0 F500\n{words}\nG0 X9 Y0 Z0\nG1 X20\n"
        ))
    };
    assert_eq!(cut("T2 M6"), (6, PathFault::SecondTool { first: Some(1), second: 2 }));
    assert_eq!(cut("S2000"), (6, PathFault::SpindleChanges));
    assert_eq!(cut("M5"), (6, PathFault::SpindleChanges));
    assert_eq!(cut("M0"), (6, PathFault::Stops { word: "M0" }));
    assert_eq!(cut("G55"), (6, PathFault::OffsetChanges));
    for word in ["G28", "G53"] {
        assert_eq!(cut(&format!("{word} Z0")), (6, PathFault::Leaves { word: word.into() }));
    }
    // Between two stretches of tip control the way is not known.
    let text = "G43.4 H1 G0 X0 Y0 Z0\nG1 X5 F100\nG49\nG0 Z100\nG43.4 H1 G0 X0 Y0 Z5\n";
    assert_eq!(fault(text), (4, PathFault::Leaves { word: "G0".into() }));
    assert_eq!(fault("G0 X0 Y0 Z0\nG1 X5 F100\nG43.4 H1\n"), (2, PathFault::OutsideTip));
}

#[test]
fn shifts_are_applied_or_refused() {
    let path = path_of("G90 F100\nG0 X0 Y0 Z0\nG52 X10 Z-1\nG1 X5 Z0\nG91 X1\nG90 G52 X0 Z0\nX1\n");
    assert_eq!(
        path.iter().map(tip).collect::<Vec<_>>(),
        [[0.0; 3], [15.0, 0.0, -1.0], [16.0, 0.0, -1.0], [1.0, 0.0, -1.0]]
    );
    assert_eq!(fault("G43.4 H1 G0 X0 Y0 Z0\nG52 X10\n"), (2, PathFault::Shifted));
    assert_eq!(fault("G52 X10\nG43.4 H1 G0 X0 Y0 Z0\n"), (2, PathFault::Shifted));
    assert!(matches!(fault("G52 C10\n"), (1, PathFault::Refused { .. })));
}

#[test]
fn a_cut_from_an_unknown_place_is_refused() {
    let lost = |words: &str| fault(&format!("F100\nG0 X0 Y0 Z0 A-30 C0\n{words}\nG1 X5\n"));
    for words in ["G43 H1", "T1 M6", "G43.4 H1"] {
        let (line, fault) = lost(words);
        assert_eq!((line, fault), (4, PathFault::NoStart), "{words}");
    }
    assert_eq!(fault("F100\nG1 X5 Y5\n"), (2, PathFault::NoStart));
    assert_eq!(fault("X5 Y5 Z5\n"), (1, PathFault::NoMotion));
    assert_eq!(fault("G1 X5 Y5 Z5 F1\nG80\nX6\n"), (3, PathFault::NoMotion));
    // The approach is a rapid, and the way down is a cut.
    let path = path_of("G0 X0 Y0 Z50\nG43.4 H1 Z50\nG1 Z0 F100\n");
    assert_eq!(path.iter().map(|at| at.pace).collect::<Vec<_>>(), [Pace::Rapid, feed(100.0)]);
}

#[test]
fn every_spelling_of_words_is_read() {
    let plain = path_of("G0 X1 Y2 Z3\nG1 X-1.5 F100\n");
    for text in [
        "g0x1y2z3\ng01 x-1.5f100",
        "N10G00X1Y2Z3(A)\n\nN20 G1 X -1.5 F+100 ; B\n",
        "%\nO0001\nG0 X1 Y2 Z3\nG1 X-1.50 F100\n%\n",
        "G0 X1. Y2. Z3.\nG1 X-1.5 F100\n",
        "/ (OFF)\nG0 X=1 Y=2 Z=3\nG1 X=-1.5 F=100\nM30\nN5 #1=2\n",
    ] {
        assert_eq!(path_of(text), plain, "{text}");
    }
    // A point at the end of a number shows a control that may count thousandths without it.
    let error = fault("G0 X1. Y2. Z3.\nG1 X15 F100\n");
    assert_eq!(error, (2, PathFault::NoPoint { word: "X15".into(), line: 1 }));
    assert_eq!(path_of("M428\nG0 X1. Y2. Z3.\nG1 X15 F100\n").len(), 2);
    for (line, expected) in [
        ("G1 X1 X2", PathFault::Twice("X".into())),
        ("G0 G1 X1", PathFault::Conflict),
        ("X1 2", PathFault::Unknown("2".into())),
        ("G1 X", PathFault::NoNumber("X".into())),
        ("G999", PathFault::Unknown("G999".into())),
        ("HELLO", PathFault::Unknown("HELLO".into())),
        ("G1 X1 (A", PathFault::OpenComment),
        ("G1 X1.2.3", PathFault::BadNumber("1.2.3".into())),
        ("G1 B5", PathFault::NoSuchAxis('B')),
        ("G1 X9999999 F1", PathFault::Coordinate),
        ("G1 X1", PathFault::NoFeed),
        ("G1 X1 F0", PathFault::BadFeed(0.0)),
    ] {
        assert_eq!(fault(&format!("G0 X0 Y0 Z0\n{line}\n")), (2, expected), "{line}");
    }
    assert_eq!(read("G0 X0 Y0 Z0 A5.\n", None, 50.0, reading()).unwrap_err().fault, PathFault::NoMachine);
}

#[test]
fn macros_jumps_cycles_and_turned_planes_are_refused_by_name() {
    for (line, word) in [
        ("G1 X#1 F1", "#"),
        ("IF [#1 GT 2] GOTO 5", "IF"),
        ("GOTO 10", "GOTO"),
        ("WHILE [#1 LT 2] DO1", "WHILE"),
        ("G65 P9010", "G65"),
        ("M98 P1000", "M98"),
        ("M99", "M99"),
        ("o<sub> call", "<"),
        ("O100 sub", "SUB"),
        ("G68.2 X0 Y0 Z0 I1 J2 K3", "G68.2"),
        ("G81 X15 Y0 Z-5 R2 F100", "G81"),
        ("G10 L2 P1 X0", "G10"),
        ("G92 X0", "G92"),
        ("G41 D1", "G41"),
        ("G63 Z-5 F100", "G63"),
        ("G5.1 X1 Y1 I1 J1", "G5.1"),
        ("ROT Z45", "ROT"),
        ("CYCLE800(1)", "CYCLE800"),
        ("CYCLE81(10)", "CYCLE"),
        ("M4 S100", "M4"),
        ("M430", "M430"),
        ("/ G1 X1", "/"),
        ("G1 X1 ,R2", ","),
        ("X=AC(5)", "="),
    ] {
        match fault(&format!("G43.4 H1\nG0 X0 Y0 Z0 A0 C0\n{line}\n")) {
            (3, PathFault::Refused { word: own, .. }) => assert_eq!(own, word, "{line}"),
            other => panic!("{line}: {other:?}"),
        }
    }
}

proptest! {
    #[test]
    fn no_text_panics(text in "([GXYZABCIJKFMNPRST]-?[0-9]{0,4}\\.?[0-9]{0,3} ?|\\n|LN |TX|TRAORI|M128|G43\\.4 |TOOL CALL ){0,60}") {
        let _ = text_of(&text);
    }
}
