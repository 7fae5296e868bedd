//! Faults of many kinds, each put into one place of a good program.

use toolpathd_core::operations::verification::Kind;

use super::block::{At, Block, Part, Word};
use super::random::Numbers;
use super::scene::{Scene, Shape};
use super::sheet::LIFT;

/// How far a path goes too deep or too wide, mm.
const WRONG: f64 = 0.01;

/// What is left at walls and on floors, mm.
const SKIN: f64 = 0.02;

/// A kind of fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    LineTooDeep,
    LineTooWide,
    ArcTooWide,
    UprightArcTooDeep,
    ArcWrongWay,
    PlungeTooDeep,
    HelixTooDeep,
    HoleTooDeep,
    RapidThroughPart,
    RapidThroughStock,
    RapidThroughClamp,
    DogLegThroughClamp,
    HolderIntoStock,
    HolderIntoWall,
    OutsideTravel,
    WrongTool,
    MissingBlock,
    WrongOffset,
    DeeperThanFlutes,
    WallNotCut,
    FloorNotCut,
    SurfaceNotCut,
}

/// All kinds, with their names in the table.
pub const FAULTS: [(Fault, &str); 22] = [
    (Fault::LineTooDeep, "line 0.01 mm too deep"),
    (Fault::LineTooWide, "line 0.01 mm too near to a wall"),
    (Fault::ArcTooWide, "arc in the level plane 0.01 mm too wide"),
    (Fault::UprightArcTooDeep, "upright arc 0.01 mm too deep"),
    (Fault::ArcWrongWay, "arc the wrong way round"),
    (Fault::PlungeTooDeep, "plunge 0.01 mm too deep"),
    (Fault::HelixTooDeep, "helix 0.01 mm too deep"),
    (Fault::HoleTooDeep, "cycle 0.01 mm too deep"),
    (Fault::RapidThroughPart, "rapid through the part"),
    (Fault::RapidThroughStock, "rapid through the stock"),
    (Fault::RapidThroughClamp, "rapid through a clamp"),
    (Fault::DogLegThroughClamp, "dog-leg through a clamp, straight line past it"),
    (Fault::HolderIntoStock, "holder into the stock"),
    (Fault::HolderIntoWall, "holder into a wall"),
    (Fault::OutsideTravel, "travel exceeded by 0.01 mm"),
    (Fault::WrongTool, "tool 0.05 mm too thick"),
    (Fault::MissingBlock, "retract missing"),
    (Fault::WrongOffset, "wrong work offset"),
    (Fault::DeeperThanFlutes, "level missing: cut deeper than the flutes"),
    (Fault::WallNotCut, "skin of 0.02 mm left at a wall"),
    (Fault::FloorNotCut, "skin of 0.02 mm left on a floor"),
    (Fault::SurfaceNotCut, "row over a surface missing"),
];

/// A program with a fault.
#[derive(Debug, Clone)]
pub struct Faulty {
    pub scene: Scene,
    /// The lines of the changed blocks. Empty where the fault concerns the whole program.
    pub lines: Vec<u32>,
    /// The findings that tell the fault.
    pub kinds: Vec<Kind>,
}

/// Where the tip stands before each block.
fn starts(scene: &Scene) -> Vec<At> {
    let mut at = scene.start;
    let before = scene.blocks.iter().map(|block| {
        let before = at;
        at = block.word.end().unwrap_or(at);
        before
    });
    before.collect()
}

/// A random block for which a fault is possible.
fn pick(scene: &Scene, numbers: &mut Numbers, can: impl Fn(&Block) -> bool) -> Option<usize> {
    let able: Vec<usize> = (0..scene.blocks.len()).filter(|k| can(&scene.blocks[*k])).collect();
    (!able.is_empty()).then(|| able[numbers.below(able.len())])
}

/// The program with a block replaced.
fn replaced(scene: &Scene, k: usize, words: &[Word], kinds: &[Kind]) -> Faulty {
    let mut scene = scene.clone();
    let own = scene.blocks[k];
    let blocks = words.iter().map(|word| Block { word: *word, ..own });
    scene.blocks.splice(k..=k, blocks);
    let lines = (0..words.len()).map(|n| (k + n + 3) as u32).collect();
    Faulty { scene, lines, kinds: kinds.to_vec() }
}

/// The program without some blocks. The judge says which later block shows the fault.
fn without(scene: &Scene, is_gone: impl Fn(usize, &Block) -> bool, kinds: &[Kind]) -> Option<Faulty> {
    let mut scene = scene.clone();
    let kept = scene.blocks.iter().enumerate().filter(|(k, block)| !is_gone(*k, block));
    scene.blocks = kept.map(|(_, block)| *block).collect();
    Some(Faulty { scene, lines: Vec::new(), kinds: kinds.to_vec() })
}

fn down(p: At, by: f64) -> At {
    [p[0], p[1], p[2] - by]
}

fn middle(a: &At, b: &At) -> At {
    [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]))
}

/// A place moved to the right of the way between two others, in plan.
fn right(p: At, from: &At, to: &At, by: f64) -> At {
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = way[0].hypot(way[1]);
    [p[0] + way[1] / length * by, p[1] - way[0] / length * by, p[2]]
}

/// The centre of an arc of less than half a turn whose middle lies farther out.
fn farther(from: &At, to: &At, center: &At, by: f64) -> At {
    let m = middle(from, to);
    let across = [0, 1, 2].map(|k| center[k] - m[k]);
    let apart = across.iter().map(|x| x * x).sum::<f64>().sqrt();
    let half = [0, 1, 2].map(|k| from[k] - m[k]).iter().map(|x| x * x).sum::<f64>().sqrt();
    let sagitta = half.hypot(apart) - apart + by;
    let radius = (half * half + sagitta * sagitta) / (2.0 * sagitta);
    [0, 1, 2].map(|k| m[k] + across[k] / apart * (radius - sagitta))
}

/// Puts a fault into a program. `None` where the program has no place for it.
pub fn put(fault: Fault, scene: &Scene, numbers: &mut Numbers) -> Option<Faulty> {
    let starts = starts(scene);
    let of = |part: Part| move |block: &Block| block.part == part;
    let is_sheet = matches!(scene.shape, Shape::Sheet(_));
    // The tip runs over a surface with a little room.
    let deep = if is_sheet { WRONG + LIFT } else { WRONG };
    match fault {
        Fault::LineTooDeep => {
            let able = |block: &Block| {
                matches!(block.word, Word::Line(_))
                    && [Part::Floor, Part::Wall, Part::Pass].contains(&block.part)
            };
            let k = pick(scene, numbers, able)?;
            let Word::Line(to) = scene.blocks[k].word else { return None };
            let low = down(middle(&starts[k], &to), deep);
            Some(replaced(scene, k, &[Word::Line(low), Word::Line(to)], &[Kind::Gouge]))
        }
        Fault::LineTooWide => {
            let k = pick(scene, numbers, of(Part::Wall))?;
            let Word::Line(to) = scene.blocks[k].word else { return None };
            let wide = right(middle(&starts[k], &to), &starts[k], &to, WRONG);
            Some(replaced(scene, k, &[Word::Line(wide), Word::Line(to)], &[Kind::Gouge]))
        }
        Fault::ArcTooWide | Fault::UprightArcTooDeep => {
            let part = if fault == Fault::ArcTooWide { Part::Corner } else { Part::Dip };
            let k = pick(scene, numbers, of(part))?;
            let Word::Arc { plane, is_ccw, to, center } = scene.blocks[k].word else { return None };
            let center = farther(&starts[k], &to, &center, WRONG);
            Some(replaced(scene, k, &[Word::Arc { plane, is_ccw, to, center }], &[Kind::Gouge]))
        }
        Fault::ArcWrongWay => {
            let k = pick(scene, numbers, |block| [Part::Bow, Part::Arch].contains(&block.part))?;
            let Word::Arc { plane, is_ccw, to, center } = scene.blocks[k].word else { return None };
            Some(replaced(scene, k, &[Word::Arc { plane, is_ccw: !is_ccw, to, center }], &[Kind::Gouge]))
        }
        Fault::PlungeTooDeep => {
            let k = pick(scene, numbers, of(Part::Plunge))?;
            let Word::Line(to) = scene.blocks[k].word else { return None };
            Some(replaced(scene, k, &[Word::Line(down(to, deep)), Word::Line(to)], &[Kind::Gouge]))
        }
        Fault::HelixTooDeep => {
            let k = pick(scene, numbers, of(Part::Helix))?;
            let Word::Arc { plane, is_ccw, to, center } = scene.blocks[k].word else { return None };
            let deeper = Word::Arc { plane, is_ccw, to: down(to, WRONG), center };
            Some(replaced(scene, k, &[deeper, Word::Line(to)], &[Kind::Gouge]))
        }
        Fault::HoleTooDeep => {
            let k = pick(scene, numbers, of(Part::Hole))?;
            let Word::Hole { at, plane, peck } = scene.blocks[k].word else { return None };
            Some(replaced(scene, k, &[Word::Hole { at: down(at, WRONG), plane, peck }], &[Kind::Gouge]))
        }
        Fault::WallNotCut | Fault::FloorNotCut => skin(fault, scene, &starts, numbers),
        _ => of_rapids_and_tools(fault, scene, &starts, numbers),
    }
}

/// A line that leaves a skin along its whole length.
fn skin(fault: Fault, scene: &Scene, starts: &[At], numbers: &mut Numbers) -> Option<Faulty> {
    let is_able = |block: &Block| {
        block.part == Part::Wall || (fault == Fault::FloorNotCut && block.part == Part::Floor)
    };
    let k = pick(scene, numbers, is_able)?;
    let Word::Line(to) = scene.blocks[k].word else { return None };
    let from = starts[k];
    let away = |p: At| if fault == Fault::WallNotCut { right(p, &from, &to, -SKIN) } else { down(p, -SKIN) };
    let words = [Word::Line(away(from)), Word::Line(away(to)), Word::Line(to)];
    Some(replaced(scene, k, &words, &[Kind::MaterialLeft]))
}

fn of_rapids_and_tools(fault: Fault, scene: &Scene, starts: &[At], numbers: &mut Numbers) -> Option<Faulty> {
    let of = |part: Part| move |block: &Block| block.part == part;
    let through = [Kind::RapidThroughPart, Kind::RapidThroughStock];
    let whole =
        |scene: Scene, kinds: &[Kind]| Some(Faulty { scene, lines: Vec::new(), kinds: kinds.to_vec() });
    let pocket = match &scene.shape {
        Shape::Pocket(pocket) => Some(*pocket),
        Shape::Sheet(_) => None,
    };
    match fault {
        Fault::RapidThroughPart => {
            let part = if pocket.is_some() { Part::Park } else { Part::Approach };
            let k = pick(scene, numbers, of(part))?;
            let to = scene.blocks[k].word.end()?;
            let low = match &scene.shape {
                Shape::Pocket(_) => [to[0], to[1], -1.0],
                Shape::Sheet(sheet) => [to[0], to[1], sheet.height(to[0], to[1])? - 0.5],
            };
            Some(replaced(scene, k, &[Word::Rapid(low)], &[Kind::RapidThroughPart]))
        }
        Fault::RapidThroughStock => {
            let k = pick(scene, numbers, |block| block.part == Part::Approach && block.level > 0)?;
            let to = scene.blocks[k].word.end()?;
            let top = match (pocket, scene.stock) {
                (Some(pocket), _) if scene.blocks[k].level == 2 => -0.5 * pocket.depth,
                (_, Some([_, high])) => high[2],
                _ => 0.0,
            };
            Some(replaced(scene, k, &[Word::Rapid([to[0], to[1], top - 0.6])], &[Kind::RapidThroughStock]))
        }
        Fault::RapidThroughClamp | Fault::DogLegThroughClamp => {
            let pocket = pocket?;
            let k = pick(scene, numbers, of(Part::Park))?;
            let is_dog_leg = fault == Fault::DogLegThroughClamp;
            let far = if is_dog_leg { -120.0 } else { -48.0 };
            let from = starts[k];
            let words = [
                Word::Rapid([from[0], from[1], scene.start[2]]),
                Word::Rapid([far, 0.5 * pocket.size[1], 2.0]),
            ];
            let mut faulty = replaced(scene, k, &words, &[Kind::FixtureNear]);
            faulty.scene.is_dog_leg |= is_dog_leg;
            Some(faulty)
        }
        Fault::HolderIntoStock | Fault::HolderIntoWall => {
            let pocket = pocket?;
            let over = scene.stock.map_or(0.0, |[_, high]| high[2]);
            let mut scene = scene.clone();
            if fault == Fault::HolderIntoStock {
                if over <= 0.0 {
                    return None;
                }
                scene.tools[0].stickout = pocket.depth + over - 0.3;
                return whole(scene, &[Kind::HolderNearStock]);
            }
            scene.tools[0].stickout = pocket.depth - 0.3;
            whole(scene, &[Kind::HolderNearPart])
        }
        Fault::OutsideTravel => {
            let k = scene.blocks.len() - 1;
            let to = scene.blocks[k].word.end()?;
            Some(replaced(scene, k, &[Word::Rapid(down(to, -WRONG))], &[Kind::OutsideTravel]))
        }
        Fault::WrongTool => {
            let first = if numbers.is_one_of(2) { 1 } else { 2 };
            let k = pick(scene, numbers, |block| block.word == Word::Tool(first))?;
            scene.tools.get(3)?;
            let mut scene = scene.clone();
            scene.blocks[k].word = Word::Tool(first + 2);
            whole(scene, &[Kind::Gouge])
        }
        Fault::MissingBlock => {
            // Behind the block a rapid leaves the pocket, or goes to the next row.
            let is_gap = |k: &usize| {
                let next = scene.blocks.get(*k + 1);
                scene.blocks[*k].part == Part::Retract && next.is_some_and(|next| next.part == Part::Park)
            };
            let retracts: Vec<usize> = (0..scene.blocks.len()).filter(is_gap).collect();
            let k = *retracts.get(numbers.below(retracts.len().max(1)))?;
            let mut faulty = without(scene, |own, _| own == k, &through)?;
            // Of two ways, one may be free.
            faulty.scene.is_dog_leg = false;
            Some(faulty)
        }
        Fault::WrongOffset => {
            pocket?;
            let k = pick(scene, numbers, |block| block.word == Word::Offset(54))?;
            let mut scene = scene.clone();
            scene.blocks[k].word = Word::Offset(55);
            whole(scene, &[Kind::Gouge])
        }
        Fault::DeeperThanFlutes => {
            pocket?;
            without(scene, |_, block| block.level == 1, &[Kind::DeeperThanFlutes])
        }
        Fault::SurfaceNotCut => {
            if pocket.is_some() {
                return None;
            }
            let last = scene.blocks.iter().map(|block| block.level).max()?;
            let row = 2 + numbers.below(last - 2);
            without(scene, |_, block| block.level == row, &[Kind::MaterialLeft])
        }
        _ => None,
    }
}
