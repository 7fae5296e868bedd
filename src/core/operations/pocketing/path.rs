//! Runs as moves of the tool.

use nalgebra::Point3;

use super::chain::ROUNDING_MM;
use super::conditions::Conditions;
use super::entry::{Entry, circle};
use super::feeds;
use super::router::Run;
use crate::geometry::curve::{Arc, Curve, Direction};
use crate::geometry::plane::Plane;
use crate::geometry::segment::Segment;
use crate::geometry::spacing::spaces;
use crate::toolpath::path::{Builder, PathError, Role};
use crate::toolpath::units::FeedRate;

/// Appends the runs of a level, each as a pass.
pub fn append(
    builder: &mut Builder,
    level: u32,
    runs: &[Run],
    conditions: &Conditions,
) -> Result<(), PathError> {
    for run in runs {
        builder.begin_pass(Some(level));
        let retract = conditions.cutting.retract_z_mm;
        let down = conditions.approach_z_mm(run.entry == Entry::Open);
        builder.rapid_over(Point3::new(run.start.x, run.start.y, down), retract, down)?;
        enter(builder, run, conditions)?;
        for step in &run.steps {
            for part in feeds::parts(step, conditions) {
                follow(builder, &part.element, conditions.z_mm, part.feed, part.role)?;
            }
        }
        builder.rapid_to_height(retract)?;
    }
    Ok(())
}

fn enter(builder: &mut Builder, run: &Run, conditions: &Conditions) -> Result<(), PathError> {
    let (start, z) = (run.start, conditions.z_mm);
    let down = |builder: &mut Builder, z: f64, role: Role| {
        if builder.at().z == z {
            return Ok(());
        }
        builder.line(Point3::new(start.x, start.y, z), conditions.cutting.feed_of(role), role)
    };
    if run.entry == Entry::Open {
        return down(builder, z, Role::LeadIn);
    }
    down(builder, conditions.top_z_mm, Role::LeadIn)?;
    match &run.entry {
        Entry::Open => {}
        Entry::Plunge => down(builder, z, Role::Plunge)?,
        Entry::Helix { center, is_left } => {
            let pitch = (start - center).norm() * std::f64::consts::TAU * conditions.entry.ramp_angle.tan();
            let turns = spaces(conditions.depth_mm(), pitch);
            let halves = circle(start, *center, *is_left);
            let count = 2.0 * turns;
            builder.check_room(count)?;
            let height =
                |k: f64| if k == count { z } else { conditions.top_z_mm - conditions.depth_mm() * k / count };
            for k in 0..count as usize {
                follow(builder, &halves[k % 2], height(k as f64 + 1.0), conditions.entry_feed, Role::Ramp)?;
            }
            // The floor under the last turn.
            for half in &halves {
                follow(builder, half, z, conditions.entry_feed, Role::Cut)?;
            }
        }
        Entry::Ramp { along, strokes } => {
            let length: f64 = along.iter().map(Segment::length).sum();
            let whole = length * *strokes as f64;
            builder.check_room(*strokes as f64)?;
            let mut done = 0.0;
            let back: Vec<Segment> = along.iter().rev().map(Segment::reversed).collect();
            for stroke in 0..*strokes {
                let way = if stroke % 2 == 0 { along } else { &back };
                for (k, element) in way.iter().enumerate() {
                    done += element.length();
                    let is_last = stroke + 1 == *strokes && k + 1 == way.len();
                    let height =
                        if is_last { z } else { conditions.top_z_mm - conditions.depth_mm() * done / whole };
                    follow(builder, element, height, conditions.entry_feed, Role::Ramp)?;
                }
            }
        }
    }
    Ok(())
}

/// Follows an element to the height `z` mm at its end.
fn follow(
    builder: &mut Builder,
    element: &Segment,
    z: f64,
    feed: FeedRate,
    role: Role,
) -> Result<(), PathError> {
    let at = builder.at();
    let end = element.end();
    let to = Point3::new(end.x, end.y, z);
    if (to - at).norm() < ROUNDING_MM {
        return Ok(());
    }
    if let Segment::Arc(arc) = element {
        let direction = if arc.turn() > 0.0 { Direction::Ccw } else { Direction::Cw };
        let center = Point3::new(arc.center().x, arc.center().y, at.z);
        if let Ok(arc) = Arc::with_center_near(Plane::Xy, direction, at, to, center) {
            return builder.follow(Curve::Arc(arc), feed, role);
        }
    }
    builder.line(to, feed, role)
}
