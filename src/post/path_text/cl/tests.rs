//! Tests of the reader of CL data.

use super::*;
use crate::path_text::{LeftWord, Said};
use toolpathd_core::machine::Straying;
use toolpathd_core::toolpath::units::FeedRate;

const FILE: &str = "$$ a blade\nPARTNO/BLADE 7\nUNITS/MM\nMULTAX/ON\nLOADTL/3,ADJUST,1\nSPINDL/8000,RPM,CLW\n\
    FROM/0,0,100\nRAPID\nGOTO/10.0,0.0,50.0,0.0,0.6,0.8\nFEDRAT/500,MMPM\nGOTO/10.0,0.0,5.0\n\
    FEDRAT/MMPM,1500.0\nGOTO/ 1.1D+01, 0.5, $\n  5.25, 0.6,0.0,0.8\nCOOLNT/OFF\nGOTO/12,1,5\nFEDRAT/0.1,MMPR\n\
    GODLTA/0,0,1.5\nFINI\nGOTO/1,1,1\n";

fn reading() -> ReadSettings {
    ReadSettings { feed: None, limit: 1000, chords: Straying { tip_mm: 0.001, axis: 1e-4 } }
}

fn feeds(text: &PathText) -> Vec<Option<f64>> {
    let feed = |pace| match pace {
        Pace::Rapid => None,
        Pace::Feed(feed) => Some(FeedRate::mm_per_min(feed)),
    };
    text.path.iter().map(|at| feed(at.pace)).collect()
}

fn tips(text: &PathText) -> Vec<[f64; 3]> {
    text.path.iter().map(|at| at.pose.tip.into()).collect()
}

fn fault(text: &str) -> (usize, PathFault) {
    let error = read(text, reading()).expect_err(text);
    (error.line, error.fault)
}

#[test]
fn a_file_is_read_with_its_axes_and_paces() {
    let text = read(FILE, reading()).unwrap();
    let expected = [
        [0.0, 0.0, 100.0],
        [10.0, 0.0, 50.0],
        [10.0, 0.0, 5.0],
        [11.0, 0.5, 5.25],
        [12.0, 1.0, 5.0],
        [12.0, 1.0, 6.5],
    ];
    assert_eq!(tips(&text), expected);
    assert_eq!(feeds(&text), [None, None, Some(500.0), Some(1500.0), Some(1500.0), Some(800.0)]);
    let path = &text.path;
    assert!((path[2].pose.axis.y - 0.6).abs() < 1e-15 && (path[4].pose.axis.x - 0.6).abs() < 1e-15);
    assert_eq!(path[0].pose.axis, Vector3::z_axis());
    assert!(path.iter().all(|at| at.rotary.is_none()));
}

#[test]
fn the_first_point_behind_a_feed_is_reached_at_this_feed() {
    let first = |text: &str| read(text, reading()).unwrap().path[0].pace;
    let feed = Pace::Feed(FeedRate::from_mm_per_min(500.0).unwrap());
    assert_eq!(first("FEDRAT/500,MMPM\nGOTO/0,0,0\nGOTO/10,0,0\n"), feed);
    assert_eq!(first("FEDRAT/500,MMPM\nRAPID\nGOTO/0,0,0\nGOTO/10,0,0\n"), Pace::Rapid);
    assert_eq!(first("GOTO/0,0,0\nFEDRAT/500,MMPM\nGOTO/10,0,0\n"), Pace::Rapid);
}

#[test]
fn what_a_program_can_hold_is_carried_over() {
    let text = read(
        &FILE.replace("COOLNT/OFF", "PPRINT/HALF WAY").replace("RAPID", "COOLNT/MIST\nRAPID"),
        reading(),
    );
    let text = text.unwrap();
    assert_eq!(text.tool, Some(Said { value: 3, line: 5 }));
    assert_eq!(text.spindle_rpm, Some(Said { value: 8000.0, line: 6 }));
    assert_eq!(text.coolant, Some(Said { value: Coolant::Mist, line: 8 }));
    assert_eq!(
        (text.name.as_deref(), text.comments.as_slice()),
        (Some("BLADE 7"), ["a blade".to_owned()].as_slice())
    );
    let left = |word: &str, line| LeftWord { word: word.to_owned(), count: 1, line };
    assert_eq!(text.left_alone, [left("comment", 16), left("behind FINI", 21)]);
}

#[test]
fn inches_become_millimetres() {
    let text = read("UNITS/INCHES\nGOTO/1,0,0\nFEDRAT/10\nGODLTA/1,0,0\nGODLTA/1\n", reading()).unwrap();
    assert_eq!(tips(&text), [[25.4, 0.0, 0.0], [50.8, 0.0, 0.0], [50.8, 0.0, 25.4]]);
    assert_eq!(feeds(&text), [None, Some(254.0), Some(254.0)]);
}

#[test]
fn spellings_of_every_system_are_read() {
    let plain = read("GOTO/1,2,3,0,0,1\nRAPID\nGOTO/1,2,4\n", reading()).unwrap();
    for text in [
        "goto / 1.,2. ,+3,0,0,1\nrapid,goto/1,2,4\n",
        "LAB1) GOTO/1,2, $$ a place\n3,0,0,1\nRAPID\nGOTO/1,2,4",
        "GOTO/1,2,$\n$$ between\n3,0,0,1\nRAPID\nGOTO/1,2,4",
        "TLAXIS/0,0,2\nGOTO/1,2,3\nFEDRAT/RAPID\nGOTO/1,2,4\nCYCLE/OFF\nCUTCOM/OFF\nTRANS/0,0,0",
    ] {
        let read = read(text, reading());
        if text.contains("2, $$") {
            // A comment continues no statement.
            assert_eq!(read.unwrap_err().fault, PathFault::Blank);
        } else {
            assert_eq!(read.expect(text).path, plain.path, "{text}");
        }
    }
}

#[test]
fn a_feed_by_turns_follows_the_speed_of_each_cut() {
    let text = "GOTO/0,0,0\nFEDRAT/0.1,MMPR\nSPINDL/1000,RPM\nGOTO/1,0,0\n";
    assert_eq!(feeds(&read(text, reading()).unwrap()), [None, Some(100.0)]);
    assert_eq!(fault("GOTO/0,0,0\nFEDRAT/0.1,IPR\nGOTO/1,0,0\n"), (3, PathFault::NoSpindle));
}

#[test]
fn a_circle_is_followed_to_its_line_within_the_chords() {
    let text = |line: &str| {
        format!(
            "FEDRAT/500,MMPM\nGOTO/0,0,0,0,0,1\nINDIRV/0,1,0\n\
            TLON,GOFWD/ (CIRCLE/ 10.0, 0.0, 0.0, 10.0),ON,{line}\nGOTO/30,0,0,0,.05,1\n"
        )
    };
    let half = read(&text("(LINE/ 10.0, 0.0, 0.0, 20.0, 0.0, 0.0)"), reading()).unwrap();
    let arc = &half.path[..half.path.len() - 1];
    assert!((arc[arc.len() - 1].pose.tip - Point3::new(20.0, 0.0, 0.0)).norm() < 1e-12);
    for pair in arc.windows(2) {
        let middle = pair[0].pose.between(&pair[1].pose, 0.5).tip;
        let off = 10.0 - (middle - Point3::new(10.0, 0.0, 0.0)).norm();
        assert!((0.0..=0.001).contains(&off) && middle.y > 0.0, "{middle} is {off} mm off");
    }
    // Half a turn within a micrometre needs 111 chords of a radius of 10 mm.
    assert!((112..130).contains(&arc.len()), "{} poses", arc.len());
    // The first crossing of a line aside, and the second one.
    let quarter = read(&text("(LINE/ 10.0, 0.0, 0.0, 10.0, 10.0, 0.0)"), reading()).unwrap();
    let last = quarter.path[quarter.path.len() - 2].pose.tip;
    assert!((last - Point3::new(10.0, 10.0, 0.0)).norm() < 1e-12, "{last}");
    let second = read(&text("2,INTOF,(LINE/ 10.0, 0.0, 0.0, 10.0, -10.0, 0.0)"), reading()).unwrap();
    let last = second.path[second.path.len() - 2].pose.tip;
    assert!((last - Point3::new(10.0, -10.0, 0.0)).norm() < 1e-12, "{last}");
}

#[test]
fn circles_that_are_not_certain_are_refused() {
    let after = |line: &str| fault(&format!("FEDRAT/500\nGOTO/0,0,0\nINDIRV/0,1,0\n{line}\n"));
    let line = "ON,(LINE/10,0,0,20,0,0)";
    assert_eq!(
        after(&format!("INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/10,0,0,10),{line}")).1,
        PathFault::NoDirection
    );
    assert!(matches!(after(&format!("TLON,GOFWD/(CIRCLE/10,0,0,9),{line}")), (4, PathFault::Radii { .. })));
    let beyond = "TLON,GOFWD/(CIRCLE/10,0,0,10),ON,(LINE/0,50,0,20,50,0)";
    assert_eq!(after(beyond), (4, PathFault::ArcEnd));
    // The line names an end that the tool meets only after another crossing.
    let other = "TLON,GOFWD/(CIRCLE/10,0,0,10),ON,(LINE/10,0,0,10,-10,0)";
    assert_eq!(after(other), (4, PathFault::ArcEnd));
    assert!(matches!(
        after("TLON,GOFWD/(CIRCLE/10,0,0,10),PAST,(LINE/1,0,0,2,0,0)"),
        (4, PathFault::Unused(_))
    ));
}

#[test]
fn a_second_tool_another_speed_and_a_stop_between_cuts_are_refused_where_they_stand() {
    let cut = |words: &str| {
        fault(&format!(
            "LOADTL/1\nSPINDL/9000,RPM,CLW\nFEDRAT/9\nGOTO/0,0,0\nGOTO/9,0,0\n{words}\nGOTO/20,0,0\n"
        ))
    };
    assert_eq!(cut("LOADTL/2"), (6, PathFault::SecondTool { first: Some(1), second: 2 }));
    assert_eq!(cut("SPINDL/2000,RPM"), (6, PathFault::SpindleChanges));
    assert_eq!(cut("SPINDL/OFF"), (6, PathFault::SpindleChanges));
    assert_eq!(cut("STOP"), (6, PathFault::Stops { word: "STOP" }));
    for word in ["GOHOME", "END"] {
        assert_eq!(cut(word), (6, PathFault::Leaves { word: word.into() }));
    }
    assert_eq!(cut("FROM/0,0,0"), (6, PathFault::Leaves { word: "FROM".into() }));
    let late = fault("FEDRAT/9\nGOTO/0,0,0\nGOTO/9,0,0\nLOADTL/2\nGOTO/20,0,0\n");
    assert_eq!(late, (4, PathFault::SecondTool { first: None, second: 2 }));
    // Coolant may change: the answer cools from its start to its end, and says so.
    let text = "FEDRAT/9\nGOTO/0,0,0\nGOTO/9,0,0\nCOOLNT/ON\nGOTO/20,0,0\n";
    let text = read(text, reading()).unwrap();
    assert_eq!(text.coolant, Some(Said { value: Coolant::Flood, line: 4 }));
    assert_eq!(text.left_alone, [LeftWord { word: "COOLNT".into(), count: 1, line: 4 }]);
}

#[test]
fn what_is_not_read_is_refused_with_its_line() {
    for (text, line, expected) in [
        ("GOTO/1,2,3\nGOTO/1,2\n", 2, PathFault::Count(2)),
        ("GOTO/1,2,x\n", 1, PathFault::BadNumber("X".into())),
        ("GOTO/1,,3\n", 1, PathFault::Blank),
        ("GOTO/1,nan,3\n", 1, PathFault::BadNumber("NAN".into())),
        ("GOTO/1,2,3,0,0,0\n", 1, PathFault::NoAxis),
        ("GOTO/1,2,3e9\n", 1, PathFault::Coordinate),
        ("GOTO/1,2,3\n\nGOTO/1,2,4\n", 3, PathFault::NoFeed),
        ("GODLTA/1\n", 1, PathFault::NoStart),
        ("$$\nGOTO/1,2,$\n3,4,$\n5\n", 2, PathFault::Count(5)),
        ("FEDRAT/-3\n", 1, PathFault::BadFeed(-3.0)),
        ("FEDRAT/500,INVERS\n", 1, PathFault::Unused("INVERS".into())),
        ("no CL data at all\n", 1, PathFault::Unknown("NO CL DATA AT ALL".into())),
        ("UNITS/CM\n", 1, PathFault::Unused("CM".into())),
        ("LOADTL/1.5\n", 1, PathFault::BadNumber("1.5".into())),
    ] {
        assert_eq!(fault(text), (line, expected), "{text}");
    }
    let refused = |text: &str| match fault(text).1 {
        PathFault::Refused { word, .. } => word,
        other => panic!("{text}: {other:?}"),
    };
    for (text, word) in [
        ("CYCLE/DRILL,1", "CYCLE/DRILL"),
        ("CUTCOM/LEFT", "CUTCOM/LEFT"),
        ("SPINDL/900,CCLW", "SPINDL/CCLW"),
        ("SPINDL/90,SFM", "SPINDL/SFM"),
        ("LOADTL/1,TURRET", "LOADTL/TURRET"),
        ("TRANS/1,0,0", "TRANS"),
        ("TRACUT/1,0,0,5,0,1,0,0,0,0,1,0", "TRACUT"),
        ("COPY/1,TRANSL,0,0,5,3", "COPY/TRANSL"),
        ("COPY/2", "COPY"),
        ("CUTCOM/1", "CUTCOM"),
        ("MULTAX/SOME", "MULTAX/SOME"),
    ] {
        assert_eq!(refused(text), word);
    }
    let few = ReadSettings { limit: 1, ..reading() };
    assert_eq!(read("GOTO/1,2,3\nRAPID\nGOTO/1,2,4", few).unwrap_err().fault, PathFault::TooMany(1));
}
