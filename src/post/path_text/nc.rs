//! NC programs with five axes: the tip with angles or vectors, or the positions of all axes.
//!
//! | control | keeps the tip from | tool axis |
//! |---|---|---|
//! | Fanuc, Haas, Mazak | G43.4, G234 to G49 | A B C angles |
//! | Fanuc | G43.5 to G49 | I J K vector |
//! | Siemens | TRAORI to TRAFOOF | A3 B3 C3 vector, or A B C angles |
//! | Heidenhain | M128, TCPM to M129 | TX TY TZ vector in LN blocks, or A B C angles |
//!
//! In a program that never keeps the tip, coordinates are the positions of the linear axes of the machine.
//! Where it does, only blocks that keep the tip are part of the path; between two such stretches the path has
//! a rapid.
//!
//! * A coordinate that a block leaves out stays as it was. The path begins where all three are known.
//! * F counts mm or inches by the minute (G94), or one by the minutes of the block (G93).
//! * Arcs, relative coordinates, variables, and planes that are turned or scaled are refused with their line.

use nalgebra::{Point3, UnitVector3, Vector3};

use super::tokens::{Word, words};
use super::{FEEDS_MM_PER_MIN, PathFault, PathTextError, ReadSettings, coordinate, direction, feed};
use crate::nc::{Distance, Effect, FeedMode, Modifier, Motion, PositionEffect, effect};
use toolpathd_core::machine::{AxisPositions, Machine};
use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};
use toolpathd_core::toolpath::program::Units;
use toolpathd_core::toolpath::tool_axes::angle_between;
use toolpathd_core::toolpath::units::FeedRate;

/// Reads the poses of a program. `top_mm` is the distance of the point whose speed is the feed where the tip
/// rests.
///
/// # Errors
/// The first line that cannot be read.
pub fn read(
    text: &str,
    machine: Option<&Machine>,
    top_mm: f64,
    reading: ReadSettings,
) -> Result<Vec<Waypoint>, PathTextError> {
    let mut reader = Reader {
        reading,
        machine,
        top_mm,
        keeps_tip_somewhere: text
            .lines()
            .any(|line| words(line).is_ok_and(|words| words.iter().any(begins_tip))),
        keeps_tip: false,
        path: Vec::new(),
        at: [None; 3],
        angles: [0.0; 2],
        vector: None,
        motion: None,
        unit_mm: 1.0,
        is_relative: false,
        feed_mode: FeedMode::PerMinute,
        feed: None,
        was_left: false,
    };
    for (k, line) in text.lines().enumerate() {
        reader.line(line).map_err(|fault| PathTextError { line: k + 1, fault })?;
    }
    Ok(reader.path)
}

/// Whether from this word on coordinates are those of the tip.
fn begins_tip(word: &Word) -> bool {
    match word.name.as_str() {
        "G" => [43.4, 43.5, 234.0].iter().any(|code| word.value == Some(*code)),
        "M" => word.value == Some(128.0),
        name => name == "TRAORI" || name == "TCPM",
    }
}

fn ends_tip(word: &Word) -> bool {
    match word.name.as_str() {
        "G" => word.value == Some(49.0),
        "M" => word.value == Some(129.0),
        name => name == "TRAFOOF",
    }
}

struct Reader<'a> {
    reading: ReadSettings,
    machine: Option<&'a Machine>,
    top_mm: f64,
    keeps_tip_somewhere: bool,
    keeps_tip: bool,
    path: Vec<Waypoint>,
    at: [Option<f64>; 3],
    /// Of the machine's rotary axes, radians.
    angles: [f64; 2],
    vector: Option<UnitVector3<f64>>,
    motion: Option<Motion>,
    unit_mm: f64,
    is_relative: bool,
    feed_mode: FeedMode,
    feed: Option<f64>,
    /// Since the last pose the tool has moved in a way that is no part of the path.
    was_left: bool,
}

/// What one line says.
#[derive(Default)]
struct Line {
    at: [Option<f64>; 3],
    angles: [Option<f64>; 3],
    vector: [Option<f64>; 3],
    has_feed: bool,
    is_rapid_once: bool,
    /// The coordinates are no place of the path.
    is_elsewhere: bool,
    /// The coordinates move nothing.
    is_idle: bool,
    /// The name of a code that turns or moves the frame of coordinates by those of its line.
    frame: Option<String>,
}

/// Tips that are nearer to each other are the same, mm: far below what a program can say. The block then
/// turns the axis about its tip, and the top moves at the feed.
const SAME_TIP_MM: f64 = 1e-7;

/// Names of codes that turn, move or scale the frame.
const FRAMES: [&str; 9] = ["ROT", "AROT", "TRANS", "ATRANS", "MIRROR", "AMIRROR", "SCALE", "ASCALE", "PLANE"];

impl Reader<'_> {
    fn line(&mut self, text: &str) -> Result<(), PathFault> {
        let text = text.trim();
        if text.starts_with('%') || text.starts_with(';') {
            return Ok(());
        }
        let mut line = Line::default();
        for word in words(text)? {
            self.word(&word, &mut line)?;
        }
        let moves = line.at.iter().chain(&line.angles).chain(&line.vector).any(Option::is_some);
        if !moves || line.is_idle {
            return Ok(());
        }
        if let Some(name) = line.frame {
            return Err(PathFault::NotRead(name));
        }
        if line.is_elsewhere {
            for (at, own) in self.at.iter_mut().zip(line.at) {
                *at = if own.is_some() { None } else { *at };
            }
            self.was_left = true;
            return Ok(());
        }
        if self.is_relative {
            return Err(PathFault::Relative);
        }
        self.go(&line)
    }

    fn word(&mut self, word: &Word, line: &mut Line) -> Result<(), PathFault> {
        if begins_tip(word) {
            self.keeps_tip = true;
        } else if ends_tip(word) {
            self.keeps_tip = false;
            self.was_left = true;
        }
        let Some(value) = word.value else {
            match word.name.as_str() {
                "L" | "LN" => self.motion = Some(Motion::Line),
                "FMAX" => line.is_rapid_once = true,
                "BLK" | "TOOL" | "CYCL" => line.is_idle = true,
                "C" | "CC" | "CR" | "CT" | "CP" | "ORICURVE" | "BSPLINE" | "POLY" | "CIP" => {
                    return Err(PathFault::NotRead(word.name.clone()));
                }
                name if FRAMES.contains(&name) => line.frame = Some(word.name.clone()),
                _ => {}
            }
            return Ok(());
        };
        match word.name.as_str() {
            "CYCLE" if value == 800.0 => return Err(PathFault::NotRead("CYCLE800".to_owned())),
            "G" => self.code(value, line)?,
            "X" => line.at[0] = Some(value),
            "Y" => line.at[1] = Some(value),
            "Z" => line.at[2] = Some(value),
            "A" => line.angles[0] = Some(value),
            "B" => line.angles[1] = Some(value),
            "C" => line.angles[2] = Some(value),
            "I" | "TX" | "A3" => line.vector[0] = Some(value),
            "J" | "TY" | "B3" => line.vector[1] = Some(value),
            "K" | "TZ" | "C3" => line.vector[2] = Some(value),
            "F" => {
                self.feed = Some(value);
                line.has_feed = true;
            }
            "IX" | "IY" | "IZ" | "IA" | "IB" | "IC" => return Err(PathFault::Relative),
            _ => {}
        }
        Ok(())
    }

    fn code(&mut self, code: f64, line: &mut Line) -> Result<(), PathFault> {
        let tenths = (code * 10.0).round();
        let refused = || PathFault::NotRead(format!("G{code}"));
        if !(0.0..1e4).contains(&tenths) {
            return Err(refused());
        }
        match effect(tenths as i32) {
            Effect::Motion(motion) => self.motion = Some(motion),
            Effect::Units(units) => self.unit_mm = if units == Units::Inch { 25.4 } else { 1.0 },
            Effect::Distance(distance) => self.is_relative = distance == Distance::Incremental,
            Effect::FeedMode(FeedMode::PerTurn) => return Err(refused()),
            Effect::FeedMode(mode) => {
                self.feed_mode = mode;
                self.feed = None;
            }
            Effect::Begins(Modifier::ToolCenterPoint | Modifier::ExactStop, _)
            | Effect::Ends(..)
            | Effect::Plane(_)
            | Effect::Centers(_)
            | Effect::Nothing
            | Effect::NoMotion
            // Codes of look-ahead and smoothing have many numbers.
            | Effect::Unknown => {}
            Effect::Begins(..) => return Err(refused()),
            Effect::Position(PositionEffect::Idle) => line.is_idle = true,
            Effect::Position(PositionEffect::Elsewhere | PositionEffect::Taken) => line.is_elsewhere = true,
            Effect::Position(PositionEffect::Shifted | PositionEffect::Kept) => {}
        }
        Ok(())
    }

    /// A block with coordinates or a tool axis.
    fn go(&mut self, line: &Line) -> Result<(), PathFault> {
        for (at, own) in self.at.iter_mut().zip(line.at) {
            if let Some(own) = own {
                *at = Some(coordinate(own * self.unit_mm)?);
            }
        }
        for (letter, angle) in ['A', 'B', 'C'].into_iter().zip(line.angles) {
            let Some(angle) = angle else { continue };
            let machine = self.machine.ok_or(PathFault::NoMachine)?;
            let k = machine.rotary().iter().position(|axis| axis.name == letter);
            self.angles[k.ok_or(PathFault::NoSuchAxis(letter))?] = angle.to_radians();
            self.vector = None;
        }
        let motion = self.motion;
        if matches!(motion, Some(Motion::Arc(_))) {
            return Err(PathFault::Arc);
        }
        if line.vector.iter().any(Option::is_some) {
            self.vector = Some(direction(Vector3::from(line.vector.map(Option::unwrap_or_default)))?);
        }
        let is_part = self.keeps_tip || !self.keeps_tip_somewhere;
        let (Some(motion), [Some(x), Some(y), Some(z)], true) = (motion, self.at, is_part) else {
            self.was_left = true;
            return Ok(());
        };
        let pose = self.pose(Point3::new(x, y, z))?;
        let was_left = std::mem::take(&mut self.was_left);
        let is_rapid = line.is_rapid_once || motion == Motion::Rapid || was_left;
        let pace = match self.path.last() {
            Some(last) if !is_rapid => Pace::Feed(self.feed_to(&pose, &last.pose, line.has_feed)?),
            _ => Pace::Rapid,
        };
        if self.path.len() >= self.reading.limit {
            return Err(PathFault::TooMany(self.reading.limit));
        }
        self.path.push(Waypoint { pose, pace });
        Ok(())
    }

    fn pose(&self, at: Point3<f64>) -> Result<Pose, PathFault> {
        if let Some(axis) = self.vector {
            return Ok(Pose { tip: at, axis });
        }
        let Some(machine) = self.machine else {
            return Ok(Pose { tip: at, axis: Vector3::z_axis() });
        };
        let pose = machine.forward(&AxisPositions { linear_mm: at.coords.into(), rotary: self.angles });
        if self.keeps_tip { Ok(Pose { tip: at, ..pose }) } else { Ok(pose) }
    }

    fn feed_to(&self, to: &Pose, from: &Pose, has_feed: bool) -> Result<FeedRate, PathFault> {
        if self.feed_mode == FeedMode::InverseTime {
            let per_minute = self.feed.filter(|_| has_feed).ok_or(PathFault::NoFeed)?;
            let length = (to.tip - from.tip).norm();
            let turned = angle_between(&to.axis, &from.axis) * self.top_mm;
            let way = if length > SAME_TIP_MM { length } else { turned };
            let (slowest, fastest) = FEEDS_MM_PER_MIN.into_inner();
            // A block that moves nothing has no feed of its own.
            return if way > 0.0 { feed((way * per_minute).clamp(slowest, fastest)) } else { feed(1.0) };
        }
        match (self.feed, self.reading.feed) {
            (Some(own), _) => feed(own * self.unit_mm),
            (None, Some(given)) => Ok(given),
            (None, None) => Err(PathFault::NoFeed),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use toolpathd_core::machine::named::by_name;

    fn reading() -> ReadSettings {
        ReadSettings { feed: None, limit: 1000 }
    }

    fn path_of(text: &str) -> Result<Vec<Waypoint>, PathTextError> {
        let machine = by_name("table_table_ac").unwrap();
        read(text, Some(&machine), 50.0, reading())
    }

    #[test]
    fn the_same_path_is_read_from_every_control() {
        let fanuc = "%\nO0001\nG21 G90 G94\nT1 M6\nG0 A-30. C0.\nG43.4 H1 X0. Y0. Z50.\nG1 Z0. F500.\nX10. Y0.5\nX20. C90.\nG49\nG91 G28 Z0.\nM30\n%\n";
        let vectors = "G90\nG43.5 H1\nG0 X0 Y0 Z50 I0 J-0.5 K0.8660254037844387\nG1 Z0 F500 I0 J-.5 K.8660254037844387\nX10 Y.5 I0 J-.5 K.8660254037844387\nX20 I-0.5 J0 K0.8660254037844387\nM30\n";
        let siemens = "T=\"MILL 6\" D1\nTRAORI\nG0 X0 Y0 Z50 A3=0 B3=-0.5 C3=0.8660254037844387\nG1 Z0 F500\nX10 Y.5\nX20 A3=-0.5 B3=0 C3=0.8660254037844387\nTRAFOOF\nM30\n";
        let heidenhain = "0 BEGIN PGM 1 MM\n1 BLK FORM 0.1 Z X-50 Y-50 Z-20\n2 TOOL CALL 1 Z S5000\n3 LN X+0 Y+0 Z+50 TX+0 TY-0.5 TZ+0.8660254037844387 FMAX M128\n4 LN Z+0 TX+0 TY-0.5 TZ+0.8660254037844387 F500\n5 LN X+10 Y+0.5 TX+0 TY-0.5 TZ+0.8660254037844387\n6 LN X+20 TX-0.5 TY+0 TZ+0.8660254037844387\n7 M129\n8 END PGM 1 MM\n";
        let own = path_of(fanuc).unwrap();
        assert_eq!(own.len(), 4);
        for text in [vectors, siemens, heidenhain] {
            let path = path_of(text).unwrap();
            assert_eq!(path.len(), 4, "{text}");
            for (a, b) in own.iter().zip(&path) {
                assert_eq!((a.pose.tip, a.pace), (b.pose.tip, b.pace), "{text}");
                assert!((a.pose.axis.into_inner() - b.pose.axis.into_inner()).norm() < 1e-9, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn inverse_time_gives_the_feed_of_the_tip_or_of_the_top() {
        let path =
            path_of("G21\nG93\nG0 X0 Y0 Z0 A0 C0\nG43.4 H1\nG1 X10 F60\nX0 A0 F30\nA-57.29577951308232 F6\n")
                .unwrap();
        let feeds: Vec<_> = path.iter().map(|at| at.pace).collect();
        let of = |value| Pace::Feed(FeedRate::from_mm_per_min(value).unwrap());
        // 10 mm sixty times a minute.
        assert_eq!(feeds[..2], [Pace::Rapid, of(300.0)]);
        let Pace::Feed(turn) = feeds[2] else { panic!("{feeds:?}") };
        assert!((turn.mm_per_min() - 50.0 * 6.0).abs() < 1e-6);
    }

    #[test]
    fn without_tip_control_coordinates_are_those_of_the_machine() {
        let machine = by_name("table_table_ac").unwrap();
        let path = path_of("G90 G21 G94 F100\nG0 X10 Y0 Z0 A-30 C0\nG1 X20 C45\n").unwrap();
        let rotary = [-30f64.to_radians(), 45f64.to_radians()];
        let there = machine.forward(&AxisPositions { linear_mm: [20.0, 0.0, 0.0], rotary });
        assert!((path[1].pose.tip - there.tip).norm() < 1e-12);
    }

    #[test]
    fn what_is_not_read_is_refused_with_its_line() {
        let start = "G43.4 H1\nG0 X0 Y0 Z0 A0 C0\n";
        for (rest, fault) in [
            ("G2 X1 Y1 I1 J0 F1", PathFault::Arc),
            ("G1 X1 B5 F1", PathFault::NoSuchAxis('B')),
            ("G91\nG1 X1 F1", PathFault::Relative),
            ("G1 X#1 F1", PathFault::Variables),
            ("G68.2 X0 Y0 Z0 I1 J2 K3", PathFault::NotRead("G68.2".into())),
            ("G1 X1", PathFault::NoFeed),
            ("G1 X9999999 F1", PathFault::Coordinate),
            ("ROT Z45", PathFault::NotRead("ROT".into())),
            ("CYCLE800(1)", PathFault::NotRead("CYCLE800".into())),
        ] {
            assert_eq!(path_of(&format!("{start}{rest}\n")).unwrap_err().fault, fault, "{rest}");
        }
        let text = "G43.4 H1\nG0 X0 Y0 Z0 A5.\n";
        assert_eq!(
            read(text, None, 50.0, reading()).unwrap_err(),
            PathTextError { line: 2, fault: PathFault::NoMachine }
        );
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "([GXYZABCIJKFMN]-?[0-9]{0,4}\\.?[0-9]{0,3} ?|\\n|LN |TX|TRAORI|M128|G43\\.4 ){0,60}") {
            let _ = path_of(&text);
        }
    }
}
