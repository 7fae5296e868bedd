//! A toolpath with its measures, and warnings, as they are answered.

use serde::{Serialize, Serializer};
use utoipa::ToSchema;

use super::point::Point;
use crate::geometry::curve::{self, Curve};
use crate::geometry::plane;
use crate::toolpath as core;
use crate::toolpath::measure;

/// Something to know that does not stop the job.
#[derive(Debug, Serialize, ToSchema)]
pub struct Warning {
    #[schema(inline)]
    pub code: WarningCode,
    pub detail: String,
}

impl Warning {
    pub fn ends_reduced(direction: &str, points: usize) -> Self {
        let detail = format!(
            "`not_a_knot` needs 4 points along {direction}; through {points} runs the interpolating polynomial"
        );
        Self { code: WarningCode::EndsReduced, detail }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WarningCode {
    /// The end condition fell to the interpolating polynomial, for want of points.
    EndsReduced,
    /// Patches leave a gap or meet in an edge: the surface cannot be milled as it is.
    NotSmooth,
    /// The surface has a place without a normal.
    NoNormal,
    /// Neighbouring passes do not meet: stock of any height is left between them.
    PassesApart,
    /// The program starts no spindle.
    NoSpindleSpeed,
}

/// Lengths and times of a toolpath, and the box around it. Feed moves of any role are cutting.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Measures {
    pub cutting_length_mm: f64,
    pub rapid_length_mm: f64,
    pub cutting_time_s: f64,
    pub rapid_time_s: f64,
    /// Cutting, rapid and dwell.
    pub total_time_s: f64,
    pub dwell_time_s: f64,
    pub moves: MoveCounts,
    pub bounds: Bounds,
}

#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, ToSchema)]
pub struct MoveCounts {
    pub rapid: usize,
    pub line: usize,
    pub arc: usize,
    pub parabola: usize,
    pub spline: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Bounds {
    pub min: Point,
    pub max: Point,
}

impl From<measure::Measures> for Measures {
    fn from(measures: measure::Measures) -> Self {
        let measure::Measures {
            cutting_length_mm,
            rapid_length_mm,
            cutting_time_s,
            rapid_time_s,
            dwell_time_s,
            total_time_s,
            counts: measure::MoveCounts { rapid, line, arc, parabola, spline },
            bounds: measure::Bounds { min, max },
        } = measures;
        Self {
            cutting_length_mm,
            rapid_length_mm,
            cutting_time_s,
            rapid_time_s,
            total_time_s,
            dwell_time_s,
            moves: MoveCounts { rapid, line, arc, parabola, spline },
            bounds: Bounds { min: min.into(), max: max.into() },
        }
    }
}

/// Positions of the tool tip, mm. A move starts where the last one ended.
#[derive(Serialize, ToSchema)]
pub struct Toolpath {
    start: Point,
    #[serde(serialize_with = "write_passes")]
    #[schema(value_type = Vec<Pass>)]
    passes: core::Toolpath,
}

impl From<core::Toolpath> for Toolpath {
    fn from(passes: core::Toolpath) -> Self {
        Self { start: passes.start().into(), passes }
    }
}

/// Moves are converted one pass at a time while they are written: a whole second toolpath is never held.
fn write_passes<S: Serializer>(toolpath: &core::Toolpath, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(
        toolpath
            .passes()
            .iter()
            .map(|pass| Pass { level: pass.level(), moves: pass.moves().iter().map(Move::from).collect() }),
    )
}

/// A connected run of moves.
#[derive(Debug, Serialize, ToSchema)]
pub struct Pass {
    #[serde(skip_serializing_if = "Option::is_none")]
    level: Option<u32>,
    moves: Vec<Move>,
}

/// One move, told apart by `kind`.
#[derive(Debug, PartialEq, Serialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Move {
    /// At the machine's traverse rate.
    Rapid {
        to: Point,
    },
    /// Straight, at feed.
    Line {
        to: Point,
        feed_mm_per_min: f64,
        role: Role,
    },
    /// As G2 and G3 in G17, G18 and G19: `cw` is seen from the positive end of the plane's normal. `to` equal to the
    /// start in the plane is one full turn; `to` may differ along the normal (a helix).
    Arc {
        to: Point,
        center: Point,
        plane: Plane,
        direction: Direction,
        feed_mm_per_min: f64,
        role: Role,
    },
    Dwell {
        seconds: f64,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    Cut,
    Plunge,
    Ramp,
    LeadIn,
    Link,
    LeadOut,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcPlane)]
pub enum Plane {
    Xy,
    Zx,
    Yz,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArcDirection)]
pub enum Direction {
    Cw,
    Ccw,
}

impl From<&core::Move> for Move {
    fn from(step: &core::Move) -> Self {
        match *step {
            core::Move::Rapid { line } => Move::Rapid { to: line.end.into() },
            core::Move::Feed { along: Curve::Line(line), rate, role } => {
                Move::Line { to: line.end.into(), feed_mm_per_min: rate.mm_per_min(), role: role.into() }
            }
            core::Move::Feed { along: Curve::Arc(arc), rate, role } => Move::Arc {
                to: arc.end().into(),
                center: arc.center().into(),
                plane: match arc.plane() {
                    plane::Plane::Xy => Plane::Xy,
                    plane::Plane::Zx => Plane::Zx,
                    plane::Plane::Yz => Plane::Yz,
                },
                direction: match arc.direction() {
                    curve::Direction::Cw => Direction::Cw,
                    curve::Direction::Ccw => Direction::Ccw,
                },
                feed_mm_per_min: rate.mm_per_min(),
                role: role.into(),
            },
            core::Move::Dwell { seconds } => Move::Dwell { seconds },
        }
    }
}

impl From<core::Role> for Role {
    fn from(role: core::Role) -> Self {
        match role {
            core::Role::Plunge => Role::Plunge,
            core::Role::Ramp => Role::Ramp,
            core::Role::LeadIn => Role::LeadIn,
            core::Role::Cut => Role::Cut,
            core::Role::Link => Role::Link,
            core::Role::LeadOut => Role::LeadOut,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use serde_json::json;

    use super::*;
    use crate::toolpath::units::FeedRate;

    #[test]
    fn moves_are_written_as_the_contract_names_them() {
        let rate = FeedRate::from_mm_per_min(800.0).expect("a feed");
        let mut builder = core::Toolpath::builder(Point3::new(10.0, 0.0, 5.0));
        builder.begin_pass(Some(2));
        builder.rapid(Point3::new(10.0, 0.0, 1.0)).expect("a rapid");
        builder.line(Point3::new(10.0, 0.0, 0.0), rate, core::Role::LeadIn).expect("a line");
        let (to, center) = (Point3::new(0.0, 10.0, 0.0), Point3::origin());
        let arc = (plane::Plane::Xy, curve::Direction::Ccw);
        builder.arc(to, center, arc, rate, core::Role::Cut).expect("an arc");
        builder.dwell(0.5).expect("a dwell");
        let toolpath = Toolpath::from(builder.finish().expect("a toolpath"));
        assert_eq!(
            serde_json::to_value(&toolpath).expect("JSON"),
            json!({ "start": [10.0, 0.0, 5.0], "passes": [{ "level": 2, "moves": [
                { "kind": "rapid", "to": [10.0, 0.0, 1.0] },
                { "kind": "line", "to": [10.0, 0.0, 0.0], "feed_mm_per_min": 800.0, "role": "lead_in" },
                { "kind": "arc", "to": [0.0, 10.0, 0.0], "center": [0.0, 0.0, 0.0], "plane": "xy",
                  "direction": "ccw", "feed_mm_per_min": 800.0, "role": "cut" },
                { "kind": "dwell", "seconds": 0.5 },
            ] }] })
        );
    }
}
