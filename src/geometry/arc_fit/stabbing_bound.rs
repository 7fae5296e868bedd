//! The circles through one place that pass near a growing number of points: when none is left, no element
//! goes on.
//!
//! # Method
//! Inversion about the place makes its circles lines, and the discs about the points discs, of centre d /
//! (d^2 - e^2) and radius e / (d^2 - e^2). Two of these far apart for their radii leave lines y = m x + t of
//! small slope in a frame along them; then "the line meets the disc" is a strip |c_y - m c_x - t| <= rho
//! sqrt(1 + m^2) of (m, t), and with the largest slope under the root a half-plane on each side. What is kept
//! is the polygon that these leave: it holds every circle there is, and little else. The frame is chosen anew
//! as better pairs come.
//!
//! # Cost
//! O(v) a point for a polygon of v corners; the frame changes O(log n) times.

use nalgebra::Vector2;

use super::Shapes;
use super::candidate::Rule;

/// Points that are looked at one by one, before every second, third and so on will do: neighbours cut off
/// much the same.
const DENSE: usize = 24;

/// A pair of discs whose lines lean by more than this sine is no frame, and one that halves the sine is a
/// better one.
const WIDEST: f64 = 0.5;
const BETTER: f64 = 0.5;

/// Points before the first frame is tried; once there is one, another is tried when there are twice as many.
const FIRST_FRAME: usize = 4;

/// What a disc cuts off is left where it is no larger than this part of the disc: corners cost more than they
/// tell.
const SLIVER: f64 = 0.04;

/// Rounding of the polygon, in parts of what is compared.
const ROUNDING: f64 = 1e-9;

/// The circles through `from` within the tolerance of all points taken so far.
pub struct Fan {
    from: Vector2<f64>,
    tolerance: f64,
    shapes: Shapes,
    discs: Vec<Disc>,
    next_frame: usize,
    frame: Option<Frame>,
    /// Corners (m, t) in order.
    polygon: Vec<Vector2<f64>>,
    spare: Vec<Vector2<f64>>,
}

#[derive(Debug, Clone, Copy)]
struct Disc {
    center: Vector2<f64>,
    radius: f64,
}

/// By how much the line (m, t) passes above `c`.
fn height_over(line: &Vector2<f64>, c: Vector2<f64>) -> f64 {
    line.x * c.x + line.y - c.y
}

/// Coordinates along a pair of discs.
#[derive(Debug, Clone, Copy)]
struct Frame {
    origin: Vector2<f64>,
    along: Vector2<f64>,
    /// The sine by which lines may lean.
    sine: f64,
    /// The root of 1 + m^2 for the largest slope.
    stretch: f64,
}

impl Frame {
    fn local(&self, c: Vector2<f64>) -> Vector2<f64> {
        let d = c - self.origin;
        Vector2::new(self.along.dot(&d), self.along.perp(&d))
    }
}

impl Fan {
    pub fn new(rule: &Rule) -> Self {
        Self {
            from: Vector2::zeros(),
            tolerance: rule.tolerance_mm,
            shapes: rule.shapes,
            discs: Vec::new(),
            next_frame: FIRST_FRAME,
            frame: None,
            polygon: Vec::new(),
            spare: Vec::new(),
        }
    }

    /// The points after `first` that are worth being taken.
    pub fn worth(first: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(first + 1), move |k| Some(k + 1 + (k - first) / DENSE))
    }

    /// All circles through `from`.
    pub fn restart(&mut self, from: Vector2<f64>) {
        self.from = from;
        self.discs.clear();
        self.next_frame = FIRST_FRAME;
        self.frame = None;
    }

    /// Whether one of the circles may pass through `p`.
    pub fn admits(&self, p: Vector2<f64>) -> bool {
        let (Some(frame), d) = (self.frame, p - self.from) else { return true };
        let c = frame.local(d / d.norm_squared());
        let slack = ROUNDING * (c.x.abs() + c.y.abs());
        let [least, most] = self.heights_over(c);
        least <= slack && most >= -slack
    }

    /// The least and the largest height of a line of the polygon over `c`.
    fn heights_over(&self, c: Vector2<f64>) -> [f64; 2] {
        let heights = self.polygon.iter().map(|corner| height_over(corner, c));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], height| {
            [least.min(height), most.max(height)]
        })
    }

    /// Keeps those that pass near `p`; whether there may be any.
    pub fn take(&mut self, p: Vector2<f64>) -> bool {
        let d = p - self.from;
        let power = d.norm_squared() - self.tolerance * self.tolerance;
        if power <= 0.0 {
            return true;
        }
        let disc = Disc { center: d / power, radius: self.tolerance / power };
        self.discs.push(disc);
        if self.discs.len() == self.next_frame {
            let is_better = self.turn_frame();
            self.next_frame += if self.frame.is_none() { FIRST_FRAME } else { self.discs.len() };
            if is_better {
                // Lines go through the image of what is infinitely far.
                let far = Disc { center: Vector2::zeros(), radius: ROUNDING * disc.center.norm() };
                return (self.shapes == Shapes::ArcsAndLines || self.clip(far))
                    && (0..self.discs.len()).all(|k| self.clip(self.discs[k]));
            }
        }
        self.frame.is_none() || self.clip(disc)
    }

    /// Whether the last disc and the one halfway make a better frame; then the polygon begins anew.
    fn turn_frame(&mut self) -> bool {
        let [a, b] = [self.discs[self.discs.len() / 2], self.discs[self.discs.len() - 1]];
        let apart = b.center - a.center;
        let sine = (a.radius + b.radius) / apart.norm();
        // Not a number where the discs coincide.
        let is_better = sine < self.frame.map_or(WIDEST, |frame| BETTER * frame.sine);
        if !is_better {
            return false;
        }
        let slope = sine / (1.0 - sine * sine).sqrt();
        let stretch = (1.0 + slope * slope).sqrt() * (1.0 + ROUNDING);
        self.frame = Some(Frame { origin: a.center, along: apart.normalize(), sine, stretch });
        let height = a.radius * stretch;
        self.polygon.clear();
        self.polygon.extend(
            [(-slope, -height), (slope, -height), (slope, height), (-slope, height)]
                .map(|(m, t)| Vector2::new(m, t)),
        );
        true
    }

    /// Cuts off the lines that miss a disc; whether any are left.
    fn clip(&mut self, disc: Disc) -> bool {
        let Some(frame) = self.frame else { return true };
        let c = frame.local(disc.center);
        let half_width = disc.radius * frame.stretch + ROUNDING * disc.radius;
        let [least, most] = self.heights_over(c);
        for (side, farthest) in [(1.0, most), (-1.0, -least)] {
            let over = |corner: &Vector2<f64>| side * height_over(corner, c) - half_width;
            if farthest <= (1.0 + SLIVER) * half_width {
                continue;
            }
            self.spare.clear();
            for (k, corner) in self.polygon.iter().enumerate() {
                let next = self.polygon[(k + 1) % self.polygon.len()];
                let (here, there) = (over(corner), over(&next));
                if here <= 0.0 {
                    self.spare.push(*corner);
                }
                if (here < 0.0) != (there < 0.0) && here != 0.0 && there != 0.0 {
                    self.spare.push(corner + (next - corner) * (here / (here - there)));
                }
            }
            std::mem::swap(&mut self.polygon, &mut self.spare);
            if self.polygon.is_empty() {
                return false;
            }
        }
        true
    }
}
