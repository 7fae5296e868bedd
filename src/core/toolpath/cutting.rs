//! The conditions of a cut: the feed for each role of a move, the spindle, the coolant, and the heights of
//! rapids. [`CuttingRequest`] is what was asked for. [`Cutting`] is the same with all defaults filled in.

use super::path::Role;
use super::program::Program;
use super::tool::Tool;
use super::units::{Acceleration, FeedRate};

/// Default distance of the clearance plane from the top of the part, mm.
pub const CLEARANCE_ABOVE_TOP_MM: f64 = 20.0;

/// Default distance of the retract plane from the top of the part, mm.
const RETRACT_ABOVE_TOP_MM: f64 = 2.0;

/// How far a height may lie below the part's top and still count as at the top, mm: tops are computed with
/// rounding.
const TOP_ACCURACY_MM: f64 = 1e-6;

/// The coolant of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"))]
pub enum Coolant {
    #[default]
    Off,
    Flood,
    Mist,
}

/// Cutting conditions as they are asked for; what is absent is chosen from the part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingRequest {
    pub feed: FeedRate,
    /// Default: half the feed.
    pub plunge_feed: Option<FeedRate>,
    /// Default: the plunge feed.
    pub ramp_feed: Option<FeedRate>,
    /// Default: the feed, as for `link_feed` and `lead_out_feed`.
    pub lead_in_feed: Option<FeedRate>,
    pub link_feed: Option<FeedRate>,
    pub lead_out_feed: Option<FeedRate>,
    /// The feed where the cutter is deeper in the material than its stepover. Default: the feed.
    pub slot_feed: Option<FeedRate>,
    /// Default: 10,000 mm/min.
    pub rapid_feed: Option<FeedRate>,
    /// Default: 1,000 mm/s2.
    pub acceleration: Option<Acceleration>,
    pub spindle_rpm: Option<f64>,
    pub coolant: Coolant,
    /// Default: 20 mm above the top of the part.
    pub clearance_z_mm: Option<f64>,
    /// Default: 2 mm above the top of the part.
    pub retract_z_mm: Option<f64>,
}

/// Why a height contradicts the part or another height.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum HeightError {
    #[error("the retract plane at {z_mm} mm is below the top of the part and its stock at {top_mm} mm")]
    RetractBelowTop { z_mm: f64, top_mm: f64 },
    #[error("the clearance plane at {z_mm} mm is below the top of the part and its stock at {top_mm} mm")]
    ClearanceBelowTop { z_mm: f64, top_mm: f64 },
    #[error("the clearance plane at {clearance_mm} mm is below the retract plane at {retract_mm} mm")]
    ClearanceBelowRetract { clearance_mm: f64, retract_mm: f64 },
}

/// No feed is chosen slower than this, mm/min: the slowest that a request may ask for.
const SLOWEST_MM_PER_MIN: f64 = 0.001;

impl CuttingRequest {
    /// Cutting at `feed` with the default of everything else: no spindle speed, no coolant.
    pub fn at_feed(feed: FeedRate) -> Self {
        Self {
            feed,
            plunge_feed: None,
            ramp_feed: None,
            lead_in_feed: None,
            link_feed: None,
            lead_out_feed: None,
            slot_feed: None,
            rapid_feed: None,
            acceleration: None,
            spindle_rpm: None,
            coolant: Coolant::Off,
            clearance_z_mm: None,
            retract_z_mm: None,
        }
    }

    /// The feed of moves of this role; it depends on no height.
    pub fn feed_of(&self, role: Role) -> FeedRate {
        self.at_heights(0.0, 0.0).feed_of(role)
    }

    /// The conditions over a part whose top is at `top_mm`.
    ///
    /// # Errors
    /// When a height is below the top, or the clearance plane below the retract plane.
    pub fn above(&self, top_mm: f64) -> Result<Cutting, HeightError> {
        let above_top = |height: Option<f64>, default_mm: f64| match height {
            Some(z_mm) if z_mm < top_mm - TOP_ACCURACY_MM => Err(z_mm),
            Some(z_mm) => Ok(z_mm),
            None => Ok(top_mm + default_mm),
        };
        let retract_z_mm = above_top(self.retract_z_mm, RETRACT_ABOVE_TOP_MM)
            .map_err(|z_mm| HeightError::RetractBelowTop { z_mm, top_mm })?;
        let default_clearance = CLEARANCE_ABOVE_TOP_MM.max(retract_z_mm - top_mm);
        let clearance_z_mm = above_top(self.clearance_z_mm, default_clearance)
            .map_err(|z_mm| HeightError::ClearanceBelowTop { z_mm, top_mm })?;
        if clearance_z_mm < retract_z_mm {
            let (clearance_mm, retract_mm) = (clearance_z_mm, retract_z_mm);
            return Err(HeightError::ClearanceBelowRetract { clearance_mm, retract_mm });
        }
        Ok(self.at_heights(clearance_z_mm, retract_z_mm))
    }

    /// The conditions with the clearance plane and the retract plane already chosen.
    pub fn at_heights(&self, clearance_z_mm: f64, retract_z_mm: f64) -> Cutting {
        let feed = self.feed;
        // Half of a positive feed is positive, unless the feed is the smallest positive number.
        let slower = (0.5 * feed.mm_per_min()).max(SLOWEST_MM_PER_MIN.min(feed.mm_per_min()));
        let half = FeedRate::from_mm_per_min(slower).unwrap_or(feed);
        let plunge_feed = self.plunge_feed.unwrap_or(half);
        Cutting {
            feed,
            plunge_feed,
            ramp_feed: self.ramp_feed.unwrap_or(plunge_feed),
            lead_in_feed: self.lead_in_feed.unwrap_or(feed),
            link_feed: self.link_feed.unwrap_or(feed),
            lead_out_feed: self.lead_out_feed.unwrap_or(feed),
            slot_feed: self.slot_feed.unwrap_or(feed),
            rapid_feed: self.rapid_feed.unwrap_or(FeedRate::DEFAULT_RAPID),
            acceleration: self.acceleration.unwrap_or(Acceleration::DEFAULT),
            spindle_rpm: self.spindle_rpm,
            coolant: self.coolant,
            clearance_z_mm,
            retract_z_mm,
        }
    }
}

/// Feeds, spindle, coolant and heights of one job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutting {
    pub feed: FeedRate,
    pub plunge_feed: FeedRate,
    pub ramp_feed: FeedRate,
    pub lead_in_feed: FeedRate,
    pub link_feed: FeedRate,
    pub lead_out_feed: FeedRate,
    /// The feed where the cutter is deeper in the material than its stepover.
    pub slot_feed: FeedRate,
    /// The machine's traverse rate; used for times only.
    pub rapid_feed: FeedRate,
    /// The machine's acceleration; used for times only.
    pub acceleration: Acceleration,
    /// Spindle speed, rpm; without one the program starts no spindle.
    pub spindle_rpm: Option<f64>,
    pub coolant: Coolant,
    /// Absolute height of rapids between distant places, mm.
    pub clearance_z_mm: f64,
    /// Absolute height to which the tool is lifted between passes and from which it plunges, mm.
    pub retract_z_mm: f64,
}

impl Cutting {
    /// The feed of moves of this role.
    pub fn feed_of(&self, role: Role) -> FeedRate {
        match role {
            Role::Plunge => self.plunge_feed,
            Role::Ramp => self.ramp_feed,
            Role::LeadIn => self.lead_in_feed,
            Role::Cut => self.feed,
            Role::Link => self.link_feed,
            Role::LeadOut => self.lead_out_feed,
        }
    }

    /// Settings that an operator should check before `program` is cut with `tool`.
    pub fn cautions(&self, tool: Option<&Tool>, program: &Program) -> Vec<Caution> {
        let mut cautions = Vec::new();
        if self.spindle_rpm.is_none() {
            cautions.push(Caution::NoSpindleSpeed);
        }
        if tool.is_none_or(|tool| tool.number.is_none()) {
            cautions.push(Caution::NoToolNumber);
        }
        if let Some((number, length_offset)) = tool.map(Tool::places).filter(|(number, h)| number != h) {
            cautions.push(Caution::LengthOffsetDiffers { number, length_offset });
        }
        if program.work_offset.is_none() {
            cautions.push(Caution::NoWorkOffset);
        }
        cautions
    }
}

/// Something about a cut that is legal and yet often a mistake.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Caution {
    #[error("no spindle speed is given: the program starts no spindle")]
    NoSpindleSpeed,
    #[error("no tool number is given: the program calls tool 1")]
    NoToolNumber,
    #[error("no work offset is given: the program runs with the active work offset")]
    NoWorkOffset,
    #[error(
        "no clearance plane is given: the program goes to z {z_mm} mm, above everything that the toolpath cuts"
    )]
    ClearanceChosen { z_mm: f64 },
    #[error("tool {number} runs with the length offset {length_offset}")]
    LengthOffsetDiffers { number: u32, length_offset: u32 },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::program::{Resolution, Units};

    const TOP: f64 = 10.0;

    fn feed(mm_per_min: f64) -> FeedRate {
        FeedRate::from_mm_per_min(mm_per_min).unwrap()
    }

    fn request() -> CuttingRequest {
        CuttingRequest::at_feed(feed(800.0))
    }

    #[test]
    fn defaults_are_chosen_from_the_part() {
        let cutting = request().above(TOP).unwrap();
        assert_eq!((cutting.retract_z_mm, cutting.clearance_z_mm), (12.0, 30.0));
        assert_eq!(cutting.rapid_feed.mm_per_min(), 10_000.0);
        assert_eq!(cutting.acceleration.mm_per_s2(), 1000.0);
    }

    #[test]
    fn every_role_has_its_own_feed_or_that_of_its_kind() {
        let roles = [Role::Cut, Role::Plunge, Role::Ramp, Role::LeadIn, Role::Link, Role::LeadOut];
        let feeds = |request: CuttingRequest| {
            let cutting = request.above(TOP).unwrap();
            roles.map(|role| cutting.feed_of(role).mm_per_min())
        };
        assert_eq!(feeds(request()), [800.0, 400.0, 400.0, 800.0, 800.0, 800.0]);
        let slower = CuttingRequest { plunge_feed: Some(feed(100.0)), ..request() };
        assert_eq!(feeds(slower), [800.0, 100.0, 100.0, 800.0, 800.0, 800.0]);
        let all = CuttingRequest {
            ramp_feed: Some(feed(200.0)),
            lead_in_feed: Some(feed(300.0)),
            link_feed: Some(feed(1500.0)),
            lead_out_feed: Some(feed(900.0)),
            ..slower
        };
        assert_eq!(feeds(all), [800.0, 100.0, 200.0, 300.0, 1500.0, 900.0]);
    }

    #[test]
    fn a_high_retract_plane_lifts_the_clearance_plane() {
        let cutting = CuttingRequest { retract_z_mm: Some(50.0), ..request() }.above(TOP).unwrap();
        assert_eq!((cutting.retract_z_mm, cutting.clearance_z_mm), (50.0, 50.0));
    }

    #[test]
    fn heights_below_the_part_or_each_other_are_refused() {
        let (z_mm, top_mm) = (9.0, TOP);
        let retract = CuttingRequest { retract_z_mm: Some(z_mm), ..request() };
        assert_eq!(retract.above(TOP), Err(HeightError::RetractBelowTop { z_mm, top_mm }));
        let clearance = CuttingRequest { clearance_z_mm: Some(z_mm), ..request() };
        assert_eq!(clearance.above(TOP), Err(HeightError::ClearanceBelowTop { z_mm, top_mm }));
        let crossed = CuttingRequest { retract_z_mm: Some(15.0), clearance_z_mm: Some(11.0), ..request() };
        let expected = HeightError::ClearanceBelowRetract { clearance_mm: 11.0, retract_mm: 15.0 };
        assert_eq!(crossed.above(TOP), Err(expected));
    }

    #[test]
    fn missing_and_contradicting_settings_are_named() {
        let cutting = request().above(TOP).unwrap();
        let other = Tool { number: Some(3), length_offset: Some(4), ..Tool::ball(5.0) };
        let differs = Caution::LengthOffsetDiffers { number: 3, length_offset: 4 };
        let none = Program::plain(Resolution { units: Units::Mm, decimals: 3 });
        let given = Program { work_offset: Some(54), ..none.clone() };
        assert_eq!(cutting.cautions(Some(&other), &given), [Caution::NoSpindleSpeed, differs]);
        let turning = Cutting { spindle_rpm: Some(1000.0), ..cutting };
        let known = Tool { number: Some(7), ..Tool::ball(5.0) };
        assert_eq!(turning.cautions(Some(&known), &given), []);
        assert_eq!(turning.cautions(Some(&known), &none), [Caution::NoWorkOffset]);
        for tool in [Some(Tool::ball(5.0)), None] {
            assert_eq!(turning.cautions(tool.as_ref(), &given), [Caution::NoToolNumber]);
        }
    }
}
