//! `POST /v1/parts/inspect`: tells what is in a file of a part.

use axum::extract::State;
use axum::response::Response;
use nalgebra::Point3;

use crate::http::answer::model::{PART_CHORD_MM, Solids};
use crate::http::answer::{Computing, Cut, Outcome, Product, answer};
use crate::http::dto::answer::{Answer, NoMembers};
use crate::http::dto::file::{drawing_options, format_name, units_overridden};
use crate::http::dto::inspection::{
    DrawingReport, FileBox, FileFormat, InspectReport, InspectRequest, Inspection, LeftOutReport,
    ModelContents, PointsReport,
};
use crate::http::error::{ApiError, FieldCode, FieldError};
use crate::http::messages::{Warning, WarningCode, no_grid};
use crate::http::pointer::Pointer;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Figures, Form, Wanted};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::region::{Outline, Region, RegionError};
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::geometry::surface::source::Source;
use toolpathd_part::drawing::Drawing;
use toolpathd_part::drawing::bulge::segments;
use toolpathd_part::dxf;
use toolpathd_part::fault::Unreadable;
use toolpathd_part::format::Format;
use toolpathd_part::left_out::LeftOut;
use toolpathd_part::points::grid::{NoGrid, grid};
use toolpathd_part::points::{self, PointText};
use toolpathd_part::step;
use toolpathd_part::unit::Unit;
use toolpathd_plot::solid;

/// The answer in JSON.
type InspectAnswer = Answer<InspectReport, NoMembers>;

/// Largest turn of the part of an arc that is drawn as one straight line, radians.
const LARGEST_TURN: f64 = 0.1;

/// Tell what is in a file.
///
/// Send one file as `multipart/form-data`, with or without a part `job` in JSON, or in `base64`. The answer
/// tells format and unit, the loops of a drawing (DXF) with their layers, areas and nesting, or how points in
/// a text are written and what grid they make, and lists whatever was left out with its reason. What it tells
/// can be sent on: a loop by its number as `wall` of a region with `kind: file`, or its vertices as
/// `boundary`.
#[utoipa::path(post, path = "/v1/parts/inspect", operation_id = "inspectPart", tag = "parts",
    params(Wanted<Figures>), request_body = InspectRequest,
    responses((status = 200, description = "What is in the file, or a picture.", body = InspectAnswer)))]
pub async fn inspect_part(
    State(computing): State<Computing>,
    wanted: Wanted<Figures>,
    body: JobBody<InspectRequest>,
) -> Result<Response, ApiError> {
    answer(computing, wanted, body, inspect).await
}

/// What is shown of a file in three dimensions.
enum Shape {
    /// Closed loops of lines and arcs; an outline within an island is filled again.
    Loops(Vec<Vec<Segment>>),
    Grid(PointGrid),
    Nothing,
}

impl Product for Shape {
    type Members = NoMembers;

    const TITLE: &'static str = "File of a part";

    fn cut(&self) -> Option<&Cut> {
        None
    }

    fn solids(&self, budget: &Budget) -> Result<Solids, ApiError> {
        match self {
            Self::Loops(loops) => flat(loops, budget),
            Self::Grid(grid) => {
                let surface = Source::PointGrid(grid.clone()).surface();
                Ok(surface.map(|surface| Solids::of_surface(&surface)).unwrap_or_default())
            }
            Self::Nothing => Ok(Solids::default()),
        }
    }

    fn members(self, _: Option<String>, _: &Form) {}
}

/// The area between loops, at the height 0; nothing where they cannot be told apart.
fn flat(loops: &[Vec<Segment>], budget: &Budget) -> Result<Solids, ApiError> {
    let outlines: Vec<Outline> = loops.iter().filter_map(|own| Outline::new(own, budget).ok()).collect();
    let region = Region::nested(&outlines, budget);
    match region.and_then(|region| solid::flat(&region, 0.0, PART_CHORD_MM, budget)) {
        Ok(part) => Ok(Solids { part: Some(part), part_chord_mm: Some(PART_CHORD_MM), stock: None }),
        Err(RegionError::Stopped(stopped)) => Err(stopped.into()),
        Err(_) => Ok(Solids::default()),
    }
}

/// What was read, before units.
struct Found {
    format: FileFormat,
    unit: Option<Unit>,
    /// Whether the file states a unit, be it one without a name here.
    has_unit: bool,
    model: Option<ModelContents>,
    bounds: Option<FileBox>,
    drawing: Option<DrawingReport>,
    points: Option<PointsReport>,
    left_out: Vec<LeftOut>,
    shape: Shape,
    picture: toolpathd_plot::Drawing,
}

fn inspect(job: Inspection, budget: &Budget) -> Result<Outcome<InspectReport, Shape>, ApiError> {
    let found = match Format::of(&job.name, &job.bytes) {
        Format::Dxf => drawing(&job, budget)?,
        Format::Points => point_text(&job, budget)?,
        Format::Step => model(&job, budget)?,
        other => {
            let detail =
                format!("`{}` is {}; send STEP, DXF or a text of points", job.name, format_name(other));
            return Err(blamed(FieldCode::Unsupported, detail));
        }
    };
    let units = job.units.or(found.unit.map(Into::into));
    let has_unit = found.has_unit || units.is_some();
    let mut warnings = Vec::new();
    if !has_unit {
        let detail =
            format!("`{}` states no unit of length: the figures are in the numbers of the file", job.name);
        warnings.push(Warning::new(WarningCode::FileUnitMissing, detail));
    }
    if let (Some(sent), Some(stated)) = (job.units.map(Unit::from), found.unit)
        && sent != stated
    {
        let detail = units_overridden(&job.name, stated, sent);
        warnings.push(Warning::new(WarningCode::UnitsOverridden, detail));
    }
    let Found { format, bounds, drawing, model, points, left_out, shape, picture, .. } = found;
    let left_out = left_out.iter().map(LeftOutReport::from).collect();
    Ok(Outcome {
        meta: job.meta,
        warnings,
        report: InspectReport { format, units, bounds, drawing, model, points, left_out },
        product: shape,
        drawing: Box::new(move || picture.clone()),
    })
}

fn drawing(job: &Inspection, budget: &Budget) -> Result<Found, ApiError> {
    let options =
        drawing_options(&job.limits, job.layer.clone(), job.units, job.gap_mm, job.curve_tolerance_mm);
    let drawing = dxf::read(&job.bytes, &options, budget).map_err(|fault| unreadable(job, fault))?;
    let mut picture = toolpathd_plot::Drawing::default();
    picture.walls.extend(drawing.loops.iter().map(|own| polyline(&own.vertices, true)));
    picture.curve.extend(drawing.open.iter().map(|chain| polyline(&chain.vertices, false)));
    let of_loops = drawing.loops.iter().flat_map(|own| segments(&own.vertices, true));
    let of_chains = drawing.open.iter().flat_map(|chain| segments(&chain.vertices, false));
    let corners = of_loops.chain(of_chains).flat_map(|element| element.bounding_box());
    let bounds = FileBox::around(corners.map(|corner| [corner.x, corner.y, 0.0]));
    let report = DrawingReport::from(&drawing);
    let shape =
        Shape::Loops(drawing.loops.iter().map(|own| segments(&own.vertices, true).collect()).collect());
    let Drawing { unit, left_out, .. } = drawing;
    let drawing = Some(report);
    let (format, has_unit) = (FileFormat::Dxf, unit.is_some());
    Ok(Found { format, unit, has_unit, bounds, drawing, model: None, points: None, left_out, shape, picture })
}

fn point_text(job: &Inspection, budget: &Budget) -> Result<Found, ApiError> {
    let mut text = points::read(&job.bytes, job.limits.surface_points, budget)
        .map_err(|fault| unreadable(job, fault))?;
    let unit = job.units.map(Unit::from).or(text.unit);
    let mm = unit.map_or(1.0, Unit::mm);
    text.points.iter_mut().flatten().for_each(|value| *value *= mm);
    let found = grid(&text.points, None, budget);
    if let Err(NoGrid::Stopped(stopped)) = found {
        return Err(stopped.into());
    }
    let report = PointsReport::new(&text, &found, |fault| no_grid(fault, &text.lines));
    let mut picture = toolpathd_plot::Drawing::default();
    let at = |k: usize| Point3::from(text.points[k]);
    let shape = match &found {
        Ok(grid) => {
            picture.surface.extend(grid.rows.iter().map(|row| row.iter().map(|&k| at(k)).collect()));
            let columns = 0..grid.rows[0].len();
            let columns = columns.map(|i| grid.rows.iter().map(|row| at(row[i])).collect());
            picture.surface.extend(columns);
            let points = picture.surface[..grid.rows.len()].to_vec();
            Shape::Grid(PointGrid { points, twist: Twist::default(), ends: Ends::Usual })
        }
        Err(_) => {
            picture.poses.extend(text.points.iter().map(|point| Point3::from(*point)));
            Shape::Nothing
        }
    };
    let bounds = FileBox::around(text.points.iter().copied());
    let PointText { unit, left_out, .. } = text;
    let (format, points) = (FileFormat::Points, Some(report));
    let has_unit = unit.is_some();
    Ok(Found { format, unit, has_unit, bounds, drawing: None, model: None, points, left_out, shape, picture })
}

/// Points along an edge in a picture.
const POINTS_OF_EDGE: usize = 24;

fn model(job: &Inspection, budget: &Budget) -> Result<Found, ApiError> {
    let model = step::read(&job.bytes, budget).map_err(|fault| unreadable(job, fault))?;
    let mm = job.units.map_or(1.0, |units| Unit::from(units).mm() / model.mm_per_unit);
    let mut picture = toolpathd_plot::Drawing::default();
    for edge in model.faces.iter().flat_map(|face| &face.loops).flat_map(|own| &own.edges) {
        budget.check()?;
        let at = |k: usize| edge.from + (edge.to - edge.from) * k as f64 / POINTS_OF_EDGE as f64;
        picture.solids.push((0..=POINTS_OF_EDGE).map(|k| edge.curve.point(at(k)) * mm).collect());
    }
    let corner = |corner: Point3<f64>| <[f64; 3]>::from(corner * mm);
    let bounds = model.bounds_mm.map(|[min, max]| FileBox { min: corner(min), max: corner(max) });
    Ok(Found {
        format: FileFormat::Step,
        unit: model.unit,
        has_unit: model.is_unit_stated,
        bounds,
        drawing: None,
        model: Some(ModelContents::new(&model, mm)),
        points: None,
        left_out: model.left_out,
        shape: Shape::Nothing,
        picture,
    })
}

/// The points of a chain of vertices with bulges, in the plane z = 0.
fn polyline(vertices: &[[f64; 3]], is_closed: bool) -> Vec<Point3<f64>> {
    let elements: Vec<Segment> = segments(vertices, is_closed).collect();
    let mut points = Vec::with_capacity(elements.len() + 1);
    for element in &elements {
        let count = (element.turn().abs() / LARGEST_TURN).ceil().max(1.0) as usize;
        points.extend((0..count).map(|k| element.at(k as f64 / count as f64)));
    }
    points.extend(elements.last().map(Segment::end));
    points.into_iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect()
}

fn unreadable(job: &Inspection, fault: Unreadable) -> ApiError {
    match fault {
        Unreadable::Stopped(stopped) => stopped.into(),
        fault => blamed(FieldCode::UnreadableFile, format!("`{}`: {fault}", job.name)),
    }
}

/// The failure of a file.
fn blamed(code: FieldCode, detail: String) -> ApiError {
    ApiError::invalid(vec![FieldError::new(&Pointer::root().field("file"), code, detail)])
}
