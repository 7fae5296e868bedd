//! Texts for people in an answer: the notes beside a drawing, and the comments at the head of an NC program.

use super::{Cut, Outcome, Product};
use crate::http::dto::meta;
use crate::http::dto::setup::Setup;
use crate::http::messages::{Warning, WarningCode};
use crate::http::request::negotiation::PictureView;
use toolpathd_core::toolpath::cutting::{Coolant, Cutting};
use toolpathd_core::toolpath::measure::measure;
use toolpathd_core::toolpath::motion_time::motion_time;
use toolpathd_core::toolpath::program::{Program, Units};
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_plot::Scene;
use toolpathd_plot::bars::{self, BarScene};
use toolpathd_plot::diagram::{self, DiagramScene};
use toolpathd_post::clock;

/// The entry of `meta` that is the title of a picture.
const PART_ID: &str = "part_id";

/// The picture as SVG, with the notes below it.
pub fn picture<R, P: Product>(outcome: &Outcome<R, P>, view: PictureView) -> String {
    let draw = match view {
        PictureView::Plan => toolpathd_plot::svg,
        PictureView::Axonometric => toolpathd_plot::axonometric,
    };
    draw(&Scene {
        title: &title(outcome),
        notes: &lines(outcome),
        warnings: &warnings(outcome),
        toolpath: outcome.product.cut().map(|cut| &cut.toolpath),
        drawing: &(outcome.drawing)(),
    })
}

/// The diagrams of the product as SVG.
pub fn diagrams<R, P: Product>(outcome: &Outcome<R, P>) -> String {
    diagram::svg(&DiagramScene {
        title: &title(outcome),
        notes: &lines(outcome),
        warnings: &warnings(outcome),
        diagrams: outcome.product.diagrams(),
        before: "given path at the feed, no ramps",
        after: "smooth path",
    })
}

/// The charts of the product as SVG sheets, one after the other.
pub fn charts<R, P: Product>(outcome: &Outcome<R, P>) -> String {
    bars::svg(&BarScene {
        title: &title(outcome),
        notes: &lines(outcome),
        warnings: &warnings(outcome),
        charts: outcome.product.charts(),
        parts: ["cutting", "rapids, and feed in the air"],
    })
}

/// The warnings beside a picture.
fn warnings<R, P: Product>(outcome: &Outcome<R, P>) -> Vec<String> {
    told(&outcome.warnings).into_iter().map(|warning| format!("WARNING: {warning}")).collect()
}

/// The lines beside a picture below the warnings: notes, and what a setter needs.
fn lines<R, P: Product>(outcome: &Outcome<R, P>) -> Vec<String> {
    let setup = outcome.product.cut().map(setup).into_iter().flatten();
    notes(outcome).into_iter().chain(setup).collect()
}

/// The title of a picture: the part's id, else the program's name, else what the picture shows.
pub fn title<R, P: Product>(outcome: &Outcome<R, P>) -> String {
    let part_id = outcome.meta.as_ref().and_then(|meta| meta.get(PART_ID));
    let name = || outcome.product.cut().and_then(|cut| cut.setup.program.name.as_ref());
    part_id.or_else(name).map_or_else(|| P::TITLE.to_owned(), Clone::clone)
}

/// The lines that a setter needs: program, work offset, tool, spindle, coolant, feeds, clearance and cycle
/// time.
fn setup(cut: &Cut) -> Vec<String> {
    let Cut { toolpath, cutting, setup: Setup { tool, program, dialect, .. }, comments: _, nc: _ } = cut;
    let Some(cutting) = cutting else { return tool.iter().map(tool_line).collect() };
    let mut lines = vec![program_line(program, dialect.name), offset_line(program)];
    lines.extend(tool.iter().map(tool_line));
    lines.extend(driving_lines(cutting));
    let plain = measure(toolpath, cutting.rapid_feed).total_time_s;
    if let Some((plain, with_ramps)) =
        plain.zip(motion_time(toolpath, cutting.rapid_feed, cutting.acceleration))
    {
        lines.push(
            format!("cycle time: {}, with acceleration {}", clock(plain), clock(with_ramps)).to_lowercase(),
        );
    }
    lines
}

/// One operation of several in one line: tool, work offset, spindle and coolant.
pub fn operation_line(tool: Option<&Tool>, program: &Program, cutting: &Cutting) -> String {
    let tool = tool.map(|tool| format!("T{} {} {} mm", tool.places().0, shape(tool).0, 2.0 * tool.radius_mm));
    let offset = program.work_offset.map(|number| format!("G{number}"));
    let [driving, ..] = driving_lines(cutting);
    let parts = tool.into_iter().chain(offset).chain([driving]);
    parts.collect::<Vec<_>>().join(", ")
}

fn program_line(program: &Program, dialect: &str) -> String {
    let name = program.name.as_ref().map_or(String::new(), |name| format!(" \"{name}\""));
    let units = match program.resolution.units {
        Units::Mm => "mm",
        Units::Inch => "inches",
    };
    format!("program: {}{name} for {dialect}, {units}", program.number)
}

fn offset_line(program: &Program) -> String {
    match program.work_offset {
        Some(number) => format!("work offset: G{number}; its zero is X0 Y0 Z0 of this sheet"),
        None => "work offset: the active one; set its zero to X0 Y0 Z0 of this sheet".to_owned(),
    }
}

/// The name of a cutter's shape, and what else tells its shape.
fn shape(tool: &Tool) -> (&'static str, String) {
    match tool.shape {
        Shape::Ball => ("ball", String::new()),
        Shape::Flat => ("flat", String::new()),
        Shape::BullNose { corner_radius_mm } => {
            ("bull nose", format!(", corner radius {corner_radius_mm} mm"))
        }
        Shape::V { tip_angle_deg, tip_diameter_mm } => {
            ("v", format!(", tip angle {tip_angle_deg} degrees, tip diameter {tip_diameter_mm} mm"))
        }
        Shape::Cone { taper_angle_deg, tip_diameter_mm } => {
            ("cone", format!(", taper {taper_angle_deg} degrees, tip diameter {tip_diameter_mm} mm"))
        }
        Shape::Drill { point_angle_deg } => {
            ("drill", point_angle_deg.map_or(String::new(), |deg| format!(", point angle {deg} degrees")))
        }
    }
}

fn tool_line(tool: &Tool) -> String {
    let (shape, more) = shape(tool);
    let (number, length_offset) = tool.places();
    format!("tool T{number} H{length_offset}: {shape}, diameter {} mm{more}", 2.0 * tool.radius_mm)
}

fn driving_lines(cutting: &Cutting) -> [String; 3] {
    let spindle = cutting.spindle_rpm.map_or("not started".to_owned(), |rpm| format!("{rpm} rpm"));
    let coolant = match cutting.coolant {
        Coolant::Off => "off",
        Coolant::Flood => "flood",
        Coolant::Mist => "mist",
    };
    let [feed, plunge] =
        [cutting.feed, cutting.plunge_feed].map(|feed| (feed.mm_per_min() * 1000.0).round() / 1000.0);
    [
        format!("spindle: {spindle}, coolant: {coolant}"),
        format!("feed: {feed}, plunge: {plunge} mm/min"),
        format!("clearance: Z {:.3} mm", cutting.clearance_z_mm),
    ]
}

/// Warnings as lines for a program and a sheet: the code, then the detail.
pub fn told(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(|warning| format!("{} - {}", warning.code.name(), warning.detail)).collect()
}

/// Warnings as lines for a program. The header of a program tells of its feeds itself.
pub fn told_in_program(warnings: &[Warning]) -> Vec<String> {
    let others = warnings.iter().filter(|warning| warning.code != WarningCode::FeedRounded).cloned();
    told(&others.collect::<Vec<_>>())
}

/// The texts of the caller's `meta`, what is told of the tool, and the comments of the operation.
pub fn notes<R, P: Product>(outcome: &Outcome<R, P>) -> Vec<String> {
    let mut notes: Vec<String> = meta::notes(outcome.meta.as_ref()).collect();
    if let Some(cut) = outcome.product.cut() {
        notes.extend(cut.setup.body.note());
        notes.extend(cut.comments.iter().cloned());
    }
    notes
}
