//! Turns a toolpath into blocks with integer coordinates, in the order of the program.

use nalgebra::Point3;

use super::block::{Block, Blocks};
use super::posed::{self, Posed};
use super::words;
use super::{BLOCKS_BETWEEN_CHECKS, ProgramJob, WriteError};
use crate::budget::Budget;
use crate::geometry::curve::Curve;
use crate::toolpath::Toolpath;
use crate::toolpath::path::Move;
use crate::toolpath::program::Resolution;
use crate::toolpath::quantize::{self, Form, Grid, Parabolas, Written};
use crate::toolpath::units::FeedRate;

/// A toolpath as blocks, with a bound for their rounding.
pub struct Lowered {
    pub blocks: Vec<Block>,
    /// Upper bound for the distance of the feed moves from any path that a control may run for them, mm, both
    /// ways.
    pub displacement_mm: f64,
    /// The same for the tool axis, radians; zero where the axis does not lean.
    pub displacement_axis: f64,
}

/// The blocks of the approach, of every move and of the retract.
pub fn lower(toolpath: &Toolpath, job: &ProgramJob, budget: &Budget) -> Result<Lowered, WriteError> {
    if let Some(five) = job.five_axes {
        let Posed { blocks, displacement_mm, displacement_axis } =
            posed::lower(toolpath, &five, job, budget)?;
        return Ok(Lowered { blocks, displacement_mm, displacement_axis });
    }
    if !toolpath.is_upright() {
        return Err(WriteError::MachineMissing);
    }
    upright(toolpath, job, budget)
}

/// The blocks of a toolpath whose tool axis is straight up.
fn upright(toolpath: &Toolpath, job: &ProgramJob, budget: &Budget) -> Result<Lowered, WriteError> {
    let resolution = job.program.resolution;
    let grid = Grid::new(resolution);
    let clearance = grid.units(job.cutting.clearance_z_mm)?;
    let at = grid.round(&toolpath.start())?;
    let parabolas = job.dialect.parabolas;
    let mut lowering =
        Lowering { resolution, grid, parabolas, at, blocks: Blocks::default(), displacement_mm: 0.0 };
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
            Move::Dwell { seconds } => lowering.blocks.dwell(*seconds)?,
            // A turn to the same axis.
            Move::Turn { .. } => {}
        }
    }
    if lowering.at[2] < clearance {
        lowering.blocks.push(Block::Rapid { to: [None, None, Some(clearance)] })?;
    }
    let Lowering { blocks, displacement_mm, .. } = lowering;
    Ok(Lowered { blocks: blocks.finish(), displacement_mm, displacement_axis: 0.0 })
}

struct Lowering {
    resolution: Resolution,
    grid: Grid,
    parabolas: Parabolas,
    at: [i64; 3],
    blocks: Blocks,
    displacement_mm: f64,
}

impl Lowering {
    /// Moves from the tool change to the start: across at the height of the tool change, then down to the
    /// clearance plane, then to the start.
    fn approach(&mut self, clearance: i64) -> Result<(), WriteError> {
        let [x, y, z] = self.at;
        self.blocks.push(Block::Rapid { to: [Some(x), Some(y), None] })?;
        self.blocks.push(Block::Rapid { to: [None, None, Some(z.max(clearance))] })?;
        if z < clearance {
            self.blocks.push(Block::Rapid { to: [None, None, Some(z)] })?;
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
                self.blocks.push(block)?;
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
            self.blocks.push(match (curve, form) {
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
}
