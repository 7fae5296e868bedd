//! The checker of pockets. It judges a plan by its moves and the outlines of the case alone: it moves the
//! disc of the cutter over a grid of points, in the order of the path, and keeps the height of the stock at
//! each.

use std::collections::BTreeMap;

use toolpathd_core::operations::pocketing::{Job, Plan};
use toolpathd_core::toolpath::Role;

use super::area::Area;
use super::cases::{Case, TOP_MM};
use super::engagement::angles;
use super::motion::{Kind, Motion, motions};
use super::plane::apart;

/// How near the cutter may come to a wall, less its radius, mm.
const GOUGE_MM: f64 = 0.002;

/// Steps along a path beside a wall, mm.
const STEP_MM: f64 = 0.05;

/// The stock is cut by a disc that is larger by so much: slivers of twice this width are forgiven, mm.
const SLIVER_MM: f64 = 0.025;

/// What links and cuts meet this near the edge of the disc does not count, mm.
const TRACE_MM: f64 = 0.06;

/// The largest part of what can be reached that may stay uncut.
const UNCUT_PART: f64 = 5e-4;

/// The slot feed has to hold where the angle exceeds this multiple of that of a straight pass, and degrees.
const SLOT_ALLOWANCE: f64 = 1.1;
const SLOT_ALLOWANCE_DEG: f64 = 2.0;

/// How much a measured angle may exceed the largest that is reported, degrees: the points it is measured with
/// are a degree apart.
const REPORT_ALLOWANCE_DEG: f64 = 2.0;

/// How far links are raised above the floor, mm.
const RAISED_MM: f64 = 0.1;

/// What can be wrong with a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    Gouge,
    GougeReport,
    Uncut,
    ThroughStock,
    TooDeep,
    Rapid,
    Entry,
    SlotFeed,
    EngagementReport,
    NotReachedReport,
    Time,
}

/// What the checker found: the worst of each fault, with the number of its places, and figures.
#[derive(Debug, Default)]
pub struct Verdict {
    pub faults: BTreeMap<Fault, (f64, usize, String)>,
    /// The depth to which the cutter enters walls, mm; negative if it keeps away.
    pub gouge_mm: f64,
    pub uncut_part: f64,
    /// The largest angle in the material, degrees.
    pub angle_deg: f64,
}

impl Verdict {
    fn add(&mut self, fault: Fault, size: f64, text: impl FnOnce() -> String) {
        let entry = self.faults.entry(fault).or_insert((f64::NEG_INFINITY, 0, String::new()));
        entry.1 += 1;
        if size > entry.0 {
            (entry.0, entry.2) = (size, text());
        }
    }

    pub fn has(&self, fault: Fault) -> bool {
        self.faults.contains_key(&fault)
    }
}

/// Judges the plan of a job. `area` belongs to the case.
pub fn judge(case: &Case, area: &Area, job: &Job, plan: &Plan) -> Verdict {
    let motions = motions(&plan.toolpath);
    let mut verdict = Verdict { gouge_mm: f64::NEG_INFINITY, ..Verdict::default() };
    check_walls(area, job, plan, &motions, &mut verdict);
    check_heights(job, plan, &motions, &mut verdict);
    check_stock(area, case, &motions, &mut verdict);
    check_angles(case, job, plan, &motions, &mut verdict);
    check_report(area, plan, &motions, &mut verdict);
    verdict
}

/// The clearance changes by no more than the way of the centre, so a step as long as what the clearance has
/// too much misses nothing.
fn check_walls(area: &Area, job: &Job, plan: &Plan, motions: &[Motion], verdict: &mut Verdict) {
    let radius = job.tool.radius_mm;
    let below = motions.iter().filter(|motion| motion.low() < TOP_MM - 1e-9);
    for motion in below {
        let length = motion.piece.length();
        let mut way = 0.0f64;
        loop {
            let p = motion.piece.at(if length > 0.0 { way / length } else { 0.0 });
            let depth = radius - area.clearance(p).min(2.0 * radius);
            verdict.gouge_mm = verdict.gouge_mm.max(depth);
            if depth > GOUGE_MM {
                verdict.add(Fault::Gouge, depth, || format!("{depth:.4} mm into a wall at {p:?}"));
            }
            if way >= length {
                break;
            }
            way = (way + STEP_MM.max(GOUGE_MM - depth)).min(length);
        }
        for p in [motion.piece.at(0.0), motion.piece.at(1.0)] {
            if !area.contains(p) {
                verdict.add(Fault::Gouge, f64::INFINITY, || format!("{p:?} is not in the pocket"));
            }
        }
    }
    let bound = plan.report.gouge_max_mm;
    if verdict.gouge_mm > bound + 1e-6 {
        let found = verdict.gouge_mm;
        verdict.add(Fault::GougeReport, found, || format!("{found} mm deep, {bound} mm reported"));
    }
}

/// Rapids stay at or above the retract plane, except straight up and down. Helices and ramps are no steeper
/// and no faster than allowed. Each move starts where the last ended.
fn check_heights(job: &Job, plan: &Plan, motions: &[Motion], verdict: &mut Verdict) {
    let cutting = &plan.cutting;
    let retract = cutting.retract_z_mm;
    if retract < TOP_MM {
        verdict.add(Fault::Rapid, 0.0, || "the retract plane is below the top".into());
    }
    for (k, motion) in motions.iter().enumerate() {
        let [from, to] = motion.z;
        let at = || format!("move {k} from {:?}, {:?}", motion.piece.at(0.0), motion.z);
        let is_apart =
            |last: &Motion| apart(last.piece.at(1.0), motion.piece.at(0.0)) > 1e-6 || last.z[1] != from;
        if k > 0 && is_apart(&motions[k - 1]) {
            verdict.add(Fault::Rapid, 0.0, || format!("{} does not follow the move before", at()));
        }
        let role = match motion.kind {
            Kind::Rapid => {
                if !motion.is_vertical() && (motion.low() < retract || !motion.is_level()) {
                    verdict.add(Fault::Rapid, retract - motion.low(), || format!("rapid: {}", at()));
                }
                continue;
            }
            Kind::Feed(role) => role,
        };
        let feed = motion.feed.unwrap_or(f64::INFINITY);
        if motion.low() < job.floor_z_mm - 1e-9 {
            verdict
                .add(Fault::TooDeep, job.floor_z_mm - motion.low(), || format!("below the floor: {}", at()));
        }
        let angle = (from - to).atan2(motion.piece.length());
        let sinks = feed * angle.sin();
        let is_slow = sinks <= cutting.plunge_feed.mm_per_min() * (1.0 + 1e-9);
        let is_fine = match role {
            Role::Cut => motion.is_level(),
            Role::Link => motion.is_level() || (to - from).abs() <= RAISED_MM + 1e-9,
            Role::Ramp => is_slow && angle <= job.entry.ramp_angle + 1e-6,
            Role::Plunge => is_slow && motion.is_vertical() && job.entry.plunge,
            Role::LeadIn | Role::LeadOut => motion.is_vertical() || motion.is_level(),
        };
        if !is_fine {
            verdict
                .add(Fault::Entry, sinks, || format!("{role:?} at {feed} mm/min and {angle} rad: {}", at()));
        }
    }
}

/// Moves the disc over the stock in the order of the path.
fn check_stock(area: &Area, case: &Case, motions: &[Motion], verdict: &mut Verdict) {
    let grid = area.grid;
    let radius = 0.5 * case.diameter_mm;
    let mut stock = vec![0.0f64; grid.len()];
    for motion in motions {
        if motion.low() >= 0.0 {
            continue;
        }
        let limit = match motion.kind {
            Kind::Feed(Role::Link) | Kind::Rapid => 1e-6,
            _ if !motion.is_level() && matches!(motion.kind, Kind::Feed(Role::LeadIn | Role::LeadOut)) => {
                1e-6
            }
            Kind::Feed(_) => case.stepdown_mm + 1e-6,
        };
        let longest = if motion.is_level() { f64::INFINITY } else { 0.3 };
        let points = motion.piece.points(0.005, longest);
        let n = (points.len() - 1) as f64;
        for (k, pair) in points.windows(2).enumerate() {
            let height = |k: usize| motion.z[0] + (motion.z[1] - motion.z[0]) * k as f64 / n;
            let z = height(k).min(height(k + 1));
            let (mut worst, mut count) = (0.0f64, 0);
            grid.near(pair[0], pair[1], radius - TRACE_MM, |range| {
                for height in &stock[range] {
                    let drop = height - z;
                    count += usize::from(drop > limit);
                    worst = worst.max(drop);
                }
            });
            if count > 0 {
                let is_cut = limit > 1e-6;
                let fault = if is_cut { Fault::TooDeep } else { Fault::ThroughStock };
                let size = if is_cut { worst } else { grid.area(count) };
                verdict.add(fault, size, || {
                    let area = grid.area(count);
                    format!("{:?} {pair:?} at {z} cuts {worst} mm deep on {area:.3} mm2", motion.kind)
                });
            }
            grid.near(pair[0], pair[1], radius + SLIVER_MM, |range| {
                for height in &mut stock[range] {
                    *height = height.min(z);
                }
            });
        }
    }
    let is_uncut = |k: &usize| area.reach[*k] && stock[*k] > case.floor_mm + 1e-6;
    let uncut: Vec<usize> = (0..grid.len()).filter(is_uncut).collect();
    verdict.uncut_part = grid.area(uncut.len()) / area.reach_mm2;
    if verdict.uncut_part > UNCUT_PART {
        let first = grid.point(uncut[uncut.len() / 2]);
        let left = grid.area(uncut.len());
        verdict.add(Fault::Uncut, left, || format!("{left:.3} mm2 stay uncut, for example at {first:?}"));
    }
}

/// Measures the angles on the first level, and compares them with the feeds and the report.
fn check_angles(case: &Case, job: &Job, plan: &Plan, motions: &[Motion], verdict: &mut Verdict) {
    let radius = job.tool.radius_mm;
    let straight = (1.0 - case.stepover_mm / radius).acos();
    let floor = case.floor_mm.max(-case.stepdown_mm);
    let mut most = 0.0f64;
    let mut most_at = [0.0; 2];
    for angle in angles(motions, radius, floor) {
        if !angle.is_entry && angle.angle > most {
            (most, most_at) = (angle.angle, angle.at);
        }
        let over = (angle.angle - SLOT_ALLOWANCE * straight).to_degrees();
        let feed = motions[angle.motion].feed.unwrap_or(f64::INFINITY);
        if let Some(slot_feed) = job.cutting.slot_feed
            && over > SLOT_ALLOWANCE_DEG
            && feed > slot_feed.mm_per_min() + 1e-9
        {
            verdict.add(Fault::SlotFeed, over, || {
                format!(
                    "{over:.1} degrees above the angle at full feed, at {feed} mm/min near {:?}",
                    angle.at
                )
            });
        }
    }
    verdict.angle_deg = most.to_degrees();
    let level = &plan.report.levels[0];
    let chosen = level.candidates.iter().find(|candidate| Some(candidate.pattern) == level.chosen).unwrap();
    let reported = chosen.engagement_max_deg;
    if verdict.angle_deg > reported + REPORT_ALLOWANCE_DEG {
        let found = verdict.angle_deg;
        verdict.add(Fault::EngagementReport, found - reported, || {
            format!("{found:.2} degrees at {most_at:?}, {reported:.2} reported")
        });
    }
}

/// Compares the reported time and the area out of reach with own sums.
fn check_report(area: &Area, plan: &Plan, motions: &[Motion], verdict: &mut Verdict) {
    let rapid = plan.cutting.rapid_feed.mm_per_min();
    let minutes: f64 = motions.iter().map(|motion| motion.length() / motion.feed.unwrap_or(rapid)).sum();
    let (own, reported) = (60.0 * minutes, plan.report.total_time_s);
    if (own - reported).abs() > 1e-6 * own {
        verdict.add(Fault::Time, (own - reported).abs(), || format!("{own} s, {reported} s reported"));
    }
    for level in &plan.report.levels {
        let (own, reported) = (area.pocket_mm2 - area.reach_mm2, level.not_reached_area_mm2);
        if (own - reported).abs() > 0.5 + 0.02 * own {
            verdict.add(Fault::NotReachedReport, (own - reported).abs(), || {
                format!("{own:.3} mm2 are out of reach, {reported:.3} mm2 reported")
            });
        }
    }
}
