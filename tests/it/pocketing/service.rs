//! Requests for pockets to the service, and the moves of its answers.

use std::sync::Arc;

use serde_json::{Value, json};
use toolpathd_server::http::App;

use super::plane::{Outline, P, Piece, Vertex};
use crate::api::support::{self, post};

/// The top of the stock in all requests, mm.
pub const TOP_MM: f64 = 0.0;

/// The retract plane of all requests, mm.
pub const RETRACT_MM: f64 = 3.0;

/// Two patterns that are planned fast.
pub const FAST: [&str; 2] = ["zigzag_stock_offset", "island_stock_offset"];

/// All patterns.
pub const ALL: [&str; 7] = [
    "island_offset",
    "island_stock_offset",
    "zigzag_offset",
    "zigzag_stock_offset",
    "continuous_offset",
    "continuous_stock_offset",
    "engagement",
];

const PLAN: &str = "/v1/pockets/plan";

/// Heights that differ by less are the same, mm.
const SAME_MM: f64 = 1e-9;

/// A service with one worker, which may take long for an answer.
pub fn app() -> Arc<App> {
    support::app(&["--workers", "1", "--deadline-s", "120"])
}

/// A cutter and the heights between which it cuts.
#[derive(Debug, Clone, Copy)]
pub struct Cut {
    pub diameter_mm: f64,
    pub stepover_mm: f64,
    pub floor_mm: f64,
    pub stepdown_mm: f64,
}

impl Cut {
    pub fn radius_mm(&self) -> f64 {
        0.5 * self.diameter_mm
    }

    /// A request without a shape.
    pub fn request(&self, patterns: &[&str]) -> Value {
        json!({
            "floor_z_mm": self.floor_mm,
            "stepdown_max_mm": self.stepdown_mm,
            "tool": { "shape": "flat", "diameter_mm": self.diameter_mm },
            "stepover_mm": self.stepover_mm,
            "patterns": patterns,
            "cutting": { "feed_mm_per_min": 800, "retract_z_mm": RETRACT_MM },
        })
    }
}

/// The request with another member.
pub fn with(request: &Value, name: &str, member: Value) -> Value {
    let mut request = request.clone();
    request[name] = member;
    request
}

/// A wall and its islands.
pub struct Region {
    boundary: Vec<Vertex>,
    islands: Vec<Vec<Vertex>>,
    wall: Outline,
    stays: Vec<Outline>,
}

impl Region {
    pub fn new(boundary: Vec<Vertex>, islands: Vec<Vec<Vertex>>) -> Self {
        let wall = Outline::new(&boundary);
        let stays = islands.iter().map(|island| Outline::new(island)).collect();
        Self { boundary, islands, wall, stays }
    }

    pub fn json(&self) -> Value {
        json!({ "boundary": self.boundary, "islands": self.islands })
    }

    pub fn contains(&self, p: P) -> bool {
        self.wall.contains(p) && !self.stays.iter().any(|island| island.contains(p))
    }

    /// The box around the vertices of the wall.
    pub fn bounds(&self) -> [P; 2] {
        let vertices = self.wall.vertices();
        let extreme = |start: f64, pick: fn(f64, f64) -> f64| {
            [0, 1].map(|axis| vertices.iter().map(|vertex| vertex[axis]).fold(start, pick))
        };
        [extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max)]
    }
}

/// The answer to a legal request, with the toolpath and the program.
pub async fn planned(app: &Arc<App>, request: &Value) -> Value {
    let path = format!("{PLAN}?nc=true&toolpath=true");
    let answer = post(app, &path, request.to_string(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    answer.json()
}

/// The code of the problem, and the code and the pointer of each violation.
pub async fn refused(app: &Arc<App>, request: &Value) -> (String, Vec<(String, String)>) {
    let answer = post(app, PLAN, request.to_string(), &[]).await;
    assert_eq!(answer.status, 422, "{}", answer.text());
    (answer.code(), answer.violations())
}

/// Asserts that a request is refused for one violation only: one with this code at this place.
pub async fn assert_refused(app: &Arc<App>, request: &Value, code: &str, pointer: &str) {
    let (_, violations) = refused(app, request).await;
    assert_eq!(violations, [(code.to_owned(), pointer.to_owned())]);
}

/// The heights of the floors of all levels, mm.
pub fn floors(answer: &Value) -> Vec<f64> {
    let levels = answer["report"]["levels"].as_array().expect("levels");
    levels.iter().map(|level| level["z_mm"].as_f64().expect("a height")).collect()
}

/// The time of all moves, s.
pub fn seconds(answer: &Value) -> f64 {
    answer["report"]["total_time_s"].as_f64().expect("a time")
}

/// One move of the tip.
#[derive(Debug)]
pub struct Step {
    /// What the move is for; none for a rapid.
    pub role: Option<String>,
    pub piece: Piece,
    /// The heights at the start and at the end, mm.
    pub z: [f64; 2],
    /// The index of the level.
    pub level: Option<usize>,
}

impl Step {
    pub fn low(&self) -> f64 {
        self.z[0].min(self.z[1])
    }

    /// Whether the whole move is at this height.
    pub fn is_at(&self, z: f64) -> bool {
        self.z.iter().all(|own| (own - z).abs() <= SAME_MM)
    }
}

/// The moves of an answer, in order.
pub fn steps(answer: &Value) -> Vec<Step> {
    let toolpath = &answer["toolpath"];
    let mut at = point(&toolpath["start"]);
    let mut found = Vec::new();
    for pass in toolpath["passes"].as_array().expect("passes") {
        let level = pass["level"].as_u64().map(|level| usize::try_from(level).expect("an index"));
        for step in pass["moves"].as_array().expect("moves") {
            let to = point(&step["to"]);
            let (a, b) = ([at[0], at[1]], [to[0], to[1]]);
            let piece = match step["kind"].as_str() {
                Some("rapid" | "line") => Piece::Line { a, b },
                Some("arc") => {
                    assert_eq!(step["plane"], "xy", "an arc stands upright");
                    let [x, y, _] = point(&step["center"]);
                    Piece::arc(a, b, [x, y], step["direction"] == "ccw")
                }
                other => panic!("a pocket has no moves of the kind {other:?}"),
            };
            let role = step["role"].as_str().map(str::to_owned);
            found.push(Step { role, piece, z: [at[2], to[2]], level });
            at = to;
        }
    }
    found
}

fn point(value: &Value) -> [f64; 3] {
    [0usize, 1, 2].map(|axis| value[axis].as_f64().expect("a coordinate"))
}
