//! Blocks of a program: their text, and the places of the tip along them.

use std::fmt::Write;

/// A place, mm.
pub type At = [f64; 3];

/// What a block does in a program, by which a fault is put into a block of its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Other,
    Floor,
    Wall,
    Corner,
    Bow,
    Plunge,
    Helix,
    Hole,
    /// An arc that stands upright and touches the floor in its middle.
    Dip,
    /// An arc that stands upright over the floor.
    Arch,
    /// A rapid down to where cutting begins.
    Approach,
    /// A rapid up, behind a cut.
    Retract,
    /// A rapid to a place beside the pocket.
    Park,
    /// A line over a surface.
    Pass,
}

/// One block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Word {
    Tool(u32),
    Offset(u32),
    Rapid(At),
    Line(At),
    /// An arc of G17, G18 or G19 about a centre in its plane, of which the third coordinate is left alone.
    Arc {
        plane: usize,
        is_ccw: bool,
        to: At,
        center: At,
    },
    /// A drilled hole, from the rapid plane down to a depth. The tip stands over the hole before and after.
    Hole {
        at: At,
        plane: f64,
        peck: Option<f64>,
    },
}

/// A block with what it is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    pub word: Word,
    pub part: Part,
    /// Which of the levels of a tool the block belongs to.
    pub level: usize,
}

/// A way of the tip that is run as one move.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// The number of the line of the program, counted from 1.
    pub line: u32,
    pub tool: u32,
    pub is_rapid: bool,
    pub points: Vec<At>,
}

/// The axes of the planes G17, G18 and G19: two within, one across.
fn axes(plane: usize) -> [usize; 3] {
    [[0, 1, 2], [2, 0, 1], [1, 2, 0]][plane - 17]
}

fn distance(a: &At, b: &At) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn mixed(a: &At, b: &At, t: f64) -> At {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t)
}

/// Lines before the first block.
const HEAD: [&str; 2] = ["G21 G17 G90 G94 G40 G49 G80 G54", "M3 S6000"];

/// The text of a program, with one line for each block.
pub fn text(blocks: &[Block], start: At) -> String {
    let mut text = HEAD.map(|line| format!("{line}\n")).concat();
    let mut at = start;
    for block in blocks {
        let [x, y, z] = block.word.end().unwrap_or(at);
        let place = format!("X{x:.6} Y{y:.6} Z{z:.6}");
        let line = match block.word {
            Word::Tool(number) => format!("T{number} M6"),
            Word::Offset(number) => format!("G{number}"),
            Word::Rapid(_) => format!("G0 {place}"),
            Word::Line(_) => format!("G1 {place} F600"),
            Word::Arc { plane, is_ccw, center, .. } => {
                let [a, b, _] = axes(plane);
                let names = ['I', 'J', 'K'];
                let word = |k: usize| format!("{}{:.6}", names[k], center[k] - at[k]);
                format!("G{plane} G{} {place} {} {} F400", if is_ccw { 3 } else { 2 }, word(a), word(b))
            }
            Word::Hole { at: [x, y, z], plane, peck } => {
                let code = if peck.is_some() { 83 } else { 81 };
                let peck = peck.map_or_else(String::new, |q| format!(" Q{q:.3}"));
                format!("G17 G98 G{code} X{x:.6} Y{y:.6} Z{z:.6} R{plane:.6}{peck} F200")
            }
        };
        let _ = writeln!(text, "{line}");
        at = [x, y, z];
        if let Word::Hole { at: [x, y, _], plane, .. } = block.word {
            at = [x, y, plane];
        }
    }
    text + "M2\n"
}

/// The ways of the tip, in points that are at most `step` mm apart. `zero` is that of the work offset G55.
pub fn ways(blocks: &[Block], start: At, zero: At, step: f64) -> Vec<Way> {
    let mut ways: Vec<Way> = Vec::new();
    let (mut at, mut tool, mut shift) = (start, 1, [0.0; 3]);
    for (k, block) in blocks.iter().enumerate() {
        let line = (HEAD.len() + k + 1) as u32;
        let mut add = |is_rapid: bool, points: Vec<At>| {
            let points = points.iter().map(|p| [0, 1, 2].map(|k| p[k] + shift[k])).collect();
            ways.push(Way { line, tool, is_rapid, points });
        };
        match block.word {
            Word::Tool(number) => tool = number,
            Word::Offset(number) => shift = if number == 55 { zero } else { [0.0; 3] },
            Word::Rapid(to) => {
                add(true, straight(&at, &to, step));
                at = to;
            }
            Word::Line(to) => {
                add(false, straight(&at, &to, step));
                at = to;
            }
            Word::Arc { plane, is_ccw, to, center } => {
                add(false, round(&at, &to, &center, plane, is_ccw, step));
                at = to;
            }
            Word::Hole { at: hole, plane, .. } => {
                let over = [hole[0], hole[1], plane];
                add(true, straight(&at, &over, step));
                add(false, straight(&over, &hole, step));
                add(true, straight(&hole, &over, step));
                at = over;
            }
        }
    }
    ways
}

fn straight(from: &At, to: &At, step: f64) -> Vec<At> {
    let n = (distance(from, to) / step).ceil().max(1.0);
    (0..=n as usize).map(|k| mixed(from, to, k as f64 / n)).collect()
}

fn round(from: &At, to: &At, center: &At, plane: usize, is_ccw: bool, step: f64) -> Vec<At> {
    let [a, b, c] = axes(plane);
    let angle = |p: &At| (p[b] - center[b]).atan2(p[a] - center[a]);
    let radius = (from[a] - center[a]).hypot(from[b] - center[b]);
    let full = std::f64::consts::TAU;
    let mut turn = (angle(to) - angle(from)).rem_euclid(full);
    if turn < 1e-9 || full - turn < 1e-9 {
        turn = full;
    } else if !is_ccw {
        turn = full - turn;
    }
    let n = (radius * turn / step).hypot((to[c] - from[c]) / step).ceil().max(8.0);
    let place = |k: usize| {
        let t = k as f64 / n;
        let own = angle(from) + turn * t * if is_ccw { 1.0 } else { -1.0 };
        let mut p = [0.0; 3];
        (p[a], p[b]) = (center[a] + radius * own.cos(), center[b] + radius * own.sin());
        p[c] = from[c] + (to[c] - from[c]) * t;
        p
    };
    let mut points: Vec<At> = (0..n as usize).map(place).collect();
    points.push(*to);
    points
}

impl Word {
    /// Where the tip stands behind the block; `None` where it stays.
    pub fn end(&self) -> Option<At> {
        match *self {
            Self::Tool(_) | Self::Offset(_) => None,
            Self::Rapid(to) | Self::Line(to) | Self::Arc { to, .. } => Some(to),
            Self::Hole { at, plane, .. } => Some([at[0], at[1], plane]),
        }
    }
}

impl Block {
    pub fn new(word: Word, part: Part) -> Self {
        Self { word, part, level: 0 }
    }

    pub fn at_level(self, level: usize) -> Self {
        Self { level, ..self }
    }
}
