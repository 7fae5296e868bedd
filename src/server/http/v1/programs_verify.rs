//! `POST /v1/programs/verify`: verifies a program or a toolpath against part, stock, fixtures and travel.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use nalgebra::{Point2, Point3};

use crate::config::Limits;
use crate::http::answer::model::{PART_CHORD_MM, Solids};
use crate::http::answer::{Cut, Outcome, Product, answer};
use crate::http::app::App;
use crate::http::decode::{SentJob, job};
use crate::http::dto::answer::{Answer, PathMembers};
use crate::http::dto::dialect;
use crate::http::dto::setup::Setup;
use crate::http::dto::verification::{
    Asked, Digests, Lines, MOST_CELLS, NumberedTool, Path, Premises, Receipt, Told, Verification,
    VerifyMembers, VerifyQuery, VerifyReport, VerifyRequest,
};
use crate::http::error::{ApiError, Code};
use crate::http::messages::{Warning, not_read, tool_not_told, words_left_alone_in};
use crate::http::pointer::Pointer;
use crate::http::request::body::JobBody;
use crate::http::request::negotiation::{Figures, Form, Offers, Wanted};
use crate::http::request::representation::Representation;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::operations::pocketing::{Outlines, PocketError};
use toolpathd_core::operations::verification::{self as core, Part, Rapids, Raw, verify};
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::measure::measure_on;
use toolpathd_core::toolpath::program::{Program, Resolution, Units};
use toolpathd_nc::ReadProgram;
use toolpathd_nc::notes::Note;
use toolpathd_plot::Drawing;
use toolpathd_plot::gltf::{Stock, Triangles};
use toolpathd_plot::solid::{self, Slab};

/// The most sentences on findings beside a picture.
const MOST_SENTENCES: usize = 4;

/// The most upright edges of one outline in a picture.
const MOST_EDGES: usize = 12;

/// Chords that stand for an arc of an outline in a picture.
const CHORDS: usize = 24;

/// The answer in JSON.
type VerifyAnswer = Answer<VerifyReport, VerifyMembers>;

/// The forms of the answer, and its query.
pub enum Verdicts {}

impl Offers for Verdicts {
    const OFFERS: &'static [Representation] = Figures::OFFERS;
    const PARAMETERS: &'static [&'static str] = &["format", "toolpath", "glb", "points"];
    const HAS_TOOLPATH: bool = true;
    type Query = VerifyQuery;
}

/// Verify a program or a toolpath.
///
/// The answer bounds, over the whole of every move, how deep the cutter enters the part, how deep rapids
/// enter the stock, how near the tool comes to fixtures, and how near shank and holder come to anything; and
/// tells what is cut in the air and what is left. The verdict is `pass`, `fail` or `undecided`. Each finding
/// has its move, its line of the program and its place. With `?receipt=true` the answer holds a receipt,
/// which `toolpathd check` and small programs of others can check.
#[utoipa::path(post, path = "/v1/programs/verify", operation_id = "verifyProgram", tag = "programs",
    params(Wanted<Verdicts>, VerifyQuery), request_body = VerifyRequest,
    responses((status = 200, description = "The verdict with its figures, or a picture.", body = VerifyAnswer)))]
pub async fn verify_program(
    State(app): State<Arc<App>>,
    wanted: Wanted<Verdicts>,
    mut body: JobBody<VerifyRequest>,
) -> Result<Response, ApiError> {
    if wanted.query.receipt && body.has_parts() {
        let detail = "a receipt states the digest of a JSON body: send the files in `base64`";
        return Err(ApiError::new(Code::InvalidQuery, detail));
    }
    if wanted.query.receipt {
        let key = app.receipt_key.clone();
        body = body.with_body(move |job, text| {
            let asked = Asked { digests: Digests::of(text)?, key: key.clone() };
            Ok(Verification { receipt: Some(asked), ..job })
        });
    }
    answer(app.computing.clone(), wanted, body, verified).await
}

/// The receipt that an answer to `body` would have, without a signature.
///
/// # Errors
/// As the endpoint.
pub fn receipt_of(body: &[u8], limits: &Limits, budget: &Budget) -> Result<Option<Receipt>, ApiError> {
    let SentJob { job, .. } = job::<VerifyRequest>(body, limits, budget)?;
    let asked = Asked { digests: Digests::of(body)?, key: None };
    Ok(verified(Verification { receipt: Some(asked), ..job }, budget)?.product.receipt)
}

/// The toolpath that was verified.
struct Verified {
    cut: Cut,
    /// The line of each move; empty where a toolpath was sent.
    lines: Vec<u32>,
    stock: Option<Raw>,
    receipt: Option<Receipt>,
}

impl Product for Verified {
    type Members = VerifyMembers;

    const TITLE: &'static str = "Verified program";

    fn cut(&self) -> Option<&Cut> {
        Some(&self.cut)
    }

    fn read_lines(&self) -> &[u32] {
        &self.lines
    }

    fn solids(&self, budget: &Budget) -> Result<Solids, ApiError> {
        let stock = self.stock.as_ref().map(|raw| block(raw, budget)).transpose()?;
        let told = |triangles| Stock { triangles, is_assumed: false };
        Ok(Solids { stock: stock.flatten().map(told), ..Solids::default() })
    }

    fn members(self, _: Option<String>, form: &Form) -> VerifyMembers {
        let Self { cut: Cut { toolpath, .. }, receipt, .. } = self;
        let measures = Some(measure_on(&toolpath, None));
        let with_toolpath = form.with_toolpath.unwrap_or(false);
        let path = PathMembers { measures, nc: None, toolpath: with_toolpath.then(|| toolpath.into()) };
        VerifyMembers { path, receipt }
    }
}

/// A toolpath with the index of the tool of each pass.
struct Tooled {
    toolpath: Toolpath,
    tool_of_pass: Vec<usize>,
    rapids: Rapids,
    /// How far arcs were moved to become exact, mm.
    moved_mm: f64,
    program: Option<ReadProgram>,
}

fn verified(job: Verification, budget: &Budget) -> Result<Outcome<VerifyReport, Verified>, ApiError> {
    let premises = Premises::of(&job)?;
    let Verification {
        path,
        tools,
        is_list,
        part,
        stock,
        cell_mm,
        fixtures,
        travel,
        tolerance_mm,
        control_tolerance_mm,
        clearance_mm,
        allowed_excess_mm,
        rapids,
        meta,
        receipt,
    } = job;
    let Tooled { toolpath, tool_of_pass, rapids: usual, moved_mm, program } =
        tooled(path, &tools, is_list, budget)?;
    if receipt.is_some() {
        Receipt::check_moves(toolpath.moves().count(), program.is_some())?;
    }
    let told = Told {
        holders: tools.iter().all(|tool| tool.has_holder),
        flutes: tools.iter().all(|tool| tool.tool.flute_length_mm.is_some()),
    };
    let job = core::Job {
        toolpath,
        tools: tools.into_iter().map(|tool| tool.tool).collect(),
        tool_of_pass,
        part,
        stock,
        cell_mm,
        most_cells: MOST_CELLS,
        fixtures,
        travel,
        tolerance_mm,
        control_tolerance_mm: control_tolerance_mm + moved_mm,
        clearance_mm,
        allowed_excess_mm,
        rapids: rapids.unwrap_or(usual),
        lists_moves: receipt.is_some(),
    };
    let found = verify(&job, budget)?;
    let lines = program.as_ref().map(|program| Lines {
        of_moves: &program.lines,
        n_rapids_not_counted: program.n_rapids_not_counted,
    });
    let report = VerifyReport::new(&found, &job, &told, lines.as_ref());
    let premises = premises.read(moved_mm, job.rapids);
    let receipt =
        receipt.map(|asked| Receipt::new(asked, premises, &report, &found, lines.as_ref())).transpose()?;
    let notes = program.iter().flat_map(|program| program.notes.iter().map(Warning::from));
    let left = program.iter().flat_map(|program| words_left_alone_in(&program.left_alone));
    let warnings = notes.chain(left).collect();
    let program_lines = program.map(|program| program.lines);
    let program = Program::plain(Resolution { units: Units::Mm, decimals: 3 });
    let setup = Setup::of_program(dialect::DEFAULT, program);
    let (solids, findings) = (solids(&job), places(&found));
    let comments = report.sentences(MOST_SENTENCES);
    let (lines, stock) = (program_lines.unwrap_or_default(), job.stock);
    let cut = Cut { toolpath: job.toolpath, cutting: None, setup, comments, nc: None };
    let drawing = Box::new(move || Drawing {
        solids: solids.clone(),
        findings: findings.clone(),
        ..Drawing::default()
    });
    Ok(Outcome { meta, warnings, report, product: Verified { cut, lines, stock, receipt }, drawing })
}

/// The triangles of a raw part; none where its outlines cannot be drawn.
fn block(raw: &Raw, budget: &Budget) -> Result<Option<Triangles>, ApiError> {
    let (outlines, bottom_z_mm, top_z_mm) = raw.outlines();
    let slab = |region| solid::triangles(&[Slab { top_z_mm, bottom_z_mm, region }], PART_CHORD_MM, budget);
    let made = outlines.region(budget).and_then(|region| Ok(slab(region)?));
    match made {
        Ok(triangles) => Ok(Some(triangles)),
        Err(PocketError::Stopped(stopped)) => Err(stopped.into()),
        Err(_) => Ok(None),
    }
}

/// The outlines of part, stock and fixtures at their tops and bottoms.
fn solids(job: &core::Job) -> Vec<Vec<Point3<f64>>> {
    let mut wires = Vec::new();
    let mut add = |outlines: &Outlines, heights: &[f64]| {
        let at = |p: Point2<f64>, z: f64| Point3::new(p.x, p.y, z);
        for outline in std::iter::once(&outlines.boundary).chain(&outlines.islands) {
            let chords = |side: &Segment| if side.turn() == 0.0 { 1 } else { CHORDS };
            let on =
                |side: &Segment, n: usize| (0..n).map(|k| side.at(k as f64 / n as f64)).collect::<Vec<_>>();
            let points: Vec<Point2<f64>> = outline.iter().flat_map(|side| on(side, chords(side))).collect();
            for z in heights {
                wires.push(points.iter().chain(points.first()).map(|p| at(*p, *z)).collect());
            }
            let corners = outline.iter().take(MOST_EDGES).map(Segment::start);
            wires.extend(corners.map(|corner| heights.iter().map(|z| at(corner, *z)).collect()));
        }
    };
    if let Some(Part::Pocket { outlines, top_mm, floor_mm }) = &job.part {
        add(outlines, &[*top_mm, *floor_mm]);
    }
    if let Some(raw) = &job.stock {
        let (outlines, bottom_mm, top_mm) = raw.outlines();
        add(&outlines, &[bottom_mm, top_mm]);
    }
    for fixture in &job.fixtures {
        add(&fixture.outlines, &[fixture.bottom_mm, fixture.top_mm]);
    }
    wires
}

/// The places of the findings.
fn places(found: &core::Report) -> Vec<Point3<f64>> {
    found.findings.listed.iter().filter_map(|finding| finding.at).collect()
}

/// Reads a program where one was sent, and finds the tool of each pass.
fn tooled(path: Path, tools: &[NumberedTool], is_list: bool, budget: &Budget) -> Result<Tooled, ApiError> {
    let reading = match path {
        Path::Toolpath { toolpath, moved_mm } => {
            let tool_of_pass = vec![0; toolpath.passes().len()];
            return Ok(Tooled { toolpath, tool_of_pass, rapids: Rapids::Straight, moved_mm, program: None });
        }
        Path::Program(reading) => reading,
    };
    let control = reading.control()?;
    let at = Pointer::root().field("nc");
    let mut program =
        toolpathd_nc::read(&reading.read_job(control), budget).map_err(|error| not_read(error, &at))?;
    let toolpath = std::mem::replace(&mut program.toolpath, Toolpath::empty());
    let mut tool_of_pass = vec![0; toolpath.passes().len()];
    let first = program.tools.iter().find(|used| used.n_passes > 0);
    let first = first.map(|used| (used.number, used.name.as_deref()));
    for used in program.tools.iter().filter(|used| used.n_passes > 0) {
        let is_first = Some((used.number, used.name.as_deref())) == first;
        let is_called = |tool: &NumberedTool| match (tool.number, used.number) {
            (Some(own), Some(called)) => own == called,
            // One tool without a number, or before any tool change, is the tool of the whole program.
            _ => match (&tool.name, &used.name) {
                (Some(own), Some(called)) => own.eq_ignore_ascii_case(called),
                _ => tools.len() == 1 && is_first,
            },
        };
        let Some(own) = tools.iter().position(is_called) else {
            return Err(tool_not_told(used, is_list));
        };
        tool_of_pass[used.first_pass..used.first_pass + used.n_passes].fill(own);
    }
    let rapids = if control.runs_straight { Rapids::Straight } else { Rapids::DogLeg };
    let moved = program.notes.iter().map(|note| match note {
        Note::ArcsMoved { most_mm, .. } => *most_mm,
        _ => 0.0,
    });
    let moved_mm = moved.fold(0.0, f64::max);
    Ok(Tooled { toolpath, tool_of_pass, rapids, moved_mm, program: Some(program) })
}
