//! Random good programs for pockets: two tools, two levels, helices, rings, arcs in three planes, cycles.

use super::block::{At, Block, Part, Word};
use super::random::Numbers;
use super::scene::{Pocket, Scene, Shape, Tool};

/// The height of rapids over the part, and where the tool stands at first, mm.
const OVER: f64 = 2.0;
const HOME: f64 = 20.0;

/// What the first tool leaves at the walls for the second one, mm.
const FOR_FINISHING: f64 = 0.1;

/// A program that grows.
struct Writer {
    blocks: Vec<Block>,
    at: At,
    level: usize,
    clear: f64,
}

impl Writer {
    fn add(&mut self, word: Word, part: Part) {
        self.at = word.end().unwrap_or(self.at);
        self.blocks.push(Block::new(word, part).at_level(self.level));
    }

    fn rapid(&mut self, to: At, part: Part) {
        self.add(Word::Rapid(to), part);
    }

    fn line(&mut self, to: At, part: Part) {
        self.add(Word::Line(to), part);
    }

    /// From home to a place over the part.
    fn come(&mut self, [x, y]: [f64; 2]) {
        let [a, b, _] = self.at;
        self.rapid([a, b, HOME], Part::Other);
        self.rapid([x, y, HOME], Part::Other);
        self.rapid([x, y, self.clear], Part::Approach);
    }

    fn leave(&mut self) {
        let [x, y, _] = self.at;
        self.rapid([x, y, self.clear], Part::Retract);
    }

    /// A ring at the distance `off` from the walls, from the middle of its lower side and back.
    fn ring(&mut self, pocket: &Pocket, off: f64, z: f64, side: Part) {
        let [w, h] = pocket.size;
        let r = (pocket.corner - off).max(0.0);
        let (low, right, up, a) = (off, w - off, h - off, off + r);
        self.line([0.5 * w, low, z], Part::Other);
        let corners = [
            ([w - a, low], [right, a], [w - a, a]),
            ([right, h - a], [w - a, up], [w - a, h - a]),
            ([a, up], [low, h - a], [a, h - a]),
            ([low, a], [a, low], [a, a]),
        ];
        for (from, to, center) in corners {
            self.line([from[0], from[1], z], side);
            if r > 0.0 {
                let center = [center[0], center[1], z];
                let to = [to[0], to[1], z];
                let part = if side == Part::Wall { Part::Corner } else { Part::Other };
                self.add(Word::Arc { plane: 17, is_ccw: true, to, center }, part);
            }
        }
        self.line([0.5 * w, low, z], side);
    }
}

/// A random pocket with a program that cuts it within a thousandth of a millimetre.
pub fn scene(numbers: &mut Numbers) -> Scene {
    let radius = 0.5 * numbers.between(5.0, 9.0).round();
    let finishes = numbers.is_one_of(2);
    let has_island = numbers.is_one_of(2);
    let corner = if finishes && numbers.is_one_of(2) { 0.0 } else { radius + numbers.between(0.3, 2.0) };
    let corridor = has_island.then(|| 2.0 * radius + numbers.between(2.0, 4.0));
    let wide = corridor.map_or(4.0 * radius, |d| 2.0 * d + 5.0).max(2.0 * corner + 3.0);
    let size = [numbers.between(wide + 6.0, wide + 14.0), numbers.between(wide, wide + 5.0)];
    let pocket = Pocket { size, corner, depth: numbers.between(2.0, 5.0), corridor };
    let over = if numbers.is_one_of(2) { 0.0 } else { numbers.between(0.6, 1.2) };
    let margin = 9.0;
    let stock = (over > 0.0 || numbers.is_one_of(2))
        .then(|| [[-margin, -margin, -pocket.depth - 4.0], [size[0] + margin, size[1] + margin, over]]);
    let small = radius - numbers.between(0.4, 0.8);
    let rounded = [0.0, 0.5, small][if finishes { 0 } else { numbers.below(3) }];
    let clear = over + OVER;
    let start = [0.5 * size[0], 0.5 * size[1], HOME];
    let mut writer = Writer { blocks: Vec::new(), at: start, level: 0, clear };
    writer.add(Word::Tool(1), Part::Other);
    writer.add(Word::Offset(54), Part::Other);
    let last = if finishes { radius + FOR_FINISHING } else { radius };
    for (level, z) in [-0.5 * pocket.depth, -pocket.depth].into_iter().enumerate() {
        writer.level = level + 1;
        clear_level(&mut writer, &pocket, radius, last, z, numbers, !finishes);
    }
    writer.level = 0;
    let home = [writer.at[0], writer.at[1], HOME];
    writer.rapid(home, Part::Other);
    writer.add(Word::Tool(2), Part::Other);
    second_tool(&mut writer, &pocket, small, finishes, numbers);
    let [x, y, _] = writer.at;
    writer.rapid([x, y, HOME], Part::Retract);
    let [w, h] = size;
    let tool = |number: u32, radius: f64, corner: f64, flute: f64| Tool {
        number,
        radius,
        corner,
        flute,
        stickout: pocket.depth + over + 1.5,
        holder: radius + 3.0,
    };
    let flute = 0.5 * pocket.depth + over + 0.2;
    Scene {
        shape: Shape::Pocket(pocket),
        blocks: writer.blocks,
        start,
        zero: [0.03, -0.02, 0.0],
        tools: vec![
            tool(1, radius, 0.0, flute),
            tool(2, small, rounded, pocket.depth + over + 0.2),
            tool(3, radius + FOR_FINISHING + 0.05, 0.0, flute),
            tool(4, small + 0.05, rounded, pocket.depth + over + 0.2),
        ],
        stock,
        clamp: [[-34.0, -6.0, -5.0], [-27.0, h + 6.0, 8.0]],
        travel: [[-130.0, -10.0, -pocket.depth - 0.5], [w + 20.0, h + 10.0, HOME]],
        clearance: 0.5,
        allowed: 0.012,
        is_dog_leg: numbers.is_one_of(3),
    }
}

/// One level of the first tool: down by a helix, then rings from within to the walls.
fn clear_level(
    writer: &mut Writer,
    pocket: &Pocket,
    radius: f64,
    last: f64,
    z: f64,
    numbers: &mut Numbers,
    is_final: bool,
) {
    let [w, h] = pocket.size;
    let step = numbers.between(1.15, 1.25) * radius;
    // Rings between the walls and the island, or the middle.
    let (middle, inner) = match pocket.corridor {
        Some(d) => (0.5 * d, d - radius),
        None => (0.5 * h, 0.5 * h),
    };
    let n = ((inner - last) / step).ceil().max(1.0);
    // The innermost ring of a pocket without an island is a line.
    let innermost = if pocket.corridor.is_some() { n as usize } else { n as usize - 1 };
    let offs: Vec<f64> = (0..=innermost).rev().map(|k| last + (inner - last) * k as f64 / n).collect();
    let begin = [0.5 * w, middle];
    writer.come(begin);
    let top = z + 0.5 * pocket.depth;
    writer.line([begin[0], begin[1], top], Part::Other);
    let turns = 1 + numbers.below(2);
    for k in 1..=turns {
        let z = top + (z - top) * k as f64 / turns as f64;
        let (to, center) = ([begin[0], begin[1], z], [begin[0] + 0.8, begin[1], z]);
        let part = if k == turns && is_level(z, pocket) { Part::Helix } else { Part::Other };
        writer.add(Word::Arc { plane: 17, is_ccw: numbers.is_one_of(2), to, center }, part);
    }
    if pocket.corridor.is_none() {
        writer.line([w - middle, middle, z], Part::Other);
        writer.line([middle, middle, z], floor_part(z, pocket));
        writer.line([begin[0], begin[1], z], floor_part(z, pocket));
    }
    for (k, off) in offs.iter().enumerate() {
        let is_last = k + 1 == offs.len();
        let side =
            if is_last && is_final && is_level(z, pocket) { Part::Wall } else { floor_part(z, pocket) };
        writer.ring(pocket, *off, z, side);
    }
    writer.leave();
}

fn is_level(z: f64, pocket: &Pocket) -> bool {
    z == -pocket.depth
}

fn floor_part(z: f64, pocket: &Pocket) -> Part {
    if is_level(z, pocket) { Part::Floor } else { Part::Other }
}

/// The second tool: along the walls where the first one has left material, arcs in three planes, and holes.
fn second_tool(writer: &mut Writer, pocket: &Pocket, small: f64, finishes: bool, numbers: &mut Numbers) {
    let ([w, h], z) = (pocket.size, -pocket.depth);
    let middle = pocket.corridor.map_or(0.4 * h, |d| 0.5 * d);
    let begin = [0.5 * w - 2.0, middle];
    writer.come(begin);
    writer.line([begin[0], begin[1], z], Part::Plunge);
    let rise = numbers.between(0.15, 0.35);
    let wide = numbers.between(1.0, 1.6);
    // An arch over the floor along x, and a dip that touches the floor, along x or y.
    let [x, y] = begin;
    let (to, center) = ([x + 2.0 * wide, y, z], [x + wide, y, z]);
    writer.add(Word::Arc { plane: 18, is_ccw: true, to, center }, Part::Arch);
    writer.line([x, y, z + rise], Part::Other);
    let half = 0.5 * numbers.between(0.8, 1.2);
    let radius = (half * half + rise * rise) / (2.0 * rise);
    let over = z + radius;
    if numbers.is_one_of(2) {
        let (to, center) = ([x + 2.0 * half, y, z + rise], [x + half, y, over]);
        writer.add(Word::Arc { plane: 18, is_ccw: false, to, center }, Part::Dip);
    } else {
        writer.line([x, y - half, z + rise], Part::Other);
        let (to, center) = ([x, y + half, z + rise], [x, y, over]);
        writer.add(Word::Arc { plane: 19, is_ccw: true, to, center }, Part::Dip);
    }
    writer.line([x, y, z + 0.5], Part::Other);
    if finishes {
        writer.line([0.5 * w, small, z], Part::Other);
        writer.ring(pocket, small, z, Part::Wall);
    }
    // A bow away from the wall, which cuts the wall when it turns the other way.
    writer.line([0.5 * w - 1.0, small, z], Part::Other);
    let (to, center) = ([0.5 * w + 1.0, small, z], [0.5 * w, small, z]);
    writer.add(Word::Arc { plane: 17, is_ccw: false, to, center }, Part::Bow);
    writer.leave();
    writer.rapid([-16.0, 0.5 * h, writer.clear], Part::Park);
    writer.come([0.5 * w, middle]);
    for k in 0..2 + numbers.below(2) {
        let x = 0.5 * w + [-1.5, 0.0, 1.5][k];
        let peck = numbers.is_one_of(2).then_some(0.8);
        writer.add(Word::Hole { at: [x, middle, z], plane: writer.clear, peck }, Part::Hole);
    }
    // Behind a cycle a program states its motion anew.
    let [x, y, z] = writer.at;
    writer.rapid([x, y, z + 1.0], Part::Other);
}
