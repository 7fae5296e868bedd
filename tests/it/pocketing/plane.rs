//! Lines, arcs and outlines of the plane. The checker computes with these, and not with the library's
//! geometry.

use std::f64::consts::TAU;

pub type P = [f64; 2];

/// A vertex of an outline with the bulge of the piece to the next vertex, as in DXF: positive to the left.
pub type Vertex = [f64; 3];

/// The distance of two points.
pub fn apart(a: P, b: P) -> f64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    (x * x + y * y).sqrt()
}

/// A line, or an arc from the angle `from` that turns by `sweep`, to the left if positive.
#[derive(Debug, Clone, Copy)]
pub enum Piece {
    Line { a: P, b: P },
    Arc { center: P, radius: f64, from: f64, sweep: f64 },
}

impl Piece {
    pub fn with_bulge(a: P, b: P, bulge: f64) -> Self {
        if bulge == 0.0 {
            return Self::Line { a, b };
        }
        let chord = [b[0] - a[0], b[1] - a[1]];
        // The centre lies on the left of the chord if the arc turns to the left by less than half a turn.
        let aside = (1.0 - bulge * bulge) / (4.0 * bulge);
        let center = [0.5 * (a[0] + b[0]) - chord[1] * aside, 0.5 * (a[1] + b[1]) + chord[0] * aside];
        let from = (a[1] - center[1]).atan2(a[0] - center[0]);
        Self::Arc { center, radius: apart(a, center), from, sweep: 4.0 * bulge.atan() }
    }

    /// The arc about `center` between two points. Equal points make a full turn.
    pub fn arc(a: P, b: P, center: P, is_left: bool) -> Self {
        let [from, to] = [a, b].map(|p| (p[1] - center[1]).atan2(p[0] - center[0]));
        let left = if a == b { TAU } else { (to - from).rem_euclid(TAU) };
        let sweep = if is_left || a == b { left } else { left - TAU };
        let sweep = if a == b && !is_left { -TAU } else { sweep };
        Self::Arc { center, radius: apart(a, center), from, sweep }
    }

    pub fn length(&self) -> f64 {
        match self {
            Self::Line { a, b } => apart(*a, *b),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The point at a fraction of the length.
    pub fn at(&self, t: f64) -> P {
        match self {
            Self::Line { a, b } => [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])],
            Self::Arc { center, radius, from, sweep } => {
                let (sin, cos) = (from + t * sweep).sin_cos();
                [center[0] + radius * cos, center[1] + radius * sin]
            }
        }
    }

    /// The angle of the motion at a fraction of the length.
    pub fn heading(&self, t: f64) -> f64 {
        match self {
            Self::Line { a, b } => (b[1] - a[1]).atan2(b[0] - a[0]),
            Self::Arc { from, sweep, .. } => from + t * sweep + sweep.signum() * 0.25 * TAU,
        }
    }

    /// The part from the start up to a fraction of the length.
    pub fn before(&self, t: f64) -> Self {
        match self {
            Self::Line { a, .. } => Self::Line { a: *a, b: self.at(t) },
            Self::Arc { center, radius, from, sweep } => {
                Self::Arc { center: *center, radius: *radius, from: *from, sweep: sweep * t }
            }
        }
    }

    /// The distance of a point, mm.
    pub fn distance(&self, p: P) -> f64 {
        match self {
            Self::Line { a, b } => {
                let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
                let square = along[0] * along[0] + along[1] * along[1];
                let t = (along[0] * to[0] + along[1] * to[1]) / square.max(f64::MIN_POSITIVE);
                let t = t.clamp(0.0, 1.0);
                let (x, y) = (to[0] - t * along[0], to[1] - t * along[1]);
                (x * x + y * y).sqrt()
            }
            Self::Arc { center, radius, from, sweep } => {
                let d = [p[0] - center[0], p[1] - center[1]];
                let turned = ((d[1].atan2(d[0]) - from) * sweep.signum()).rem_euclid(TAU);
                if turned <= sweep.abs() {
                    (apart(p, *center) - radius).abs()
                } else {
                    apart(p, self.at(0.0)).min(apart(p, self.at(1.0)))
                }
            }
        }
    }

    /// Whether a point is at most `limit` mm away.
    pub fn is_within(&self, p: P, limit: f64) -> bool {
        match self {
            // The circle of an arc is no farther than the arc.
            Self::Arc { center, radius, .. } if (apart(p, *center) - radius).abs() > limit => false,
            _ => self.distance(p) <= limit,
        }
    }

    /// Points on the piece whose chords stay within `height` mm of it, and are no longer than `longest` mm.
    pub fn points(&self, height: f64, longest: f64) -> Vec<P> {
        let of_length = self.length() / longest;
        let of_height = match self {
            Self::Line { .. } => 1.0,
            Self::Arc { radius, sweep, .. } => {
                sweep.abs() / (2.0 * (1.0 - (height / radius).min(1.0)).acos())
            }
        };
        let n = of_length.max(of_height).ceil().max(1.0);
        (0..=n as usize).map(|k| self.at(k as f64 / n)).collect()
    }

    /// The box from the least to the largest coordinates; for an arc that of its circle.
    pub fn bounds(&self) -> [P; 2] {
        match self {
            Self::Line { a, b } => [[a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]],
            Self::Arc { center: [x, y], radius, .. } => [[x - radius, y - radius], [x + radius, y + radius]],
        }
    }
}

/// A closed outline.
#[derive(Debug, Clone)]
pub struct Outline {
    pub pieces: Vec<Piece>,
    vertices: Vec<P>,
}

impl Outline {
    pub fn new(vertices: &[Vertex]) -> Self {
        let next = vertices.iter().cycle().skip(1);
        let piece = |(a, b): (&Vertex, &Vertex)| Piece::with_bulge([a[0], a[1]], [b[0], b[1]], a[2]);
        let pieces = vertices.iter().zip(next).map(piece).collect();
        Self { pieces, vertices: vertices.iter().map(|v| [v[0], v[1]]).collect() }
    }

    pub fn vertices(&self) -> &[P] {
        &self.vertices
    }

    /// Adds the places where the line at height `y` enters or leaves the area inside. This area is the
    /// polygon of the vertices, with the segment between each arc and its chord turned inside out.
    pub fn crossings(&self, y: f64, found: &mut Vec<f64>) {
        let n = self.vertices.len();
        for (k, piece) in self.pieces.iter().enumerate() {
            let (a, b) = (self.vertices[k], self.vertices[(k + 1) % n]);
            let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            if (a[1] <= y) != (b[1] <= y) {
                found.push(x);
            }
            if let Piece::Arc { center, radius, sweep, .. } = piece {
                found
                    .extend(segment_crossings(a, b, *center, *radius, *sweep > 0.0, y).into_iter().flatten());
            }
        }
    }

    pub fn contains(&self, p: P) -> bool {
        let mut found = Vec::new();
        self.crossings(p[1], &mut found);
        found.iter().filter(|x| **x < p[0]).count() % 2 == 1
    }
}

/// The part at height `y` of the area between an arc and its chord from `a` to `b`.
fn segment_crossings(a: P, b: P, center: P, radius: f64, is_left: bool, y: f64) -> Option<[f64; 2]> {
    let rise = radius * radius - (y - center[1]) * (y - center[1]);
    if rise <= 0.0 {
        return None;
    }
    let half = rise.sqrt();
    let (mut low, mut high) = (center[0] - half, center[0] + half);
    // An arc that turns to the left lies on the right of its chord.
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let sense = if is_left { -1.0 } else { 1.0 };
    if dy == 0.0 {
        // A line on the chord counts as just above it, as for the polygon.
        let is_above = y >= a[1];
        return ((sense * dx > 0.0) == is_above).then_some([low, high]);
    }
    let x = a[0] + (y - a[1]) / dy * dx;
    // The left of a chord that rises has the smaller x.
    if sense * dy > 0.0 {
        high = high.min(x)
    } else {
        low = low.max(x)
    }
    (low < high).then_some([low, high])
}
