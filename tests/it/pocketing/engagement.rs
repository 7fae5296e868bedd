//! The angle of the cutter in the material: points of the leading half of its circle are compared with all
//! motions that came before.

use std::collections::HashMap;

use toolpathd_core::toolpath::Role;

use super::motion::{Kind, Motion};
use super::plane::{P, Piece};

/// Points on the leading half circle, a degree apart.
const POINTS: usize = 180;

/// The distance of the places at which the angle is measured, mm.
const STEP_MM: f64 = 0.5;

/// The most places; where there are more, they are farther apart.
const MOST_PLACES: f64 = 3000.0;

/// What is this far outside an earlier disc still counts as free, mm: rounding.
const ROUNDING_MM: f64 = 1e-4;

/// An angle at a place of a motion.
#[derive(Debug, Clone, Copy)]
pub struct Angle {
    /// The index of the motion.
    pub motion: usize,
    pub at: P,
    /// radians
    pub angle: f64,
    /// Whether the motion only takes what a helix or ramp over the same way has left.
    pub is_entry: bool,
}

/// The pieces along which the floor of a level has been cut.
struct Floor {
    radius: f64,
    buckets: HashMap<[i32; 2], Vec<Piece>>,
}

impl Floor {
    fn bucket(&self, p: P) -> [i32; 2] {
        p.map(|x| (x / (2.0 * self.radius)).floor() as i32)
    }

    fn push(&mut self, piece: Piece) {
        let ([low, high], wide) = (piece.bounds(), 2.0 * self.radius);
        let first = self.bucket(low.map(|x| x - wide));
        let last = self.bucket(high.map(|x| x + wide));
        for i in first[0]..=last[0] {
            for j in first[1]..=last[1] {
                self.buckets.entry([i, j]).or_default().push(piece);
            }
        }
    }

    /// The angle in material at the fraction `t` of a piece.
    fn angle(&self, piece: &Piece, t: f64) -> f64 {
        let center = piece.at(t);
        let all = self.buckets.get(&self.bucket(center)).into_iter().flatten();
        let mut near: Vec<Piece> =
            all.filter(|piece| piece.is_within(center, 2.0 * self.radius)).copied().collect();
        if matches!(piece, Piece::Arc { .. }) {
            near.push(piece.before(t));
        }
        let step = std::f64::consts::PI / POINTS as f64;
        let first = piece.heading(t) - 0.5 * std::f64::consts::PI;
        let (mut count, mut last) = (0, 0);
        for k in 0..POINTS {
            let (sin, cos) = (first + (k as f64 + 0.5) * step).sin_cos();
            let p = [center[0] + self.radius * cos, center[1] + self.radius * sin];
            let frees = |piece: &Piece| piece.is_within(p, self.radius + ROUNDING_MM);
            // A neighbouring point is mostly freed by the same piece.
            if near.get(last).is_some_and(frees) {
                continue;
            }
            match near.iter().rposition(frees) {
                Some(found) => last = found,
                None => count += 1,
            }
        }
        count as f64 * step
    }
}

/// The angles along the cuts at the height `z`, which is the floor of the first level.
pub fn angles(motions: &[Motion], radius: f64, z: f64) -> Vec<Angle> {
    let mut floor = Floor { radius, buckets: HashMap::new() };
    let is_on_floor = |motion: &Motion| motion.low() <= z + 1e-9;
    let is_cut = |motion: &Motion| motion.kind == Kind::Feed(Role::Cut) && motion.is_level();
    let on_floor = || motions.iter().enumerate().filter(|(_, motion)| is_on_floor(motion));
    let length: f64 = on_floor().map(|(_, motion)| motion.piece.length()).sum();
    let step = STEP_MM.max(length / MOST_PLACES);
    let mut found = Vec::new();
    let mut behind = 0.0;
    for (k, motion) in on_floor() {
        if motion.level != Some(0) {
            continue;
        }
        let length = motion.piece.length();
        if is_cut(motion) {
            let before = motions[..k].iter().rev().take_while(|other| other.pass == motion.pass);
            let mut ramps = before.filter(|other| other.kind == Kind::Feed(Role::Ramp));
            let is_entry = ramps.any(|ramp| motion.retraces(ramp));
            // The places are evenly spaced along the whole path, however short its motions are.
            behind += length;
            while behind >= 0.5 * step {
                let t = ((length - behind + 0.5 * step) / length).clamp(0.0, 1.0);
                let angle = floor.angle(&motion.piece, t);
                found.push(Angle { motion: k, at: motion.piece.at(t), angle, is_entry });
                behind -= step;
            }
        }
        // A ramp touches the floor at its end only.
        let end = motion.piece.at(1.0);
        floor.push(if motion.is_level() { motion.piece } else { Piece::Line { a: end, b: end } });
    }
    found
}

fn cut(a: P, b: P) -> Motion {
    let kind = Kind::Feed(Role::Cut);
    Motion { kind, piece: Piece::Line { a, b }, z: [0.0; 2], feed: None, level: Some(0), pass: 0 }
}

#[test]
fn a_pass_beside_another_has_the_angle_of_its_stepover() {
    for stepover in [1.0, 3.0, 5.0, 8.0, 10.0] {
        let passes = [
            cut([0.0, 0.0], [100.0, 0.0]),
            cut([100.0, 0.0], [100.0, stepover]),
            cut([100.0, stepover], [0.0, stepover]),
        ];
        let found = angles(&passes, 5.0, 0.0);
        let of_pass = |k: usize| {
            found.iter().filter(move |angle| angle.motion == k && (20.0..80.0).contains(&angle.at[0]))
        };
        assert!(of_pass(0).count() > 50 && of_pass(2).count() > 50);
        assert!(of_pass(0).all(|slot| slot.angle == std::f64::consts::PI));
        let expected = (1.0 - stepover / 5.0f64).acos();
        assert!(of_pass(2).all(|beside| (beside.angle - expected).abs() < 1f64.to_radians()));
    }
}
