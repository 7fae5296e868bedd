//! Turns a toolpath into blocks with integer coordinates, in the order of the program.

use nalgebra::{Point2, Point3};

use super::block::{Block, Blocks};
use super::cycles::{CycleWords, check_heights};
use super::dialect::{Arcs, Dialect};
use super::helix;
use super::posed::{self, Posed, Slowed};
use super::rails::RailWords;
use super::words::{self, FeedWord};
use super::{BLOCKS_BETWEEN_CHECKS, ProgramJob, WriteError};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::{Curve, Direction};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::cycle::Cycle;
use toolpathd_core::toolpath::path::{Move, Pass, Role};
use toolpathd_core::toolpath::program::Resolution;
use toolpathd_core::toolpath::quantize::{self, Form, Grid, Written};
use toolpathd_core::toolpath::units::FeedRate;

/// A toolpath as blocks, with a bound for their rounding.
pub struct Lowered {
    pub blocks: Vec<Block>,
    /// The rails of the blocks.
    pub rails: Vec<RailWords>,
    /// The canned cycles of the blocks.
    pub cycles: Vec<CycleWords>,
    /// For each move of the toolpath the number of blocks up to its end.
    pub move_ends: Vec<u32>,
    /// For each note of the job the index of the block before which it stands.
    pub notes_at: Vec<usize>,
    /// Upper bound for the distance of the feed moves from any path that a control may run for them, mm, both
    /// ways.
    pub displacement_mm: f64,
    /// The same for the tool axis, radians; zero where the axis does not lean.
    pub displacement_axis: f64,
    /// How much longer the blocks take than the moves they stand for, s.
    pub delay_s: f64,
    pub slowed: Slowed,
    /// Where the last block ends; `None` where a tool leans or turns.
    pub end: Option<[i64; 3]>,
}

/// The blocks of the approach, of every move and of the retract. The operation before may have ended at
/// `from`, with the same tool and work offset.
pub fn lower(
    toolpath: &Toolpath,
    job: &ProgramJob,
    from: Option<[i64; 3]>,
    budget: &Budget,
) -> Result<Lowered, WriteError> {
    let grid = Grid::new(job.program.resolution);
    let mut cycles = toolpath.passes().iter().flat_map(Pass::cycles);
    cycles.try_for_each(|cycle| check_heights(&cycle.hole, &grid))?;
    if let Some(five) = job.five_axes {
        let Posed { blocks, rails, move_ends, displacement_mm, displacement_axis, delay_s, slowed } =
            posed::lower(toolpath, &five, job, budget)?;
        return Ok(Lowered {
            blocks,
            rails,
            cycles: Vec::new(),
            move_ends,
            notes_at: Vec::new(),
            displacement_mm,
            displacement_axis,
            delay_s,
            slowed,
            end: None,
        });
    }
    if !toolpath.is_upright() {
        return Err(WriteError::MachineMissing);
    }
    upright(toolpath, job, from, budget)
}

/// The blocks of a toolpath whose tool axis is straight up.
fn upright(
    toolpath: &Toolpath,
    job: &ProgramJob,
    from: Option<[i64; 3]>,
    budget: &Budget,
) -> Result<Lowered, WriteError> {
    let resolution = job.program.resolution;
    let grid = Grid::new(resolution);
    let clearance = grid.units(job.cutting.clearance_z_mm)?;
    let at = grid.round(&toolpath.start())?;
    let rest = rest(toolpath, job.dialect, &grid, clearance)?;
    let mut lowering = Lowering {
        rest,
        resolution,
        grid,
        dialect: job.dialect,
        at,
        off_grid: None,
        blocks: Blocks::default(),
        cycles: Vec::new(),
        displacement_mm: 0.0,
    };
    match from {
        Some(from) => lowering.cross(from, clearance)?,
        None => lowering.approach(clearance)?,
    }
    let (mut done, mut checked, total) = (0, 0, toolpath.moves().count());
    let mut move_ends = Vec::with_capacity(total);
    let mut notes = job.pass_notes.iter().peekable();
    let mut notes_at = Vec::new();
    for (index, pass) in toolpath.passes().iter().enumerate() {
        while notes.next_if(|note| note.pass <= index).is_some() {
            notes_at.push(lowering.blocks.len());
        }
        let mut cycles = pass.cycles().iter().peekable();
        let mut k = 0;
        while let Some(step) = pass.moves().get(k) {
            // One move may become very many blocks, and very many moves may become no block.
            if (done + k).is_multiple_of(BLOCKS_BETWEEN_CHECKS)
                || lowering.blocks.len() >= checked + BLOCKS_BETWEEN_CHECKS
            {
                budget.check()?;
                budget.progress("lowering", done + k, total);
                checked = lowering.blocks.len();
            }
            let cycle = cycles.next_if(|cycle| cycle.moves.start == k);
            if let Some(cycle) = cycle
                && lowering.cycle(cycle)?
            {
                k = cycle.moves.end;
            } else {
                lowering.step(step)?;
                k += 1;
            }
            move_ends.resize(done + k, u32::try_from(lowering.blocks.len()).unwrap_or(u32::MAX));
        }
        done += pass.moves().len();
    }
    lowering.retract(clearance)?;
    let Lowering { blocks, cycles, displacement_mm, at, .. } = lowering;
    Ok(Lowered {
        blocks: blocks.finish(),
        rails: Vec::new(),
        cycles,
        move_ends,
        notes_at,
        displacement_mm,
        displacement_axis: 0.0,
        delay_s: 0.0,
        slowed: Slowed::default(),
        end: Some([at[0], at[1], at[2].max(clearance)]),
    })
}

/// The place where the machine rests between programs: at least as high as the clearance plane, and as the
/// place where the toolpath ends.
fn rest(
    toolpath: &Toolpath,
    dialect: &Dialect,
    grid: &Grid,
    clearance: i64,
) -> Result<Option<[i64; 3]>, WriteError> {
    let Some(rest_mm) = dialect.rests_at_mm else { return Ok(None) };
    let [x, y, z] = grid.round(&Point3::from(rest_mm))?;
    let last = toolpath.moves().filter_map(|step| match step {
        Move::Rapid { line } => Some(line.end),
        Move::Feed { along, .. } => Some(along.end()),
        Move::Turn { .. } | Move::Dwell { .. } => None,
    });
    let ends = [toolpath.start(), last.last().unwrap_or(toolpath.start())];
    let [first, last] = [grid.units(ends[0].z)?, grid.units(ends[1].z)?];
    Ok(Some([x, y, z.max(clearance).max(first).max(last)]))
}

struct Lowering<'a> {
    resolution: Resolution,
    grid: Grid,
    dialect: &'a Dialect,
    /// The place where the machine rests between programs.
    rest: Option<[i64; 3]>,
    at: [i64; 3],
    /// Where the tool really is in X and Y, mm, behind a helix.
    off_grid: Option<Point2<f64>>,
    blocks: Blocks,
    cycles: Vec<CycleWords>,
    displacement_mm: f64,
}

impl Lowering<'_> {
    fn step(&mut self, step: &Move) -> Result<(), WriteError> {
        let abilities = &self.dialect.abilities;
        match step {
            Move::Rapid { line } => self.rapid(&line.end),
            Move::Feed { along, rate, role } => self.feed(along, rate.ok_or(WriteError::FeedMissing)?, *role),
            Move::Dwell { .. } if !abilities.has_dwells => Err(WriteError::NoDwells),
            Move::Dwell { seconds } => self.blocks.dwell(*seconds, abilities.max_dwell_s),
            // A turn to the same axis.
            Move::Turn { .. } => Ok(()),
        }
    }

    /// A canned cycle. False where its moves have to be written instead.
    fn cycle(&mut self, cycle: &Cycle) -> Result<bool, WriteError> {
        let Some(words) = CycleWords::of(cycle, self.resolution, self.dialect)? else { return Ok(false) };
        let index = u32::try_from(self.cycles.len()).unwrap_or(u32::MAX);
        let hole = &cycle.hole;
        let heights = [(words.retract, hole.retract_z_mm), (words.bottom, hole.bottom_z_mm)];
        self.blocks.push(Block::BeginCycle { index })?;
        for place in &cycle.places {
            let [x, y] = [self.grid.units(place.x)?, self.grid.units(place.y)?];
            for (z, height_mm) in heights {
                let moved = self.grid.point([x, y, z]) - Point3::new(place.x, place.y, height_mm);
                self.displacement_mm = self.displacement_mm.max(moved.norm());
            }
            self.blocks.push(Block::Hole { to: [x, y], index })?;
            self.at = [x, y, words.returns];
        }
        self.off_grid = None;
        self.blocks.push(Block::EndCycle)?;
        self.cycles.push(words);
        Ok(true)
    }

    /// Moves from the tool change to the start: across at the height of the tool change, then down to the
    /// clearance plane, then to the start.
    fn approach(&mut self, clearance: i64) -> Result<(), WriteError> {
        let [x, y, z] = self.at;
        if let Some(to) = self.rest {
            self.blocks.push(Block::Park { to: to.map(Some) })?;
            self.blocks.push(Block::Rapid { to: [Some(x), Some(y), Some(z.max(clearance))] })?;
            return self.down_to(z, clearance);
        }
        self.blocks.push(Block::Rapid { to: [Some(x), Some(y), None] })?;
        self.blocks.push(Block::Rapid { to: [None, None, Some(z.max(clearance))] })?;
        self.down_to(z, clearance)
    }

    /// Moves from the end of the operation before to the start: up if need be, across, and down.
    fn cross(&mut self, from: [i64; 3], clearance: i64) -> Result<(), WriteError> {
        let [x, y, z] = self.at;
        let height = from[2].max(clearance).max(z);
        if height > from[2] {
            self.blocks.push(Block::Rapid { to: [None, None, Some(height)] })?;
        }
        self.blocks.push(Block::Rapid { to: [Some(x), Some(y), None] })?;
        self.down_to(z, height)
    }

    fn down_to(&mut self, z: i64, clearance: i64) -> Result<(), WriteError> {
        if z < clearance { self.blocks.push(Block::Rapid { to: [None, None, Some(z)] }) } else { Ok(()) }
    }

    /// Goes up to the clearance plane, and to where the machine rests.
    fn retract(&mut self, clearance: i64) -> Result<(), WriteError> {
        if self.at[2] < clearance {
            self.blocks.push(Block::Rapid { to: [None, None, Some(clearance)] })?;
        }
        let Some([x, y, z]) = self.rest else { return Ok(()) };
        self.blocks.push(Block::Park { to: [None, None, Some(z)] })?;
        self.blocks.push(Block::Park { to: [Some(x), Some(y), None] })
    }

    /// Writes a rapid along Z and across as two blocks, because a machine does not run such a rapid straight:
    /// up, then across; or across, then down.
    fn rapid(&mut self, to: &Point3<f64>) -> Result<(), WriteError> {
        let [x, y, z] = self.grid.round(to)?;
        let [from_x, from_y, from_z] = self.at;
        let is_off = self.off_grid.take().is_some();
        let across = |from: i64, to: i64| (from != to || is_off).then_some(to);
        let across = Block::Rapid { to: [across(from_x, x), across(from_y, y), None] };
        let along_z = Block::Rapid { to: [None, None, (from_z != z).then_some(z)] };
        let order = if z > from_z { [along_z, across] } else { [across, along_z] };
        for block in order {
            if block != (Block::Rapid { to: [None; 3] }) {
                self.blocks.push(block)?;
            }
        }
        self.at = [x, y, z];
        Ok(())
    }

    fn feed(&mut self, along: &Curve, rate: FeedRate, role: Role) -> Result<(), WriteError> {
        let feed = words::feed(rate, self.resolution.units, &self.dialect.numbers)?;
        let rounded = quantize::round(along, self.resolution, &self.dialect.curves)?;
        self.displacement_mm = self.displacement_mm.max(rounded.displacement_mm);
        for Written { curve, end_units: to, form, displacement_mm, .. } in rounded.curves {
            if let (Curve::Arc(arc), Form::Arc { center }) = (curve, form) {
                let is_helix = arc.plane() == Plane::Xy && to[2] != self.at[2];
                if self.dialect.curves.arcs == Arcs::WithHelicesAboutZ && is_helix {
                    self.helix(arc.direction(), to, center, (feed, role), displacement_mm)?;
                    continue;
                }
                self.back_to_grid(feed, role)?;
            }
            self.off_grid = None;
            self.blocks.push(match (curve, form) {
                (Curve::Arc(arc), Form::Arc { center }) => {
                    Block::Arc { plane: arc.plane(), direction: arc.direction(), to, center, feed }
                }
                (_, Form::Parabola { control }) => Block::Parabola { to: [to[0], to[1]], control, feed },
                _ => Block::Line { to, feed, role },
            })?;
            self.at = to;
        }
        Ok(())
    }

    /// A helix about Z, which turns from where the tool is. `displacement_mm` bounds how far rounding
    /// moves the helix between points of the grid.
    fn helix(
        &mut self,
        direction: Direction,
        to: [i64; 3],
        center: [i64; 2],
        (feed, role): (FeedWord, Role),
        displacement_mm: f64,
    ) -> Result<(), WriteError> {
        let place = |x: i64, y: i64| Point2::new(self.grid.mm(x), self.grid.mm(y));
        let ends = [place(self.at[0], self.at[1]), place(to[0], to[1])];
        let about = place(self.at[0] + center[0], self.at[1] + center[1]);
        let mut turn = helix::turn(self.off_grid.unwrap_or(ends[0]), ends, about, direction);
        let step_mm = self.grid.step_mm();
        if displacement_mm + turn.apart_mm > quantize::MAX_DISPLACEMENT_STEPS * step_mm {
            self.back_to_grid(feed, role)?;
            turn = helix::turn(ends[0], ends, about, direction);
        }
        self.blocks.push(Block::Helix { direction, to, center, angle: turn.angle, feed })?;
        self.displacement_mm = self.displacement_mm.max(displacement_mm + turn.apart_mm);
        self.at = to;
        self.off_grid = Some(turn.end);
        Ok(())
    }

    /// Goes to the point of the grid at or beside which a helix has ended. A full circle ends where it
    /// starts: behind a helix, no control would know that its end is there.
    fn back_to_grid(&mut self, feed: FeedWord, role: Role) -> Result<(), WriteError> {
        match self.off_grid.take() {
            Some(_) => self.blocks.push(Block::Line { to: self.at, feed, role }),
            None => Ok(()),
        }
    }
}
