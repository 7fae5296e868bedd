//! The milling job: surface, tool, passes and approach.

use crate::geometry::plane::Plane;
use crate::geometry::surface::source::Source;
use crate::machining::cutter::Cutter;
use crate::toolpath::cutting::CuttingRequest;
use crate::toolpath::program::{Resolution, Units};
use crate::toolpath::quantize::Curves;
use crate::toolpath::tool::Tool;
use crate::toolpath::units::{FeedRate, Tolerance};

/// The most section planes of a job whose caller sets no limit.
pub const DEFAULT_PLANE_LIMIT: usize = 20_000;

/// The most moves and the most CL points of a job whose caller sets no limits.
pub const DEFAULT_MOVE_LIMIT: usize = 500_000;
pub const DEFAULT_POINT_LIMIT: usize = 10_000_000;

/// The share of the limit of CL points that a job may need where the cutter is lowered onto the surface. On
/// two cores such a point took 42 us with a bull nose and 61 us with a flat cutter, where a point of a
/// section of the offset took 2 us.
pub const CONTACT_SHARE: f64 = 0.04;

/// Pieces of a section shorter than this share of the cutter's radius are left out if the job has a longer
/// piece. Each piece costs a plunge and a retract. A larger share leaves more material; a smaller one makes
/// passes that cut next to nothing.
const SHORT_SHARE: f64 = 0.1;

/// The planes of the passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum SectionPlane {
    /// Planes of constant y.
    #[default]
    Zx,
    /// Planes of constant x.
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

/// How the CL points are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum Engine {
    /// Direct contact of the cutter with the surface.
    #[default]
    Contact,
    /// Sections of the offset surface (Ju), for ball cutters that can follow the surface everywhere.
    OffsetSection,
}

/// How far apart the planes are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spacing {
    /// The largest distance between neighbouring planes, mm.
    Stepover(f64),
    /// The largest height that may be left between passes, along the surface normal, mm.
    ScallopHeight(f64),
    /// The largest distance between the wires of `wire_union`, mm. This method ignores engine, plane,
    /// boundary, direction and interpolation.
    WirePitch(f64),
}

/// Where the passes end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum Boundary {
    /// The whole cutter stays inside the outline, seen from above.
    Inside,
    /// The cutter's contact reaches the edge.
    #[default]
    On,
    /// The contact point goes on past the edge, straight along the tangents, by at least the cutter's radius.
    Past,
}

/// In which direction passes are cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum CutDirection {
    OneWay,
    #[default]
    Zigzag,
}

/// What joins the CL points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Deserialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum Interpolation {
    #[default]
    Arcs,
    Lines,
}

/// The material over the surface before the path is cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stock {
    /// A layer that roughing left, at most this thick along the normal, mm. It lies on the surface with its
    /// allowance.
    OnSurface { thickness_mm: f64 },
    /// A block of material up to this height.
    Block { top_z_mm: f64 },
}

impl Stock {
    /// The thickness of a layer on the surface, mm; zero for a block.
    pub(super) fn thickness_mm(self) -> f64 {
        match self {
            Self::OnSurface { thickness_mm } => thickness_mm,
            Self::Block { .. } => 0.0,
        }
    }
}

/// How the cutter comes to a pass from above.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Entry {
    #[default]
    Plunge,
    /// Down sloping lines in the plane of the pass, which fall by `slope` mm per mm of horizontal travel.
    Ramp { slope: f64 },
    /// Down a quarter of a circle in the plane of the pass, along its tangent.
    Arc { radius_mm: f64 },
}

/// How the cutter leaves a pass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Exit {
    #[default]
    Retract,
    /// Up a quarter of a circle in the plane of the pass, along its tangent.
    Arc { radius_mm: f64 },
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
    /// `None` if the caller does not state the stock: rapids then come down as if there were none, and the
    /// answer warns. Wire unions assume a block as high as the part.
    pub stock: Option<Stock>,
    pub entry: Entry,
    pub exit: Exit,
    pub interpolation: Interpolation,
    /// The largest distance between neighbouring CL points, mm.
    pub step_length_mm: Option<f64>,
    pub cutting: CuttingRequest,
    /// The resolution of the written program. The report's bounds hold after rounding to it.
    pub resolution: Resolution,
    /// What the control of the written program runs. The report's bounds count what is written as lines.
    pub curves: Curves,
    /// A job that needs more section planes is refused.
    pub plane_limit: usize,
    /// A job that needs more moves is refused.
    pub move_limit: usize,
    /// A job that needs more CL points is refused; by contact of the cutter, a job with more than
    /// `CONTACT_SHARE` of these.
    pub point_limit: usize,
}

impl Job {
    /// The job with the default of everything that has one, written in mm with three decimals for a control
    /// that runs all arcs.
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
            stock: None,
            entry: Entry::default(),
            exit: Exit::default(),
            interpolation: Interpolation::default(),
            step_length_mm: None,
            cutting: CuttingRequest::at_feed(feed),
            resolution: Resolution { units: Units::Mm, decimals: 3 },
            curves: Curves::ARCS,
            plane_limit: DEFAULT_PLANE_LIMIT,
            move_limit: DEFAULT_MOVE_LIMIT,
            point_limit: DEFAULT_POINT_LIMIT,
        }
    }

    /// The cutter enlarged by the allowance.
    pub(super) fn cutter(&self) -> Cutter {
        self.tool.cutter().enlarged(self.allowance_mm)
    }

    /// The top of the part and of the stock over it, mm, for a surface whose top is at `surface_mm`.
    pub(super) fn top(&self, surface_mm: f64) -> f64 {
        let left = surface_mm + self.allowance_mm;
        match self.stock {
            Some(Stock::Block { top_z_mm }) => left.max(top_z_mm),
            stock => left + stock.map_or(0.0, Stock::thickness_mm),
        }
    }

    /// Length up to which a piece of a section is not cut, mm: it would vanish in rounding.
    pub(super) fn vanishing_mm(&self) -> f64 {
        2.0 * self.resolution.step_mm()
    }

    /// Length below which a piece of a section is left out if the job has a longer piece, mm.
    pub(super) fn short_mm(&self) -> f64 {
        SHORT_SHARE * self.cutter().radius()
    }

    /// The distance of a ball's centre from the surface, mm.
    pub(super) fn offset_mm(&self) -> f64 {
        self.tool.radius_mm + self.allowance_mm
    }
}
