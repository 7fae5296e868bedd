//! `POST /v1/pockets/plan`: plans the clearing of a pocket, and answers a toolpath, an NC program or a
//! picture.

mod charts;
mod solids;

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use nalgebra::Point3;

use crate::http::answer::model::Solids;
use crate::http::answer::{Computing, Cut, Outcome, Product, answer};
use crate::http::dto::answer::{Answer, PathMembers};
use crate::http::dto::pocketing::PocketRequest;
use crate::http::dto::setup::JobWithSetup;
use crate::http::error::ApiError;
use crate::http::messages::Warning;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Form, Toolpaths, Wanted};
use solids::Bodies;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::operations::pocketing::{self, Job, LevelOutlines, LevelStart, Plan, Report};
use toolpathd_core::toolpath::measure::{Bounds, measure};
use toolpathd_core::toolpath::tool_body::Depths;
use toolpathd_core::toolpath::units::{FeedRate, rounded_up};
use toolpathd_plot::Drawing;
use toolpathd_plot::bars::BarChart;
use toolpathd_post::PassNote;

/// The answer in JSON.
type PocketAnswer = Answer<Report>;

/// Plan the clearing of a pocket.
///
/// The answer is the toolpath with the figures of every pattern on every level, the NC program, or a picture.
#[utoipa::path(post, path = "/v1/pockets/plan", operation_id = "planPocket", tag = "pockets",
    params(Wanted<Toolpaths>), request_body = PocketRequest,
    responses((status = 200, description = "The toolpath, the program or a picture.", body = PocketAnswer)))]
pub async fn plan_pocket(
    State(computing): State<Computing>,
    wanted: Wanted<Toolpaths>,
    body: JobBody<PocketRequest>,
) -> Result<Response, ApiError> {
    answer(computing, wanted, body, plan).await
}

/// The toolpath, with what program and page tell of its levels.
struct PlannedPath {
    cut: Cut,
    pass_notes: Vec<PassNote>,
    charts: Vec<BarChart>,
    bodies: Arc<Bodies>,
}

impl Product for PlannedPath {
    type Members = PathMembers;

    const TITLE: &'static str = Cut::TITLE;

    fn cut(&self) -> Option<&Cut> {
        Some(&self.cut)
    }

    fn charts(&self) -> &[BarChart] {
        &self.charts
    }

    fn solids(&self, budget: &Budget) -> Result<Solids, ApiError> {
        self.bodies.solids(budget)
    }

    fn pass_notes(&self) -> &[PassNote] {
        &self.pass_notes
    }

    fn members(self, written: Option<String>, form: &Form) -> PathMembers {
        self.cut.members(written, form)
    }
}

fn plan(job: JobWithSetup<Job>, budget: &Budget) -> Result<Outcome<Report, PlannedPath>, ApiError> {
    let JobWithSetup { job, mut setup, meta } = job;
    let plan = pocketing::plan(&job, budget)?;
    setup.check_depths(&depths(&plan), ("/stepdown_max_mm", "send a smaller `stepdown_max_mm`"))?;
    let doubts = pocketing::doubts(&job, &plan, budget)?;
    let Plan { toolpath, report, outlines, starts, cutting, warnings, .. } = plan;
    let cut = Cut { toolpath, cutting: Some(cutting), setup, comments: vec![proved(&report)], nc: None };
    let bodies = Arc::new(Bodies::new(&job, outlines));
    let of_drawing = Arc::clone(&bodies);
    Ok(Outcome {
        meta,
        warnings: warnings.iter().map(Warning::from).chain(doubts.iter().map(Warning::from)).collect(),
        product: PlannedPath {
            cut,
            pass_notes: pass_notes(&starts, &report),
            charts: charts::charts(&report, job.choose_by),
            bodies,
        },
        report,
        drawing: Box::new(move || drawing(&of_drawing.levels)),
    })
}

/// The remarks of the program before the first pass of each level, and before the passes that finish walls.
fn pass_notes(starts: &[LevelStart], report: &Report) -> Vec<PassNote> {
    let (n_levels, n_pockets) = (report.levels.len(), charts::n_pockets(report));
    let note = |start: &LevelStart| {
        let &LevelStart { pass, level, z_mm, pattern } = start;
        let (label, text) = match pattern {
            Some(pattern) => ("LEVEL", format!("{} OF {n_levels} - {}", level + 1, charts::words(pattern))),
            None => ("FINISH", "WALLS AND ISLANDS".to_owned()),
        };
        let of_regions = charts::of_regions(&report.levels[level], n_pockets, " - ");
        PassNote { pass, label, text: text + &of_regions, z_mm }
    };
    starts.iter().map(note).collect()
}

/// How deep the cutter goes below the top of stock and part, and how deep the deepest level is.
fn depths(plan: &Plan) -> Depths {
    let Bounds { min, .. } = measure(&plan.toolpath, FeedRate::DEFAULT_RAPID).bounds;
    let levels = plan.outlines.iter().zip(&plan.report.levels);
    let cut = levels.filter(|(_, report)| report.chosen.is_some());
    let at_once_mm = cut.map(|(level, _)| level.top_z_mm - level.z_mm).reduce(f64::max);
    Depths { whole_mm: plan.highest_mm - min.z, at_once_mm }
}

/// The walls and the islands of each level, at the level's top and floor, and the edges of what stays uncut.
fn drawing(levels: &[LevelOutlines]) -> Drawing {
    let mut drawing = Drawing::default();
    for level in levels {
        let at_floor = |outline: &Vec<Segment>| polyline(outline, level.z_mm);
        drawing.walls.extend(level.pocket.iter().map(|outline| polyline(outline, level.top_z_mm)));
        drawing.walls.extend(level.pocket.iter().map(at_floor));
        drawing.uncut.extend(level.uncut.iter().map(at_floor));
    }
    drawing
}

/// Largest turn of the part of an arc that is drawn as one straight line, radians.
const LARGEST_TURN: f64 = 0.1;

fn polyline(chain: &[Segment], z: f64) -> Vec<Point3<f64>> {
    let mut points = Vec::with_capacity(chain.len() + 1);
    for element in chain {
        let count = (element.turn().abs() / LARGEST_TURN).ceil().max(1.0) as usize;
        points.extend((0..count).map(|k| element.at(k as f64 / count as f64)));
    }
    points.extend(chain.last().map(Segment::end));
    points.into_iter().map(|p| Point3::new(p.x, p.y, z)).collect()
}

/// The line with the proved figures for the program's header. The gouge is rounded up. The levels of several
/// pockets count for each of them.
fn proved(report: &Report) -> String {
    let n_levels = report.levels.len();
    let of_pockets = match charts::n_pockets(report) {
        0 | 1 => String::new(),
        count => format!(" OF {count} POCKETS"),
    };
    format!(
        "PROVED GOUGE {:.4} MM - UNCUT {:.1} MM2 ON {n_levels} LEVEL{}{of_pockets}",
        rounded_up(report.gouge_max_mm),
        report.uncut_area_mm2,
        if n_levels == 1 { "" } else { "S" }
    )
}
