//! Lines, arcs, corners, frames and units.

use std::f64::consts::{PI, SQRT_2};

use super::*;
use crate::notes::Note;

#[test]
fn words_need_no_blanks_and_expressions_need_an_equals_sign() {
    for (lines, length) in [
        ("G1X10Y0F100", 10.0),
        ("g1 x=5+5 y=0", 10.0),
        ("N10 R1=10 R2=0\nG1 X=R1 Y=R2", 10.0),
        ("G1 X=AC(10)", 10.0),
        ("G91 G1 X10\nX=IC(5) Y=AC(0)\nX=AC(0)", 30.0),
        ("G1 X10\nX=IC(-4)", 14.0),
        ("G1 X10 ; G1 X99\n; X50\n(", 10.0),
        ("/G1 X10", 10.0),
        ("G1 X.5EX1", 5.0),
    ] {
        if lines.ends_with('(') {
            close(&[cut(lines.trim_end_matches('('))], &[length]);
        } else {
            close(&[cut(lines)], &[length]);
        }
    }
    let text = framed("/1 G1 X10\nG1 X20");
    let skips = ReadJob { skips_optional: true, ..job(&text) };
    let end = read(&skips, &Budget::unlimited()).unwrap();
    assert_eq!((end.lines, end.n_lines), (vec![5], 6));
}

#[test]
fn arcs_are_the_same_in_every_form() {
    for (words, length) in [
        ("G2 X10 Y10 I10 J0", 5.0 * PI),
        ("G3 X10 Y10 I10 J0", 15.0 * PI),
        ("G2 X10 Y10 I=AC(10) J=AC(0)", 5.0 * PI),
        ("G2 X10 Y10 CR=10", 5.0 * PI),
        ("G2 X10 Y10 CR=-10", 15.0 * PI),
        ("G2 X10 Y10 AR=90", 5.0 * PI),
        ("G2 X10 Y10 AR=270", 15.0 * PI),
        ("G3 X10 Y0 AR=180", 5.0 * PI),
        ("G2 I10 AR=90", 5.0 * PI),
        ("G3 I10 AR=45", 2.5 * PI),
        ("G3 I-4.5", 9.0 * PI),
        ("G3 X0 Y0 I-4.5", 9.0 * PI),
        ("G3 I-4.5 TURN=2", 27.0 * PI),
        ("G2 X0 Y0 Z3 I5", (10.0 * PI).hypot(3.0)),
        ("G2 X0 Y0 Z6 I5 TURN=2", (30.0 * PI).hypot(6.0)),
        ("G18 G3 X10 Z0 I5 K0", 5.0 * PI),
        ("G19 G2 Y10 Z0 J5 K0", 5.0 * PI),
        ("CIP X10 Y0 I1=5 J1=5", 5.0 * PI),
        ("CIP X10 Y0 Z0 I1=5 J1=0 K1=5", 5.0 * PI),
        ("G91 CIP X10 Y0 I1=5 J1=-5", 5.0 * PI),
        ("G1 X10\nCT X20 Y10", 10.0 + 5.0 * PI),
        ("G1 X10\nCT X20", 20.0),
        ("G111 X10 Y0\nG2 AP=90 RP=10", 5.0 * PI),
        ("G110 X10\nG2 AP=90 RP=10", 5.0 * PI),
    ] {
        close(&[cut(words)], &[length]);
    }
    close(&end("G2 I10 AR=90"), &[10.0, 10.0, 0.0]);
    close(&end("G1 X10\nCT X20 Y10\nCT X10 Y20"), &[10.0, 20.0, 0.0]);
    close(&[cut("G1 X10\nCT X20 Y10\nCT X10 Y20")], &[10.0 + 10.0 * PI]);
    for words in ["G18 G3 X10 I5", "G19 G2 Y10 J5"] {
        let bounds = measures(&framed(words)).bounds;
        close(&[bounds.min.z, bounds.max.z], &[0.0, 5.0]);
    }
}

#[test]
fn polar_coordinates_count_from_their_pole() {
    close(&end("G1 AP=30 RP=10"), &[10.0 * 30f64.to_radians().cos(), 5.0, 0.0]);
    close(&end("G111 X20 Y30\nG1 RP=10 AP=90 Z-1\nAP=180"), &[10.0, 30.0, -1.0]);
    close(&end("G111 X20 Y30\nG112 X1 Y1\nG1 RP=10 AP=0"), &[31.0, 31.0, 0.0]);
    close(&end("G0 X5 Y5\nG110 AP=90 RP=2\nG1 RP=10 AP=0"), &[15.0, 7.0, 0.0]);
    assert_eq!(framed_faults("G18\nG1 AP=0 RP=5"), [(2, "G1 AP=0 RP=5".into(), Fault::NoPole)]);
}

#[test]
fn corners_are_rounded_and_cut_off() {
    let corner = |word: &str| format!("G1 X20 {word}\nY20");
    close(&[cut(&corner("RND=5"))], &[30.0 + 2.5 * PI]);
    close(&[cut(&corner("RNDM=5"))], &[30.0 + 2.5 * PI]);
    close(&[cut(&corner("CHR=5"))], &[30.0 + 5.0 * SQRT_2]);
    close(&[cut(&corner("CHF=5"))], &[40.0 - 5.0 * SQRT_2 + 5.0]);
    close(&[cut("G1 X20 RNDM=5\nY20\nX0\nY0 RNDM=0")], &[80.0 - 30.0 + 7.5 * PI]);
    close(&[cut("G1 X20 RND=5\nX40")], &[40.0]);
    // A slot end: a line to a half circle, rounded on the inner side.
    let measured = measures(&framed("G1 X20 RND=2\nG3 X20 Y20 CR=10"));
    let (inner, leg) = (8.0f64, (8.0f64 * 8.0 - 0.0).sqrt());
    assert!(measured.cutting_length_mm > 20.0 && inner == leg);
    let arc = cut("G1 X20 RND=5\nG2 X30 Y10 CR=10");
    // The centre is 5 from the line y = 0 and 15 from (30, 0); the foot of the line is 30 - sqrt(200).
    let foot = 30.0 - 200f64.sqrt();
    let angle = (5.0f64 / 15.0).asin();
    close(&[arc], &[foot + 5.0 * (PI / 2.0 - angle) + 10.0 * (PI / 2.0 - angle)]);
    // The feed of the corner.
    let time = measures(&framed("G1 X20 CHR=3 FRC=60\nY20")).cutting_time_s.unwrap();
    close(&[time], &[34.0 / 10.0 + 3.0 * SQRT_2]);
    for lines in ["G1 X20 RND=50\nY20", "G1 X20 RND=5\nG0 Y20", "G1 X20 RND=5\nZ5", "G1 X20 RND=5"] {
        assert_eq!(framed_faults(lines)[0].2, Fault::NoCorner, "{lines}");
    }
    close(&[cut("RNDM=2\nG1 X20\nG0 Z5\nG1 Y9")], &[29.0]);
}

#[test]
fn frames_shift_turn_scale_and_mirror() {
    close(&end("TRANS X10 Y5\nG0 X1 Y1"), &[11.0, 6.0, 0.0]);
    close(&end("TRANS X10\nATRANS X5\nG0 X1 Y1\nTRANS\nG0 X2"), &[2.0, 1.0, 0.0]);
    close(&end("ROT RPL=90\nG0 X10 Y0"), &[0.0, 10.0, 0.0]);
    close(&end("TRANS X10\nAROT Z90\nG1 X10 Y0"), &[10.0, 10.0, 0.0]);
    close(&end("SCALE X2 Y2\nG1 X10 Y1"), &[20.0, 2.0, 0.0]);
    close(&end("MIRROR X0\nG1 X10 Y1"), &[-10.0, 1.0, 0.0]);
    close(&end("TRANS X10\nAMIRROR Y1\nASCALE X2\nG1 X10 Y1"), &[30.0, -1.0, 0.0]);
    close(&[cut("MIRROR X0\nG2 X10 Y10 I10 J0")], &[5.0 * PI]);
    close(&[cut("MIRROR X0\nG2 X10 Y10 CR=10\nMIRROR\nG1 X0 Y10")], &[5.0 * PI + 10.0]);
    close(&[cut("MIRROR X0\nG1 X20 RND=5\nY20\nG2 X40 Y40 AR=90")], &[30.0 + 2.5 * PI + 10.0 * PI]);
    close(&[cut("ROT RPL=30\nG1 X10\nCT X20 Y10")], &[10.0 + 5.0 * PI]);
    close(&[cut("SCALE X2 Y2\nG1 X20 RND=5\nY20")], &[60.0 + 5.0 * PI]);
    assert_eq!(framed_faults("SCALE X2\nG2 X10 Y10 I10 J0")[0].2, Fault::Ellipse);
    assert_eq!(framed_faults("ROT X30"), [(1, "X30".into(), Fault::NotRead)]);
    assert_eq!(framed_faults("ROT Z90\nG91 G1 X5"), [(2, "X5".into(), Fault::IncrementOfNewZero)]);
}

#[test]
fn zeros_relate_only_where_they_are_given() {
    let text = framed("G1 X5\nG55\nG0 X0 Y0 Z0\nG1 X3");
    assert!(of(&text).notes.iter().any(|note| matches!(note, Note::UnrelatedOffset { line: 5, .. })));
    assert_eq!(measures(&text).cutting_length_mm, 8.0);
    assert_eq!(of(&text).work_offset, 2);
    let offsets = [(1, [-100.0, 0.0, -50.0]), (505, [-80.0, 0.0, -50.0])];
    let text = framed("G505 G0 X0 Y0 Z0\nG0 SUPA Z0\nG53 X0");
    let reading = read(&ReadJob { offsets: &offsets, ..job(&text) }, &Budget::unlimited()).unwrap();
    assert_eq!((reading.end, reading.work_offset), ([Some(100.0), Some(0.0), Some(50.0)], 505));
    let text = framed("$P_UIFR[2]=CTRANS(X,-80,Y,0,Z,-50)\nG55 G0 X0");
    let reading = read(&ReadJob { offsets: &offsets[..1], ..job(&text) }, &Budget::unlimited()).unwrap();
    assert_eq!(reading.end, [Some(20.0), Some(0.0), Some(0.0)]);
    // D0 puts the tip to a place that is not known.
    let text = framed("G0 X1\nG0 SUPA Z0 D0\nG0 X2");
    let reading = read(&ReadJob { offsets: &offsets, ..job(&text) }, &Budget::unlimited()).unwrap();
    assert_eq!(reading.end, [Some(2.0), Some(0.0), None]);
    let text = framed("G0 Z5\nG74 X1=0 Z1=0\nG0 Y3");
    assert_eq!(of(&text).end, [None, Some(3.0), Some(5.0)].map(|v| v.filter(|v| *v == 3.0)));
    // What was in force before the first selection is a setting.
    let text = "G0 X0 Y0 Z0\nG0 X1\nG54\nG1 X5 F100\nM30";
    assert_eq!(faults(text)[0].2, Fault::UnknownStart('X'));
}

#[test]
fn units_of_lengths_and_feeds_differ() {
    let of_units = |units: &str| {
        let m = measures(&format!("{units} G94\nG0 X0 Y0 Z0\nG1 X1 F60\nM30"));
        [m.cutting_length_mm, m.cutting_time_s.unwrap()]
    };
    close(&of_units("G71"), &[1.0, 1.0]);
    close(&of_units("G70"), &[25.4, 25.4]);
    close(&of_units("G700"), &[25.4, 1.0]);
    close(&of_units("G710"), &[1.0, 1.0]);
    assert!(of("G0 X0 Y0 Z0\nG1 X1 F60\nM30").notes.contains(&Note::BasicUnits { line: 1, units: "mm" }));
    for (words, seconds) in [
        ("G93 G1 X10 F2", 30.0),
        ("G95 G1 X10 F0.1", 6.0),
        ("G94 G1 X10 F60", 10.0),
        ("G97 G1 X10 F0.1", 6.0),
    ] {
        close(&[measures(&framed(words)).cutting_time_s.unwrap()], &[seconds]);
    }
    for (word, seconds) in [("G4 F2.5", 2.5), ("G4 S30", 1.8), ("G4 F=1+1", 2.0)] {
        close(&[measures(&framed(&format!("{word}\nG1 X1"))).dwell_time_s], &[seconds]);
        close(&[measures(&framed(&format!("{word}\nG1 X10"))).cutting_time_s.unwrap()], &[1.0]);
    }
}

#[test]
fn tools_have_numbers_or_names_and_lose_the_height() {
    let text = "G710 G90\nT=\"MILL_10\" D1\nM6\nG0 X0 Y0\nZ5 D1\nS1=2000 M1=3\nG1 Z-1 F60\nT5 M6\nD1\nG0 X9 Z5\nG1 Z0\nM30";
    let reading = of(text);
    let tools: Vec<_> =
        reading.tools.iter().map(|t| (t.number, t.name.as_deref(), t.line, t.cutting_length_mm)).collect();
    assert_eq!(tools, [(None, Some("MILL_10"), 3, 6.0), (Some(5), None, 8, 5.0)]);
    assert_eq!(reading.tools[0].largest_speed_rpm, Some(2000.0));
    // Without any M6 in the text, T changes the tool.
    assert_eq!(
        faults("T1 D1\nG0 X0 Y0 Z0\nG1 X1 F9\nT2 D1\nG1 X2\nM30")[0],
        (5, "G1 X2".into(), Fault::UnknownStart('Z'))
    );
}

#[test]
fn words_that_cannot_change_the_path_are_left_alone_and_counted() {
    let reading = of(&framed(
        "G64 G601 SOFT FFWON COMPCAD CTOL=0.01 G645 ADIS=0.1 H12\nMSG(\"A;B \"<<R5)\nSTOPRE\nWORKPIECE(,\"\",,\"BOX\",112,0,-20,-80,0,0,100,100)\n\
         CYCLE832(0.01,_FINISH,1)\nFGROUP(X,Y) LIMS=5000 LIMS[1]=4000 SPOS=90 SPOS[1]=DC(5) G40 G450 M8 M1 A0 C=0\nTRAFOOF\nG1 X10",
    ));
    let words: Vec<_> = reading.left_alone.iter().map(|left| left.word.as_str()).collect();
    for word in
        ["G64", "SOFT", "CTOL", "MSG", "STOPRE", "WORKPIECE", "CYCLE832", "FGROUP", "H", "M8", "A0", "C0"]
    {
        assert!(words.contains(&word), "{word} {words:?}");
    }
    assert_eq!(measure(&reading.toolpath, FeedRate::DEFAULT_RAPID).cutting_length_mm, 10.0);
}

#[test]
fn an_incremental_way_runs_the_change_of_the_zero_too() {
    // The coordinate of the program goes on from where it was: X5 behind a shift of 10 is X15 of before.
    close(&end("G1 X20\nTRANS X10\nG91 X5"), &[35.0, 0.0, 0.0]);
    close(&end("G1 X20\nTRANS X10\nX=IC(5) Y1\nX=IC(5)"), &[40.0, 1.0, 0.0]);
    close(&end("G1 X20\nTRANS X10\nG91 X0"), &[30.0, 0.0, 0.0]);
    close(&end("G1 X20\nTRANS X10\nATRANS X2\nX=IC(5)"), &[37.0, 0.0, 0.0]);
    // An axis that no block names, or that an absolute place names, runs nothing beside.
    close(&end("G1 X20 Y20\nTRANS X10 Y10\nX5\nX=IC(5)"), &[20.0, 20.0, 0.0]);
    close(&end("G1 X20\nTRANS X10\nTRANS\nX=IC(5)"), &[25.0, 0.0, 0.0]);
    // The shift lies along the axes of a turn that was there before.
    close(&end("ROT Z90\nG1 X20 Y0\nATRANS X10\nX=IC(5)"), &[0.0, 35.0, 0.0]);
    let reading = of(&framed("G1 X20\nTRANS X10\nG91 X5"));
    assert!(reading.notes.iter().any(|note| matches!(note, crate::notes::Note::ShiftTraversed { line: 6 })));
    let offsets = [(1, [0.0; 3]), (2, [7.0, 0.0, 0.0])];
    let text = framed("G1 X20\nG55\nG91 X5");
    let reading = read(&ReadJob { offsets: &offsets, ..job(&text) }, &Budget::unlimited()).unwrap();
    assert_eq!(reading.end[0], Some(32.0));
    // A place of the machine is no start of an incremental way that is certain.
    let on_machine = framed_faults("G1 X20\nSUPA G0 X0\nG91 X5");
    assert_eq!(on_machine[0], (3, "X5".into(), Fault::IncrementOfNewZero));
    assert_eq!(
        framed_faults("TRANS X1\nCIP X=IC(10) I1=IC(5) J1=5"),
        [(2, "I1=IC(5)".into(), Fault::IncrementOfNewZero)]
    );
}

#[test]
fn a_line_ends_at_one_coordinate_and_an_angle() {
    let root = 3f64.sqrt();
    close(&end("G0 X10 Y10\nG1 ANG=60 X20"), &[20.0, 10.0 + 10.0 * root, 0.0]);
    close(&end("G0 X10 Y10\nG1 Y20 ANG=60"), &[10.0 + 10.0 / root, 20.0, 0.0]);
    close(&end("G0 X10 Y10\nG1 ANG=180 X0"), &[0.0, 10.0, 0.0]);
    close(&end("G0 X10 Y10\nG91 G1 ANG=45 X5"), &[15.0, 15.0, 0.0]);
    close(&end("TRANS X100\nG0 X10 Y10\nG1 ANG=60 X20"), &[120.0, 10.0 + 10.0 * root, 0.0]);
    for (lines, fault) in [
        ("G1 ANG=60", Fault::NotRead),
        ("G1 ANG=60 X5 Y5", Fault::NotRead),
        ("G1 ANG=60 X-5", Fault::OutOfRange(60.0)),
        ("G1 ANG=90 X5", Fault::OutOfRange(90.0)),
        ("G0 ANG=60 X5", Fault::UnusedWord),
        ("TRANS X5\nG91 G1 ANG=60 X5", Fault::IncrementOfNewZero),
    ] {
        assert_eq!(framed_faults(lines)[0].2, fault, "{lines}");
    }
}
