//! Walls and islands from files: drawings in DXF.

use serde::Deserialize;
use utoipa::ToSchema;

use super::{Outline, Vertex, WalledRegion};
use crate::http::decode::files::FileReading;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Range;
use crate::http::dto::file::{FileUnits, Reference, drawing_options, format_name};
use crate::http::error::FieldCode;
use crate::http::messages::WarningCode;
use crate::http::pointer::Pointer;
use toolpathd_part::drawing::{Drawing, Loop, OpenChain, bulge};
use toolpathd_part::dxf;
use toolpathd_part::format::Format;

/// Default of `gap_mm`.
pub const GAP_MM: f64 = 0.01;

/// Default of `curve_tolerance_mm`.
pub const CURVE_TOLERANCE_MM: f64 = 0.001;

/// Legal gaps and tolerances, mm.
pub const GAPS: Range = Range { min: 0.0, max: 10.0 };
pub const CURVE_TOLERANCES: Range = Range { min: 1e-5, max: 1.0 };

/// Most layers that a sentence names.
const MOST_NAMES: usize = 20;

/// Walls and islands from a drawing (DXF) that is sent with the request.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionFile {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The name of the file: that of its part of the body (`multipart/form-data`), or any name beside
    /// `base64`.
    #[schema(max_length = 200)]
    name: String,
    /// The file in base64. Default: the part of the body with this name.
    #[schema(max_length = 16_777_216)]
    base64: Option<String>,
    /// The unit of the file. Default: the unit that the file states; a file that states none is refused.
    units: Option<FileUnits>,
    /// The layer whose curves count. Default: all layers.
    #[schema(max_length = 255)]
    layer: Option<String>,
    /// The wall, by the number of its loop in the drawing, as `/v1/parts/inspect` counts them with the same
    /// layer, gap and tolerance; the loops right inside it are its islands. It may be an island. Default:
    /// `region` takes the only wall, and `regions` all walls, also those within islands.
    #[schema(minimum = 0, maximum = 1_000_000)]
    wall: Option<usize>,
    /// Largest gap between the ends of curves that counts as a joint, in mm. Gaps that are bridged are
    /// told.
    #[schema(minimum = 0, maximum = 10, default = 0.01)]
    gap_mm: Option<f64>,
    /// Largest distance of splines and ellipses from the arcs in their place, in mm.
    #[schema(minimum = 0.000_01, maximum = 1, default = 0.001)]
    curve_tolerance_mm: Option<f64>,
    /// What happens where an open chain of curves begins, ends or has its middle within a wall: it may be an
    /// island that is not closed, and the pocket would be cut through it.
    #[serde(default)]
    #[schema(default = "refuse")]
    open_curves: OpenCurves,
}

/// What happens to open curves within walls. `refuse`: the drawing is refused. `ignore`: they are no walls,
/// and the answer warns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum OpenCurves {
    #[default]
    Refuse,
    Ignore,
}

impl RegionFile {
    /// The name by which the request refers to the file.
    pub fn file_name(&self) -> &str {
        &self.name
    }

    /// The only region of the file; `None` with a violation where there are none, or several.
    pub fn region(&self, at: &Pointer, reading: &mut FileReading) -> Option<WalledRegion> {
        let mut all = self.regions(at, reading)?;
        if all.len() == 1 {
            return all.pop();
        }
        let detail = format!(
            "there are {} walls: send `regions` with this object in a list, or choose one by `wall`",
            all.len()
        );
        self.reference(at).blame(FieldCode::Conflict, &detail, reading);
        None
    }

    /// The regions of the file, at least one; `None` with a violation where there is none.
    pub fn regions(&self, at: &Pointer, reading: &mut FileReading) -> Option<Vec<WalledRegion>> {
        let violations = &mut reading.violations;
        let before = violations.total();
        violations.optional(&at.field("gap_mm"), self.gap_mm, GAPS, "mm");
        violations.optional(&at.field("curve_tolerance_mm"), self.curve_tolerance_mm, CURVE_TOLERANCES, "mm");
        if violations.total() > before {
            return None;
        }
        let drawing = self.drawing(at, reading)?;
        let walls = self.walls(&drawing, at, reading)?;
        if self.open_curves == OpenCurves::Refuse
            && let Some((wall, chain)) = open_within(&drawing, &walls)
        {
            let detail = format!(
                "an open chain of curves on layer `{}` lies within the loop {wall}, and may be an island: its ends are {:.4} mm apart. Close it, send a larger `gap_mm`, choose a `layer`, or send `open_curves: ignore`",
                chain.layer, chain.gap_mm
            );
            self.reference(at).blame(FieldCode::Conflict, &detail, reading);
            return None;
        }
        self.tell(&drawing, &walls, at, reading);
        Some(walls.into_iter().map(|wall| region(&drawing.loops, wall)).collect())
    }

    fn reference<'a>(&'a self, at: &'a Pointer) -> Reference<'a> {
        Reference { at, name: &self.name, base64: self.base64.as_deref(), units: self.units }
    }

    fn drawing(&self, at: &Pointer, reading: &mut FileReading) -> Option<Drawing> {
        let reference = self.reference(at);
        let bytes = reference.bytes(reading)?;
        match Format::of(&self.name, &bytes) {
            Format::Dxf => {}
            other => {
                let detail = format!("a region is read from DXF, and this is {}", format_name(other));
                reference.blame(FieldCode::Unsupported, &detail, reading);
                return None;
            }
        }
        let (gap_mm, tolerance_mm) =
            (self.gap_mm.unwrap_or(GAP_MM), self.curve_tolerance_mm.unwrap_or(CURVE_TOLERANCE_MM));
        let options = drawing_options(reading.limits, self.layer.clone(), self.units, gap_mm, tolerance_mm);
        let drawing = reference.read(dxf::read(&bytes, &options, reading.budget), reading)?;
        reference.mm(drawing.unit, reading)?;
        if drawing.unknown_unit {
            let detail =
                format!("`{}` states a unit that is not known, and is read as `units` says", self.name);
            reading.warn(at, WarningCode::UnitsOverridden, detail);
        }
        Some(drawing)
    }

    /// The loops that are walls.
    fn walls(&self, drawing: &Drawing, at: &Pointer, reading: &mut FileReading) -> Option<Vec<usize>> {
        let loops = &drawing.loops;
        if let Some(wall) = self.wall {
            if wall < loops.len() {
                return Some(vec![wall]);
            }
            let detail = format!("there are {} loops, counted from 0", loops.len());
            reading.violations.add(&at.field("wall"), FieldCode::OutOfRange, detail);
            return None;
        }
        let walls: Vec<usize> = (0..loops.len()).filter(|k| loops[*k].depth.is_multiple_of(2)).collect();
        if walls.is_empty() {
            self.reference(at).blame(FieldCode::UnreadableFile, &self.nothing(drawing), reading);
            return None;
        }
        Some(walls)
    }

    /// Why a drawing has no walls.
    fn nothing(&self, drawing: &Drawing) -> String {
        let layers = drawing.layers.iter().take(MOST_NAMES);
        let layers: Vec<String> = layers.map(|layer| format!("`{}`", layer.name)).collect();
        let nearest = drawing.open.iter().min_by(|a, b| a.gap_mm.total_cmp(&b.gap_mm));
        match (&self.layer, nearest) {
            (_, Some(open)) => format!(
                "there is no closed loop; {} chains are open, the least by {:.4} mm, on layer `{}`: close it, or send a larger `gap_mm` where that is a rounding",
                drawing.open.len(),
                open.gap_mm,
                open.layer
            ),
            (Some(layer), None) if !layers.is_empty() => {
                format!(
                    "there is no closed loop on layer `{layer}`; the layers with curves are {}",
                    layers.join(", ")
                )
            }
            _ => "there is no closed loop in it".to_owned(),
        }
    }

    /// Tells what a person should know of the drawing before the program runs.
    fn tell(&self, drawing: &Drawing, walls: &[usize], at: &Pointer, reading: &mut FileReading) {
        let reference = self.reference(at);
        // Nobody needs to be told of the layers that the request itself leaves out.
        let told = drawing.left_out.iter().filter(|one| one.reason != dxf::NOT_ASKED);
        reference.tell_left_out(&told.cloned().collect::<Vec<_>>(), reading);
        if drawing.bridged_max_mm > 0.0 {
            let detail = format!(
                "`{}`: gaps of up to {:.4} mm between curves are bridged",
                self.name, drawing.bridged_max_mm
            );
            reading.warn(at, WarningCode::GapsBridged, detail);
        }
        if drawing.deviation_max_mm > 0.0 {
            let detail = format!(
                "`{}`: arcs and lines stand for splines and ellipses, at most {:.6} mm beside them",
                self.name, drawing.deviation_max_mm
            );
            reading.warn(at, WarningCode::CurvesFitted, detail);
        }
        if let Some(open) = drawing.open.first() {
            let detail = format!(
                "`{}`: {} open chains are no walls; the first, on layer `{}`, is open by {:.4} mm",
                self.name,
                drawing.open.len(),
                open.layer,
                open.gap_mm
            );
            reading.warn(at, WarningCode::OpenCurves, detail);
        }
        if let Some(branch) = drawing.branches.first() {
            let detail = format!(
                "`{}`: in {} places more than two curves meet, the first at ({:.4}, {:.4}); they are joined where only one way makes loops",
                self.name,
                drawing.branches.len(),
                branch.at[0],
                branch.at[1]
            );
            reading.warn(at, WarningCode::CurvesBranch, detail);
        }
        let islands = walls.iter().map(|wall| islands(&drawing.loops, *wall).count()).sum::<usize>();
        if drawing.loops.len() > 1 {
            let detail = format!(
                "`{}`: of {} loops {} and {} are taken by what lies within what; the walls are the loops {}",
                self.name,
                drawing.loops.len(),
                counted(walls.len(), "wall"),
                counted(islands, "island"),
                walls.iter().take(20).map(usize::to_string).collect::<Vec<_>>().join(", "),
            );
            reading.warn(at, WarningCode::LoopsNested, detail);
        }
    }
}

/// An open chain within a wall: one of its ends or its middle is inside.
fn open_within<'d>(drawing: &'d Drawing, walls: &[usize]) -> Option<(usize, &'d OpenChain)> {
    let within = |wall: usize, chain: &OpenChain| {
        let n = chain.vertices.len();
        let mut tried = [0, n / 2, n.saturating_sub(1)].into_iter().filter_map(|k| chain.vertices.get(k));
        tried.any(|[x, y, _]| bulge::is_inside(&drawing.loops[wall].vertices, [*x, *y]))
    };
    walls.iter().find_map(|&wall| {
        let chain = drawing.open.iter().find(|chain| within(wall, chain))?;
        Some((wall, chain))
    })
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// The loops right inside a wall.
fn islands(loops: &[Loop], wall: usize) -> impl Iterator<Item = &Loop> {
    loops.iter().filter(move |island| island.parent == Some(wall))
}

fn region(loops: &[Loop], wall: usize) -> WalledRegion {
    let outline = |own: &Loop| Outline::Vertices(own.vertices.iter().map(vertex).collect());
    let islands: Vec<Outline> = islands(loops, wall).map(outline).collect();
    WalledRegion::new(outline(&loops[wall]), Some(islands).filter(|islands| !islands.is_empty()))
}

fn vertex(&[x, y, bulge]: &[f64; 3]) -> Vertex {
    if bulge == 0.0 { Vertex::plain([x, y]) } else { Vertex::bulging([x, y], bulge) }
}
