//! Turns a toolpath into blocks with integer coordinates, in the order of the program.

use nalgebra::Point3;

use super::words::{self, FeedWord};
use super::{BLOCKS_BETWEEN_CHECKS, MAX_BLOCKS, ProgramJob, WriteError};
use crate::budget::Budget;
use crate::geometry::curve::{Curve, Direction};
use crate::geometry::plane::Plane;
use crate::toolpath::Toolpath;
use crate::toolpath::path::Move;
use crate::toolpath::program::Resolution;
use crate::toolpath::quantize::{self, Form, Grid, Parabolas, Written};
use crate::toolpath::units::FeedRate;

/// The longest dwell, s: eleven days. A longer dwell is taken for a mistake and refused.
const MAX_DWELL_S: f64 = 1e6;

/// One block of motion or dwell. Positions are absolute, in units of the last decimal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Block {
    /// Moves the axes that have a value.
    Rapid {
        to: [Option<i64>; 3],
    },
    Line {
        to: [i64; 3],
        feed: FeedWord,
    },
    /// `center` counts from the start along the plane's first and second axis.
    Arc {
        plane: Plane,
        direction: Direction,
        to: [i64; 3],
        center: [i64; 2],
        feed: FeedWord,
    },
    /// Stays at the height of its start. `control`, the Bezier control point, counts from the start.
    Parabola {
        to: [i64; 2],
        control: [i64; 2],
        feed: FeedWord,
    },
    Dwell {
        milliseconds: u64,
    },
}

/// A toolpath as blocks, with a bound for their rounding.
pub struct Lowered {
    pub blocks: Vec<Block>,
    /// Upper bound for the distance of the feed moves from any path that a control may run for them, mm, both
    /// ways.
    pub displacement_mm: f64,
}

/// The blocks of the approach, of every move and of the retract.
pub fn lower(toolpath: &Toolpath, job: &ProgramJob, budget: &Budget) -> Result<Lowered, WriteError> {
    let resolution = job.program.resolution;
    let grid = Grid::new(resolution);
    let clearance = grid.units(job.cutting.clearance_z_mm)?;
    let at = grid.round(&toolpath.start())?;
    let parabolas = job.dialect.parabolas;
    let mut lowering = Lowering { resolution, grid, parabolas, at, blocks: Vec::new(), displacement_mm: 0.0 };
    lowering.approach(clearance)?;
    let (mut checked, total) = (0, toolpath.moves().count());
    for (k, step) in toolpath.moves().enumerate() {
        // One move may become very many blocks, and very many moves may become no block.
        if k.is_multiple_of(BLOCKS_BETWEEN_CHECKS) || lowering.blocks.len() >= checked + BLOCKS_BETWEEN_CHECKS
        {
            budget.check()?;
            budget.progress("lowering", k, total);
            checked = lowering.blocks.len();
        }
        match step {
            Move::Rapid { line } => lowering.rapid(&line.end)?,
            Move::Feed { along, rate, .. } => lowering.feed(along, rate.ok_or(WriteError::FeedMissing)?)?,
            Move::Dwell { seconds } => lowering.dwell(*seconds)?,
        }
    }
    if lowering.at[2] < clearance {
        lowering.push(Block::Rapid { to: [None, None, Some(clearance)] })?;
    }
    Ok(Lowered { blocks: lowering.blocks, displacement_mm: lowering.displacement_mm })
}

struct Lowering {
    resolution: Resolution,
    grid: Grid,
    parabolas: Parabolas,
    at: [i64; 3],
    blocks: Vec<Block>,
    displacement_mm: f64,
}

impl Lowering {
    /// Moves from the tool change to the start: across at the height of the tool change, then down to the
    /// clearance plane, then to the start.
    fn approach(&mut self, clearance: i64) -> Result<(), WriteError> {
        let [x, y, z] = self.at;
        self.push(Block::Rapid { to: [Some(x), Some(y), None] })?;
        self.push(Block::Rapid { to: [None, None, Some(z.max(clearance))] })?;
        if z < clearance {
            self.push(Block::Rapid { to: [None, None, Some(z)] })?;
        }
        Ok(())
    }

    /// Writes a rapid along Z and across as two blocks, because a machine does not run such a rapid straight:
    /// up, then across; or across, then down.
    fn rapid(&mut self, to: &Point3<f64>) -> Result<(), WriteError> {
        let [x, y, z] = self.grid.round(to)?;
        let [from_x, from_y, from_z] = self.at;
        let changed = |from: i64, to: i64| (from != to).then_some(to);
        let across = Block::Rapid { to: [changed(from_x, x), changed(from_y, y), None] };
        let along_z = Block::Rapid { to: [None, None, changed(from_z, z)] };
        let order = if z > from_z { [along_z, across] } else { [across, along_z] };
        for block in order {
            if block != (Block::Rapid { to: [None; 3] }) {
                self.push(block)?;
            }
        }
        self.at = [x, y, z];
        Ok(())
    }

    fn feed(&mut self, along: &Curve, rate: FeedRate) -> Result<(), WriteError> {
        let feed = words::feed(rate, self.resolution.units)?;
        let rounded = quantize::round(along, self.resolution, self.parabolas)?;
        self.displacement_mm = self.displacement_mm.max(rounded.displacement_mm);
        for Written { curve, end_units: to, form, .. } in rounded.curves {
            self.push(match (curve, form) {
                (Curve::Arc(arc), Form::Arc { center }) => {
                    Block::Arc { plane: arc.plane(), direction: arc.direction(), to, center, feed }
                }
                (_, Form::Parabola { control }) => Block::Parabola { to: [to[0], to[1]], control, feed },
                _ => Block::Line { to, feed },
            })?;
            self.at = to;
        }
        Ok(())
    }

    fn dwell(&mut self, seconds: f64) -> Result<(), WriteError> {
        if seconds > MAX_DWELL_S {
            return Err(WriteError::Dwell { seconds });
        }
        let milliseconds = (seconds * 1000.0).round() as u64;
        if milliseconds > 0 { self.push(Block::Dwell { milliseconds }) } else { Ok(()) }
    }

    fn push(&mut self, block: Block) -> Result<(), WriteError> {
        if self.blocks.len() >= MAX_BLOCKS {
            return Err(WriteError::TooManyBlocks { limit: MAX_BLOCKS });
        }
        self.blocks.push(block);
        Ok(())
    }
}
