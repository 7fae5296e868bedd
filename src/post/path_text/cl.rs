//! APT CL data: `GOTO/x,y,z,i,j,k` with feeds, rapids and units.
//!
//! * A `$` at the end of a line continues the statement on the next line; `$$` begins a comment.
//! * A point without an axis keeps the axis before it; at first that is straight up.
//! * `RAPID` holds for the next motion. `FEDRAT` states the feed in MMPM, IPM, MMPR or IPR before or behind
//!   the number; without a unit it counts by the minute, in the units of the file.
//! * `FROM` is where the tool starts. `GODLTA` counts from the place before.
//! * Words for the machine (`LOADTL`, `COOLNT`, ...) are skipped. Motions of other kinds are refused.
//!
//! # Reference
//! ISO 4343, *NC processor output - Post processor commands*; ISO 3592, *NC processor output - File
//! structure*.

use nalgebra::{Point3, UnitVector3, Vector3};

use super::{PathFault, PathTextError, ReadSettings, coordinate, direction, feed};
use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};
use toolpathd_core::toolpath::units::FeedRate;

const INCH_MM: f64 = 25.4;

/// Statements that move the tool, or change where points lie, and are not read.
const REFUSED: [&str; 13] = [
    "CIRCLE", "CYCLE", "TRACUT", "COPY", "ORIGIN", "TRANS", "ROTATE", "GOHOME", "THREAD", "GOLFT", "GORGT",
    "GOFWD", "CURVE",
];

/// Longest statement, in characters, with its continuations. A longer one is taken for no CL data.
const MAX_STATEMENT: usize = 100_000;

/// Reads the poses of CL data.
///
/// # Errors
/// The first line that cannot be read.
pub fn read(text: &str, reading: ReadSettings) -> Result<Vec<Waypoint>, PathTextError> {
    let mut reader = Reader {
        reading,
        path: Vec::new(),
        axis: Vector3::z_axis(),
        unit_mm: 1.0,
        feed: reading.feed,
        spindle_rpm: None,
        is_rapid: false,
    };
    let mut statement = String::new();
    let mut begins = 0;
    for (k, line) in text.lines().enumerate() {
        let line = line.split("$$").next().unwrap_or_default().trim();
        if statement.is_empty() {
            begins = k + 1;
        }
        let (part, continues) = match line.strip_suffix('$') {
            Some(part) => (part, true),
            None => (line, false),
        };
        statement.push_str(part);
        if continues && statement.len() <= MAX_STATEMENT {
            continue;
        }
        let is_end = reader.statement(&statement).map_err(|fault| PathTextError { line: begins, fault })?;
        if is_end {
            break;
        }
        statement.clear();
    }
    Ok(reader.path)
}

struct Reader {
    reading: ReadSettings,
    path: Vec<Waypoint>,
    axis: UnitVector3<f64>,
    unit_mm: f64,
    feed: Option<FeedRate>,
    spindle_rpm: Option<f64>,
    /// The next motion is a rapid.
    is_rapid: bool,
}

impl Reader {
    /// Reads one statement. Says whether the file ends.
    fn statement(&mut self, statement: &str) -> Result<bool, PathFault> {
        let (word, rest) = statement.split_once('/').unwrap_or((statement, ""));
        let word = word.trim().to_ascii_uppercase();
        // A statement may have a label.
        let word = word.rsplit(')').next().unwrap_or_default().trim();
        match word {
            "GOTO" | "FROM" => self.go_to(&numbers(rest)?, word == "FROM")?,
            "GODLTA" => {
                let by = numbers(rest)?;
                let &[x, y, z] = &by[..] else { return Err(PathFault::Count(by.len())) };
                let at = self.path.last().map_or(Point3::origin(), |last| last.pose.tip);
                let at = at.map(|mm| mm / self.unit_mm);
                self.go_to(&[at.x + x, at.y + y, at.z + z], false)?;
            }
            "RAPID" => self.is_rapid = true,
            "FEDRAT" => self.feed_rate(rest)?,
            "SPINDL" => {
                self.spindle_rpm = words(rest).find_map(|word| word.parse().ok()).or(self.spindle_rpm)
            }
            "TLAXIS" => {
                let axis = numbers(rest)?;
                let &[i, j, k] = &axis[..] else { return Err(PathFault::Count(axis.len())) };
                self.axis = direction(Vector3::new(i, j, k))?;
            }
            "UNITS" => {
                let is_inch = words(rest).any(|word| word.starts_with("IN"));
                self.unit_mm = if is_inch { INCH_MM } else { 1.0 };
            }
            "FINI" => return Ok(true),
            word if REFUSED.contains(&word) && !words(rest).any(|word| word == "OFF" || word == "NOMORE") => {
                return Err(PathFault::NotRead(word.to_owned()));
            }
            _ => {}
        }
        Ok(false)
    }

    fn go_to(&mut self, numbers: &[f64], is_start: bool) -> Result<(), PathFault> {
        let (tip, axis) = match *numbers {
            [x, y, z] => ([x, y, z], None),
            [x, y, z, i, j, k] => ([x, y, z], Some(direction(Vector3::new(i, j, k))?)),
            _ => return Err(PathFault::Count(numbers.len())),
        };
        self.axis = axis.unwrap_or(self.axis);
        let mut place = Point3::origin();
        for (k, value) in tip.into_iter().enumerate() {
            place[k] = coordinate(value * self.unit_mm)?;
        }
        let is_rapid = std::mem::take(&mut self.is_rapid) || is_start || self.path.is_empty();
        let pace = if is_rapid { Pace::Rapid } else { Pace::Feed(self.feed.ok_or(PathFault::NoFeed)?) };
        if self.path.len() >= self.reading.limit {
            return Err(PathFault::TooMany(self.reading.limit));
        }
        self.path.push(Waypoint { pose: Pose { tip: place, axis: self.axis }, pace });
        Ok(())
    }

    fn feed_rate(&mut self, rest: &str) -> Result<(), PathFault> {
        let (mut value, mut unit_mm, mut by_turn) = (None, self.unit_mm, false);
        for word in words(rest) {
            match word.as_str() {
                "MMPM" => (unit_mm, by_turn) = (1.0, false),
                "IPM" => (unit_mm, by_turn) = (INCH_MM, false),
                "MMPR" => (unit_mm, by_turn) = (1.0, true),
                "IPR" => (unit_mm, by_turn) = (INCH_MM, true),
                "PERMIN" => by_turn = false,
                "PERREV" => by_turn = true,
                "RAPID" => self.is_rapid = true,
                word => value = value.or(word.parse::<f64>().ok()),
            }
        }
        let Some(value) = value else { return Ok(()) };
        let turns = if by_turn { self.spindle_rpm.ok_or(PathFault::NoSpindle)? } else { 1.0 };
        self.feed = Some(feed(value * unit_mm * turns)?);
        Ok(())
    }
}

fn words(rest: &str) -> impl Iterator<Item = String> {
    rest.split(',').map(|word| word.trim().to_ascii_uppercase())
}

fn numbers(rest: &str) -> Result<Vec<f64>, PathFault> {
    let number = |word: &str| {
        let word = word.trim();
        // Fortran writes exponents with D.
        let plain = word.replace(['D', 'd'], "E");
        plain.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| PathFault::BadNumber(shown(word)))
    };
    rest.split(',').map(number).collect()
}

/// The beginning of a text, for a message.
fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "$$ a blade\nPARTNO/BLADE 7\nUNITS/MM\nMULTAX/ON\nLOADTL/3,ADJUST,1\nSPINDL/8000,RPM,CLW\n\
        FROM/0,0,100\nRAPID\nGOTO/10.0,0.0,50.0,0.0,0.6,0.8\nFEDRAT/500,MMPM\nGOTO/10.0,0.0,5.0\n\
        FEDRAT/MMPM,1500.0\nGOTO/ 1.1D+01, 0.5, $\n  5.25, 0.6,0.0,0.8\nCOOLNT/OFF\nGOTO/12,1,5\nFEDRAT/0.1,MMPR\n\
        GODLTA/0,0,1.5\nFINI\nGOTO/1,1,1\n";

    fn reading() -> ReadSettings {
        ReadSettings { feed: None, limit: 100 }
    }

    #[test]
    fn a_file_is_read_with_its_axes_and_paces() {
        let path = read(FILE, reading()).unwrap();
        let tips: Vec<[f64; 3]> = path.iter().map(|at| at.pose.tip.into()).collect();
        let expected = [
            [0.0, 0.0, 100.0],
            [10.0, 0.0, 50.0],
            [10.0, 0.0, 5.0],
            [11.0, 0.5, 5.25],
            [12.0, 1.0, 5.0],
            [12.0, 1.0, 6.5],
        ];
        assert_eq!(tips, expected);
        let feeds: Vec<Option<f64>> = path
            .iter()
            .map(|at| match at.pace {
                Pace::Rapid => None,
                Pace::Feed(feed) => Some(feed.mm_per_min()),
            })
            .collect();
        assert_eq!(feeds, [None, None, Some(500.0), Some(1500.0), Some(1500.0), Some(800.0)]);
        assert!((path[2].pose.axis.y - 0.6).abs() < 1e-15 && (path[4].pose.axis.x - 0.6).abs() < 1e-15);
        assert_eq!(path[0].pose.axis, Vector3::z_axis());
    }

    #[test]
    fn inches_become_millimetres() {
        let path = read("UNITS/INCHES\nGOTO/1,0,0\nFEDRAT/10\nGODLTA/1,0,0\n", reading()).unwrap();
        assert_eq!((path[0].pose.tip.x, path[1].pose.tip.x), (25.4, 50.8));
        assert_eq!(path[1].pace, Pace::Feed(FeedRate::from_mm_per_min(254.0).unwrap()));
    }

    #[test]
    fn what_is_not_read_is_refused_with_its_line() {
        for (text, line, fault) in [
            ("GOTO/1,2,3\nGOTO/1,2\n", 2, PathFault::Count(2)),
            ("GOTO/1,2,x\n", 1, PathFault::BadNumber("x".into())),
            ("GOTO/1,2,3,0,0,0\n", 1, PathFault::NoAxis),
            ("GOTO/1,2,3e9\n", 1, PathFault::Coordinate),
            ("GOTO/1,2,3\n\nGOTO/1,2,4\n", 3, PathFault::NoFeed),
            ("CYCLE/DRILL,1\n", 1, PathFault::NotRead("CYCLE".into())),
            ("$$\nGOTO/1,2,$\n3,4,$\n5\n", 2, PathFault::Count(5)),
            ("FEDRAT/-3\n", 1, PathFault::BadFeed(-3.0)),
            ("FEDRAT/0.1,IPR\n", 1, PathFault::NoSpindle),
        ] {
            assert_eq!(read(text, reading()).unwrap_err(), PathTextError { line, fault }, "{text}");
        }
        let few = ReadSettings { limit: 1, ..reading() };
        assert_eq!(read("GOTO/1,2,3\nRAPID\nGOTO/1,2,4", few).unwrap_err().fault, PathFault::TooMany(1));
        assert_eq!(read("CYCLE/OFF\nno CL data at all\n", reading()), Ok(Vec::new()));
    }
}
