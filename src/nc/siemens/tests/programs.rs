//! Whole programs as a CAM system or an operator writes them, read fully.

use std::f64::consts::PI;

use super::*;

/// A length in closed form, mm.
type Length = fn() -> f64;

/// Programs, with the lengths of their cuts, mm.
pub const PROGRAMS: [(&str, Length); 6] = [
    (FACING, || 2.0 * (6.0 + 120.0) + 3.0 * 50.0),
    (CONTOUR, || 3.0 * (5.0 + 2.0 * (80.0 + 50.0) - 8.0 * 8.0 + 4.0 * 4.0 * PI)),
    (DRILLING, || 4.0 * 5.0 + 3.0 * (14.0 + 4.0) + 3.0 * 14.0 + 6.0 * 28.0),
    (BOLTS, || 8.0 * 11.0 + 8.0 * (21.0 + 12.0)),
    (ROTATED, || 4.0 * (3.0 + 20.0 + 5.0 * PI + 20.0 + 5.0 * PI)),
    (CAM, || 3.0 + 30.0 + 2.5 * PI + 15.0 + 5.0 * 2f64.sqrt() + 25.0 + (2.0 * PI * 8.0).hypot(2.0) + 8.0),
];

/// An operator's program for facing, with R parameters and a loop.
const FACING: &str = r#"%_N_FACING_MPF
;$PATH=/_N_WKS_DIR/_N_PLATE_WPD
; FACING WITH A CUTTER OF 50
N10 G17 G40 G90 G94 G71
N20 R1=120 ; LENGTH
N30 R2=0 R3=2
N40 T="FACE_50" D1
N50 M6
N60 G54 D1 S1200 M3
N70 G0 X-30 Y20
N80 Z50 M8
N90 Z5
NEXT_PASS:
N100 R2=R2+1
N110 G1 Z=5-6*(R2>0) F800
N120 X=R1-30
N130 G0 Z5
N140 X-30 Y=20+R2*40
N150 IF R2<R3 GOTOB NEXT_PASS
N160 G0 Z1
N170 G1 X20 F1200
N180 X70
N190 X20 Y100 ; BACK
N200 G0 Z100 M9
N210 G0 SUPA Z0 D0
N220 M30
"#;

/// A frame with rounded corners in three depths by a subprogram.
const CONTOUR: &str = r#"%_N_FRAME_MPF
N10 G710 G17 G90 G94 G40 G54 G64
N20 T5 M6
N30 S3000 M3 D1 F900
N40 G0 X0 Y25 Z5
N50 FOR R10=1 TO 3
N60 OUTLINE(-2*R10, 8)
N70 ENDFOR
N80 G0 Z50
N90 M30
%_N_OUTLINE_SPF
PROC OUTLINE(REAL LEVEL, REAL CORNER) DISPLOF
G0 Z=LEVEL+5
G1 Z=LEVEL F200
RNDM=CORNER
G1 Y50 F900
X80
Y0
X0
Y25 RNDM=0
G0 Z5
RET
"#;

/// Center drilling, deep holes and threads at the same places.
const DRILLING: &str = r#"N10 G17 G71 G90 G94
N20 T="CENTER" M6
N30 G54 G0 X10 Y10 Z50 D1 S2500 M3
N40 F150 M8
N50 MCALL CYCLE81(10,0,2,-3)
N60 X10 Y10
N70 X40
N80 Y40
N90 X10
N100 MCALL
N110 T="DRILL_6.8" M6
N120 G0 X10 Y10 Z50 D1 S1800 M3
N130 F200
N140 MCALL CYCLE83(10,0,2,,12,,5,0,0.2,0,1,0)
ROW: HOLES1(0,0,0,10,15,3)
N150 MCALL
N160 MCALL CYCLE82(10,0,2,-12,0,0.5)
N170 HOLES1(0,30,0,10,15,3)
N180 MCALL
N190 T="TAP_M8" M6
N200 G0 X10 Y0 Z50 D1
N210 MCALL CYCLE84(10,0,2,-12,,0.5,3,8,,0,400,400)
REPEAT ROW ROW
N220 HOLES1(0,30,0,10,15,3)
N230 MCALL
N240 G0 Z100 M9
N250 M30
"#;

/// Bolt circles about a shifted zero.
const BOLTS: &str = r#"; BOLT CIRCLE
DEF REAL RADIUS_1=40, DEPTH=-9
DEF INT COUNT_1=8
G90 G17 G710 G54
TRANS X100 Y50
T1 D1
M6
S2000 M3 F180 D1
G0 X=RADIUS_1 Y0
Z20
MCALL CYCLE82(20, 0, 2, DEPTH, , 0.3)
HOLES2(0, 0, RADIUS_1, 0, 360/COUNT_1, COUNT_1)
MCALL
T2 D1
M6
S900 M3 F90 D1
G0 X=RADIUS_1 Y0
Z20
MCALL CYCLE83(20, 0, 2, -19, , -6, , 1.5, 0, 0, 1, 0, 3, 0, 1)
HOLES2(0, 0, RADIUS_1, 0, 360/COUNT_1, COUNT_1)
MCALL
TRANS
G0 Z100
M30
"#;

/// A slot at four angles.
const ROTATED: &str = r#"G17 G90 G710 G94 G54
T3 M6
D1 S5000 M3
G0 X0 Y0 Z10
FOR R1=0 TO 3
ROT RPL=R1*90
G0 X30 Y5
Z1
G1 Z-2 F300
G1 X50 F1000
G2 X50 Y-5 CR=5
G1 X30
G2 X30 Y5 I0 J5
G0 Z10
ENDFOR
ROT
G0 X0 Y0
M30
"#;

/// What a CAM system writes: smoothing, corners, a helix.
const CAM: &str = r#"; PART = BRACKET
; POST = MILL 3X
N1 G90 G17 G40 G64 G710 G94
N2 WORKPIECE(,"",,"BOX",112,0,-20,-80,0,0,100,100)
N3 MSG("ROUGHING; 1 OF 2")
N4 CYCLE800()
N5 T="EM_10R1" ; D=10 CR=1
N6 M6
N7 CYCLE832(0.05,_ROUGH,1)
N8 S8000 M3
N9 G54 G0 X0. Y0. D1
N10 Z50. M8
N11 Z3.
N12 G1 Z0. F500.
N13 X35. RND=5. F1200.
N14 Y25. CHR=5.
N15 X5.
N16 G3 X5. Y25. Z-2. I8. J0. F600.
N17 G1 Z6.
N18 CYCLE832(0,_OFF,1)
N19 G0 G53 Z0. D0
N20 M5
N21 M30
"#;

#[test]
fn programs_are_read_fully_with_the_right_length() {
    for (text, length) in PROGRAMS {
        close(&[measures(text).cutting_length_mm], &[length()]);
    }
}
