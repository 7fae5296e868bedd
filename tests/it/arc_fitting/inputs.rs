//! Points for fits, made of pseudo-random numbers that are the same every time.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

/// The pseudo-random generator SplitMix64, with its state.
pub struct Random(pub u64);

impl Random {
    /// A generator for a test. Different streams give different numbers, and so do different values of the
    /// environment variable `PROPTEST_RNG_SEED`, whose default is 1.
    pub fn stream(stream: u64) -> Self {
        let seed: u64 = std::env::var("PROPTEST_RNG_SEED").map_or(1, |seed| seed.parse().expect("a number"));
        Self(stream.wrapping_add(seed.wrapping_sub(1).wrapping_mul(0xD6E8_FEB8_6659_FD93)))
    }

    /// The next number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    /// A random vector in the square of half width `size` about the origin.
    pub fn jitter(&mut self, size: f64) -> Vector2<f64> {
        Vector2::new(self.between(-size, size), self.between(-size, size))
    }
}

pub fn polar(radius: f64, angle: f64) -> Vector2<f64> {
    Vector2::new(radius * angle.cos(), radius * angle.sin())
}

/// The kinds of points that [`few`] makes.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    Walk,
    SmoothWalk,
    NoisyArc,
    TwoArcs,
    Backtracking,
    Zigzag,
    Grid,
    NearlyClosed,
    Spike,
}

pub const KINDS: [Kind; 9] = [
    Kind::Walk,
    Kind::SmoothWalk,
    Kind::NoisyArc,
    Kind::TwoArcs,
    Kind::Backtracking,
    Kind::Zigzag,
    Kind::Grid,
    Kind::NearlyClosed,
    Kind::Spike,
];

/// At most 14 points of a kind within some 10 mm, with errors of about `noise` (mm). No two neighbouring
/// points coincide.
pub fn few(kind: Kind, noise: f64, random: &mut Random) -> Vec<Vector2<f64>> {
    // Small numbers are likelier, because the time of brute force grows with the cube of the number.
    let n = 3 + (12.0 * random.unit().powi(2)) as usize;
    let part = |k: usize| k as f64 / (n - 1) as f64;
    let mut points: Vec<Vector2<f64>> = match kind {
        Kind::Walk => walk(n, 1.0, PI, random),
        Kind::SmoothWalk => walk(n, 1.0, 0.4, random),
        Kind::NoisyArc => {
            let (radius, sweep) = (random.between(0.3, 8.0), random.between(-6.2, 6.2));
            (0..n).map(|k| polar(radius, sweep * part(k)) + random.jitter(noise)).collect()
        }
        Kind::TwoArcs => {
            let (turn, length) = ([random.between(-4.0, 4.0), random.between(-4.0, 4.0)], 6.0 / n as f64);
            let (mut at, mut angle) = (Vector2::zeros(), 0.0);
            let step = |k: usize| {
                at += polar(length, angle);
                angle += turn[2 * k / n] / n as f64;
                at + random.jitter(noise)
            };
            (0..n).map(step).collect()
        }
        Kind::Backtracking => {
            let mut x = 0.0;
            let step = |_| {
                x += if random.unit() < 0.75 {
                    random.between(0.1, 1.0)
                } else {
                    -random.between(0.0, 3.0 * noise)
                };
                Vector2::new(x, 0.3 * x) + random.jitter(0.3 * noise)
            };
            (0..n).map(step).collect()
        }
        Kind::Zigzag => {
            let height = random.between(0.5, 3.0) * noise;
            let side = |k: usize| if k.is_multiple_of(2) { height } else { -height };
            (0..n).map(|k| Vector2::new(k as f64 * 0.7, side(k)) + random.jitter(0.5 * noise)).collect()
        }
        Kind::Grid => {
            let (radius, sweep) = (random.between(1.0, 8.0), random.between(-5.0, 5.0));
            let cell = 2.0 * noise;
            (0..n).map(|k| polar(radius, sweep * part(k)).map(|c| (c / cell).round() * cell)).collect()
        }
        Kind::NearlyClosed => {
            let (radius, sweep) = (random.between(0.5, 5.0), TAU - random.between(0.0, 0.4));
            (0..n).map(|k| polar(radius, sweep * part(k)) + random.jitter(noise)).collect()
        }
        Kind::Spike => {
            let mut points: Vec<_> =
                (0..n).map(|k| Vector2::new(k as f64 * 0.5, 0.0) + random.jitter(0.5 * noise)).collect();
            let at = random.below(n);
            points[at].y += random.between(0.5, 4.0) * noise;
            points
        }
    };
    points.dedup();
    if points.len() < 2 {
        points.push(points[0] + Vector2::x());
    }
    points
}

/// `n` points with steps of 0.3 to 1 times `length` between them. Each step turns by up to `turn` radians
/// from the step before.
pub fn walk(n: usize, length: f64, turn: f64, random: &mut Random) -> Vec<Vector2<f64>> {
    let (mut at, mut angle) = (Vector2::zeros(), 0.0);
    let step = |_| {
        angle += random.between(-turn, turn);
        at += polar(length * random.between(0.3, 1.0), angle);
        at
    };
    (0..n).map(step).collect()
}
