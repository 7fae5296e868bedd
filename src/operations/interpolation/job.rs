//! What is to be interpolated, and how.

use crate::geometry::deviation::Band;
use crate::geometry::offset::Side;
use crate::toolpath::cutting::CuttingRequest;
use crate::toolpath::program::{Resolution, Units};
use crate::toolpath::quantize::Parabolas;

pub use super::source::Source;

/// Elements of one job where the caller sets no limit.
pub const DEFAULT_ELEMENT_LIMIT: usize = 250_000;

/// What elements a curve is interpolated by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Linear,
    Parabolic,
    /// Lines where they stay within the band, else parabolas.
    Mixed,
    /// Arcs, and lines where they would be too flat.
    Arc,
}

/// How the curve is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subdivision {
    /// Hyun's: what leaves the band is halved.
    Bisection,
    /// Into as few elements as possible.
    Least(Joints),
}

/// Where elements meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joints {
    OnCurve,
    /// Anywhere in the band, for lines where that saves some; the ends of the curve are kept.
    InBand,
}

/// A job of interpolation.
#[derive(Debug, Clone)]
pub struct Job {
    pub curve: Source,
    pub method: Method,
    pub subdivision: Subdivision,
    /// Equal parts of the domain that the curve is divided into beforehand, one or more.
    pub initial_elements: usize,
    pub band: Band,
    /// The side and radius of a cutter that is to run beside the contour, mm.
    pub compensation: Option<(Side, f64)>,
    /// Height of the contour, mm.
    pub z_mm: f64,
    /// Without them the toolpath has no feeds.
    pub cutting: Option<CuttingRequest>,
    pub resolution: Resolution,
    /// The most elements.
    pub element_limit: usize,
    /// Whether the control runs parabolas; where it does not, arcs and lines stand for them.
    pub parabolas: Parabolas,
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
            compensation: None,
            z_mm: 0.0,
            cutting: None,
            resolution: Resolution { units: Units::Mm, decimals: 3 },
            element_limit: DEFAULT_ELEMENT_LIMIT,
            parabolas: Parabolas::InXy,
        }
    }
}
