//! What is told of the solid in `block.step` plans its pockets and holes. The drawing of the block is written
//! here once more: the plans are measured against it.

use axum::http::StatusCode;
use serde_json::{Value, json};

use crate::api::parts::{BLOCK, INSPECT, block, send};
use crate::api::support::{app, post};

const PLAN: &str = "/v1/pockets/plan?points=true";

/// The top of the block, mm.
const TOP_MM: f64 = 30.0;

/// The distance between places that are looked at along a path, and between those of a floor, mm.
const STEP_MM: f64 = 0.2;

/// A path may cut into a wall by this much, mm: the planner's own tolerance with the chord of its points.
const GOUGE_MM: f64 = 3e-3;

/// A pocket of the drawing: a rectangle with rounded corners.
struct Drawn {
    floor_mm: f64,
    x: [f64; 2],
    y: [f64; 2],
    corner_mm: f64,
}

/// The two pockets, and the blind hole as a rectangle that is all corners.
const POCKETS: [Drawn; 3] = [
    Drawn { floor_mm: 20.0, x: [62.0, 92.0], y: [12.0, 68.0], corner_mm: 6.0 },
    Drawn { floor_mm: 14.0, x: [102.0, 128.0], y: [24.0, 56.0], corner_mm: 5.0 },
    Drawn { floor_mm: 12.0, x: [130.0, 136.0], y: [69.0, 75.0], corner_mm: 3.0 },
];

/// The middles of the holes that go through; their radius is 3 mm.
const HOLES: [[f64; 2]; 3] = [[97.0, 8.0], [133.0, 8.0], [97.0, 72.0]];

impl Drawn {
    /// The distance of a place from the wall, mm; positive inside.
    fn inside(&self, [x, y]: [f64; 2]) -> f64 {
        let beyond = |[low, high]: [f64; 2], at: f64| {
            (at - (low + high) / 2.0).abs() - ((high - low) / 2.0 - self.corner_mm)
        };
        let (dx, dy) = (beyond(self.x, x), beyond(self.y, y));
        self.corner_mm - f64::hypot(dx.max(0.0), dy.max(0.0)) - dx.max(dy).min(0.0)
    }

    fn area_mm2(&self) -> f64 {
        let sides = (self.x[1] - self.x[0]) * (self.y[1] - self.y[0]);
        sides - (4.0 - std::f64::consts::PI) * self.corner_mm * self.corner_mm
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn list(value: &Value) -> Vec<Value> {
    value.as_array().cloned().unwrap_or_else(|| panic!("{value} is no list"))
}

/// The outlines of a kind that look up, from the top down, each with the height of its level.
fn outlines(report: &Value, kind: &str) -> Vec<(f64, Value)> {
    let levels = list(&report["model"]["levels"]).into_iter();
    let all = levels.flat_map(|level| {
        list(&level["outlines"]).into_iter().map(move |outline| (number(&level["z_mm"]), outline))
    });
    all.filter(|(_, outline)| outline["kind"] == kind).collect()
}

/// A request as the document of the service makes it of an outline.
fn pocket(outline: &Value, floor_mm: f64, tool_mm: f64) -> Value {
    json!({
        "region": { "boundary": outline["vertices"], "islands": [] },
        "top_z_mm": outline["top_z_mm"], "floor_z_mm": floor_mm,
        "stepdown_max_mm": 3, "stepover_mm": 0.375 * tool_mm,
        "tool": { "shape": "flat", "diameter_mm": tool_mm },
        "cutting": { "feed_mm_per_min": 800, "spindle_rpm": 6000 },
    })
}

/// Places of the tip along the path of a plan.
async fn path(job: &Value) -> Vec<[f64; 3]> {
    let sent = post(&app(&[]), PLAN, job.to_string(), &[]).await;
    assert_eq!(sent.status, StatusCode::OK, "{}", sent.text());
    let points: Vec<[f64; 3]> =
        list(&sent.json()["polyline"]).iter().map(|point| [0, 1, 2].map(|k| number(&point[k]))).collect();
    let between = |pair: &[[f64; 3]]| {
        let [a, b] = [pair[0], pair[1]];
        let length = (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt();
        let n = (length / STEP_MM).ceil().max(1.0);
        (0..=n as usize).map(move |k| [0, 1, 2].map(|axis| a[axis] + (b[axis] - a[axis]) * k as f64 / n))
    };
    points.windows(2).flat_map(between).collect()
}

#[tokio::test]
async fn the_outlines_of_a_solid_are_the_pockets_of_its_drawing() {
    let report = block().await;
    let found = outlines(&report, "pocket");
    assert_eq!(found.len(), POCKETS.len());
    for ((floor, outline), drawn) in found.iter().zip(&POCKETS) {
        assert_eq!((*floor, &outline["top_z_mm"]), (drawn.floor_mm, &json!(TOP_MM)));
        assert_eq!((&outline["is_covered"], &outline["inner"]), (&json!(false), &json!([])));
        assert!(outline.get("open").is_none(), "{outline}");
        let area = number(&outline["area_mm2"]);
        assert!((area / drawn.area_mm2() - 1.0).abs() < 1e-9, "{area} {}", drawn.area_mm2());
        for vertex in list(&outline["vertices"]) {
            let off = drawn.inside([number(&vertex[0]), number(&vertex[1])]);
            assert!(off.abs() < 1e-9, "{vertex} is {off} mm from the wall");
        }
    }
    // On the top pockets and holes begin; only the freeform face goes up from one of its edges.
    let top = &outlines(&report, "open")[0];
    assert_eq!(top.0, TOP_MM);
    let inner = list(&top.1["inner"]);
    assert_eq!(inner.iter().filter(|own| own["kind"] == "opening").count(), 6, "{inner:?}");
    let range = list(&top.1["open"]);
    assert_eq!(range.len(), 1);
    let ends = [0, 1].map(|k| &top.1["vertices"][range[0][k].as_u64().unwrap_or(99) as usize]);
    assert_eq!(ends.map(|end| number(&end[0])), [50.0, 50.0]);
    // The bottom looks down, and nothing is told of walls.
    let bottom = list(&report["model"]["levels"]).into_iter().find(|level| level["is_up"] == false);
    let bottom = &bottom.expect("a bottom")["outlines"][0];
    for name in ["kind", "open", "top_z_mm", "is_covered"] {
        assert!(bottom.get(name).is_none(), "{bottom}");
    }
}

#[tokio::test]
async fn outlines_have_the_unit_of_the_request() {
    let files = [("part", "block.step", BLOCK)];
    let sent = send(INSPECT, Some(&json!({ "units": "inch" })), &files).await.json();
    let (floor, outline) = outlines(&sent["report"], "pocket").remove(0);
    assert!((floor - 20.0 * 25.4).abs() < 1e-9);
    assert!((number(&outline["vertices"][0][0]) - 62.0 * 25.4).abs() < 1e-9, "{outline}");
    assert!((number(&outline["area_mm2"]) / (POCKETS[0].area_mm2() * 25.4 * 25.4) - 1.0).abs() < 1e-9);
}

#[tokio::test]
async fn pockets_planned_from_outlines_clear_their_floors_and_leave_their_walls() {
    let report = block().await;
    for ((floor, outline), drawn) in outlines(&report, "pocket").iter().zip(&POCKETS) {
        let radius = if drawn.corner_mm < 5.0 { 2.0 } else { 4.0 };
        let path = path(&pocket(outline, *floor, 2.0 * radius)).await;
        let lowest = path.iter().map(|at| at[2]).fold(f64::MAX, f64::min);
        assert!((lowest - drawn.floor_mm).abs() < 1e-9, "{lowest}");
        for at in path.iter().filter(|at| at[2] < TOP_MM - 1e-9) {
            let room = drawn.inside([at[0], at[1]]);
            assert!(room > radius - GOUGE_MM, "{at:?} is {room} mm from the wall");
        }
        let on_floor: Vec<&[f64; 3]> = path.iter().filter(|at| at[2] < drawn.floor_mm + 1e-9).collect();
        let is_cleared = |x: f64, y: f64| {
            // The cutter passes between two places that are looked at nearer by less than this.
            let reach = radius + 0.01;
            on_floor.iter().any(|at| (at[0] - x).powi(2) + (at[1] - y).powi(2) < reach * reach)
        };
        let place = |[low, _]: [f64; 2], k: usize| low + STEP_MM * (k as f64 + 0.5);
        let count = |[low, high]: [f64; 2]| ((high - low) / STEP_MM).round() as usize;
        let mut n_places = 0;
        for (i, j) in (0..count(drawn.x)).flat_map(|i| (0..count(drawn.y)).map(move |j| (i, j))) {
            let (x, y) = (place(drawn.x, i), place(drawn.y, j));
            if drawn.inside([x, y]) > 0.0 {
                n_places += 1;
                assert!(is_cleared(x, y), "the floor at {x}, {y} is not cleared");
            }
        }
        // The places stand for the floor: squares at its rim count as a whole or not at all.
        let area = f64::from(n_places) * STEP_MM * STEP_MM;
        assert!((area / drawn.area_mm2() - 1.0).abs() < 0.02, "{area} of {} mm2", drawn.area_mm2());
    }
}

#[tokio::test]
async fn holes_planned_as_round_pockets_stay_within_their_radius() {
    let report = block().await;
    let through: Vec<Value> =
        list(&report["model"]["holes"]).into_iter().filter(|hole| hole["is_through"] == true).collect();
    let regions: Vec<Value> = through
        .iter()
        .map(|hole| {
            let (x, y, r) =
                (number(&hole["start"][0]), number(&hole["start"][1]), number(&hole["diameter_mm"]) / 2.0);
            json!({ "boundary": [[x + r, y, 1], [x - r, y, 1]] })
        })
        .collect();
    let mut job = pocket(&json!({ "top_z_mm": through[0]["start"][2] }), -0.5, 4.0);
    job.as_object_mut().expect("an object").remove("region");
    job["regions"] = json!(regions);
    let path = path(&job).await;
    let mut depths = [TOP_MM; 3];
    for at in path.iter().filter(|at| at[2] < TOP_MM - 1e-9) {
        let offs = HOLES.map(|[x, y]| f64::hypot(at[0] - x, at[1] - y));
        let nearest = (0..3).min_by(|a, b| offs[*a].total_cmp(&offs[*b])).expect("three holes");
        assert!(offs[nearest] < 1.0 + GOUGE_MM, "{at:?} is {} mm off the axis", offs[nearest]);
        depths[nearest] = depths[nearest].min(at[2]);
    }
    assert_eq!(depths, [-0.5; 3]);
}

#[tokio::test]
async fn the_picture_of_a_solid_names_the_edges_of_the_part() {
    let files = [("part", "block.step", BLOCK)];
    let picture = send("/v1/parts/inspect?format=svg", None, &files).await.text();
    assert!(picture.contains(">edge of the part<"), "{}", &picture[..2000.min(picture.len())]);
    assert!(!picture.contains("fixtures"));
}
