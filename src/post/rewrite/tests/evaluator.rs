//! A small control, written independently of the rewriter: it follows the words of a program and records the
//! path.

use nalgebra::{Point3, Vector2};

/// Paths along arcs are chords that leave the arc by at most this, mm.
pub const SAGITTA_MM: f64 = 1e-5;

/// The state after a line with a comment, and the path since the line with a comment before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    pub line: String,
    pub path: Vec<Point3<f64>>,
    /// The time of the path's blocks under G93, minutes.
    pub minutes: f64,
    pub state: State,
    pub moves: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    pub at: Point3<f64>,
    pub unit: f64,
    pub is_absolute: bool,
    pub has_absolute_centers: bool,
    pub plane: i32,
    pub motion: i32,
    pub feed: f64,
    pub is_inverse: bool,
}

/// The stops at all lines with a comment and at the end, in order. A number without a point counts
/// `increment` units.
pub fn stops(program: &str, increment: f64) -> Vec<Stop> {
    let mut state = State {
        at: Point3::origin(),
        unit: 1.0,
        is_absolute: true,
        has_absolute_centers: false,
        plane: 17,
        motion: 0,
        feed: 0.0,
        is_inverse: false,
    };
    let (mut stops, mut path, mut minutes) = (Vec::new(), vec![state.at], 0.0);
    let program = program.replace("\r\n", "\n").replace('\r', "\n");
    for line in program.lines() {
        if line.starts_with('%') {
            state.motion = 0;
        }
        let words = words(line, increment);
        let moves = step(&mut state, &words, &mut path, &mut minutes);
        if line.contains('(') {
            let taken = std::mem::replace(&mut path, vec![state.at]);
            stops.push(Stop { line: line.to_owned(), path: taken, minutes, state, moves });
            minutes = 0.0;
        }
    }
    stops.push(Stop { line: String::new(), path, minutes, state, moves: false });
    stops
}

fn words(line: &str, increment: f64) -> Vec<(char, f64)> {
    let code = line.split(['(', ';']).next().unwrap().to_ascii_uppercase().replace([' ', '\t'], "");
    let starts: Vec<_> = code.match_indices(|c: char| c.is_ascii_alphabetic()).map(|(k, _)| k).collect();
    let ends = starts.iter().copied().skip(1).chain([code.len()]);
    let word = |(from, end): (usize, usize)| {
        let (letter, number) = (code.as_bytes()[from] as char, &code[from + 1..end]);
        let counts = "XYZIJK".contains(letter) && !number.contains('.');
        number.parse::<f64>().ok().map(|value| (letter, if counts { value * increment } else { value }))
    };
    starts.iter().copied().zip(ends).filter_map(word).collect()
}

fn step(state: &mut State, words: &[(char, f64)], path: &mut Vec<Point3<f64>>, minutes: &mut f64) -> bool {
    for &(letter, value) in words {
        match (letter, (value * 10.0).round() as i32) {
            ('G', 0 | 10 | 20 | 30) => state.motion = value as i32,
            ('G', 170 | 180 | 190) => state.plane = value as i32,
            ('G', 200) => state.unit = 25.4,
            ('G', 210) => state.unit = 1.0,
            ('G', 900) => state.is_absolute = true,
            ('G', 910) => state.is_absolute = false,
            ('G', 901) => state.has_absolute_centers = true,
            ('G', 911) => state.has_absolute_centers = false,
            ('G', 930) => state.is_inverse = true,
            ('G', 940) => state.is_inverse = false,
            ('F', _) => state.feed = value,
            _ => {}
        }
    }
    let get = |letter| words.iter().find(|(l, _)| *l == letter).map(|(_, value)| value * state.unit);
    let (from, mut to) = (state.at, state.at);
    for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
        if let Some(value) = get(letter) {
            to[axis] = if state.is_absolute { value } else { from[axis] + value };
        }
    }
    let rotates = words.contains(&('G', 68.0));
    let moves = ['X', 'Y', 'Z'].into_iter().any(|letter| get(letter).is_some());
    if !moves || rotates {
        return false;
    }
    if state.is_inverse && state.motion > 0 {
        *minutes += 1.0 / state.feed;
    }
    if state.motion >= 2 {
        let [a, b, n] = [[0, 1, 2], [2, 0, 1], [1, 2, 0]][(state.plane - 17) as usize];
        let offset = |axis: usize| {
            let base = if state.has_absolute_centers { 0.0 } else { from[axis] };
            get(['I', 'J', 'K'][axis]).map_or(from[axis], |value| base + value)
        };
        let center = Vector2::new(offset(a), offset(b));
        let arm = |p: &Point3<f64>| Vector2::new(p[a], p[b]) - center;
        let (s, e) = (arm(&from), arm(&to));
        assert!((s.norm() - e.norm()).abs() < 0.0027, "radii {} {}", s.norm(), e.norm());
        let sense = if state.motion == 3 { 1.0 } else { -1.0 };
        let turn = (sense * s.perp(&e).atan2(s.dot(&e))).rem_euclid(std::f64::consts::TAU);
        assert!(turn > 0.0, "a full circle");
        let count = (turn / (8.0 * SAGITTA_MM / s.norm()).sqrt()).ceil();
        for k in 1..count as usize {
            let t = k as f64 / count;
            let (sin, cos) = (sense * turn * t).sin_cos();
            let r = s.norm() + (e.norm() - s.norm()) * t;
            let d = s / s.norm() * r;
            let mut p = from;
            p[a] = center.x + d.x * cos - d.y * sin;
            p[b] = center.y + d.x * sin + d.y * cos;
            p[n] = from[n] + (to[n] - from[n]) * t;
            path.push(p);
        }
    }
    path.push(to);
    state.at = to;
    true
}

/// The largest distance of a point on one path from the other path, both ways.
pub fn distance(one: &[Point3<f64>], other: &[Point3<f64>]) -> f64 {
    let to_path = |p: &Point3<f64>, path: &[Point3<f64>]| {
        let stretches = path.windows(2).map(|s| {
            let (along, d) = (s[1] - s[0], p - s[0]);
            let squared = along.norm_squared();
            let t = if squared > 0.0 { (d.dot(&along) / squared).clamp(0.0, 1.0) } else { 0.0 };
            (d - along * t).norm()
        });
        stretches.fold((p - path[0]).norm(), f64::min)
    };
    let way = |from: &[Point3<f64>], to: &[Point3<f64>]| {
        let middles = from.windows(2).flat_map(|s| [0.25, 0.5, 0.75, 1.0].map(|t| s[0] + (s[1] - s[0]) * t));
        middles.map(|p| to_path(&p, to)).fold(0.0, f64::max)
    };
    way(one, other).max(way(other, one))
}
