//! The interpolation job: curve, method, division and band.

use crate::geometry::deviation::Band;
use crate::geometry::offset::Side;
use crate::toolpath::cutting::CuttingRequest;
use crate::toolpath::program::{Resolution, Units};
use crate::toolpath::quantize::{Curves, Parabolas};

pub use super::band::Widths;
pub use super::meter::DEFAULT_STEP_LIMIT;
pub use super::source::Source;

/// The most elements of a job whose caller sets no limit.
pub const DEFAULT_ELEMENT_LIMIT: usize = 250_000;

/// The kind of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = InterpolationMethod))]
pub enum Method {
    Linear,
    Parabolic,
    /// Lines where they stay within the band, else parabolas.
    Mixed,
    /// Arcs, and lines where arcs would be too flat.
    Arc,
}

/// How the curve is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subdivision {
    /// Hyun's method: an element that leaves the band is halved.
    Bisection,
    /// Into as few elements as possible.
    Least(Joints),
}

/// Where elements meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "wire", schema(as = InterpolationJoints))]
pub enum Joints {
    #[default]
    OnCurve,
    /// Anywhere in the band, for lines, if that needs fewer of them. The ends of the curve stay on the curve.
    InBand,
}

/// A job of interpolation.
#[derive(Debug, Clone)]
pub struct Job {
    pub curve: Source,
    pub method: Method,
    pub subdivision: Subdivision,
    /// The number of equal parts into which the domain is divided first, one or more.
    pub initial_elements: usize,
    pub band: Band,
    /// The widths of the band that are functions of x. They replace those of `band`.
    pub widths: Widths,
    /// The side and the radius (mm) of a cutter that runs beside the contour.
    pub compensation: Option<(Side, f64)>,
    /// Height of the contour, mm.
    pub z_mm: f64,
    /// The cutting conditions; without them the toolpath has no feeds.
    pub cutting: Option<CuttingRequest>,
    pub resolution: Resolution,
    /// A job that needs more elements is refused.
    pub element_limit: usize,
    /// A job that takes more steps is refused. A search for fewer elements, and one for a lower bound, end
    /// before that with what they have.
    pub step_limit: u64,
    /// What the control runs. Arcs and lines stand for parabolas that it does not run, and lines for arcs.
    pub curves: Curves,
}

impl Job {
    /// The job with the default of everything that has one: the contour itself at a height of zero without
    /// feeds, written in mm with three decimals for a control that runs parabolas.
    pub fn new(curve: Source, method: Method, subdivision: Subdivision, band: Band) -> Self {
        Self {
            curve,
            method,
            subdivision,
            initial_elements: 1,
            band,
            widths: Widths::default(),
            compensation: None,
            z_mm: 0.0,
            cutting: None,
            resolution: Resolution { units: Units::Mm, decimals: 3 },
            element_limit: DEFAULT_ELEMENT_LIMIT,
            step_limit: DEFAULT_STEP_LIMIT,
            curves: Curves { parabolas: Parabolas::InXy, ..Curves::ARCS },
        }
    }
}
