//! One element, in coordinates along and across its chord: the nearest place of the element to a point, and
//! how far the line between two points lies from the element.

use nalgebra::Vector2;

use super::chord::Chord;

/// Angles that differ from half a turn by less count as half a turn, radians: rounding explains the
/// difference.
const HALF_A_TURN: f64 = 1e-9;

/// The place of an element that is nearest to a point.
pub struct Foot {
    /// The place as a fraction of the element's length; below 0 or above 1 on the element's continuation.
    pub along: f64,
    /// The point's distance from the element, mm.
    pub distance: f64,
}

/// An element in the frame of its chord.
pub struct ChordFrame {
    /// Half the length of the chord, mm; for a line, half of its length in space.
    half: f64,
    /// How much higher the end is than the start, mm.
    rise: f64,
    shape: Shape,
}

enum Shape {
    /// A line with its direction: the parts along the chord and upward.
    Line(Vector2<f64>),
    Arc(ChordArc),
}

/// An arc, or a helix seen from above, in the frame of its chord.
pub struct ChordArc {
    pub bulge: f64,
    /// The coordinate of the centre on the second axis, mm; on the first axis it is 0.
    center: f64,
    pub radius: f64,
    pub sweep: f64,
}

impl ChordFrame {
    /// The arc with a bulge; the chord itself, as a line, for the bulge 0.
    pub fn new(chord: &Chord, bulge: f64, rise: f64) -> Self {
        if bulge == 0.0 {
            let slope = Vector2::new(chord.half, 0.5 * rise);
            let half = slope.norm();
            return Self { half, rise, shape: Shape::Line(slope / half) };
        }
        let arc = ChordArc {
            bulge,
            center: chord.center(bulge),
            radius: chord.radius(bulge),
            sweep: 4.0 * bulge.abs().atan(),
        };
        Self { half: chord.half, rise, shape: Shape::Arc(arc) }
    }

    /// `None` for a line.
    pub fn arc(&self) -> Option<&ChordArc> {
        if let Shape::Arc(arc) = &self.shape { Some(arc) } else { None }
    }

    /// The point in a plane with the element. For a line in space this is the plane through the line and the
    /// point.
    fn flattened(&self, p: Vector2<f64>, height: f64) -> Vector2<f64> {
        match &self.shape {
            Shape::Line(slope) if height != 0.0 || self.rise != 0.0 => {
                let over = Vector2::new(p.x, height);
                Vector2::new(slope.dot(&over), p.y.hypot(slope.perp(&over)))
            }
            _ => p,
        }
    }

    pub fn foot(&self, p: Vector2<f64>, height: f64) -> Foot {
        let flat = self.flattened(p, height);
        let (along, beside) = match &self.shape {
            Shape::Line(_) => (0.5 + 0.5 * flat.x / self.half, flat.y.abs()),
            Shape::Arc(arc) => {
                let d = Vector2::new(flat.x, flat.y - arc.center);
                // The angle from the middle of the arc, positive towards its end.
                let angle = d.x.atan2(arc.bulge.signum() * d.y);
                (0.5 + angle / arc.sweep, (d.norm() - arc.radius).abs())
            }
        };
        let is_beside = (0.0..=1.0).contains(&along);
        let distance =
            if is_beside { beside } else { self.to_ends(flat).into_iter().fold(f64::INFINITY, f64::min) };
        // The height of a helix counts at the point's own angle.
        let above = self.arc().map_or(0.0, |_| self.above(along, height));
        Foot { along, distance: distance.hypot(above) }
    }

    /// How far a height lies above a helix at the place `along` it, mm.
    fn above(&self, along: f64, height: f64) -> f64 {
        height - self.rise * (along.clamp(0.0, 1.0) - 0.5)
    }

    fn to_ends(&self, p: Vector2<f64>) -> [f64; 2] {
        [Vector2::new(p.x + self.half, p.y).norm(), Vector2::new(p.x - self.half, p.y).norm()]
    }

    /// The first place within `tolerance` mm of a point that is not before `reached`, as a fraction of the
    /// length; `None` if there is no such place.
    pub fn first_place(&self, p: Vector2<f64>, height: f64, tolerance: f64, reached: f64) -> Option<f64> {
        let foot = self.foot(p, height);
        let p = self.flattened(p, height);
        let half_width = match &self.shape {
            Shape::Line(_) => 0.5 * (tolerance * tolerance - p.y * p.y).max(0.0).sqrt() / self.half,
            Shape::Arc(arc) if self.rise != 0.0 || height != 0.0 => {
                self.half_width_of_helix(arc, &foot, height, tolerance)
            }
            Shape::Arc(arc) => arc.half_width(p, tolerance),
        };
        let mut ranges = [[foot.along - half_width, foot.along + half_width], [1.0, 0.0]];
        let [is_at_start, is_at_end] = self.to_ends(p).map(|distance| distance <= tolerance);
        match &self.shape {
            Shape::Line(_) if is_at_start && is_at_end => ranges[0] = [0.0, 1.0],
            Shape::Line(_) => {}
            // The continuation of an arc that is nearly a full circle comes round to the arc's other end.
            Shape::Arc(arc) if is_at_start && ranges[0][0] > 0.0 => {
                ranges[1] = [0.0, ranges[0][1] - arc.full_turn()];
            }
            Shape::Arc(arc) if is_at_end && ranges[0][1] < 1.0 => {
                ranges[1] = [ranges[0][0] + arc.full_turn(), 1.0];
            }
            Shape::Arc(_) => {}
        }
        let ranges = ranges.map(|[low, high]| [low.max(0.0), high.min(1.0)]);
        let reachable = ranges.iter().filter(|range| range[0] <= range[1] && reached <= range[1]);
        reachable.map(|range| range[0].max(reached)).min_by(f64::total_cmp)
    }

    /// Upper bound of the distance of the line from `a` to `b` from a helix, mm. Each end comes with its
    /// height.
    ///
    /// Let the line be seen from the centre under the angle 2 h. A point at the fraction t of the line is
    /// seen at the fraction f of that angle, and |f - t| <= h^2 / (8 cos^2 h): the error of a chord of the
    /// tangent. So there the helix is higher or lower than the line by at most |f - t| of its rise.
    pub fn beside(&self, arc: &ChordArc, [a, b]: [(Vector2<f64>, f64); 2]) -> f64 {
        let off = |(p, height): (Vector2<f64>, f64)| {
            let foot = self.foot(p, height);
            let above = self.above(foot.along, height);
            ((foot.distance * foot.distance - above * above).max(0.0).sqrt(), above.abs())
        };
        let [(beside_a, above_a), (beside_b, above_b)] = [off(a), off(b)];
        let half_angle = 0.5 * arc.turned(a.0, b.0).abs();
        let ahead = (0.125 * (half_angle / half_angle.cos()).powi(2)).min(0.5);
        let rise = self.rise.abs() * 2.0 * half_angle / arc.sweep;
        let beside = beside_a.max(beside_b).max(arc.dip(a.0, b.0));
        beside.hypot(above_a.max(above_b) + rise * ahead)
    }

    /// As [`ChordArc::half_width`] for a helix, as a lower bound on both sides of the foot. Let s be the
    /// slope of the helix, a the height of the point over the foot, and b its distance beside the foot. A
    /// place d farther on is at most sqrt(b^2 + (a + s d)^2 + d^2) away.
    fn half_width_of_helix(&self, arc: &ChordArc, foot: &Foot, height: f64, tolerance: f64) -> f64 {
        let length = arc.radius * arc.sweep;
        let slope = self.rise.abs() / length;
        let above = self.above(foot.along, height).abs();
        let room = (tolerance * tolerance - foot.distance * foot.distance).max(0.0);
        let (steep, lean) = (1.0 + slope * slope, slope * above);
        ((lean * lean + steep * room).sqrt() - lean) / (steep * length)
    }
}

impl ChordArc {
    /// A full turn in fractions of the length.
    fn full_turn(&self) -> f64 {
        std::f64::consts::TAU / self.sweep
    }

    /// Half the length, as a fraction of the arc's length, of the part of the arc or its continuation that is
    /// within `tolerance` mm of a point.
    fn half_width(&self, p: Vector2<f64>, tolerance: f64) -> f64 {
        let (r, distance) = (self.radius, Vector2::new(p.x, p.y - self.center).norm());
        // Computed from the sine of half the angle: the cosine would lose the digits of a flat arc.
        let beside = distance - r;
        let square = (tolerance - beside) * (tolerance + beside) / (4.0 * r * distance);
        if square.is_nan() { 0.0 } else { 2.0 * square.clamp(0.0, 1.0).sqrt().asin() / self.sweep }
    }

    /// The angle that the line from `a` to `b` turns about the centre, radians, positive in the sense of the
    /// arc.
    pub fn turned(&self, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
        let center = Vector2::new(0.0, self.center);
        let [a, b] = [a - center, b - center];
        let turned = -self.bulge.signum() * a.perp(&b).atan2(a.dot(&b));
        // Exactly half a turn counts as one in the sense of the arc.
        if turned < HALF_A_TURN - std::f64::consts::PI { turned + std::f64::consts::TAU } else { turned }
    }

    /// How far the line from `a` to `b` lies inside the arc at the line's nearest place to the centre, mm.
    pub fn dip(&self, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
        (self.radius - from_line(Vector2::new(0.0, self.center), a, b)).max(0.0)
    }
}

/// The distance of `p` from the line between two points, ends included, mm; NaN if the two points coincide.
pub fn from_line(p: Vector2<f64>, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    (p - nearest_on_line(p, a, b)).norm()
}

/// The place nearest to `p` on the line between two points, ends included; NaN if the two points coincide.
pub fn nearest_on_line(p: Vector2<f64>, a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    let along = b - a;
    a + along * ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
}
