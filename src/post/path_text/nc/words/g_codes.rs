//! G codes of RS274/NGC, Fanuc and Siemens.

use super::super::super::table::{Row, left, read, refused};

const POINTS: &str = "write the motion as lines and arcs";
const OWN_REQUESTS: &str = "write coordinates of the work offset, without shifts, turns and scales";

/// The codes with their tenths: G43.4.
pub const G_CODES: &[Row] = &[
    read(
        "G0",
        "",
        "G0 X1 Y2 Z3",
        "rapid; before the path it places the axes, and behind tip control it is left alone",
    ),
    read("G1", "", "G1 X1 Y2 Z3 F500", "line"),
    read(
        "G2, G3",
        "P",
        "G2 X2 Y0 I1 J0 F500",
        "arc or helix in the plane, by I J K or by R, less than two turns",
    ),
    left("G4", "P X U F S", "G4 P1", "a dwell; an answer has none along its path"),
    left("G8, G5, G5.1, G187, G103", "P Q R E", "G8 P1", "smoothing and look-ahead of the control"),
    refused(
        "G5 X, G5.1 X, G5.2, G5.3, G6.2",
        "G5 X1 Y1 I1 J1 P1 Q1",
        "a spline; write the curve as lines or arcs",
    ),
    refused(
        "G7, G7.1, G107",
        "G7",
        "coordinates are no places of the tool under this mode; write X, Y and Z",
    ),
    left(
        "G64, G9, G60, G61, G61.1, G62",
        "P Q",
        "G64 P0.01 Q0.01",
        "exact stop and path control of the control",
    ),
    refused("G10", "G10 L2 P1 X0 Y0 Z0", "set the offsets on the control, and leave the line out"),
    left("G11", "", "G11", "ends G10"),
    refused(
        "G16, G12, G12.1, G112, G13",
        "G16",
        "coordinates are no places of the tool under this mode; write X, Y and Z",
    ),
    read("G15, G13.1, G113, G50.1, G69, G69.1", "X Y Z", "G15", "ends a mode that no read program begins"),
    refused("G17.1, G18.1, G19.1", "G17.1", "planes of U, V and W; write the motion in X, Y and Z"),
    read("G17, G18, G19", "", "G17", "the plane of arcs"),
    read("G21, G20, G70, G71, G700, G710", "", "G21", "inches or mm; the feed has to be stated again"),
    left("G23, G22, G25, G26", "X Y Z I J K S", "G23", "limits that the control watches"),
    left("G28, G30", "X Y Z A B C P", "G28 Z0", "before or behind the path; between motions it is refused"),
    refused(
        "G31, G27, G28.1, G29, G30.1, G37, G50.2, G51.2",
        "G31 Z0 F100",
        "leave the line out, or send what stands before and behind it",
    ),
    refused("G33, G33.1, G34, G63, G76", "G33 Z-5 K1", POINTS),
    refused("G38.2, G38.3, G38.4, G38.5", "G38.2 Z0 F100", "probe in a program of its own"),
    read("G40", "", "G40", "ends compensation of the radius, which no read program begins"),
    refused("G41, G39, G41.1, G41.2, G42, G42.1, G42.2", "G41 D1", "send the path of the centre of the tool"),
    read("G43", "H", "G43 H1", "the length offset: Z has to be stated again"),
    read(
        "G43.4, G43.5, G234",
        "H Q",
        "G43.4 H1 X0 Y0 Z0",
        "tip control begins; G43.5 states the axis as I J K",
    ),
    refused("G43.1, G43.2, G43.7, G44", "G43.1 Z5", "use G43 or G43.4 with one length offset"),
    refused("G45, G46, G47, G48", "G45 X1 D1", POINTS),
    read("G49", "H", "G49", "tip control and the length offset end"),
    left("G50", "S", "G50", "ends scaling, which no read program begins; with S a limit of the spindle"),
    refused(
        "G68.2, G51, G51.1, G68, G68.1, G68.3, G68.4, G53.1, G53.6, G54.4, G254",
        "G68.2 X0 Y0 Z0 I1 J2 K3",
        OWN_REQUESTS,
    ),
    read("G52", "X Y Z", "G52 X1", "moves X, Y and Z; refused under tip control and with rotary axes"),
    left("G53, G153", "X Y Z A B C", "G53 G0 Z0", "before or behind the path; between motions it is refused"),
    read(
        "G54, G55, G56, G57, G58, G59",
        "",
        "G54",
        "the work offset of the answer's program; a second one is refused",
    ),
    left(
        "G54.1, G59.1, G59.2, G59.3, G500",
        "P",
        "G54.1 P3",
        "the answer runs with the offset of program.work_offset",
    ),
    refused("G65, G66, G66.1", "G65 P9010 A1", "write the motions of the macro"),
    left("G67, G255", "", "G67", "ends a mode that no read program begins"),
    refused(
        "G81, G72, G73, G74, G75, G77, G78, G79, G82, G83, G84, G84.2, G84.3, G85, G86, G87, G88, G89",
        "G81 Z-5 R2",
        "write each hole as rapids and lines",
    ),
    read("G80", "", "G80", "ends a cycle; the next motion needs G0, G1, G2 or G3"),
    read("G91, G90", "", "G91", "coordinates from the origin, or from the place before"),
    read("G91.1, G90.1", "", "G91.1", "centres of arcs from the origin, or from the start"),
    refused("G92, G92.3", "G92 X0", OWN_REQUESTS),
    left("G92.1, G92.2", "", "G92.1", "ends shifts that no read program begins"),
    read(
        "G94, G93, G95",
        "",
        "G94",
        "F by the time of the block, by the minute, or by turns of a known speed",
    ),
    refused("G96", "G96 S100", "write the speed in turns by the minute"),
    read("G97", "", "G97", "S counts turns by the minute"),
    left("G98, G99", "", "G98", "the height between the holes of cycles, which are refused"),
    left(
        "G642, G290, G450, G451, G601, G602, G603, G641, G643, G644, G645",
        "",
        "G642",
        "path control of the control",
    ),
];
