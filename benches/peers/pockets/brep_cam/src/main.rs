//! Reads a pocket as JSON from the standard input, lets BREP_cam plan it, and writes the path as G-code.
//!
//! The pocket: `radius`, `stepover`, `floor`, `feed`, `operation` (`pocket` or `adaptive`), `helix`
//! (diameter, 0 to plunge), `tolerance`, `loops` (outlines of edges `[x0, y0, x1, y1]` or `[x0, y0, x1, y1,
//! xc, yc, ccw]`) and `triangles` of the part, nine numbers each.

use std::io::Read;
use std::time::Instant;

use brep_cam::link::with_pre_op_stock;
use brep_cam::planar::machining::{PlanarInput, PlanarRegion};
use brep_cam::planar::{Loop, Region, Segment};
use brep_cam::*;
use serde_json::Value;

const SOLID: &str = "part";

fn main() {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).expect("the pocket on the standard input");
    let pocket: Value = serde_json::from_str(&text).expect("a pocket as JSON");
    match plan(&pocket) {
        Ok((path, seconds)) => print(&path, seconds),
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(1);
        }
    }
}

fn number(of: &Value) -> f64 {
    of.as_f64().expect("a number")
}

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().expect("numbers").iter().map(number).collect()
}

fn plan(pocket: &Value) -> Result<(Toolpath, f64), CamError> {
    let tolerance = Tolerance::default();
    let (radius, floor, feed) = (number(&pocket["radius"]), number(&pocket["floor"]), number(&pocket["feed"]));

    let loops = pocket["loops"].as_array().expect("loops").iter().map(outline).collect();
    let region = Region::from_unoriented(loops, &tolerance).map_err(|e| CamError::InvalidInput(format!("region: {e:?}")))?;
    let mut builder = MeshBuilder::new(tolerance);
    let face = builder.add_face(FaceSource { solid: SOLID.into(), face: "all".into(), protected_only: false });
    for t in pocket["triangles"].as_array().expect("triangles") {
        let c = numbers(t);
        let corner = |k: usize| Point3::new(c[3 * k], c[3 * k + 1], c[3 * k + 2]);
        builder.add_triangle(face, corner(0), corner(1), corner(2)).map_err(|e| CamError::InvalidInput(e.to_string()))?;
    }
    let mesh = builder.finish();
    let index = TreeIndex::build(&mesh, TreeOptions::default());

    let mut tool = Tool::new("tool", 1, ToolKind::Flat, ToolGeometry::flat(2.0 * radius, 30.0));
    tool.feeds = FeedsSpeeds { cutting_feed: feed, plunge_feed: feed / 2.0, ..FeedsSpeeds::default() };
    let mut setup = Setup::new("setup", "");
    setup.heights = Heights { clearance: 2.5, retract: 2.0, feed: 2.0, top: Some(0.0), bottom: Some(floor) };

    let depths = Depths { top: Some(0.0), bottom: Some(floor), ..Depths::default() };
    let distance = number(&pocket["stepover"]);
    let adaptive = pocket["operation"] == "adaptive";
    let strategy = if adaptive {
        Strategy::Adaptive2D(Adaptive2dParams { depths, optimal_load: distance, ..Adaptive2dParams::default() }.into())
    } else {
        let stepover = Stepover { distance, ..Stepover::default() };
        Strategy::Pocket2D(Pocket2dParams { depths, stepover, offset_pattern: true, wall_finish: true, keep_islands: true }.into())
    };
    let mut operation = Operation::new("operation", "", "setup", "tool", strategy);
    operation.targets = TargetSelection::solids([SOLID]);
    operation.tolerance = number(&pocket["tolerance"]);
    operation.linking.keep_down_distance = number(&pocket["keep_down"]);
    let helix = number(&pocket["helix"]);
    if helix > 0.0 {
        operation.linking.ramp = Ramp { kind: RampKind::Helix, angle_deg: 5.0, helix_diameter: helix, clearance: 0.0 };
    }

    let input = PlanarInput {
        regions: vec![PlanarRegion { region, z: floor, upward: true }],
        chains: Vec::new(),
        circles: Vec::new(),
        stock_top: Some(0.0),
    };
    let mut sink = NullSink;
    let mut runner = Runner::detached(&mut sink);
    let begun = Instant::now();
    let path = with_pre_op_stock(None, || {
        if adaptive {
            adaptive2d::generate(&operation, &setup, &tool, &mesh, Some(&index), &input, None, tolerance, &mut runner)
        } else {
            pocket2d::generate(&operation, &setup, &tool, &mesh, Some(&index), &input, tolerance, &mut runner)
        }
    })?;
    Ok((path, begun.elapsed().as_secs_f64()))
}

fn outline(edges: &Value) -> Loop {
    let edge = |value: &Value| {
        let e = numbers(value);
        let (start, end) = (Point2::new(e[0], e[1]), Point2::new(e[2], e[3]));
        if e.len() > 4 { Segment::arc(start, end, Point2::new(e[4], e[5]), e[6] > 0.0) } else { Segment::line(start, end) }
    };
    Loop::new(edges.as_array().expect("edges").iter().map(edge).collect())
}

/// Links above the top become rapids: the crate says that posts may do so.
fn print(path: &Toolpath, seconds: f64) {
    println!("(SECONDS {seconds})");
    for warning in &path.report.warnings {
        println!("({}: {})", warning.code, warning.message.replace(['(', ')', '\n'], " "));
    }
    let mut at: Option<Point3> = None;
    for motion in &path.motions {
        let Some(to) = motion.end() else { continue };
        let above = to.z > 0.0 && at.is_some_and(|from| from.z > 0.0);
        match &motion.kind {
            MotionKind::ArcCw { center, .. } | MotionKind::ArcCcw { center, .. } => {
                let from = at.expect("an arc starts somewhere");
                let word = if matches!(motion.kind, MotionKind::ArcCw { .. }) { 2 } else { 3 };
                println!("G{word} X{} Y{} Z{} I{} J{}", to.x, to.y, to.z, center.x - from.x, center.y - from.y);
            }
            _ => println!("G{} X{} Y{} Z{}", if motion.feed.is_rapid() || above { 0 } else { 1 }, to.x, to.y, to.z),
        }
        at = Some(to);
    }
}
