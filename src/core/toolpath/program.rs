//! How a program is to be written: its units, its decimals, its number and its name.

use nalgebra::Point3;

/// Units of a written program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum Units {
    #[default]
    Mm,
    Inch,
}

impl Units {
    /// Millimetres in one unit.
    pub fn mm(self) -> f64 {
        match self {
            Units::Mm => 1.0,
            Units::Inch => 25.4,
        }
    }
}

/// The grid on which written coordinates lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resolution {
    pub units: Units,
    /// Decimals of a written coordinate, 1..=6.
    pub decimals: u8,
}

impl Resolution {
    /// One unit of the last decimal, mm.
    pub fn step_mm(self) -> f64 {
        self.units.mm() / 10f64.powi(i32::from(self.decimals))
    }
}

/// How a control may leave the written path to run it faster. What is absent is the control's choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothing {
    /// Of the path.
    pub tolerance_mm: Option<f64>,
    /// Of the angles of the rotary axes.
    pub tolerance_deg: Option<f64>,
    pub mode: Option<SmoothingMode>,
}

/// What the program is for: a control is set up for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum SmoothingMode {
    /// Speed counts most.
    Roughing,
    SemiFinishing,
    /// The form counts most.
    Finishing,
}

/// The raw part as a box, mm. Controls draw it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blank {
    pub low: Point3<f64>,
    pub high: Point3<f64>,
}

/// Everything that a program states besides its moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    pub resolution: Resolution,
    pub number: u32,
    /// User text; only ever written cleaned, inside a comment.
    pub name: Option<String>,
    pub block_numbers: bool,
    /// 54..=59, written as G54 to G59.
    pub work_offset: Option<u8>,
    pub safe_home: SafeHome,
    /// Without it the program keeps the path as closely as its dialect can say.
    pub smoothing: Option<Smoothing>,
    /// None where it is not known, or the dialect has no word for it.
    pub blank: Option<Blank>,
    pub custom: Custom,
}

impl Program {
    /// Program 1, without a name and without everything else that may be left out.
    pub const fn plain(resolution: Resolution) -> Self {
        Self {
            resolution,
            number: 1,
            name: None,
            block_numbers: false,
            work_offset: None,
            safe_home: SafeHome::None,
            smoothing: None,
            blank: None,
            custom: Custom { header: Vec::new(), tool_change: Vec::new(), footer: Vec::new() },
        }
    }
}

/// Lines of your own in a program: words of a letter and a number, or a comment. A line may call programs and
/// macros of yours. It may move axes only to places of the machine (G28, G30, G53; SUPA on Siemens; M91 in
/// Klartext). It may not end or leave the program, nor change units or coordinates for later blocks. Only
/// lines of `header` may select a work offset; `work_offset` comes after them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(deny_unknown_fields))]
pub struct Custom {
    /// Lines before the first line that sets modes, in order.
    #[cfg_attr(feature = "wire", serde(default), schema(max_items = 50))]
    pub header: Vec<String>,
    /// Lines in place of the line that changes the tool, in order.
    #[cfg_attr(feature = "wire", serde(default), schema(max_items = 50))]
    pub tool_change: Vec<String>,
    /// Lines before the line that ends the program, in order.
    #[cfg_attr(feature = "wire", serde(default), schema(max_items = 50))]
    pub footer: Vec<String>,
}

impl Custom {
    /// Number of lines.
    pub fn len(&self) -> usize {
        self.header.len() + self.tool_change.len() + self.footer.len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The way up along Z before the tool change and before the end of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum SafeHome {
    /// The tool does not go up.
    #[default]
    None,
    /// The tool goes to the reference point.
    G28,
    /// The tool goes to zero of the machine's coordinates.
    G53,
}
