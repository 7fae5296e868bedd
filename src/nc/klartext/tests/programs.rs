//! Programs as a CAM system or an operator writes them.

use std::f64::consts::PI;

use super::*;

pub const ALL: [&str; 6] = [CONTOUR, PLATE, LEVELS, FLANGE, THREAD, GERMAN];

/// The contour of a plate with rounded corners, from a CAM system.
const CONTOUR: &str = "0  BEGIN PGM PLATE_10 MM
1  ; Generated 12.03.2024
2  BLK FORM 0.1 Z X-5 Y-5 Z-12
3  BLK FORM 0.2 X+105 Y+65 Z+0
4  * - D10 END MILL
5  TOOL CALL 3 Z S4775 DL+0 DR+0
6  TOOL DEF 4
7  M3
8  L  X-15 Y+30 R0 FMAX
9  L  Z+50 R0 FMAX M8
10 L  Z+2 FMAX
11 L  Z-5 F300
12 L  X-5 F764
13 L  Y+55
14 CC X+5 Y+55
15 C  X+5 Y+65 DR-
16 L  X+95
17 CC X+95 Y+55
18 C  X+105 Y+55 DR-
19 L  Y+5
20 CR X+95 Y-5 R+10 DR-
21 L  X+5
22 CT X-5 Y+5
23 L  Y+30
24 L  X-15
25 L  Z+50 R0 FMAX M9
26 M5
27 L  Z-1 R0 FMAX M91
28 M30
29 END PGM PLATE_10 MM
";

#[test]
fn a_contour_of_lines_and_arcs() {
    let reading = whole(CONTOUR);
    let measured = measures(&reading);
    let contour = 25.0 + 90.0 + 50.0 + 90.0 + 25.0 + 20.0 * PI;
    close(&[measured.cutting_length_mm], &[7.0 + 20.0 + contour]);
    close(&[measured.rapid_length_mm], &[48.0 + 55.0]);
    close(&[measured.bounds.max.x, measured.bounds.max.y, measured.bounds.min.y], &[105.0, 65.0, -5.0]);
    assert_eq!(reading.end, [Some(-15.0), Some(30.0), None]);
    assert_eq!(reading.tools[0].number, Some(3));
}

/// Holes at the control: two cycles with a subprogram of places.
const PLATE: &str = "0 BEGIN PGM 4711 MM
1 TOOL CALL \"CENTER_90\" Z S3000
2 L Z+100 R0 FMAX M3
3 CYCL DEF 240 CENTERING ~
  Q200=+2     ;SET-UP CLEARANCE ~
  Q343=+0     ;SELECT DEPTH/DIA. ~
  Q201=-2     ;DEPTH ~
  Q344=-4     ;DIAMETER ~
  Q206=+150   ;FEED RATE FOR PLNGNG ~
  Q211=+0.2   ;DWELL TIME AT DEPTH ~
  Q203=+0     ;SURFACE COORDINATE ~
  Q204=+50    ;2ND SET-UP CLEARANCE
4 CALL LBL 1
5 TOOL CALL 2 Z S1800 F120
6 L Z+100 R0 FMAX M3
7 CYCL DEF 200 DRILLING ~
  Q200=+2     ;SET-UP CLEARANCE ~
  Q201=-24    ;DEPTH ~
  Q206= FAUTO ;FEED RATE FOR PLNGNG ~
  Q202=+10    ;PLUNGING DEPTH ~
  Q210=+0     ;DWELL TIME AT TOP ~
  Q203=+0     ;SURFACE COORDINATE ~
  Q204=+50    ;2ND SET-UP CLEARANCE ~
  Q211=+0     ;DWELL TIME AT DEPTH ~
  Q395=+0     ;DEPTH REFERENCE
8 CALL LBL 1
9 L Z+100 R0 FMAX M2
10 LBL 1
11 L X+10 Y+10 R0 FMAX M99
12 L X+90 M99 FMAX
13 L Y+50 FMAX M99
14 L X+10 FMAX M99
15 LBL 0
16 END PGM 4711 MM
";

#[test]
fn holes_by_two_cycles_and_a_subprogram() {
    let reading = whole(PLATE);
    let measured = measures(&reading);
    // Centring: 4 mm each. Drilling: 12, 12 and 6 mm each.
    close(&[measured.cutting_length_mm, measured.dwell_time_s], &[4.0 * 4.0 + 4.0 * 30.0, 0.8]);
    // The ways to the first place of each tool begin at places that are not known, or at the last place.
    let centring = (98.0 + 4.0 + 48.0) + 3.0 * (48.0 + 4.0 + 48.0);
    let hole = (12.0 + 10.0) + (22.0 + 20.0) + 26.0 + 48.0;
    let drilling = 98.0 + hole + 3.0 * (48.0 + hole) + 40.0 + 50.0;
    close(&[measured.rapid_length_mm], &[centring + 200.0 + drilling + 200.0]);
    assert_eq!(reading.tools[0].name.as_deref(), Some("CENTER_90"));
    assert_eq!((reading.n_rapids_not_counted, reading.tools.len()), (3, 2));
}

/// A slot in levels by a repeated part, with a taper by parameters.
const LEVELS: &str = "0 BEGIN PGM SLOT MM
1 Q1 = 60           ; length
2 Q2 = - 4          ; depth
3 FN 0: Q3 = +4     ; levels
4 Q4 = Q2 / Q3
5 TOOL CALL 7 Z S5000 F800
6 L X+0 Y+0 R0 FMAX M13
7 L Z+1 FMAX
8 L Z+0 F200
9 LBL 1
10 L IZ+Q4 F200
11 L X+Q1 F AUTO
12 L Y+8
13 L X+0
14 L Y+0
15 CALL LBL 1 REP 3
16 L Z+50 R0 FMAX
17 FN 9: IF +Q3 EQU +4 GOTO LBL 99
18 L X+999 F9
19 LBL 99
20 M30
21 END PGM SLOT MM
";

#[test]
fn levels_by_a_repeated_part() {
    let measured = measures(&whole(LEVELS));
    close(&[measured.cutting_length_mm, measured.rapid_length_mm], &[1.0 + 4.0 + 4.0 * 136.0, 54.0]);
    close(&[measured.cutting_time_s.unwrap()], &[5.0 / 200.0 * 60.0 + 544.0 / 800.0 * 60.0]);
    close(&[measured.bounds.min.z], &[-4.0]);
}

/// Holes on a circle by a loop with polar coordinates.
const FLANGE: &str = "0 BEGIN PGM FLANGE MM
1 FN 0: Q10 = +6 ;holes
2 FN 0: Q11 = +40 ;radius
3 Q12 = 360 / Q10
4 Q13 = 0
5 TOOL CALL 12 Z S2000
6 CYCL DEF 7.0 DATUM SHIFT
7 CYCL DEF 7.1 X+50
8 CYCL DEF 7.2 Y+50
9 L Z+20 R0 FMAX M3
10 CYCL DEF 201 REAMING ~
 Q200=2 ;SET-UP CLEARANCE ~
 Q201=-15 ;DEPTH ~
 Q206=80 ;FEED ~
 Q211=0 ;DWELL ~
 Q208=0 ;RETRACTION ~
 Q203=0 ;SURFACE ~
 Q204=5 ;2ND
11 CC X+0 Y+0
12 LBL \"HOLE\"
13 LP PR+Q11 PA+Q13 R0 FMAX M99
14 Q13 = Q13 + Q12
15 FN 12: IF +Q13 LT +360 GOTO LBL \"HOLE\"
16 CYCL DEF 7.0 DATUM SHIFT
17 CYCL DEF 7.1 X+0
18 CYCL DEF 7.2 Y+0
19 L Z+100 R0 FMAX
20 L X+0 Y+0 FMAX M30
21 END PGM FLANGE MM
";

#[test]
fn holes_on_a_circle_by_a_loop() {
    let reading = whole(FLANGE);
    let measured = measures(&reading);
    close(&[measured.cutting_length_mm], &[6.0 * 34.0]);
    // Six chords of 40 mm are sides of a hexagon; five of them are run.
    let down = 18.0 + 5.0 * 3.0;
    let last = (70f64).hypot(50.0 - 20.0 * 3f64.sqrt());
    close(&[measured.rapid_length_mm], &[down + 6.0 * 3.0 + 200.0 + 95.0 + last]);
    assert_eq!(reading.end, [Some(0.0), Some(0.0), Some(100.0)]);
}

/// A thread by a helix, in inches.
const THREAD: &str = "0 BEGIN PGM THREAD INCH
1 TOOL CALL 21 Z S3200
2 L X+0 Y+0 R0 FMAX M3
3 L Z+0.1 FMAX
4 L Z-0.5 F400
5 CC X+0 Y+0
6 L X+0.25 F100
7 CP IPA+1440 IZ+0.4 DR+
8 L X+0 F400
9 L Z+4 R0 FMAX M30
10 END PGM THREAD INCH
";

#[test]
fn a_thread_by_a_helix_in_inches() {
    let measured = measures(&whole(THREAD));
    let helix = (2.0 * PI).hypot(0.4);
    close(&[measured.cutting_length_mm], &[25.4 * (0.6 + 0.25 + helix + 0.25)]);
    close(&[measured.cutting_time_s.unwrap()], &[(0.85 / 40.0 + (0.25 + helix) / 10.0) * 60.0]);
    close(&[measured.rapid_length_mm], &[25.4 * 4.1]);
}

/// Turned slots with rounded corners by another program, and pecking in the older form.
const GERMAN: &str = "0 BEGIN PGM 1234 MM
1 BLK FORM 0.1 Z X-50 Y-50 Z-20
2 BLK FORM 0.2 X+50 Y+50 Z+0
3 TOOL DEF 1 L+0 R+5
4 TOOL CALL 1 Z S1000
5 L Z+50 R0 F MAX M3
6 LBL 10
7 CALL PGM NUT
8 CYCL DEF 10.0 DREHUNG
9 CYCL DEF 10.1 IROT+90
10 CALL LBL 10 REP 3/3
11 CYCL DEF 10.0 DREHUNG
12 CYCL DEF 10.1 ROT+0
13 CYCL DEF 1.0 TIEFBOHREN
14 CYCL DEF 1.1 ABST 2
15 CYCL DEF 1.2 TIEFE -18
16 CYCL DEF 1.3 ZUSTLG 6
17 CYCL DEF 1.4 V.ZEIT 0,5
18 CYCL DEF 1.5 F90
19 L X+0 Y+0 R0 F MAX
20 L Z+2 F MAX M99
21 L Z+50 F MAX M2
22 END PGM 1234 MM

0 BEGIN PGM NUT MM
1 L X+20 Y-5 R0 F MAX
2 L Z+2 F MAX
3 L Z-3 F100
4 L X+40 F300
5 RND R3
6 L Y+5
7 CHF 2
8 L X+20
9 L Z+50 F MAX
10 END PGM NUT MM
";

#[test]
fn turned_slots_and_pecking_in_german() {
    let reading = whole(GERMAN);
    let measured = measures(&reading);
    let slot = 5.0 + 50.0 - 6.0 - 4.0 + 1.5 * PI + 2.0 * 2f64.sqrt();
    // Infeeds to 6, 12 and 18 mm from 2 mm above, and from 0.6 mm above the last bottom.
    let hole = 8.0 + 6.6 + 6.6;
    close(&[measured.cutting_length_mm, measured.dwell_time_s], &[4.0 * slot + hole, 0.5]);
    close(&[measured.bounds.max.x, measured.bounds.min.y, measured.bounds.max.y], &[40.0, -40.0, 40.0]);
    assert_eq!(reading.end, [Some(0.0), Some(0.0), Some(50.0)]);
}
