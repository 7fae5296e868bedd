//! Runs as moves of the tool.

use nalgebra::Point3;

use super::chain::{ROUNDING_MM, SHORTEST_MM};
use super::conditions::Conditions;
use super::entry::{Entry, circle};
use super::feeds;
use super::router::{Purpose, Run, Step};
use crate::geometry::curve::{Arc, Curve, Direction};
use crate::geometry::plane::Plane;
use crate::geometry::segment::Segment;
use crate::geometry::spacing::spaces;
use crate::toolpath::path::{Builder, PathError, Role};
use crate::toolpath::units::FeedRate;

/// How far links are raised above the floor, mm: the tool does not rub on it.
const RAISED_MM: f64 = 0.1;

/// The length along which a link rises, and along which it comes down again, mm.
const RISE_ALONG_MM: f64 = 2.0;

/// The shortest link that is raised, in lengths of a rise.
const SHORTEST_RAISED: f64 = 3.0;

/// An arc that leaves its chord by less is written as a line, mm.
const FLAT_MM: f64 = 1e-6;

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
        for steps in run.steps.chunk_by(|a, b| a.purpose == b.purpose) {
            if steps.iter().all(|step| step.purpose == Purpose::Link) {
                link(builder, steps, conditions)?;
                continue;
            }
            for part in steps.iter().flat_map(|step| feeds::parts(step, conditions)) {
                follow(builder, &part.element, conditions.z_mm, part.feed, part.role)?;
            }
        }
        builder.rapid_to_height(retract)?;
    }
    Ok(())
}

/// Goes along a link, raised above the floor where it is long enough.
fn link(builder: &mut Builder, steps: &[Step], conditions: &Conditions) -> Result<(), PathError> {
    let feed = conditions.cutting.feed_of(Role::Link);
    let length: f64 = steps.iter().map(|step| step.element.length()).sum();
    let is_raised = length >= SHORTEST_RAISED * RISE_ALONG_MM;
    let height = |along: f64| {
        let part = along.min(length - along).clamp(0.0, RISE_ALONG_MM) / RISE_ALONG_MM;
        if is_raised { conditions.z_mm + RAISED_MM * part } else { conditions.z_mm }
    };
    let mut gone = 0.0;
    for step in steps {
        let own = step.element.length();
        // Divided where the height no longer changes, and where it changes again.
        let mut cuts = vec![0.0];
        let is_within = |t: &f64| *t * own > SHORTEST_MM && (1.0 - *t) * own > SHORTEST_MM;
        if is_raised {
            let ends = [RISE_ALONG_MM, length - RISE_ALONG_MM];
            cuts.extend(ends.map(|end| (end - gone) / own).iter().filter(|t| is_within(t)));
        }
        cuts.push(1.0);
        for pair in cuts.windows(2) {
            let is_last = pair[1] == 1.0 && std::ptr::eq(step, &steps[steps.len() - 1]);
            let z = if is_last { conditions.z_mm } else { height(gone + pair[1] * own) };
            follow(builder, &step.element.part(pair[0], pair[1]), z, feed, Role::Link)?;
        }
        gone += own;
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
    // The centre of a flatter arc is far away and inexact.
    let is_flat = |element: &Segment| element.length() * element.turn().abs() < 8.0 * FLAT_MM;
    if let Segment::Arc(arc) = element
        && !is_flat(element)
    {
        let direction = if arc.turn() > 0.0 { Direction::Ccw } else { Direction::Cw };
        let center = Point3::new(arc.center().x, arc.center().y, at.z);
        // Where an arc is as short as the rounding of its ends, the end may come to lie before the start, and
        // the way there would be a whole turn.
        if let Ok(written) = Arc::with_center_near(Plane::Xy, direction, at, to, center)
            && (written.sweep() - arc.turn().abs()).abs() < std::f64::consts::PI
        {
            return builder.follow(Curve::Arc(written), feed, role);
        }
    }
    builder.line(to, feed, role)
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::toolpath::{Move, Toolpath};

    #[test]
    fn an_arc_whose_end_lies_before_its_start_makes_no_whole_turn() {
        let place = |angle: f64| Point2::new(3.0 * angle.cos(), 3.0 * angle.sin());
        let feed = FeedRate::from_mm_per_min(100.0).unwrap();
        for turn in [1e-4, -1e-4] {
            let element = Segment::about(Point2::origin(), 3.0, [place(0.0), place(-turn)], turn);
            let mut builder = Toolpath::builder(Point3::new(3.0, 0.0, 0.0));
            follow(&mut builder, &element, 0.0, feed, Role::Cut).unwrap();
            let path = builder.finish().unwrap();
            let moves: Vec<&Move> = path.moves().collect();
            assert!(matches!(moves[..], [Move::Feed { along: Curve::Line(_), .. }]), "{moves:?}");
        }
    }
}
