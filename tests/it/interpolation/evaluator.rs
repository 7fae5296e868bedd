//! Finds deviations by brute force: for many points of each element, it searches for the nearest point of the
//! curve.

use serde_json::Value;

/// A curve over a domain, given by a function from the parameter to its points.
pub struct Curve<'a> {
    pub point: &'a dyn Fn(f64) -> [f64; 2],
    pub domain: [f64; 2],
}

/// Steps between the samples of each element.
const SAMPLES: usize = 160;

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn point(value: &Value) -> [f64; 2] {
    [number(&value[0]), number(&value[1])]
}

/// The cutting moves of an answer in order, each as a polyline of many points. Fails if there are none.
pub fn moves(answer: &Value) -> Vec<Vec<[f64; 2]>> {
    let mut at = point(&answer["toolpath"]["start"]);
    let mut paths = Vec::new();
    let passes = answer["toolpath"]["passes"].as_array().expect("passes");
    for step in passes.iter().flat_map(|pass| pass["moves"].as_array().expect("moves")) {
        let to = point(&step["to"]);
        if step["role"] == "cut" {
            paths.push((0..=SAMPLES).map(|k| along(step, at, to, k as f64 / SAMPLES as f64)).collect());
        }
        at = to;
    }
    assert!(!paths.is_empty(), "no cutting moves");
    paths
}

fn along(step: &Value, from: [f64; 2], to: [f64; 2], s: f64) -> [f64; 2] {
    let mix = |a: f64, b: f64, s: f64| a * (1.0 - s) + b * s;
    match step["kind"].as_str().expect("a kind") {
        "line" => [mix(from[0], to[0], s), mix(from[1], to[1], s)],
        "parabola" => {
            let control = point(&step["control"]);
            [0, 1].map(|k| mix(mix(from[k], control[k], s), mix(control[k], to[k], s), s))
        }
        "arc" => {
            let center = point(&step["center"]);
            let angle = |p: [f64; 2]| (p[1] - center[1]).atan2(p[0] - center[0]);
            let turn = std::f64::consts::TAU;
            let sweep = match step["direction"].as_str() {
                Some("ccw") => (angle(to) - angle(from)).rem_euclid(turn),
                _ => -(angle(from) - angle(to)).rem_euclid(turn),
            };
            let radius = (from[0] - center[0]).hypot(from[1] - center[1]);
            let angle = angle(from) + sweep * s;
            [center[0] + radius * angle.cos(), center[1] + radius * angle.sin()]
        }
        other => panic!("{other}"),
    }
}

impl Curve<'_> {
    /// The distance from `p` to the curve between two parameters, mm. A fine grid finds the nearest sample,
    /// and ever finer grids about the nearest sample refine it.
    pub fn distance(&self, p: [f64; 2], [from, to]: [f64; 2]) -> f64 {
        let distance = |t: f64| {
            let [x, y] = (self.point)(t);
            (x - p[0]).hypot(y - p[1])
        };
        let (mut low, mut high) = (from.max(self.domain[0]), to.min(self.domain[1]));
        let mut best = f64::INFINITY;
        for parts in [240usize, 16, 16, 16, 16, 16, 16, 16, 16, 16] {
            let at = |k: usize| low + (high - low) * k as f64 / parts as f64;
            let nearest = (0..=parts)
                .min_by(|a, b| distance(at(*a)).total_cmp(&distance(at(*b))))
                .expect("the grid has a place");
            best = best.min(distance(at(nearest)));
            (low, high) = (at(nearest.saturating_sub(1)), at((nearest + 1).min(parts)));
        }
        best
    }

    /// The largest distance of the points of an element from the curve, mm. Only the part of the curve over
    /// the element's domain and a little beyond it is searched.
    pub fn deviation(&self, path: &[[f64; 2]], [from, to]: [f64; 2]) -> f64 {
        let beside = 0.2 * (to - from);
        path.iter().map(|p| self.distance(*p, [from - beside, to + beside])).fold(0.0, f64::max)
    }

    /// The largest vertical distance of the points of an element from a graph, mm.
    pub fn vertical_deviation(&self, path: &[[f64; 2]]) -> f64 {
        path.iter().map(|[x, y]| (y - (self.point)(*x)[1]).abs()).fold(0.0, f64::max)
    }
}

/// The domain of a reported element.
pub fn domain(element: &Value) -> [f64; 2] {
    point(&element["domain"])
}
