//! The request to inspect a file, and the report of what is in it.

mod model;

use axum::body::Bytes;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::check::Violations;
use super::file::{FileUnits, Reference};
use super::meta::{self, Meta, MetaTexts};
use super::outline::{CURVE_TOLERANCE_MM, CURVE_TOLERANCES, GAP_MM, GAPS};
use crate::config::Limits;
use crate::http::decode::files::FileReading;
use crate::http::decode::{IntoJob, object};
use crate::http::error::{ApiError, FieldCode};
use crate::http::pointer::Pointer;
pub use model::ModelContents;
use toolpathd_part::drawing::{Branch, Drawing, Loop, OpenChain};
use toolpathd_part::fault::Place;
use toolpathd_part::left_out::LeftOut;
use toolpathd_part::points::PointText;
use toolpathd_part::points::grid::{Grid, NoGrid};

/// A file, and how it is read.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InspectRequest {
    /// The file. Default: the only file beside the job in a body of `multipart/form-data`.
    #[serde(default, deserialize_with = "object::optional")]
    file: Option<InspectedFile>,
    /// The unit of the file, in place of the one that it states. Default: the unit that the file states;
    /// where it states none, the report is in the numbers of the file, and the answer warns.
    units: Option<FileUnits>,
    /// The layer of a drawing whose curves count. Default: all layers.
    #[schema(max_length = 255)]
    layer: Option<String>,
    /// Largest gap between the ends of curves of a drawing that counts as a joint, in mm.
    #[schema(minimum = 0, maximum = 10, default = 0.01)]
    gap_mm: Option<f64>,
    /// Largest distance of splines and ellipses of a drawing from the arcs in their place, in mm.
    #[schema(minimum = 0.000_01, maximum = 1, default = 0.001)]
    curve_tolerance_mm: Option<f64>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer
    /// and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
    /// The bytes of the file, once it was found.
    #[serde(skip)]
    #[schema(ignore)]
    found: Option<(String, Bytes)>,
}

/// A file that is inspected.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct InspectedFile {
    /// The name of the file: that of its part of the body (`multipart/form-data`), or any name beside
    /// `base64`.
    #[schema(max_length = 200)]
    name: String,
    /// The file in base64. Default: the part of the body with this name.
    #[schema(max_length = 16_777_216)]
    base64: Option<String>,
}

/// A file that is to be inspected.
#[derive(Debug)]
pub struct Inspection {
    pub name: String,
    pub bytes: Bytes,
    pub units: Option<FileUnits>,
    pub layer: Option<String>,
    pub gap_mm: f64,
    pub curve_tolerance_mm: f64,
    pub limits: Limits,
    pub meta: Option<Meta>,
}

impl IntoJob for InspectRequest {
    type Job = Inspection;

    const JOB_OF_FILES: Option<&'static str> = Some("{}");

    fn read_files(&mut self, reading: &mut FileReading) {
        let at = Pointer::root().field("file");
        self.found = match &self.file {
            Some(InspectedFile { name, base64 }) => {
                let file = Reference { at: &at, name, base64: base64.as_deref(), units: None };
                file.bytes(reading).map(|bytes| (name.clone(), bytes))
            }
            None => reading.only_file(),
        };
    }

    fn into_job(self, limits: &Limits) -> Result<Inspection, ApiError> {
        let Self { file: _, units, layer, gap_mm, curve_tolerance_mm, meta, found } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        violations.optional(&root.field("gap_mm"), gap_mm, GAPS, "mm");
        violations.optional(&root.field("curve_tolerance_mm"), curve_tolerance_mm, CURVE_TOLERANCES, "mm");
        meta::check(meta.as_ref(), &mut violations);
        let Some((name, bytes)) = found else {
            let detail = "send one file, as `curl -F part=@plate.dxf`, or the file in `base64`";
            violations.add(&root.field("file"), FieldCode::MissingField, detail);
            return Err(violations.into_error());
        };
        violations.result()?;
        Ok(Inspection {
            name,
            bytes,
            units,
            layer,
            gap_mm: gap_mm.unwrap_or(GAP_MM),
            curve_tolerance_mm: curve_tolerance_mm.unwrap_or(CURVE_TOLERANCE_MM),
            limits: *limits,
            meta,
        })
    }
}

/// What is in a file.
#[derive(Serialize, ToSchema)]
pub struct InspectReport {
    /// The format of the file.
    pub format: FileFormat,
    /// `units` of the request, or else the unit that the file states. Absent where neither states one: then
    /// all lengths of the report are in the numbers of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<FileUnits>,
    /// A box around all that was read, in mm. Absent where nothing was read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<FileBox>,
    /// The drawing. Present with `dxf`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawing: Option<DrawingReport>,
    /// The solids and sheets. Present with `step`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelContents>,
    /// The points. Present with `points`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<PointsReport>,
    /// What was left out of the file, and why; an empty list where nothing was.
    pub left_out: Vec<LeftOutReport>,
}

/// A format of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FileFormat {
    Dxf,
    Points,
    Step,
}

/// A box along the axes, in mm.
#[derive(Clone, Copy, Serialize, ToSchema)]
pub struct FileBox {
    /// The corner with the least coordinates, in mm.
    pub min: [f64; 3],
    /// The corner with the largest coordinates, in mm.
    pub max: [f64; 3],
}

impl FileBox {
    /// The box around points; `None` without points.
    pub fn around(points: impl Iterator<Item = [f64; 3]>) -> Option<Self> {
        points.map(|point| Self { min: point, max: point }).reduce(|a, b| Self {
            min: [0, 1, 2].map(|k| a.min[k].min(b.min[k])),
            max: [0, 1, 2].map(|k| a.max[k].max(b.max[k])),
        })
    }
}

/// What a drawing holds.
#[derive(Serialize, ToSchema)]
pub struct DrawingReport {
    /// The layers with curves.
    layers: Vec<LayerReport>,
    /// The closed loops. `wall` of a region in a file is the place of a loop in this list, counted from 0.
    loops: Vec<LoopReport>,
    /// Chains of curves that are open.
    open_chains: Vec<OpenChainReport>,
    /// Places where more than two ends of curves meet.
    branches: Vec<BranchReport>,
    /// The largest gap that was bridged, in mm.
    bridged_max_mm: f64,
    /// How far splines and ellipses may be from the arcs and lines in their place, in mm.
    deviation_max_mm: f64,
}

/// A layer of a drawing.
#[derive(Serialize, ToSchema)]
struct LayerReport {
    /// Its name, as the file writes it.
    name: String,
    /// The number of its curves.
    n_curves: usize,
}

/// What a loop is, by what lies within what.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum LoopKind {
    Wall,
    Island,
}

/// A closed loop.
#[derive(Serialize, ToSchema)]
struct LoopReport {
    /// `wall`: it lies within no loop, or within an even number of loops. `island`: within an odd number.
    kind: LoopKind,
    /// The layer of its first curve.
    layer: String,
    /// The number of loops within which it lies.
    depth: usize,
    /// The smallest loop around it, by its number in the list, counted from 0. Absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    parent: Option<usize>,
    /// Its area with all that lies in it, in mm2.
    area_mm2: f64,
    /// Its length, in mm.
    length_mm: f64,
    /// Its vertices, counterclockwise, as `boundary` of a region takes them: `[x, y]` or `[x, y, bulge]`, in
    /// mm.
    #[schema(value_type = Vec<Vec<f64>>)]
    vertices: Vec<LoopVertex>,
}

/// A vertex, which is written without a bulge of 0.
#[derive(Serialize)]
#[serde(untagged)]
enum LoopVertex {
    Plain([f64; 2]),
    Bulging([f64; 3]),
}

/// A place where more than two ends of curves meet.
#[derive(Serialize, ToSchema)]
struct BranchReport {
    /// The place, in mm.
    at: [f64; 2],
    /// The number of ends that meet there.
    n_ends: usize,
    /// The number of ends that are joined to no other, because more than one way makes loops.
    n_open: usize,
}

/// A chain of curves whose ends do not meet.
#[derive(Serialize, ToSchema)]
struct OpenChainReport {
    /// The layer of its first curve.
    layer: String,
    /// The distance of its ends, in mm.
    gap_mm: f64,
    /// Its two ends, in mm.
    ends: [[f64; 2]; 2],
    /// The number of its lines and arcs.
    n_curves: usize,
}

impl From<&Drawing> for DrawingReport {
    fn from(drawing: &Drawing) -> Self {
        let layers = drawing.layers.iter();
        Self {
            layers: layers
                .map(|one| LayerReport { name: one.name.clone(), n_curves: one.n_curves })
                .collect(),
            loops: drawing.loops.iter().map(LoopReport::from).collect(),
            open_chains: drawing.open.iter().map(OpenChainReport::from).collect(),
            branches: drawing.branches.iter().map(BranchReport::from).collect(),
            bridged_max_mm: drawing.bridged_max_mm,
            deviation_max_mm: drawing.deviation_max_mm,
        }
    }
}

impl From<&Loop> for LoopReport {
    fn from(own: &Loop) -> Self {
        let vertex = |&[x, y, bulge]: &[f64; 3]| match bulge {
            0.0 => LoopVertex::Plain([x, y]),
            bulge => LoopVertex::Bulging([x, y, bulge]),
        };
        Self {
            kind: if own.depth.is_multiple_of(2) { LoopKind::Wall } else { LoopKind::Island },
            layer: own.layer.clone(),
            depth: own.depth,
            parent: own.parent,
            area_mm2: own.area_mm2,
            length_mm: own.length_mm,
            vertices: own.vertices.iter().map(vertex).collect(),
        }
    }
}

impl From<&Branch> for BranchReport {
    fn from(&Branch { at, n_ends, n_open }: &Branch) -> Self {
        Self { at, n_ends, n_open }
    }
}

impl From<&OpenChain> for OpenChainReport {
    fn from(chain: &OpenChain) -> Self {
        let end = |vertex: Option<&[f64; 3]>| vertex.map_or([0.0; 2], |[x, y, _]| [*x, *y]);
        Self {
            layer: chain.layer.clone(),
            gap_mm: chain.gap_mm,
            ends: [end(chain.vertices.first()), end(chain.vertices.last())],
            n_curves: chain.vertices.len().saturating_sub(1),
        }
    }
}

/// What a text of points holds.
#[derive(Serialize, ToSchema)]
pub struct PointsReport {
    /// The number of points.
    n_points: usize,
    /// What stands between the figures of a line.
    separator: &'static str,
    /// Whether they have a decimal comma in place of a point.
    decimal_comma: bool,
    /// The number of columns.
    n_columns: usize,
    /// The numbers of the columns of x, y and z, counted from 1; two where the text has no z.
    coordinates: Vec<usize>,
    /// The grid that the points make. Absent where they make none.
    #[serde(skip_serializing_if = "Option::is_none")]
    grid: Option<GridReport>,
    /// Why the points make no grid. Absent where they make one.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_grid: Option<String>,
}

/// Points in rows and columns.
#[derive(Serialize, ToSchema)]
struct GridReport {
    /// The number of rows.
    n_rows: usize,
    /// The number of points of each row.
    n_columns: usize,
    /// The direction of the rows against x, in degrees.
    angle_deg: f64,
    /// A small distance of neighbours in plan, in mm: one in twenty points has a nearer one.
    spacing_mm: f64,
    /// The largest distance of a point from its row or its column in plan, in mm.
    off_max_mm: f64,
}

impl PointsReport {
    pub fn new(text: &PointText, grid: &Result<Grid, NoGrid>, no_grid: impl Fn(&NoGrid) -> String) -> Self {
        let PointText { points, writing, n_columns, columns, .. } = text;
        Self {
            n_points: points.len(),
            separator: writing.separator_name(),
            decimal_comma: writing.has_decimal_comma,
            n_columns: *n_columns,
            coordinates: columns.iter().flatten().map(|column| column + 1).collect(),
            grid: grid.as_ref().ok().map(GridReport::from),
            no_grid: grid.as_ref().err().map(no_grid),
        }
    }
}

impl From<&Grid> for GridReport {
    fn from(Grid { rows, angle, off, spacing }: &Grid) -> Self {
        Self {
            n_rows: rows.len(),
            n_columns: rows.first().map_or(0, Vec::len),
            angle_deg: angle.to_degrees(),
            spacing_mm: *spacing,
            off_max_mm: *off,
        }
    }
}

/// Entities of one kind that were left out for one reason.
#[derive(Serialize, ToSchema)]
pub struct LeftOutReport {
    /// The kind, as the file writes it.
    kind: String,
    /// Why they were left out.
    reason: String,
    /// The number of such entities.
    count: usize,
    /// The number of the line of the first, counted from 1, in a text.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u64>,
    /// The number of the first entity, in files that number their entities.
    #[serde(skip_serializing_if = "Option::is_none")]
    entity: Option<u64>,
}

impl From<&LeftOut> for LeftOutReport {
    fn from(LeftOut { kind, reason, count, first }: &LeftOut) -> Self {
        let (line, entity) = match first {
            Place::Line(line) => (Some(*line), None),
            Place::Entity(number) => (None, Some(*number)),
            Place::File | Place::Byte(_) => (None, None),
        };
        Self { kind: kind.clone(), reason: reason.clone(), count: *count, line, entity }
    }
}
