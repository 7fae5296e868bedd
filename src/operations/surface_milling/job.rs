//! What is to be milled, and how.

use crate::geometry::cutter::Cutter;
use crate::geometry::plane::Plane;
use crate::geometry::surface::source::Source;
use crate::toolpath::cutting::CuttingRequest;
use crate::toolpath::program::{Resolution, Units};
use crate::toolpath::tool::Tool;
use crate::toolpath::units::{FeedRate, Tolerance};

/// Section planes of one job where the caller sets no limit.
pub const DEFAULT_PLANE_LIMIT: usize = 20_000;

/// The planes of the sections: zx at constant y, yz at constant x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SectionPlane {
    #[default]
    Zx,
    Yz,
}

impl SectionPlane {
    /// The index of the coordinate that is constant on a plane: 1 is y, 0 is x.
    pub(super) fn normal_axis(self) -> usize {
        self.arc_plane().axes()[2]
    }

    pub(super) fn arc_plane(self) -> Plane {
        match self {
            SectionPlane::Zx => Plane::Zx,
            SectionPlane::Yz => Plane::Yz,
        }
    }
}

/// What finds the CL curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Engine {
    /// Direct contact of the cutter with the surface.
    #[default]
    Contact,
    /// Sections of the offset of the surface (Ju), for balls that can follow it everywhere.
    OffsetSection,
}

/// How far apart the planes are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spacing {
    /// The largest distance between neighbouring planes, mm.
    Stepover(f64),
    /// The largest height that may be left between passes, along the surface normal, mm.
    ScallopHeight(f64),
    /// The largest distance of the wires of `wire_union`, mm: a method of its own, to which engine, plane, boundary, direction and
    /// interpolation say nothing.
    WirePitch(f64),
}

/// Where the passes end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// The cutter stays inside the outline, seen from above.
    Inside,
    /// The cutter's contact reaches the edge.
    #[default]
    On,
    /// The contact goes on past the edge, straight on along the tangents, by the cutter's radius at least.
    Past,
}

/// The order in which the sections are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CutDirection {
    OneWay,
    #[default]
    Zigzag,
}

/// What the CL points are joined by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    #[default]
    Arcs,
    Lines,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    pub surface: Source,
    pub tool: Tool,
    pub engine: Engine,
    pub plane: SectionPlane,
    pub spacing: Spacing,
    pub boundary: Boundary,
    pub direction: CutDirection,
    pub tolerance: Tolerance,
    /// Stock to be left on the surface, mm; zero or more.
    pub allowance_mm: f64,
    pub interpolation: Interpolation,
    /// Upper bound for the distance of neighbouring CL points, mm.
    pub step_length_mm: Option<f64>,
    pub cutting: CuttingRequest,
    /// The resolution the program will be written with: the bounds hold after rounding to it.
    pub resolution: Resolution,
    /// More section planes than this are refused.
    pub plane_limit: usize,
}

impl Job {
    /// The job with the default of everything that has one, written in mm with three decimals.
    pub fn new(surface: Source, tool: Tool, stepover_mm: f64, tolerance: Tolerance, feed: FeedRate) -> Self {
        Self {
            surface,
            tool,
            engine: Engine::default(),
            plane: SectionPlane::default(),
            spacing: Spacing::Stepover(stepover_mm),
            boundary: Boundary::default(),
            direction: CutDirection::default(),
            tolerance,
            allowance_mm: 0.0,
            interpolation: Interpolation::default(),
            step_length_mm: None,
            cutting: CuttingRequest::at_feed(feed),
            resolution: Resolution { units: Units::Mm, decimals: 3 },
            plane_limit: DEFAULT_PLANE_LIMIT,
        }
    }

    /// The cutter with the stock to be left around it.
    pub(super) fn cutter(&self) -> Cutter {
        self.tool.cutter().enlarged(self.allowance_mm)
    }

    /// Distance of the ball's centre from the surface, mm.
    pub(super) fn offset_mm(&self) -> f64 {
        self.tool.radius_mm + self.allowance_mm
    }
}
