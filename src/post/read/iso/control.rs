//! How controls that read ISO words differ, as far as the reader needs to know.
//!
//! The facts come from the controls' manuals, never from the [`Dialect`](crate::Dialect) that the writer
//! uses. So the reader refuses a program in which the writer has used a wrong word.

use crate::nc::Fault;

/// What a control makes of its words. G codes are in tenths.
#[derive(Debug, Clone, Copy)]
pub struct Control {
    /// Whether `%` stands before and behind the program.
    pub has_tape_marks: bool,
    pub program_number: Option<ProgramNumber>,
    /// Whether lengths must have a point: without one, the control reads X10 as ten of its least steps.
    pub needs_points: bool,
    pub dwell: Dwell,
    /// G codes that only some controls know.
    pub further_g: &'static [i32],
    /// Whether G5.1 is a parabola.
    pub has_parabolas: bool,
    /// Whether G81 and its like are canned cycles whose return G98 and G99 choose.
    pub has_cycles: bool,
    /// Whether T and M6 call a tool.
    pub has_tools: bool,
    /// The code whose H word is the number of a length offset.
    pub length_offset: Option<i32>,
    /// The code whose H word is the number of a work offset.
    pub work_offset: Option<i32>,
    /// The code that begins tip control with angles of the rotary axes, with an H word.
    pub angles: Option<i32>,
    /// The code that begins tip control with vectors of the tool axis, with an H word.
    pub vectors: Option<i32>,
    /// The M codes after which coordinates are those of the tip, and those of the axes again.
    pub kinematics: Option<[i32; 2]>,
    pub smoothing: SmoothingWord,
    /// The largest F under G93.
    pub most_inverse_time: f64,
}

/// The letter O and at least `digits` digits.
#[derive(Debug, Clone, Copy)]
pub struct ProgramNumber {
    pub digits: usize,
    pub max: u32,
}

impl ProgramNumber {
    /// The number of a program, from its line.
    pub fn number(self, text: &str) -> Result<u32, Fault> {
        // The program's name may stand beside the number.
        let line = match text.split_once(" (") {
            Some((line, name)) if name.ends_with(')') && !name[..name.len() - 1].contains(['(', ')']) => line,
            _ => text,
        };
        let digits = line
            .trim()
            .strip_prefix('O')
            .filter(|digits| digits.len() >= self.digits && digits.bytes().all(|c| c.is_ascii_digit()));
        let read = digits.and_then(|digits| digits.parse().ok());
        read.filter(|read| (1..=self.max).contains(read)).ok_or(Fault::ProgramNumber)
    }
}

/// The word that chooses how closely a control keeps the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmoothingWord {
    None,
    /// G64 P: the distance by which corners are rounded.
    Blending,
    /// G5.1 Q1 begins contour control, with R from 1 (fast) to 10 (precise); G5.1 Q0 ends it.
    ContourControl,
    /// G187 P from 1 (rough) to 3 (finish), E the largest rounding of corners; alone it ends it.
    G187,
}

/// The word that holds the time of G4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dwell {
    /// P counts seconds.
    Seconds,
    /// P counts whole milliseconds.
    Milliseconds,
    /// F counts seconds.
    FeedWord,
}

impl Control {
    /// The control that reads the dialect called `name`. A dialect without a row has the words of `iso`.
    pub fn of(name: &str) -> Self {
        match name {
            "linuxcnc" => LINUXCNC,
            "fanuc" => FANUC,
            "mazak" => Control { smoothing: SmoothingWord::None, ..FANUC },
            "haas" => HAAS,
            "grbl" => GRBL,
            "mach4" => MACH4,
            "okuma" => OKUMA,
            _ => ISO,
        }
    }

    /// Whether a code needs an H word.
    pub fn takes_offset(&self, code: i32) -> bool {
        [self.length_offset, self.work_offset, self.angles, self.vectors].contains(&Some(code))
    }
}

/// The words that most controls share.
const ISO: Control = Control {
    has_tape_marks: true,
    program_number: Some(ProgramNumber { digits: 4, max: 9999 }),
    needs_points: true,
    dwell: Dwell::Seconds,
    further_g: &[],
    has_parabolas: false,
    has_cycles: true,
    has_tools: true,
    length_offset: Some(430),
    work_offset: None,
    angles: None,
    vectors: None,
    kinematics: None,
    smoothing: SmoothingWord::None,
    // B-62764EN, 5.3: 0.001 to 9999.999 in mm and in inches.
    most_inverse_time: 9999.999,
};

/// Tool centre point control is G43.4 with rotary axes (type 1), and G43.5 with the tool axis as I, J, K
/// (type 2).
const FANUC: Control = Control {
    dwell: Dwell::Milliseconds,
    angles: Some(434),
    vectors: Some(435),
    smoothing: SmoothingWord::ContourControl,
    ..ISO
};

/// Tool centre point control is G234, for angles alone. Program numbers have five digits.
const HAAS: Control = Control {
    program_number: Some(ProgramNumber { digits: 5, max: 99_999 }),
    angles: Some(2340),
    vectors: None,
    smoothing: SmoothingWord::G187,
    ..FANUC
};

/// A program is a file that ends with M2 or M30. G5.1 is a quadratic spline.
const LINUXCNC: Control = Control {
    has_tape_marks: false,
    program_number: None,
    needs_points: false,
    has_parabolas: true,
    // configs/sim/axis/vismach/5axis/table-rotary-tilting/xyzac-trt.txt: M428 is XYZAC (TCP), M429 identity.
    kinematics: Some([4280, 4290]),
    smoothing: SmoothingWord::Blending,
    most_inverse_time: f64::INFINITY,
    ..ISO
};

/// G43 is unknown: the control has no table of tools. It has no canned cycles.
const GRBL: Control = Control {
    has_parabolas: false,
    has_cycles: false,
    has_tools: false,
    length_offset: None,
    kinematics: None,
    smoothing: SmoothingWord::None,
    ..LINUXCNC
};

/// G91.1 makes the offsets of centres incremental.
const MACH4: Control =
    Control { has_tape_marks: true, needs_points: false, program_number: None, further_g: &[911], ..ISO };

/// G15 H selects a work offset and G56 H a length offset. G4 has its seconds in F. M53 and M54 choose the
/// return of canned cycles, not G98 and G99.
const OKUMA: Control = Control {
    has_tape_marks: false,
    dwell: Dwell::FeedWord,
    has_cycles: false,
    length_offset: Some(560),
    work_offset: Some(150),
    ..ISO
};
