//! APT CL data: `GOTO/x,y,z,i,j,k` with feeds, rapids, arcs and units.
//!
//! * A `$` at the end of a line continues the statement on the next line; `$$` begins a comment.
//! * A point without an axis keeps the axis before it; at first that is straight up.
//! * `RAPID` holds for the next motion. `FEDRAT` states the feed in MMPM, IPM, MMPR or IPR before or behind
//!   the number; without a unit it counts by the minute, in the units of the file.
//! * `FROM` is where the tool starts. `GODLTA` counts from the place before.
//! * `TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/...)` is an arc from the place of the tool, in the plane through
//!   the circle's centre that is parallel to XY, or across `i,j,k` with seven numbers.
//! * [`WORDS`] lists every word. A word that it lacks is refused.
//!
//! # Reference
//! ISO 4343, *NC processor output - Post processor commands*; ISO 3592, *NC processor output - File
//! structure*.

mod arguments;
mod circle;
mod words;

use std::collections::HashMap;
use std::sync::LazyLock;

use nalgebra::{Point3, UnitVector3, Vector3};

use self::arguments::{minors, number, numbers, parts_of, shown, three, words};
use super::table::{Row, Treatment, by_word};
use super::trail::Trail;
use super::{
    Fault, PathFault, PathText, PathTextError, ReadSettings, TextSpindle, coordinate, direction, feed,
    refusal, tool_number,
};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};
pub use words::WORDS;

const INCH_MM: f64 = 25.4;

/// Longest statement, in characters, with its continuations. A longer one is taken for no CL data.
const MAX_STATEMENT: usize = 100_000;

/// `FROM` behind motions names the place of the tool where it is no farther from it than this, mm: CL data
/// have three decimals or more.
const SAME_PLACE_MM: f64 = 0.002;

static ROWS: LazyLock<HashMap<&'static str, &'static Row>> = LazyLock::new(|| by_word(&[WORDS]));

/// Reads CL data.
///
/// # Errors
/// The first line that cannot be read.
pub fn read(text: &str, reading: ReadSettings) -> Result<PathText, PathTextError> {
    let mut reader = Reader {
        reading,
        trail: Trail::new(reading.limit),
        axis: Vector3::z_axis(),
        unit_mm: 1.0,
        feed: None,
        spindle_rpm: None,
        is_rapid: false,
        enters: None,
        heading: None,
        has_ended: false,
    };
    let mut statement = String::new();
    let mut begins = 0;
    let mut continues = false;
    for (k, line) in text.lines().enumerate() {
        let (line, comment) = match line.split_once("$$") {
            Some((line, comment)) => (line.trim(), comment),
            None => (line.trim(), ""),
        };
        // A comment between the lines of a statement.
        if continues && line.is_empty() && !comment.is_empty() {
            reader.trail.comment(comment);
            continue;
        }
        if !continues {
            statement.clear();
            begins = k + 1;
        }
        reader.trail.line = begins;
        reader.trail.comment(comment);
        let part = line.strip_suffix('$');
        continues = part.is_some();
        statement.push_str(part.unwrap_or(line));
        if continues && statement.len() <= MAX_STATEMENT {
            continue;
        }
        reader.statement(&statement).map_err(|fault| fault.at(begins))?;
    }
    if continues {
        reader.statement(&statement).map_err(|fault| fault.at(begins))?;
    }
    Ok(reader.trail.finish())
}

/// What an F counts.
#[derive(Debug, Clone, Copy)]
enum TextFeed {
    PerMinute(f64),
    PerTurn(f64),
}

struct Reader {
    reading: ReadSettings,
    trail: Trail,
    axis: UnitVector3<f64>,
    unit_mm: f64,
    feed: Option<TextFeed>,
    spindle_rpm: Option<f64>,
    /// The next motion is a rapid.
    is_rapid: bool,
    /// The direction in which the next circle is entered.
    enters: Option<Vector3<f64>>,
    /// The direction at the end of the motion before.
    heading: Option<Vector3<f64>>,
    has_ended: bool,
}

impl Reader {
    fn statement(&mut self, statement: &str) -> Result<(), Fault> {
        let statement = statement.trim();
        if statement.is_empty() {
            return Ok(());
        }
        if self.has_ended {
            self.trail.left_alone("behind FINI");
            return Ok(());
        }
        let (word, rest) = parts_of(statement);
        if let Some(motion) = word.strip_prefix("RAPID,") {
            self.is_rapid = true;
            return self.major(motion.trim(), rest);
        }
        self.major(&word, rest)
    }

    fn major(&mut self, word: &str, rest: Option<&str>) -> Result<(), Fault> {
        let row = *ROWS.get(word).ok_or_else(|| PathFault::Unknown(shown(word)))?;
        match row.treatment {
            Treatment::Refused => return Err(refusal(word, row).into()),
            Treatment::LeftAlone => {
                self.trail.left_alone(word);
                self.leave(word);
                return Ok(());
            }
            Treatment::Read => {}
        }
        let text = rest.unwrap_or_default();
        match word {
            "PARTNO" => self.trail.name(text),
            "PPRINT" | "REMARK" | "TPRINT" => self.trail.comment(text),
            "GOTO" => self.go_to(&numbers(text)?)?,
            "GODLTA" => self.go_on(&numbers(text)?)?,
            "FROM" => self.from(&numbers(text)?)?,
            "TLAXIS" => self.axis = direction(Vector3::from(three(&numbers(text)?)?))?,
            "INDIRV" => self.enters = Some(direction(Vector3::from(three(&numbers(text)?)?))?.into_inner()),
            "TLON,GOFWD" => self.circle(text)?,
            "TRANS" | "ORIGIN" => {
                if numbers(text)?.iter().any(|value| *value != 0.0) {
                    let advice = "write the points where the tool goes";
                    return Err(PathFault::Refused { word: word.to_owned(), advice }.into());
                }
            }
            "END" => self.trail.bar(PathFault::Leaves { word: word.to_owned() }),
            "FINI" => self.has_ended = true,
            "RAPID" => {
                minors(word, row, text)?;
                self.is_rapid = true;
            }
            "FEDRAT" => self.feed_rate(text)?,
            "SPINDL" => self.spindle(row, text)?,
            "COOLNT" => self.coolant(text)?,
            "UNITS" => {
                self.unit_mm = match words(text)?.as_slice() {
                    [unit] if unit == "MM" => 1.0,
                    [unit] if unit == "INCHES" || unit == "INCH" || unit == "IN" => INCH_MM,
                    _ => return Err(PathFault::Unused(shown(text)).into()),
                };
            }
            "LOADTL" | "LOAD/TOOL" | "TOOLNO" => self.tool(word, row, text)?,
            _ => {
                // Of these words, a row takes names alone: numbers would move the points.
                if !minors(word, row, text)?.is_empty() {
                    return Err(refusal(word, row).into());
                }
            }
        }
        Ok(())
    }

    /// Bars the motions behind a word that stops, or that takes the tool elsewhere.
    fn leave(&mut self, word: &str) {
        match word {
            "STOP" => self.trail.bar(PathFault::Stops { word: "STOP" }),
            "BREAK" => self.trail.bar(PathFault::Stops { word: "BREAK" }),
            "GOHOME" | "UNLOAD" => self.trail.bar(PathFault::Leaves { word: word.to_owned() }),
            _ => {}
        }
    }

    fn place(&self, at: [f64; 3]) -> Result<Point3<f64>, PathFault> {
        let mut place = Point3::origin();
        for (k, value) in at.into_iter().enumerate() {
            place[k] = coordinate(value * self.unit_mm)?;
        }
        Ok(place)
    }

    /// The place of a point, whose axis becomes that of the tool.
    fn point(&mut self, numbers: &[f64]) -> Result<Point3<f64>, PathFault> {
        let at = match *numbers {
            [x, y, z] => [x, y, z],
            [x, y, z, i, j, k] => {
                self.axis = direction(Vector3::new(i, j, k))?;
                [x, y, z]
            }
            _ => return Err(PathFault::Count(numbers.len())),
        };
        self.place(at)
    }

    fn go_to(&mut self, numbers: &[f64]) -> Result<(), Fault> {
        let place = self.point(numbers)?;
        self.go(place)
    }

    fn go(&mut self, tip: Point3<f64>) -> Result<(), Fault> {
        let is_rapid = std::mem::take(&mut self.is_rapid);
        let pace = match self.pace() {
            _ if is_rapid => Pace::Rapid,
            // Where the tool starts, before any word of feed.
            Err(PathFault::NoFeed) if self.trail.is_empty() => Pace::Rapid,
            pace => pace?,
        };
        self.enters = None;
        let way = self.trail.last().map(|last| tip - last.pose.tip);
        self.heading = way.and_then(|way| direction(way).ok()).map(UnitVector3::into_inner).or(self.heading);
        self.trail.push(Waypoint::new(Pose { tip, axis: self.axis }, pace))
    }

    fn go_on(&mut self, by: &[f64]) -> Result<(), Fault> {
        let at = self.trail.last().ok_or(PathFault::NoStart)?.pose.tip;
        let by = match *by {
            [along] => self.axis.scale(along),
            [x, y, z] => Vector3::new(x, y, z),
            _ => return Err(PathFault::Count(by.len()).into()),
        };
        let to = at + by * self.unit_mm;
        for value in to.iter() {
            coordinate(*value)?;
        }
        self.go(to)
    }

    fn from(&mut self, numbers: &[f64]) -> Result<(), Fault> {
        let place = self.point(numbers)?;
        match self.trail.last() {
            Some(last) if (last.pose.tip - place).norm() > SAME_PLACE_MM => {
                Err(PathFault::Leaves { word: "FROM".to_owned() }.into())
            }
            Some(_) => Ok(()),
            None => {
                self.is_rapid = true;
                self.go(place)
            }
        }
    }

    /// The pace of a cut.
    fn pace(&self) -> Result<Pace, PathFault> {
        Ok(Pace::Feed(match self.feed {
            Some(TextFeed::PerMinute(value)) => feed(value)?,
            Some(TextFeed::PerTurn(value)) => feed(value * self.spindle_rpm.ok_or(PathFault::NoSpindle)?)?,
            None => self.reading.feed.ok_or(PathFault::NoFeed)?,
        }))
    }

    fn feed_rate(&mut self, text: &str) -> Result<(), PathFault> {
        let (mut value, mut unit_mm, mut by_turn, mut is_rapid) = (None, self.unit_mm, false, false);
        for word in words(text)? {
            match word.as_str() {
                "MMPM" => (unit_mm, by_turn) = (1.0, false),
                "IPM" => (unit_mm, by_turn) = (INCH_MM, false),
                "MMPR" => (unit_mm, by_turn) = (1.0, true),
                "IPR" => (unit_mm, by_turn) = (INCH_MM, true),
                "PERMIN" => by_turn = false,
                "PERREV" => by_turn = true,
                "RAPID" => is_rapid = true,
                word if value.is_none() => value = Some(number(word)?),
                word => return Err(PathFault::Unused(shown(word))),
            }
        }
        self.is_rapid |= is_rapid;
        let Some(value) = value.map(|value| value * unit_mm) else {
            return if is_rapid { Ok(()) } else { Err(PathFault::NoNumber("FEDRAT".to_owned())) };
        };
        if !by_turn {
            feed(value)?;
        } else if value <= 0.0 {
            return Err(PathFault::BadFeed(value));
        }
        self.feed = Some(if by_turn { TextFeed::PerTurn(value) } else { TextFeed::PerMinute(value) });
        Ok(())
    }

    fn spindle(&mut self, row: &Row, text: &str) -> Result<(), PathFault> {
        let given = words(text)?;
        if given == ["OFF"] {
            self.trail.spindle(TextSpindle::Off);
            return Ok(());
        }
        if let Some(word) = given.iter().find(|word| word.parse::<f64>().is_err() && !row.takes(word)) {
            let advice = match word.as_str() {
                "CCLW" => "the answer's program turns the spindle clockwise; cut with a clockwise tool",
                _ => "only a speed in RPM with CLW is read; write SPINDL with its speed, RPM and CLW",
            };
            return Err(PathFault::Refused { word: format!("SPINDL/{}", shown(word)), advice });
        }
        let mut speeds = given.iter().filter_map(|word| word.parse::<f64>().ok());
        if let Some(rpm) = speeds.next() {
            if !(rpm > 0.0 && rpm.is_finite()) || speeds.next().is_some() {
                return Err(PathFault::BadNumber(shown(text)));
            }
            self.spindle_rpm = Some(rpm);
        }
        self.trail.spindle(TextSpindle::On(self.spindle_rpm));
        Ok(())
    }

    fn coolant(&mut self, text: &str) -> Result<(), PathFault> {
        match words(text)?.as_slice() {
            [word] if word == "ON" || word == "FLOOD" => self.trail.coolant(Coolant::Flood, "COOLNT"),
            [word] if word == "MIST" => self.trail.coolant(Coolant::Mist, "COOLNT"),
            [word] if word == "OFF" => self.trail.coolant(Coolant::Off, "COOLNT"),
            _ => self.trail.left_alone("COOLNT"),
        }
        Ok(())
    }

    fn tool(&mut self, word: &str, row: &Row, text: &str) -> Result<(), PathFault> {
        let given = minors(word, row, text)?;
        let number = given.first().copied().ok_or_else(|| PathFault::NoNumber(word.to_owned()))?;
        self.trail.tool(tool_number(number)?);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
