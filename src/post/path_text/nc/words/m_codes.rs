//! M codes of RS274/NGC, Fanuc, Siemens and Klartext.

use super::super::super::table::{Row, left, read, refused};

/// The codes: M3.
pub const M_CODES: &[Row] = &[
    left("M0, M60", "", "M0", "before or behind the path; a stop between motions is refused"),
    left("M1", "", "M1", "an answer has no optional stop"),
    read("M30, M2, M17", "", "M30", "ends the program; the lines behind it are left alone"),
    read("M3, M13", "", "M3 S5000", "clockwise at S in the answer's program; M13 with coolant"),
    refused(
        "M4, M14",
        "M4 S5000",
        "the answer's program turns the spindle clockwise; cut with a clockwise tool",
    ),
    read("M5", "", "M5", "spindle off; a cut behind it is refused where one stands before it"),
    read("M6", "", "T1 M6", "the tool of T; a second tool behind a cut is refused"),
    read("M8, M7, M9", "", "M8", "the coolant of the answer's program, on from its start to its end"),
    left("M11, M10", "", "M11", "clamps of rotary axes"),
    left("M19", "P Q R", "M19", "the answer's program stops no spindle at an angle"),
    refused("M29", "M29 S500", "write no tapping"),
    left("M48, M49, M50, M51, M52, M53", "P", "M48", "overrides of the control"),
    refused("M61", "M61 Q1", "call the tool with T and M6"),
    refused(
        "M64, M62, M63, M65, M66, M67, M68",
        "M64 P1",
        "an answer sets and awaits no signals; leave the line out",
    ),
    refused("M70, M71, M72, M73", "M70", "write the modes themselves"),
    left("M88, M89", "", "M88", "coolant through the spindle; the answer has flood or mist"),
    left(
        "M91, M92",
        "",
        "L Z-1 R0 FMAX M91",
        "coordinates of the machine: before or behind the path, else refused",
    ),
    refused("M98, M96, M97, M99, M198", "M98 P1000", "write the motions of the subprogram, and end with M30"),
    refused(
        "M136, M103, M109, M110, M118, M140, M144",
        "M136",
        "write feeds by the minute, and the motion as lines",
    ),
    left(
        "M126, M107, M108, M116, M117, M120, M127, M137",
        "",
        "M126",
        "how the control drives to the same places",
    ),
    read("M128", "F", "M128", "tip control begins; F is the speed of its own motions"),
    read("M129", "", "M129", "tip control ends"),
    read("M428", "", "M428", "LinuxCNC: tip control begins"),
    read("M429", "", "M429", "LinuxCNC: tip control ends"),
    refused("M430", "M430", "its kinematics are the user's own; use M428 or M429"),
];
