//! A control in a few lines, written from the manuals alone: reads the cutting moves of a program, judges its
//! arcs, and tells along which circles it may run them. Shares nothing with the writer and the readers.

use std::f64::consts::TAU;

/// A cutting move. Places in mm.
#[derive(Debug, Clone, Copy)]
pub enum Cut {
    Line { from: [f64; 3], to: [f64; 3] },
    Arc(Stated),
}

/// An arc as a program states it.
#[derive(Debug, Clone, Copy)]
pub struct Stated {
    pub from: [f64; 3],
    pub to: [f64; 3],
    /// Along the first two of `axes`.
    pub center: [f64; 2],
    /// The two axes of the plane, turned the shorter way by G3, and the third.
    pub axes: [usize; 3],
    pub is_ccw: bool,
}

/// A circular arc about an exact centre.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    pub center: [f64; 2],
    pub radius: f64,
    pub begins: f64,
    /// Positive counterclockwise.
    pub sweep: f64,
    pub height: f64,
    pub axes: [usize; 3],
}

const XY: [usize; 3] = [0, 1, 2];
const ZX: [usize; 3] = [2, 0, 1];
const YZ: [usize; 3] = [1, 2, 0];

/// The cutting moves of a program of words.
pub fn cuts_of_words(text: &str) -> Vec<Cut> {
    let (mut at, mut axes, mut unit, mut motion) = ([f64::NAN; 3], XY, 1.0, 0);
    let mut cuts = Vec::new();
    for line in text.lines() {
        let line = line.split([';', '(']).next().unwrap_or_default();
        let words: Vec<(char, f64)> = line
            .split_whitespace()
            .filter_map(|word| Some((word.chars().next()?, word[1..].parse().ok()?)))
            .collect();
        let codes: Vec<f64> = words.iter().filter(|(letter, _)| *letter == 'G').map(|word| word.1).collect();
        if line.contains("SUPA") || codes.iter().any(|code| [4.0, 28.0, 53.0].contains(code)) {
            continue;
        }
        for code in codes {
            match code as i32 {
                code @ 0..=3 => motion = code,
                17 => axes = XY,
                18 => axes = ZX,
                19 => axes = YZ,
                20 | 700 => unit = 25.4,
                21 | 710 => unit = 1.0,
                _ => {}
            }
        }
        let word = |letter: char| words.iter().find(|word| word.0 == letter).map(|word| word.1 * unit);
        let from = at;
        for (axis, letter) in "XYZ".chars().enumerate() {
            at[axis] = word(letter).unwrap_or(at[axis]);
        }
        let moves = "XYZIJK".chars().any(|letter| word(letter).is_some());
        if motion == 1 && moves {
            cuts.push(Cut::Line { from, to: at });
        } else if motion > 1 && moves {
            let offset = |k: usize| word(['I', 'J', 'K'][axes[k]]).unwrap_or(0.0);
            let center = [0, 1].map(|k| from[axes[k]] + offset(k));
            cuts.push(Cut::Arc(Stated { from, to: at, center, axes, is_ccw: motion == 3 }));
        }
    }
    cuts
}

/// The cutting moves of a program in Klartext.
pub fn cuts_of_klartext(text: &str) -> Vec<Cut> {
    let (mut at, mut about, mut unit) = ([f64::NAN; 3], ([0.0; 2], XY), 1.0);
    let mut cuts = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> =
            line.split(';').next().unwrap_or_default().split_whitespace().skip(1).collect();
        let value = |name: &str| -> Option<f64> {
            words
                .iter()
                .find_map(|word| word.strip_prefix(name)?.strip_prefix(['+', '-']).map(|_| word))
                .and_then(|word| word[name.len()..].parse().ok())
        };
        let length = |name: &str| value(name).map(|value: f64| value * unit);
        let places = ["X", "Y", "Z"].map(length);
        let (from, is_ccw) = (at, words.contains(&"DR+"));
        let next = [0, 1, 2].map(|axis| places[axis].unwrap_or(at[axis]));
        match words.first() {
            Some(&"BEGIN") if words.contains(&"INCH") => unit = 25.4,
            Some(&"L") if !words.contains(&"M91") => {
                at = next;
                if !words.contains(&"FMAX") {
                    cuts.push(Cut::Line { from, to: at });
                }
            }
            Some(&"CC") => {
                let axes = if places[2].is_none() {
                    XY
                } else if places[1].is_none() {
                    ZX
                } else {
                    YZ
                };
                about = ([0, 1].map(|k| places[axes[k]].unwrap_or(f64::NAN)), axes);
            }
            Some(&"C") => {
                at = next;
                cuts.push(Cut::Arc(Stated { from, to: at, center: about.0, axes: about.1, is_ccw }));
            }
            Some(&"CP") => {
                let turn = value("IPA").unwrap_or(f64::NAN).to_radians();
                let (x, y) = (from[0] - about.0[0], from[1] - about.0[1]);
                if turn.abs() < TAU - 1e-9 {
                    at[0] = about.0[0] + x * turn.cos() - y * turn.sin();
                    at[1] = about.0[1] + x * turn.sin() + y * turn.cos();
                }
                at[2] += length("IZ").unwrap_or(0.0);
                cuts.push(Cut::Arc(Stated { from, to: at, center: about.0, axes: about.1, is_ccw }));
            }
            _ => {}
        }
    }
    cuts
}

/// What each control accepts: a difference of the radii, the part of the radius where that is more, the most.
fn figures(control: &str) -> [f64; 3] {
    match control {
        "linuxcnc" => [0.0011 * 25.4, 1e-3, 0.11 * 25.4],
        "grbl" => [0.005, 1e-3, 0.5],
        "siemens" => [0.01, 1e-3, f64::INFINITY],
        "okuma" => [0.02, 0.0, 0.02],
        _ => [0.016, 0.0, 0.016],
    }
}

impl Stated {
    fn seen(&self, p: [f64; 3]) -> [f64; 2] {
        [p[self.axes[0]] - self.center[0], p[self.axes[1]] - self.center[1]]
    }

    pub fn is_closed(&self) -> bool {
        self.seen(self.from) == self.seen(self.to)
    }

    /// The angle, radians, by which a Siemens control turns the centre, by the law of cosines: the own centre
    /// is the tip of a triangle of equal sides on the chord. `None` where the sides are too short.
    pub fn turned_centre(&self) -> Option<f64> {
        let [from, to] = [self.from, self.to].map(|p| self.seen(p));
        let (side, chord) = (from[0].hypot(from[1]), (to[0] - from[0]).hypot(to[1] - from[1]));
        let stated = -(from[0] * (to[0] - from[0]) + from[1] * (to[1] - from[1])) / (side * chord);
        let own = chord / (2.0 * side);
        (chord / 2.0 <= side + 1e-9).then(|| (stated.clamp(-1.0, 1.0).acos() - own.min(1.0).acos()).abs())
    }

    /// How far the arc is from the limits of its control, as a part of them: above 1 the control stops.
    pub fn strain(&self, control: &str) -> f64 {
        let [from, to] = [self.from, self.to].map(|p| self.seen(p));
        let radii = [from, to].map(|[a, b]| a.hypot(b));
        let [length, part, most] = figures(control);
        let limit = if length > part * radii[0] { length } else { part * radii[0] };
        let strain = (radii[0] - radii[1]).abs() / if limit > most { most } else { limit };
        if control != "siemens" || self.is_closed() {
            return strain;
        }
        self.turned_centre().map_or(f64::INFINITY, |turn| strain.max(turn / 0.001f64.sqrt()))
    }

    /// The circles along which a control may run the arc: about the stated centre with either radius, and on
    /// Siemens about the centre that is as far from both ends as the stated one is from the start.
    pub fn ways(&self, control: &str) -> Vec<Way> {
        let [from, to] = [self.from, self.to].map(|p| self.seen(p));
        let mut ways: Vec<Way> =
            [from, to].iter().map(|end| self.way(self.center, end[0].hypot(end[1]))).collect();
        if control == "siemens" && !self.is_closed() {
            let middle = [0, 1].map(|k| (from[k] + to[k]) / 2.0);
            let chord = [0, 1].map(|k| to[k] - from[k]);
            let length = chord[0].hypot(chord[1]);
            let radius = from[0].hypot(from[1]);
            let height = (radius * radius - length * length / 4.0).max(0.0).sqrt();
            // The stated centre is the zero of these places.
            let left = (middle[0] * chord[1] - middle[1] * chord[0]) / length;
            let up = if left < 0.0 { -height } else { height };
            let own = [middle[0] - chord[1] / length * up, middle[1] + chord[0] / length * up];
            ways.push(self.way([self.center[0] + own[0], self.center[1] + own[1]], radius));
        }
        ways
    }

    fn way(&self, center: [f64; 2], radius: f64) -> Way {
        let angle = |p: [f64; 3]| (p[self.axes[1]] - center[1]).atan2(p[self.axes[0]] - center[0]);
        let sense = if self.is_ccw { 1.0 } else { -1.0 };
        let turn = (sense * (angle(self.to) - angle(self.from))).rem_euclid(TAU);
        let sweep = sense * if self.is_closed() { TAU } else { turn };
        let height = self.from[self.axes[2]];
        Way { center, radius, begins: angle(self.from), sweep, height, axes: self.axes }
    }
}

impl Way {
    pub fn at(&self, t: f64) -> [f64; 3] {
        let angle = self.begins + self.sweep * t;
        let mut p = [0.0; 3];
        p[self.axes[0]] = self.center[0] + self.radius * angle.cos();
        p[self.axes[1]] = self.center[1] + self.radius * angle.sin();
        p[self.axes[2]] = self.height;
        p
    }

    pub fn distance(&self, p: [f64; 3]) -> f64 {
        let [a, b, n] = self.axes;
        let (x, y) = (p[a] - self.center[0], p[b] - self.center[1]);
        let ahead = (self.sweep.signum() * (y.atan2(x) - self.begins)).rem_euclid(TAU);
        let rise = p[n] - self.height;
        if ahead <= self.sweep.abs() {
            return (x.hypot(y) - self.radius).hypot(rise);
        }
        [0.0, 1.0].map(|t| apart(self.at(t), p)).into_iter().fold(f64::INFINITY, f64::min)
    }
}

pub fn apart(p: [f64; 3], q: [f64; 3]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1]).hypot(p[2] - q[2])
}
