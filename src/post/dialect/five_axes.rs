//! The words for leaning tools.

use super::FANUC_INVERSE_TIME;

/// How a control is told the axis of a leaning tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FiveAxisWords {
    /// Decimals of a written angle, in degrees.
    pub angle_decimals: u8,
    /// Under tip control X, Y and Z state the place of the tool tip, also while the tool leans: with the
    /// angles of the rotary axes in the blocks, or with the vector of the tool axis. `None` where the control
    /// has no such mode.
    pub angles: Option<TipControl>,
    pub vectors: Option<TipControl>,
    /// Whether tip control is a switch of the control's kinematics, which only some machines have. Programs
    /// then state positions, unless a request asks for angles.
    pub switches_kinematics: bool,
    /// With polynomials of the tip and of a second point on the axis.
    pub rails: Option<TipControl>,
    /// Whether blocks may state the positions of all five axes of the machine, with the time of each block.
    pub has_positions: bool,
    /// How fast the axis turns about a resting tip.
    pub turns: Turns,
}

impl FiveAxisWords {
    /// A control of three axes.
    pub const NONE: Self = Self {
        angle_decimals: 0,
        angles: None,
        vectors: None,
        switches_kinematics: false,
        rails: None,
        has_positions: false,
        turns: Turns::InverseTime { most: FANUC_INVERSE_TIME },
    };

    /// All ways in which a program can state the tool axis.
    pub fn outputs(self) -> impl Iterator<Item = AxisOutput> {
        let all = [AxisOutput::Angles, AxisOutput::Vectors, AxisOutput::Rails, AxisOutput::Machine];
        all.into_iter().filter(move |&output| self.write(output))
    }

    /// Whether a program can state the tool axis in this way.
    pub fn write(&self, output: AxisOutput) -> bool {
        match output {
            AxisOutput::Angles => self.angles.is_some(),
            AxisOutput::Vectors => self.vectors.is_some(),
            AxisOutput::Rails => self.rails.is_some(),
            AxisOutput::Machine => self.has_positions,
        }
    }
}

/// How a program states the tool axis. On LinuxCNC `angles` is never the default: it writes M428 and M429,
/// which have to select the kinematics of the tip and of the axes, as in the sample configurations
/// `xyzac-trt`, `xyzbc-trt` and `xyzab-tdr`. Other configurations give these codes another meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum AxisOutput {
    /// The tip and the angles of the rotary axes (Fanuc: G43.4, Siemens: TRAORI, Heidenhain: TCPM, LinuxCNC:
    /// M428). The control keeps the tip on its line.
    Angles,
    /// The tip and the vector of the tool axis (Fanuc: G43.5, Siemens: A3 B3 C3, Heidenhain: LN).
    Vectors,
    /// As `vectors`, and polynomials of the tip and of a second point where the toolpath has them (Siemens:
    /// ORICURVE, POLY).
    Rails,
    /// The positions of all five axes of the machine, with the time of each block (G93).
    Machine,
}

/// The words of tip control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TipControl {
    /// The blocks that switch it on, each a line. `{offset}` stands for the number of the length offset.
    pub before: &'static [&'static str],
    /// The words in the block of the first motion.
    pub words: Option<&'static str>,
    pub off: &'static str,
    /// The letters of the components of a vector.
    pub vector: [&'static str; 3],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turns {
    /// By the time that the block takes: F is one by its minutes, at most `most`. A shorter block takes
    /// longer than it should.
    InverseTime { most: u32 },
    /// By a feed in degrees per minute.
    DegreesPerMinute,
}
