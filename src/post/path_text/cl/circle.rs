//! Arcs of CL data: a circle that the tool follows from its place to a line.

use nalgebra::{Point3, UnitVector3, Vector3};

use super::super::way::{ArcWay, parts};
use super::super::{Fault, PathFault, direction};
use super::Reader;
use super::arguments::{numbers, shown, words};
use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};

/// A crossing of the line that is nearer to the start than this along the circle, radians, is the start.
const AT_START: f64 = 1e-4;

/// The least part of the direction of entry along the circle. Across the circle no sense of turn is known.
const LEAST_ALONG: f64 = 0.1;

/// How far the end that the line names may lie from where the line crosses the circle, mm.
const END_MISMATCH_MM: f64 = 0.02;

impl Reader {
    /// `(CIRCLE/x,y,z,r),ON,(LINE/...)`, also with `n,INTOF` before the line.
    pub(super) fn circle(&mut self, text: &str) -> Result<(), Fault> {
        let unread = || PathFault::Unused(shown(text));
        let (circle, rest) = inside(text, "CIRCLE").or_else(|| inside(text, "CYLNDR")).ok_or_else(unread)?;
        let at_line = rest.find('(').ok_or_else(unread)?;
        let (before, line) = rest.split_at(at_line);
        let (line, behind) = inside(line, "LINE").ok_or_else(unread)?;
        let before = before.trim().trim_start_matches(',').trim().trim_end_matches(',');
        let given = words(before)?;
        let crossing = match given.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["ON"] => 1,
            ["ON", n, "INTOF"] => n.parse().map_err(|_| unread())?,
            _ => return Err(unread().into()),
        };
        if !behind.trim().is_empty() {
            return Err(unread().into());
        }
        let (center, radius, normal) = self.circle_of(&numbers(circle)?)?;
        let line = numbers(line)?;
        let &[x, y, z, u, v, w] = &line[..] else { return Err(PathFault::Count(line.len()).into()) };
        let ends = [self.place([x, y, z])?, self.place([u, v, w])?];
        let last = self.trail.last().ok_or(PathFault::NoStart)?;
        let from = last.pose.tip;

        let arm = from - center;
        let flat = arm - normal.scale(arm.dot(&normal));
        let entry = self.enters.or(self.heading).ok_or(PathFault::NoDirection)?;
        let out = direction(flat).map_err(|_| PathFault::NoCenter)?;
        let along = normal.cross(&out).dot(&entry);
        if along.abs() < LEAST_ALONG {
            return Err(PathFault::NoDirection.into());
        }
        let normal = if along > 0.0 { normal } else { -normal };
        let to = end(&from, &center, radius, &normal, ends, crossing)?;
        let arc = ArcWay::new(&from, &to, &center, &normal)?;
        let is_rapid = std::mem::take(&mut self.is_rapid);
        let pace = if is_rapid { Pace::Rapid } else { self.pace()? };
        let axis = self.axis;
        let way = |part: f64| Pose { tip: arc.at(part), axis };
        let count = parts(way, self.reading.chords, arc.fewest_parts())?;
        for k in 1..=count {
            self.trail.push(Waypoint::new(way(k as f64 / count as f64), pace))?;
        }
        self.enters = None;
        self.heading = Some(arc.direction_at_end());
        Ok(())
    }

    fn circle_of(&self, numbers: &[f64]) -> Result<(Point3<f64>, f64, UnitVector3<f64>), PathFault> {
        let (at, normal, radius) = match *numbers {
            [x, y, z, radius] => ([x, y, z], Vector3::z(), radius),
            [x, y, z, i, j, k, radius] => ([x, y, z], Vector3::new(i, j, k), radius),
            _ => return Err(PathFault::Count(numbers.len())),
        };
        Ok((self.place(at)?, radius * self.unit_mm, direction(normal)?))
    }
}

/// Where the tool, going counterclockwise about `normal` from `from`, meets the line the n-th time.
fn end(
    from: &Point3<f64>,
    center: &Point3<f64>,
    radius: f64,
    normal: &UnitVector3<f64>,
    line: [Point3<f64>; 2],
    crossing: usize,
) -> Result<Point3<f64>, PathFault> {
    let flat = |v: Vector3<f64>| v - normal.scale(v.dot(normal));
    let arm = flat(from - center);
    if (arm.norm() - radius).abs() > END_MISMATCH_MM {
        return Err(PathFault::Radii { mismatch_mm: (arm.norm() - radius).abs() });
    }
    let along = direction(flat(line[1] - line[0])).map_err(|_| PathFault::ArcEnd)?;
    let to_line = flat(line[0] - center);
    let foot = to_line - along.scale(to_line.dot(&along));
    let half = (radius * radius - foot.norm_squared()).max(0.0).sqrt();
    if foot.norm() > radius + END_MISMATCH_MM {
        return Err(PathFault::ArcEnd);
    }
    let first = arm.normalize();
    let second = normal.cross(&first);
    let angle_of = |v: &Vector3<f64>| {
        let angle = v.dot(&second).atan2(v.dot(&first)).rem_euclid(std::f64::consts::TAU);
        if angle < AT_START { angle + std::f64::consts::TAU } else { angle }
    };
    let mut places = [foot + along.scale(half), foot - along.scale(half)];
    places.sort_by(|a, b| angle_of(a).total_cmp(&angle_of(b)));
    let chosen = *crossing.checked_sub(1).and_then(|k| places.get(k)).ok_or(PathFault::ArcEnd)?;
    // A line from the centre names the end itself.
    let named = flat(line[1] - center);
    let names_end =
        flat(line[0] - center).norm() <= END_MISMATCH_MM && (named.norm() - radius).abs() <= END_MISMATCH_MM;
    if names_end && (named - chosen).norm() > END_MISMATCH_MM {
        return Err(PathFault::ArcEnd);
    }
    Ok(center + chosen + normal.scale((from - center).dot(normal)))
}

/// What stands in `(WORD/...)` at the start of a text, and the text behind it.
fn inside<'a>(text: &'a str, word: &str) -> Option<(&'a str, &'a str)> {
    let open = text.trim_start().strip_prefix('(')?;
    let (inner, behind) = open.split_once(')')?;
    let (own, numbers) = inner.split_once('/')?;
    own.trim().eq_ignore_ascii_case(word).then_some((numbers, behind))
}
