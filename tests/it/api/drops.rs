//! Tests of cutters that are dropped onto surfaces: tips are compared with formulas, and illegal requests are
//! refused.

use std::f64::consts::TAU;
use std::sync::Arc;

use serde_json::{Value, json};
use toolpathd_server::http::App;

use super::support::{app, post};

const DROP: &str = "/v1/surfaces/drop";

/// Largest distance of a tip from its closed form, and of a contact from the surface and from the cutter, mm.
const ACCURACY_MM: f64 = 1e-7;

/// A cutter by its underside: a disc of radius `flat`, surrounded by a quarter circle of radius `corner`, mm.
#[derive(Debug, Clone, Copy)]
struct Cutter {
    flat: f64,
    corner: f64,
}

impl Cutter {
    /// A ball, a flat and a bull nose cutter of one radius.
    fn all(radius: f64) -> [Self; 3] {
        [0.0, radius, 0.6 * radius].map(|flat| Self { flat, corner: radius - flat })
    }

    fn radius(self) -> f64 {
        self.flat + self.corner
    }

    fn json(self) -> Value {
        let diameter = 2.0 * self.radius();
        if self.flat == 0.0 {
            json!({ "shape": "ball", "diameter_mm": diameter })
        } else if self.corner == 0.0 {
            json!({ "shape": "flat", "diameter_mm": diameter })
        } else {
            json!({ "shape": "bull_nose", "diameter_mm": diameter, "corner_radius_mm": self.corner })
        }
    }

    /// The height of the underside above the tip at the distance `r` from the axis, which is at most the
    /// radius, mm.
    fn underside(self, r: f64) -> f64 {
        let beyond = (r - self.flat).max(0.0);
        self.corner - (self.corner * self.corner - beyond * beyond).max(0.0).sqrt()
    }

    /// The distance from the underside to a point at `r` from the axis and `z` above the tip, mm.
    fn off(self, r: f64, z: f64) -> f64 {
        if r <= self.flat {
            return z.abs();
        }
        let rise = (self.corner - z).max(0.0);
        ((r - self.flat).hypot(rise) - self.corner).abs()
    }

    /// The height of the tip over a round crest of radius `rho`, above the crest's centre, mm. The horizontal
    /// distance between the cutter's axis and the centre is `beside`.
    fn over_crest(self, rho: f64, beside: f64) -> f64 {
        let beyond = (beside.abs() - self.flat).max(0.0);
        ((rho + self.corner).powi(2) - beyond * beyond).sqrt() - self.corner
    }

    /// The height of the tip above the point of a sloping plane on the cutter's axis, mm.
    fn over_slope(self, slope: f64) -> f64 {
        self.flat * slope.abs() + self.corner * (slope.hypot(1.0) - 1.0)
    }
}

/// The tip and the contact at one point. `None` if the cutter does not touch the surface there.
type Touch = Option<([f64; 3], [f64; 3])>;

fn point(value: &Value) -> Option<[f64; 3]> {
    let numbers: Vec<_> = value.as_array()?.iter().map(|x| x.as_f64().expect("a number")).collect();
    Some(numbers.try_into().expect("three coordinates"))
}

/// Drops a cutter at `points`, by a request.
async fn dropped(app: &Arc<App>, surface: &Value, cutter: Cutter, points: &[[f64; 2]]) -> Vec<Touch> {
    let body = json!({ "surface": surface, "tool": cutter.json(), "points": points });
    let answer = post(app, DROP, body.to_string(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    let report = answer.json()["report"].clone();
    let column =
        |name: &str| report[name].as_array().expect("an array").iter().map(point).collect::<Vec<_>>();
    let (tips, contacts) = (column("tips"), column("contacts"));
    assert_eq!((tips.len(), contacts.len()), (points.len(), points.len()));
    let both = |(tip, contact): (Option<_>, Option<_>)| match (tip, contact) {
        (Some(tip), Some(contact)) => Some((tip, contact)),
        (None, None) => None,
        other => panic!("only one of tip and contact: {other:?}"),
    };
    tips.into_iter().zip(contacts).map(both).collect()
}

/// Drops three cutters of radius 5 at `points`. Fails unless every tip is at `height`, and every contact lies
/// on the cutter and on the surface. `off` is the distance of a contact from the surface.
async fn hold(
    surface: &Value,
    points: &[[f64; 2]],
    height: impl Fn(Cutter, [f64; 2]) -> f64,
    off: impl Fn([f64; 3]) -> f64,
) {
    let app = app(&["--workers", "1"]);
    for cutter in Cutter::all(5.0) {
        for (at, drop) in points.iter().zip(dropped(&app, surface, cutter, points).await) {
            let (tip, contact) = drop.unwrap_or_else(|| panic!("{cutter:?} {at:?}: no tip"));
            assert_eq!([tip[0], tip[1]], *at);
            let expected = height(cutter, *at);
            assert!(
                (tip[2] - expected).abs() < ACCURACY_MM,
                "{cutter:?} {at:?}: the tip is at {}, not {expected}",
                tip[2]
            );
            let r = (contact[0] - tip[0]).hypot(contact[1] - tip[1]);
            let gap = cutter.off(r, contact[2] - tip[2]);
            assert!(
                gap < ACCURACY_MM,
                "{cutter:?} {at:?}: the contact {contact:?} is {gap} mm from the cutter at {tip:?}"
            );
            let gap = off(contact).abs();
            assert!(
                gap < ACCURACY_MM,
                "{cutter:?} {at:?}: the contact {contact:?} is {gap} mm from the surface"
            );
        }
    }
}

/// Points spread over a square about `center`; `half` is half its side.
fn scattered(count: u32, center: [f64; 2], half: f64) -> Vec<[f64; 2]> {
    let along = |k: u32, step: f64, c: f64| c + half * (2.0 * (f64::from(k) * step + 0.37).fract() - 1.0);
    (0..count).map(|k| [along(k, 0.754_877_666, center[0]), along(k, 0.569_840_291, center[1])]).collect()
}

/// Control points of an arc of the unit circle that reaches `half` (rad) to both sides of an axis. Each has
/// its coordinates across and along the axis, and its weight.
fn arc(half: f64) -> [[f64; 3]; 3] {
    let (sin, cos) = half.sin_cos();
    [[-sin, cos, 1.0], [0.0, 1.0 / cos, cos], [sin, cos, 1.0]]
}

/// A rational biquadratic patch: `point` makes each control point of one of `u` and one of `v`.
fn biquadratic(u: [[f64; 3]; 3], v: [[f64; 3]; 3], point: impl Fn([f64; 3], [f64; 3]) -> [f64; 3]) -> Value {
    json!({
        "kind": "nurbs", "degree_u": 2, "degree_v": 2, "knots_u": [0, 0, 0, 1, 1, 1], "knots_v": [0, 0, 0, 1, 1, 1],
        "control_points": u.map(|u| v.map(|v| point(u, v))), "weights": u.map(|u| v.map(|v| u[2] * v[2])),
    })
}

/// The bicubic patch of z = c0 + c1 x + c2 y + c3 x² + c4 xy + c5 y² over a square about the origin; `half`
/// is half its side.
fn quadric(c: [f64; 6], half: f64) -> Value {
    let (node, square) = ([-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0], [1.0, -1.0 / 3.0, -1.0 / 3.0, 1.0]);
    let net = [0, 1, 2, 3].map(|a| {
        [0, 1, 2, 3].map(|b| {
            let (x, y) = (half * node[a], half * node[b]);
            let bent = c[3] * square[a] + c[4] * node[a] * node[b] + c[5] * square[b];
            [x, y, c[0] + c[1] * x + c[2] * y + half * half * bent]
        })
    });
    json!({ "kind": "bezier_patches", "patches": [[net]] })
}

fn quadric_at(c: [f64; 6], x: f64, y: f64) -> f64 {
    c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y
}

#[tokio::test]
async fn tips_on_spheres_cylinders_and_tori_equal_closed_forms() {
    let cap = arc(1.0);
    let sphere = biquadratic(cap, cap, |u, v| [30.0 * u[0], 30.0 * u[1] * v[0], 30.0 * u[1] * v[1]]);
    let off = |p: [f64; 3]| p[0].hypot(p[1]).hypot(p[2]) - 30.0;
    hold(&sphere, &scattered(40, [0.0; 2], 12.0), |cutter, [x, y]| cutter.over_crest(30.0, x.hypot(y)), off)
        .await;

    let bar = [[-40.0, 0.0, 1.0], [0.0, 0.0, 1.0], [40.0, 0.0, 1.0]];
    let cylinder = biquadratic(arc(1.2), bar, |u, v| [20.0 * u[0], v[0], 20.0 * u[1]]);
    let off = |p: [f64; 3]| p[0].hypot(p[2]) - 20.0;
    hold(&cylinder, &scattered(40, [0.0; 2], 12.0), |cutter, [x, _]| cutter.over_crest(20.0, x), off).await;

    // More than an eighth of a ring, from its inside to its outside.
    let torus = biquadratic(cap, arc(0.8), |u, v| {
        let ring = 40.0 + 12.0 * u[0];
        [ring * v[1], ring * v[0], 12.0 * u[1]]
    });
    let off = |p: [f64; 3]| (p[0].hypot(p[1]) - 40.0).hypot(p[2]) - 12.0;
    let height = |cutter: Cutter, [x, y]: [f64; 2]| cutter.over_crest(12.0, x.hypot(y) - 40.0);
    hold(&torus, &scattered(40, [40.0, 0.0], 5.0), height, off).await;
}

#[tokio::test]
async fn tips_on_planes_of_any_slope_and_azimuth_equal_the_closed_form() {
    for (k, degrees) in [0.0f64, 10.0, 45.0, 80.0, 87.0].into_iter().enumerate() {
        for azimuth in [0.0, 0.25 * TAU, 0.4 + k as f64, 4.0 + k as f64] {
            let slope = degrees.to_radians().tan();
            let c = [1.5, slope * f64::cos(azimuth), slope * f64::sin(azimuth), 0.0, 0.0, 0.0];
            let off = |p: [f64; 3]| (p[2] - quadric_at(c, p[0], p[1])) / slope.hypot(1.0);
            let height = |cutter: Cutter, [x, y]: [f64; 2]| quadric_at(c, x, y) + cutter.over_slope(slope);
            hold(&quadric(c, 20.0), &scattered(12, [0.0; 2], 14.0), height, off).await;
        }
    }
}

/// The largest value of `f` over an interval: a scan finds the best sample, and golden sections search near
/// it.
fn highest(f: &dyn Fn(f64) -> f64, [from, to]: [f64; 2], samples: u32) -> f64 {
    let step = (to - from) / f64::from(samples);
    let at = |k: u32| from + step * f64::from(k);
    let best = (0..=samples).max_by(|&a, &b| f(at(a)).total_cmp(&f(at(b)))).expect("a sample");
    let (mut low, mut high) = ((at(best) - step).max(from), (at(best) + step).min(to));
    for _ in 0..60 {
        let (p, q) = (high - 0.618_033_988_75 * (high - low), low + 0.618_033_988_75 * (high - low));
        if f(p) > f(q) { high = q } else { low = p }
    }
    [low, high, at(best)].map(f).into_iter().fold(f64::NEG_INFINITY, f64::max)
}

#[tokio::test]
async fn tips_on_a_saddle_equal_those_of_a_dense_search() {
    let c = [0.3, 0.1, -0.2, 0.03, 0.05, -0.04];
    let off = |p: [f64; 3]| p[2] - quadric_at(c, p[0], p[1]);
    let height = |cutter: Cutter, [x, y]: [f64; 2]| {
        let under = |angle: f64, r: f64| {
            quadric_at(c, x + r * angle.cos(), y + r * angle.sin()) - cutter.underside(r)
        };
        highest(&|angle| highest(&|r| under(angle, r), [0.0, cutter.radius()], 24), [0.0, TAU], 48)
    };
    hold(&quadric(c, 20.0), &scattered(10, [0.0; 2], 14.0), height, off).await;
}

/// The height of the tip over a profile: a polyline in x and z, extruded along y.
fn over_profile(cutter: Cutter, x: f64, profile: &[[f64; 2]]) -> f64 {
    let corners = profile.iter().filter(|p| (p[0] - x).abs() < cutter.radius());
    let corners = corners.map(|p| p[1] - cutter.underside((p[0] - x).abs()));
    let walls = profile.windows(2).filter_map(|ends| {
        let slope = (ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0]);
        let lean = if slope == 0.0 { 0.0 } else { cutter.flat.copysign(slope) };
        let touched = x + lean + cutter.corner * slope / slope.hypot(1.0);
        let is_on = ends[0][0] <= touched && touched <= ends[1][0];
        is_on.then(|| ends[0][1] + slope * (x - ends[0][0]) + cutter.over_slope(slope))
    });
    corners.chain(walls).fold(f64::NEG_INFINITY, f64::max)
}

#[tokio::test]
async fn tips_over_walls_of_87_degrees_touch_the_faces_and_sharp_edges() {
    let run = |rise: f64| rise / 87f64.to_radians().tan();
    let profile = [
        [-30.0, 0.0],
        [-12.0, 0.0],
        [-12.0 + run(10.0), 10.0],
        [-2.0, 10.0],
        [-2.0 + run(6.0), 4.0],
        [16.0, 4.0],
        [16.0 + run(6.0), 10.0],
        [30.0, 10.0],
    ];
    let panel = |ends: &[[f64; 2]]| {
        let third = |a: u32, k: usize| ends[0][k] + (ends[1][k] - ends[0][k]) * f64::from(a) / 3.0;
        let row = |a: u32| [-20.0, -20.0 / 3.0, 20.0 / 3.0, 20.0].map(|y| [third(a, 0), y, third(a, 1)]);
        json!([[row(0), row(1), row(2), row(3)]])
    };
    let patches: Vec<_> = profile.windows(2).map(panel).collect();
    let surface = json!({ "kind": "bezier_patches", "patches": patches });
    let points: Vec<_> = (0..53u32).map(|k| [f64::from(k) - 26.03, 0.3 * f64::from(k % 40) - 6.1]).collect();
    // The distance of a contact from the nearest wall or edge.
    let off = |p: [f64; 3]| {
        let gap = |ends: &[[f64; 2]]| {
            let (along, to) =
                ([0, 1].map(|k| ends[1][k] - ends[0][k]), [p[0] - ends[0][0], p[2] - ends[0][1]]);
            let square = along[0] * along[0] + along[1] * along[1];
            let t = ((along[0] * to[0] + along[1] * to[1]) / square).clamp(0.0, 1.0);
            (to[0] - t * along[0]).hypot(to[1] - t * along[1])
        };
        profile.windows(2).map(gap).fold(f64::INFINITY, f64::min)
    };
    hold(&surface, &points, |cutter, [x, _]| over_profile(cutter, x, &profile), off).await;
}

#[tokio::test]
async fn a_cutter_in_a_bowl_tighter_than_itself_rests_on_a_ring() {
    let app = app(&["--workers", "1"]);
    let bowl = quadric([0.0, 0.0, 0.0, 0.4, 0.0, 0.4], 6.0);
    for (cutter, expected) in Cutter::all(2.5).into_iter().zip([0.625, 2.5]) {
        let drops = dropped(&app, &bowl, cutter, &[[0.0, 0.0]]).await;
        let (tip, contact) = drops[0].expect("a tip");
        assert!((tip[2] - expected).abs() < ACCURACY_MM, "{cutter:?}: the tip is at {tip:?}, not {expected}");
        let ring = contact[0].hypot(contact[1]);
        assert!(
            (contact[2] - 0.4 * ring * ring).abs() < ACCURACY_MM,
            "the contact {contact:?} is not on the bowl"
        );
    }
}

#[tokio::test]
async fn a_cutter_wholly_beside_the_surface_has_no_tip_and_a_cutter_partly_over_it_touches_its_edge() {
    let app = app(&["--workers", "1"]);
    let plate = quadric([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 10.0);
    let diagonal = 10.0 + 5.0 * 0.5f64.sqrt();
    let (beside, near) = ([15.01, diagonal + 0.01, 400.0], [14.99, diagonal - 0.01, 10.0]);
    let points = [
        [beside[0], 3.0],
        [beside[1], beside[1]],
        [-beside[2], 0.0],
        [near[0], 3.0],
        [-near[1], near[1]],
        [near[2], -near[2]],
        [0.0, 0.0],
        [0.0, 0.0],
    ];
    for cutter in Cutter::all(5.0) {
        let drops = dropped(&app, &plate, cutter, &points).await;
        assert_eq!(drops[..3], [None; 3]);
        let heights = [6, 7].map(|k: usize| drops[k].expect("a tip").0[2]);
        assert!(
            (heights[0] - heights[1]).abs() < 3e-9,
            "the same point twice gives other heights: {heights:?}"
        );
        for drop in &drops[3..] {
            let (tip, contact) = drop.expect("a tip");
            let outside = [0, 1].map(|k| (tip[k].abs() - 10.0).max(0.0));
            let expected = 1.0 - cutter.underside(outside[0].hypot(outside[1]));
            assert!(
                (tip[2] - expected).abs() < ACCURACY_MM,
                "{cutter:?}: the tip is at {tip:?}, not {expected}"
            );
            let is_on = contact[0].abs() < 10.0 + ACCURACY_MM && contact[1].abs() < 10.0 + ACCURACY_MM;
            assert!(
                is_on && (contact[2] - 1.0).abs() < ACCURACY_MM,
                "the contact {contact:?} is not on the plate"
            );
        }
    }
}

/// A legal request with one member replaced or added.
fn whole(name: &str, value: Value) -> Value {
    let tool = json!({ "shape": "ball", "diameter_mm": 5 });
    let mut body = json!({ "surface": quadric([0.0; 6], 10.0), "tool": tool, "points": [[0, 0], [1, 1]] });
    body[name] = value;
    body
}

#[tokio::test]
async fn every_violation_in_a_drop_request_has_its_code_and_its_pointer() {
    let app = app(&["--workers", "1"]);
    let ball = |name: &str, value: Value| json!({ "shape": "ball", "diameter_mm": 5, name: value });
    let bull = |corner: Value| json!({ "shape": "bull_nose", "diameter_mm": 5, "corner_radius_mm": corner });
    for (name, value, code, blamed) in [
        ("points", json!([]), "too_few_points", "#/points"),
        ("points", json!([[0, 0], ["x", 1]]), "wrong_type", "#/points/1/0"),
        ("points", json!([[0, 0], [null, 1]]), "wrong_type", "#/points/1/0"),
        ("points", json!([[0, 0], null]), "wrong_type", "#/points/1"),
        ("points", json!([[0, 0], [1]]), "wrong_length", "#/points/1"),
        ("points", json!([[0, 0, 0]]), "wrong_length", "#/points/0"),
        ("points", json!([[0, 2e6], [0, 0]]), "too_large", "#/points/0/1"),
        ("points", json!("all"), "wrong_type", "#/points"),
        ("point", json!([0, 0]), "unknown_field", "#/point"),
        ("surface", json!({}), "missing_field", "#/surface/kind"),
        ("tool", ball("diametre", json!(5)), "unknown_field", "#/tool/diametre"),
        ("tool", ball("corner_radius_mm", json!(1)), "unknown_field", "#/tool/corner_radius_mm"),
        ("tool", ball("diameter_mm", json!(0)), "out_of_range", "#/tool/diameter_mm"),
        ("tool", ball("diameter_mm", json!(-5)), "out_of_range", "#/tool/diameter_mm"),
        ("tool", ball("diameter_mm", json!("5")), "wrong_type", "#/tool/diameter_mm"),
        ("tool", json!({ "shape": "round", "diameter_mm": 5 }), "unknown_value", "#/tool/shape"),
        ("tool", json!({ "shape": "flat" }), "missing_field", "#/tool/diameter_mm"),
        (
            "tool",
            json!({ "shape": "bull_nose", "diameter_mm": 5 }),
            "missing_field",
            "#/tool/corner_radius_mm",
        ),
        ("tool", bull(json!(2.6)), "out_of_range", "#/tool/corner_radius_mm"),
        ("tool", bull(json!(0)), "out_of_range", "#/tool/corner_radius_mm"),
    ] {
        let answer = post(&app, DROP, whole(name, value.clone()).to_string(), &[]).await;
        assert_eq!(answer.status, 422, "{name} {value}: {}", answer.text());
        assert_eq!(answer.violations(), [(code.to_owned(), blamed.to_owned())], "{name} {value}");
    }
    for missing in ["surface", "tool", "points"] {
        let mut body = whole("points", json!([[0, 0]]));
        body.as_object_mut().expect("an object").remove(missing);
        let answer = post(&app, DROP, body.to_string(), &[]).await;
        assert_eq!(answer.violations(), [("missing_field".to_owned(), format!("#/{missing}"))]);
    }
    // JSON cannot write these numbers.
    for number in ["NaN", "Infinity", "1e999"] {
        let body = whole("points", json!([[0, 123]])).to_string().replace("123", number);
        let answer = post(&app, DROP, body, &[]).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (400, "malformed_json"), "{number}");
    }
}

#[tokio::test]
async fn more_points_than_the_limit_are_refused() {
    // The body is nearly as long as a body may be, and holds more points than allowed.
    let app = app(&["--workers", "1"]);
    let body = whole("points", json!([[0, 123]])).to_string();
    let (before, after) = body.split_once("[0,123]").expect("the point");
    let answer = post(&app, DROP, format!("{before}{}[0,0]{after}", "[0,0],".repeat(2_500_000)), &[]).await;
    assert_eq!(answer.status, 422);
    assert_eq!(answer.violations(), [("limit_exceeded".to_owned(), "#/points".to_owned())]);
}
