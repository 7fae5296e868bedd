//! Toolpaths whose tool axis leans: from moves to blocks that state the axis.
//!
//! # Method
//! 1. Every move becomes straight motions between poses ([`legs`]): the tip on a line, the axis on a great
//!    circle in step with it. Curves are divided, because a control runs no arc in step with an axis.
//! 2. Where the toolpath holds the positions of the rotary axes, they are written. Otherwise
//!    [`Machine::follow`] chooses them over the whole toolpath.
//! 3. A control that is told angles moves all five axes, or the tip and both angles, in step. Between two
//!    blocks the tool strays from the straight motion ([`Machine::straying`]). A motion is halved until it
//!    strays by no more than the job allows. Motions with positions were divided when they were chosen.
//! 4. Positions are rounded to the decimals of the program.
//!
//! # Guarantees
//! * At every moment the written tip is within [`Posed::displacement_mm`] of the toolpath, and the written
//!   axis within `displacement_axis`, rounding counted. For [`AxisOutput::Vectors`] this holds on a control
//!   that turns the axis on the great circle.
//! * Where positions are stated, no axis is faster than [`FiveAxes::speeds`] at the feed or the time of its
//!   block, rounding counted: a block that would ask for more is slowed.
//! * A rapid of the toolpath is a line at the rapid feed: a machine does not run the rapid of five axes
//!   straight. Only the way to the first pose and the way up at the end are rapids.
//!
//! # Cost
//! O(n) for n blocks.

mod feeds;
mod legs;
mod slowed;

use nalgebra::Point3;

use self::legs::{Leg, LegTime, Legs};
pub use self::slowed::Slowed;
use super::block::{AxisWords, Block, BlockFeed, Blocks};
use super::dialect::{AxisOutput, Turns};
use super::rails::{self, FineGrid, RailWords, Rounded};
use super::words;
use super::{BLOCKS_BETWEEN_CHECKS, MAX_BLOCKS, ProgramJob, WriteError};
use toolpathd_core::budget::Budget;
use toolpathd_core::machine::{AxisPositions, Machine, Straying};
use toolpathd_core::toolpath::path::Toolpath;
use toolpathd_core::toolpath::pose::Pose;
use toolpathd_core::toolpath::quantize::Grid;
use toolpathd_core::toolpath::rail::Rail;
use toolpathd_core::toolpath::tool_axes::angle_between;
use toolpathd_core::toolpath::units::FeedRate;

/// What a program of a leaning tool needs besides the toolpath.
#[derive(Debug, Clone, Copy)]
pub struct FiveAxes<'a> {
    pub output: AxisOutput,
    /// Required but for [`AxisOutput::Vectors`] and [`AxisOutput::Rails`].
    pub machine: Option<&'a Machine>,
    /// How far the tool may stray from the toolpath between two blocks, before rounding.
    pub allowed: Straying,
    /// The largest speeds of X, Y and Z, mm/s, and of the rotary axes, radians by s; infinite where there is
    /// no limit.
    pub speeds: [f64; 5],
}

/// The decimals of a component of a vector.
pub const VECTOR_DECIMALS: u8 = 7;

/// Halvings of one motion, at most. Each divides the straying by four.
const MOST_HALVINGS: u32 = 16;

/// The blocks of a leaning toolpath.
pub struct Posed {
    pub blocks: Vec<Block>,
    pub rails: Vec<RailWords>,
    /// For each move of the toolpath the number of blocks up to its end.
    pub move_ends: Vec<u32>,
    pub displacement_mm: f64,
    /// Radians.
    pub displacement_axis: f64,
    /// How much longer the blocks take than their moves, s.
    pub delay_s: f64,
    pub slowed: Slowed,
}

/// # Errors
/// When the machine cannot follow the toolpath, or a number cannot be written.
pub fn lower(
    toolpath: &Toolpath,
    five: &FiveAxes,
    job: &ProgramJob,
    budget: &Budget,
) -> Result<Posed, WriteError> {
    let grid = Grid::new(job.program.resolution);
    let Legs { start, rotary, legs, ends, delay_s } =
        legs::divide(toolpath, job, 0.5 * grid.step_mm(), five.output == AxisOutput::Rails)?;
    let stated = stated(five.machine, (&start, rotary), &legs);
    let has_positions = stated.is_some();
    let joints = match (five.output, five.machine) {
        (AxisOutput::Vectors | AxisOutput::Rails, _) => None,
        (_, None) => return Err(WriteError::MachineMissing),
        (_, Some(machine)) => Some(stated.map_or_else(|| chosen(machine, &start, &legs), Ok)?),
    };
    let mut lowering = Lowering {
        five,
        job,
        grid,
        at: [i64::MIN; 3],
        axis: AxisWords::Angles([i64::MIN; 2]),
        owed_s: 0.0,
        rails: Vec::new(),
        is_on_rails: false,
        blocks: Blocks::default(),
        displacement_mm: 0.0,
        displacement_axis: 0.0,
        slowed: Slowed::default(),
        capped_s: 0.0,
        has_positions,
    };
    let joints_at = |k: usize| joints.as_ref().map(|joints| joints[k]);
    let clearance = grid.units(job.cutting.clearance_z_mm)?;
    lowering.approach(&start, joints_at(0), clearance)?;
    let (mut from, mut checked) = (start, 0);
    let mut blocks_by_legs = Vec::with_capacity(legs.len() + 1);
    blocks_by_legs.push(lowering.blocks.len());
    for (k, leg) in legs.iter().enumerate() {
        if k.is_multiple_of(BLOCKS_BETWEEN_CHECKS) || lowering.blocks.len() >= checked + BLOCKS_BETWEEN_CHECKS
        {
            budget.check()?;
            budget.progress("lowering", k, legs.len());
            checked = lowering.blocks.len();
        }
        match (leg.rail, leg.time) {
            (Some(rail), LegTime::Feed(rate)) => lowering.rail(rail, &leg.to, rate)?,
            (_, LegTime::Dwell(seconds)) => {
                lowering.blocks.dwell(seconds, job.dialect.abilities.max_dwell_s)?
            }
            (_, time) => {
                let ends = [joints_at(k), joints_at(k + 1)];
                lowering.motion([&from, &leg.to], ends, time, MOST_HALVINGS)?;
            }
        }
        from = leg.to;
        blocks_by_legs.push(lowering.blocks.len());
    }
    let n_blocks = |n_legs: &usize| u32::try_from(blocks_by_legs[*n_legs]).unwrap_or(u32::MAX);
    let move_ends = ends.iter().map(n_blocks).collect();
    lowering.retract(clearance)?;
    let Lowering { blocks, rails, displacement_mm, displacement_axis, slowed, capped_s, .. } = lowering;
    let delay_s = delay_s + slowed.by_s + slowed.coarse_by_s + capped_s;
    let blocks = blocks.finish();
    Ok(Posed { blocks, rails, move_ends, displacement_mm, displacement_axis, delay_s, slowed })
}

/// The positions of all axes at the start and at the end of each motion; `None` unless the toolpath holds the
/// angles of the rotary axes at all of them.
fn stated(
    machine: Option<&Machine>,
    (start, rotary): (&Pose, Option<[f64; 2]>),
    legs: &[Leg],
) -> Option<Vec<AxisPositions>> {
    let ends = std::iter::once((start, rotary)).chain(legs.iter().map(|leg| (&leg.to, leg.rotary)));
    ends.map(|(pose, rotary)| Some(machine?.at(&pose.tip, rotary?))).collect()
}

/// The positions of all axes at the start and at the end of each motion, chosen from the poses.
fn chosen(machine: &Machine, start: &Pose, legs: &[Leg]) -> Result<Vec<AxisPositions>, WriteError> {
    let poses: Vec<Pose> = std::iter::once(*start).chain(legs.iter().map(|leg| leg.to)).collect();
    machine.follow(&poses, [0.0; 2]).map_err(|error| {
        let at = poses[error.index().unwrap_or(0).min(poses.len() - 1)].tip;
        WriteError::NotFollowed { error, at }
    })
}

struct Lowering<'a> {
    five: &'a FiveAxes<'a>,
    job: &'a ProgramJob<'a>,
    grid: Grid,
    /// The position as last written: the tip, or the linear axes.
    at: [i64; 3],
    axis: AxisWords,
    /// The time of motions that are too short to be written.
    owed_s: f64,
    rails: Vec<RailWords>,
    is_on_rails: bool,
    blocks: Blocks,
    displacement_mm: f64,
    displacement_axis: f64,
    slowed: Slowed,
    /// How much longer blocks take because an axis would have been too fast, s.
    capped_s: f64,
    /// Whether the toolpath holds the positions of the rotary axes. The program then writes them.
    has_positions: bool,
}

impl Lowering<'_> {
    /// Brings the tip from the tool change to the start: turns the rotary axes where the tool was
    /// changed, goes across at that height, then down.
    ///
    /// Where angles are written, the linear axes go across before tip control begins. Tip control then
    /// moves along the machine's Z alone: a way across in the frame of a tilted table would lead down.
    /// Where vectors are written, the angles are the control's choice, so the tip goes across under tip
    /// control.
    fn approach(
        &mut self,
        start: &Pose,
        joints: Option<AxisPositions>,
        clearance: i64,
    ) -> Result<(), WriteError> {
        (self.at, self.axis) = self.rounded(start, joints)?;
        let [x, y, z] = self.at;
        if self.five.output == AxisOutput::Machine {
            return self.go_across(self.axis, self.at, Block::Rapid { to: [None, None, Some(z)] });
        }
        let above = [x, y, z.max(clearance)];
        if let (Some(machine), Some(joints)) = (self.five.machine, joints) {
            let axes = machine.at(&self.grid.point(above), joints.rotary);
            let over = self.grid.round(&axes.linear_mm.into())?;
            let begins = Block::BeginTipControl { to: above.map(Some), axis: self.axis };
            self.go_across(self.axis, over, begins)?;
        } else {
            self.blocks.push(Block::BeginTipControl { to: [Some(x), Some(y), None], axis: self.axis })?;
            self.blocks.push(Block::Posed { to: above, axis: self.axis, feed: BlockFeed::Rapid })?;
        }
        if z < clearance {
            self.blocks.push(Block::Posed { to: self.at, axis: self.axis, feed: BlockFeed::Rapid })?;
        }
        Ok(())
    }

    /// Turns the rotary axes, goes across to `over` in the positions of the linear axes, and down with
    /// `down`.
    fn go_across(&mut self, axis: AxisWords, over: [i64; 3], down: Block) -> Result<(), WriteError> {
        if let AxisWords::Angles(angles) = axis {
            self.blocks.push(Block::Rotate { angles })?;
        }
        self.blocks.push(Block::Rapid { to: [Some(over[0]), Some(over[1]), None] })?;
        self.blocks.push(down)
    }

    /// A motion along a rail.
    fn rail(&mut self, rail: &Rail, to: &Pose, rate: FeedRate) -> Result<(), WriteError> {
        let numbers = &self.job.dialect.numbers;
        let feed = words::feed(rate, self.job.program.resolution.units, numbers)?;
        let Rounded { words, tip_mm, axis } = rails::round(rail, self.at, feed, &self.grid)?;
        if !std::mem::replace(&mut self.is_on_rails, true) {
            let from = self.grid.point(self.at);
            let second = FineGrid::new(&self.grid).second(from, rail.to_second[0])?;
            self.blocks.push(Block::BeginRails { second, feed })?;
        }
        let index =
            u32::try_from(self.rails.len()).map_err(|_| WriteError::TooManyBlocks { limit: MAX_BLOCKS })?;
        self.rails.push(words);
        self.blocks.push(Block::Rail { index })?;
        self.displacement_mm = self.displacement_mm.max(tip_mm);
        self.displacement_axis = self.displacement_axis.max(axis);
        (self.at, self.axis) = (words.to, self.rounded(to, None)?.1);
        self.owed_s = 0.0;
        Ok(())
    }

    fn end_rails(&mut self) -> Result<(), WriteError> {
        if std::mem::take(&mut self.is_on_rails) { self.blocks.push(Block::EndRails) } else { Ok(()) }
    }

    /// Goes up to the clearance plane, and ends the modes.
    fn retract(&mut self, clearance: i64) -> Result<(), WriteError> {
        self.end_rails()?;
        if self.at[2] < clearance {
            self.at[2] = clearance;
            self.blocks.push(Block::Posed { to: self.at, axis: self.axis, feed: BlockFeed::Rapid })?;
        }
        self.blocks.push(Block::EndPosed)
    }

    /// A straight motion, in as many blocks as its straying needs.
    fn motion(
        &mut self,
        [from, to]: [&Pose; 2],
        joints: [Option<AxisPositions>; 2],
        time: LegTime,
        halvings: u32,
    ) -> Result<(), WriteError> {
        let strays = match joints {
            [Some(first), Some(last)] if !self.has_positions => {
                let (straying, allowed) = (self.straying(&first, &last), self.five.allowed);
                straying.tip_mm > allowed.tip_mm || straying.axis > allowed.axis
            }
            _ => false,
        };
        let is_long = self.has_time() && time.seconds(from, to) > slowed::LONGEST_S;
        if !strays && (!is_long || halvings == 0) {
            return self.block([from, to], joints[1], time);
        }
        if halvings == 0 {
            return Err(WriteError::NearPole { at: from.tip });
        }
        let middle = from.between(to, 0.5);
        let there = match (joints, self.five.machine) {
            ([Some(first), Some(last)], Some(machine)) => {
                let near = [0, 1].map(|k| 0.5 * (first.rotary[k] + last.rotary[k]));
                Some(if self.has_positions {
                    machine.at(&middle.tip, near)
                } else {
                    machine.nearest(&middle, near)
                })
            }
            _ => None,
        };
        let half = match time {
            LegTime::Seconds(seconds) => LegTime::Seconds(0.5 * seconds),
            time => time,
        };
        self.motion([from, &middle], [joints[0], there], half, halvings - 1)?;
        self.motion([&middle, to], [there, joints[1]], half, halvings - 1)
    }

    /// Whether blocks may state their time.
    fn has_time(&self) -> bool {
        matches!(self.job.dialect.five_axes.turns, Turns::InverseTime { .. })
    }

    /// How far the tool strays between two positions.
    fn straying(&self, from: &AxisPositions, to: &AxisPositions) -> Straying {
        let Some(machine) = self.five.machine else { return Straying::default() };
        let straying = machine.straying(from, to);
        match self.five.output {
            AxisOutput::Machine => straying,
            // The control keeps the tip on its line.
            AxisOutput::Angles | AxisOutput::Vectors | AxisOutput::Rails => {
                Straying { tip_mm: 0.0, ..straying }
            }
        }
    }

    fn block(
        &mut self,
        [from, to]: [&Pose; 2],
        joints: Option<AxisPositions>,
        time: LegTime,
    ) -> Result<(), WriteError> {
        let (at, axis) = self.rounded(to, joints)?;
        let off = self.rounding(to, at, axis);
        let straying = match (self.positions(self.at, self.axis), self.positions(at, axis)) {
            (Some(first), Some(last)) => self.straying(&first, &last),
            _ => Straying::default(),
        };
        self.displacement_mm = self.displacement_mm.max(off.tip_mm + straying.tip_mm);
        self.displacement_axis = self.displacement_axis.max(off.axis + straying.axis);
        let own_s = self.owed_s + time.seconds(from, to);
        if (at, axis) == (self.at, self.axis) {
            self.owed_s = own_s;
            return Ok(());
        }
        let least_s = self.least_s(at, axis);
        let length_mm = (self.grid.point(at) - self.grid.point(self.at)).norm();
        self.end_rails()?;
        let was = std::mem::replace(&mut self.axis, axis);
        (self.at, self.owed_s) = (at, 0.0);
        let per_minute = match time {
            LegTime::Feed(rate) if length_mm > 0.0 && self.five.output != AxisOutput::Machine => {
                self.per_minute(rate, length_mm, own_s, least_s)?
            }
            _ => None,
        };
        let feed = match per_minute {
            Some(feed) => feed,
            None => self.of_time(own_s, least_s, [was, axis])?,
        };
        self.blocks.push(Block::Posed { to: at, axis, feed })
    }

    /// The positions of the axes that words state; none for vectors.
    fn positions(&self, at: [i64; 3], axis: AxisWords) -> Option<AxisPositions> {
        let AxisWords::Angles(angles) = axis else { return None };
        let scale = 10f64.powi(i32::from(self.job.dialect.five_axes.angle_decimals));
        let rotary = angles.map(|units| (units as f64 / scale).to_radians());
        Some(AxisPositions { linear_mm: at.map(|units| self.grid.mm(units)), rotary })
    }

    /// The position and the axis in units of their last decimals.
    fn rounded(
        &self,
        pose: &Pose,
        joints: Option<AxisPositions>,
    ) -> Result<([i64; 3], AxisWords), WriteError> {
        let tip = |tip: &Point3<f64>| self.grid.round(tip).map_err(WriteError::from);
        let Some(joints) = joints else {
            let scale = 10f64.powi(i32::from(VECTOR_DECIMALS));
            let parts = [0, 1, 2].map(|k| (pose.axis[k] * scale).round() as i64);
            return Ok((tip(&pose.tip)?, AxisWords::Vector(parts)));
        };
        let scale = 10f64.powi(i32::from(self.job.dialect.five_axes.angle_decimals));
        let angles = joints.rotary.map(|angle| (angle.to_degrees() * scale).round() as i64);
        let place = match self.five.output {
            AxisOutput::Machine => Point3::from(joints.linear_mm),
            AxisOutput::Angles | AxisOutput::Vectors | AxisOutput::Rails => pose.tip,
        };
        Ok((tip(&place)?, AxisWords::Angles(angles)))
    }

    /// How far a written pose is from the pose it was made of.
    fn rounding(&self, pose: &Pose, at: [i64; 3], axis: AxisWords) -> Straying {
        let place = Point3::from(at.map(|units| self.grid.mm(units)));
        let written = match (axis, self.positions(at, axis), self.five.machine) {
            (_, Some(joints), Some(machine)) => {
                let pose = machine.forward(&joints);
                if self.five.output == AxisOutput::Machine { pose } else { Pose { tip: place, ..pose } }
            }
            (AxisWords::Vector(parts), ..) => Pose { tip: place, axis: axis_of(parts) },
            _ => Pose { tip: place, ..*pose },
        };
        Straying { tip_mm: (written.tip - pose.tip).norm(), axis: angle_between(&written.axis, &pose.axis) }
    }
}

/// The tool axis that a written vector states.
fn axis_of(parts: [i64; 3]) -> nalgebra::UnitVector3<f64> {
    nalgebra::Unit::new_normalize(nalgebra::Vector3::from(parts.map(|units| units as f64)))
}
