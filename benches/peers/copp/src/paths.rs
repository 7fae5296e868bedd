//! Test paths: coordinates as functions of the parameter, with derivatives by truncated power series.

use toolpathd_core::operations::five_axis::schedule::{Derivatives, Limits, Station};

/// The Taylor coefficients of a function up to the third.
#[derive(Clone, Copy)]
pub struct Jet(pub [f64; 4]);

impl Jet {
    pub fn constant(x: f64) -> Self {
        Self([x, 0.0, 0.0, 0.0])
    }

    /// f of this, from the derivatives of f at the value.
    fn chain(self, [f, f1, f2, f3]: [f64; 4]) -> Self {
        let [_, a, b, c] = self.0;
        Self([f, f1 * a, f1 * b + 0.5 * f2 * a * a, f1 * c + f2 * a * b + f3 / 6.0 * a * a * a])
    }

    pub fn sin(self) -> Self {
        let (s, c) = self.0[0].sin_cos();
        self.chain([s, c, -s, -c])
    }

    pub fn cos(self) -> Self {
        let (s, c) = self.0[0].sin_cos();
        self.chain([c, -s, -c, s])
    }

    pub fn powf(self, p: f64) -> Self {
        let x = self.0[0];
        let f = |k: f64, q: f64| k * x.powf(q);
        self.chain([
            x.powf(p),
            f(p, p - 1.0),
            f(p * (p - 1.0), p - 2.0),
            f(p * (p - 1.0) * (p - 2.0), p - 3.0),
        ])
    }

    pub fn atan2(self, x: Self) -> Self {
        // The derivative of the angle is (x y' - y x') / (x^2 + y^2).
        let d = |j: Self| Self([j.0[1], 2.0 * j.0[2], 3.0 * j.0[3], 0.0]);
        let rate = (x * d(self) + -1.0 * (self * d(x))) * (x * x + self * self).powf(-1.0);
        Self([self.0[0].atan2(x.0[0]), rate.0[0], rate.0[1] / 2.0, rate.0[2] / 3.0])
    }
}

impl std::ops::Add for Jet {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + o.0[k]))
    }
}

impl std::ops::Mul for Jet {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self(std::array::from_fn(|k| (0..=k).map(|i| self.0[i] * o.0[k - i]).sum()))
    }
}

impl std::ops::Mul<Jet> for f64 {
    type Output = Jet;
    fn mul(self, o: Jet) -> Jet {
        Jet(o.0.map(|x| self * x))
    }
}

pub struct Case {
    pub name: String,
    pub length: f64,
    pub feed: f64,
    pub limits: Vec<Limits>,
    pub path: fn(Jet) -> Vec<Jet>,
}

impl Case {
    pub fn coordinates(&self, u: f64) -> Vec<Jet> {
        (self.path)(Jet([u, 1.0, 0.0, 0.0]))
    }

    pub fn station(&self, u: f64) -> Station {
        let q = self.coordinates(u);
        let tip = q.iter().take(3).map(|x| x.0[1] * x.0[1]).sum::<f64>().sqrt();
        let coordinates = q
            .iter()
            .map(|x| Derivatives { first: x.0[1], second: 2.0 * x.0[2], third: [6.0 * x.0[3]; 2] })
            .collect();
        Station { u, speed_cap: self.feed / tip, coordinates }
    }

    pub fn stations(&self, intervals: usize) -> Vec<Station> {
        (0..=intervals).map(|k| self.station(self.length * k as f64 / intervals as f64)).collect()
    }
}

/// Table kinematics: the angles of the tool axis (i, j, k), and the tip turned into the frame of the machine.
fn turned(tip: [Jet; 3], axis: [Jet; 2]) -> Vec<Jet> {
    let [i, j] = axis;
    let across = (i * i + j * j).powf(0.5);
    let up = (Jet::constant(1.0) + -1.0 * (i * i + j * j)).powf(0.5);
    let a = across.atan2(up);
    let c = i.atan2(j);
    let [x, y, z] = tip;
    let (sa, ca, sc, cc) = (a.sin(), a.cos(), c.sin(), c.cos());
    let (p, q) = (cc * x + -1.0 * (sc * y), sc * x + cc * y);
    let degrees = 180.0 / std::f64::consts::PI;
    vec![x, y, z, p, ca * q + -1.0 * (sa * z), sa * q + ca * z, degrees * a, degrees * c]
}

/// A wavy curve of 150 mm; the axis leans by 20 degrees forward and swings sideways.
fn wavy(u: Jet) -> Vec<Jet> {
    let w = std::f64::consts::TAU / 150.0;
    let tip = [u, 8.0 * (2.0 * w * u).sin(), 3.0 * (3.0 * w * u).cos()];
    let side = 0.34 * (4.0 * w * u).sin();
    turned(tip, [Jet::constant(0.34), side])
}

fn line(u: Jet) -> Vec<Jet> {
    let z = Jet::constant(0.0);
    vec![0.8 * u, 0.6 * u, z, 0.8 * u, 0.6 * u, z, z, z]
}

fn circle(u: Jet) -> Vec<Jet> {
    let angle = 0.1 * u;
    turned(
        [10.0 * angle.cos(), 10.0 * angle.sin(), Jet::constant(5.0)],
        [0.2 * angle.cos(), 0.2 * angle.sin()],
    )
}

/// Sharp peaks of curvature: y = 20 s^(1/2) like ridges.
fn peaks(u: Jet) -> Vec<Jet> {
    let w = std::f64::consts::TAU / 50.0;
    // |sin| rounded to a radius of some tenths of a millimetre.
    let s = (w * u).sin();
    let y = 10.0 * (s * s + Jet::constant(0.002)).powf(0.5);
    turned([u, y, Jet::constant(0.0)], [Jet::constant(0.3), 0.1 * (0.5 * w * u).sin()])
}

/// A slow change of the axis while the tip nearly rests in a corner.
fn swing(u: Jet) -> Vec<Jet> {
    let w = std::f64::consts::TAU / 60.0;
    turned(
        [u, 2.0 * (w * u).sin(), Jet::constant(0.0)],
        [0.25 * (5.0 * w * u).sin() + Jet::constant(0.4), 0.3 * (3.0 * w * u).cos()],
    )
}

pub fn cases() -> Vec<Case> {
    let axis = |speed, acceleration, jerk| Limits { speed, acceleration, jerk };
    let linear = axis(500.0, 5_000.0, 100_000.0);
    let free = axis(f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let rotary = axis(180.0, 1_500.0, 50_000.0);
    // The tip in the frame of the part has only its feed.
    let limits = vec![free, free, free, linear, linear, linear, rotary, rotary];
    let mut cases = Vec::new();
    let paths: [(&str, f64, fn(Jet) -> Vec<Jet>); 5] = [
        ("wavy", 150.0, wavy),
        ("line", 100.0, line),
        ("circle", 62.8, circle),
        ("peaks", 100.0, peaks),
        ("swing", 120.0, swing),
    ];
    for (name, length, path) in paths {
        for feed in [3_000.0, 12_000.0, 60_000.0] {
            cases.push(Case {
                name: format!("{name} F{feed}"),
                length,
                feed: feed / 60.0,
                limits: limits.clone(),
                path,
            });
        }
    }
    cases
}
