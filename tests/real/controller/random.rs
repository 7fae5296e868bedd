//! Makes random toolpaths: arcs of every size, sweep and direction in three planes, helices, parabolas,
//! lines, rapids and dwells.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::{Coolant, Cutting, CuttingRequest};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Builder, Role, Toolpath};

pub struct Case {
    pub toolpath: Toolpath,
    pub tool: Tool,
    pub cutting: Cutting,
}

/// Knuth's linear congruential generator: the same cases on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        random.unit();
        random
    }

    /// The next number in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n - 1)
    }

    pub fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::new(self.within(-size, size), self.within(-size, size), self.within(-size, size))
    }

    pub fn feed(&mut self) -> FeedRate {
        let value = 10f64.powf(self.within(1.0, 3.7));
        FeedRate::from_mm_per_min(value).unwrap_or_else(|| unreachable!("a power of ten is above zero"))
    }
}

pub fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    let mut path = Toolpath::builder(Point3::from(random.vector(50.0)));
    for _ in 0..10 + random.below(30) {
        // The builder refuses an arc whose points rounding has moved too far. Then another move is drawn.
        let mut tries = 0;
        while add(&mut path, &mut random).is_err() && tries < 10 {
            tries += 1;
        }
    }
    let feed = random.feed();
    Case {
        toolpath: path.finish().unwrap_or_else(|error| unreachable!("{error}")),
        tool: Tool {
            number: Some(1 + random.below(99) as u32),
            length_offset: Some(1 + random.below(99) as u32),
            ..Tool::ball(3.0)
        },
        cutting: CuttingRequest {
            spindle_rpm: (random.unit() < 0.8).then(|| random.within(10.0, 20_000.0)),
            coolant: [Coolant::Off, Coolant::Flood, Coolant::Mist][random.below(3)],
            ..CuttingRequest::at_feed(feed)
        }
        .at_heights(random.within(0.0, 60.0), 0.0),
    }
}

fn add(path: &mut Builder, random: &mut Random) -> Result<(), toolpathd_core::toolpath::PathError> {
    let at = path.at();
    let rate = random.feed();
    match random.below(10) {
        0 => path.rapid(at + random.vector(20.0)),
        1 | 2 => path.line(at + random.vector(20.0), rate, Role::Cut),
        4 => {
            let size = 10f64.powf(random.within(-1.0, 2.3));
            let (mut by, mut control) = (random.vector(size), random.vector(size));
            if random.unit() < 0.8 {
                (by.z, control.z) = (0.0, 0.0);
            }
            path.parabola(at + by, at + control, rate, Role::Cut)
        }
        3 if random.unit() < 0.3 => path.dwell(random.within(0.0, 3.0)),
        _ => {
            let plane = Plane::ALL[random.below(3)];
            let direction = if random.unit() < 0.5 { Direction::Cw } else { Direction::Ccw };
            let radius = 10f64.powf(random.within(-1.5, 4.3));
            // Large arcs are short, because the four printed decimals do not fix the place of a long arc.
            let most = TAU.min(300.0 / radius);
            let sweep = match random.below(6) {
                0 if most == TAU => TAU,
                1 if most == TAU => random.within(0.9, 1.0) * TAU,
                _ => random.within(0.002, 1.0) * most,
            };
            let rise = if random.unit() < 0.3 { random.within(-10.0, 10.0) } else { 0.0 };
            let sign = if direction == Direction::Ccw { 1.0 } else { -1.0 };
            let from = random.within(0.0, TAU);
            let spoke = |angle: f64| Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
            let local = plane.to_local(&at);
            let center = local - spoke(from);
            let mut end = if sweep == TAU { local } else { center + spoke(from + sign * sweep) };
            end.z = local.z + rise;
            let [end, center] = [end, center].map(|p| plane.to_workpiece(&p));
            path.arc(end, center, (plane, direction), rate, Role::Cut)
        }
    }
}
