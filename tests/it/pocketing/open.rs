//! Tests of pockets with open edges: faces, steps, slots, bosses and random blocks. The checker knows the part
//! as polygons of what has to stay, and looks at distances from these and from the path alone.

use std::collections::{BTreeMap, BTreeSet};

use toolpathd_core::budget::Budget;
use toolpathd_core::operations::pocketing::{
    Finish, FinishWalls, Job, Outlines, Pattern, Plan, Standing, plan,
};
use toolpathd_core::toolpath::Role;

use super::cases::{self, Case, PATTERNS, elements, job, polygon};
use super::motion::{Kind, Motion, motions};
use super::plane::{Outline, P, Piece, apart};

/// Depth to which rounding may bring the cutter into the part, mm.
const GOUGE_MM: f64 = 2e-3;

/// A place of the pocket counts as cut if the cutter passes nearer than its radius and this, mm: a burr at an
/// outer corner may be as large.
const SLACK_MM: f64 = 0.1;

/// Distance of the places that are looked at, mm.
const CELL_MM: f64 = 0.7;

/// A pocket with open edges, and what must stay around it.
#[derive(Debug, Clone)]
struct Body {
    case: Case,
    /// Indices of open edges of the boundary.
    open: Vec<usize>,
    /// Polygons that the cutter must not enter.
    stays: Vec<Vec<P>>,
}

impl Body {
    fn new(boundary: &[P], islands: &[&[P]], open: &[usize], stays: &[&[P]]) -> Self {
        let islands: Vec<_> = islands.iter().map(|island| polygon(island)).collect();
        let mut stays: Vec<Vec<P>> = stays.iter().map(|one| one.to_vec()).collect();
        stays.extend(
            islands.iter().map(|island| island.iter().map(|vertex| [vertex[0], vertex[1]]).collect()),
        );
        Self { case: cases::pocket(polygon(boundary), islands), open: open.to_vec(), stays }
    }

    fn job(&self, patterns: &[Pattern]) -> Job {
        let job = job(&self.case, patterns, None);
        let edges = elements(&self.case.boundary);
        Job { open: self.open.iter().map(|k| edges[*k]).collect(), ..job }
    }
}

fn box_of(x: f64, y: f64, width: f64, height: f64) -> [P; 4] {
    [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
}

/// The part and the pocket, as distances from polygons.
struct Scene {
    stays: Vec<Outline>,
    pocket: Outline,
    islands: Vec<Outline>,
    bounds: [P; 2],
    radius: f64,
}

fn outline(points: &[P]) -> Outline {
    Outline::new(&polygon(points))
}

fn edges(outline: &Outline) -> impl Iterator<Item = Piece> {
    let vertices = outline.vertices();
    (0..vertices.len()).map(|k| Piece::Line { a: vertices[k], b: vertices[(k + 1) % vertices.len()] })
}

impl Scene {
    fn new(body: &Body) -> Self {
        let pocket = Outline::new(&body.case.boundary);
        let of = |k: usize| pocket.vertices().iter().map(move |p| p[k]);
        let low = [0, 1].map(|k| of(k).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|k| of(k).fold(f64::NEG_INFINITY, f64::max));
        Self {
            stays: body.stays.iter().map(|one| outline(one)).collect(),
            islands: body.case.islands.iter().map(|island| Outline::new(island)).collect(),
            bounds: [low, high],
            radius: 0.5 * body.case.diameter_mm,
            pocket,
        }
    }

    /// The distance of a place from the part; negative inside.
    fn distance_from_part(&self, p: P) -> f64 {
        let distance = self.stays.iter().flat_map(edges).map(|edge| edge.distance(p));
        let distance = distance.fold(f64::INFINITY, f64::min);
        if self.stays.iter().any(|one| one.contains(p)) { -distance } else { distance }
    }

    fn is_pocket(&self, p: P) -> bool {
        self.pocket.contains(p) && !self.islands.iter().any(|island| island.contains(p))
    }

    /// The distance of a place from the pocket.
    fn distance_from_pocket(&self, p: P) -> f64 {
        if self.is_pocket(p) {
            return 0.0;
        }
        let all = std::iter::once(&self.pocket).chain(&self.islands);
        all.flat_map(edges).map(|edge| edge.distance(p)).fold(f64::INFINITY, f64::min)
    }

    /// Whether the cutter can cut a place without touching the part.
    fn is_in_reach(&self, p: P) -> bool {
        let aside = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / 96.0).sin_cos();
            [p[0] + 0.995 * self.radius * cos, p[1] + 0.995 * self.radius * sin]
        };
        self.distance_from_part(p) >= self.radius
            || (0..96).any(|k| self.distance_from_part(aside(k)) >= self.radius)
    }

    fn places(&self) -> Vec<P> {
        let [low, high] = self.bounds;
        let count = |k: usize| ((high[k] - low[k]) / CELL_MM) as usize;
        let place =
            |k: usize, j: usize| [low[0] + 0.0317 + CELL_MM * k as f64, low[1] + 0.0271 + CELL_MM * j as f64];
        let all = (0..=count(0)).flat_map(|k| (0..=count(1)).map(move |j| place(k, j)));
        all.filter(|p| self.is_pocket(*p) && self.is_in_reach(*p)).collect()
    }
}

fn is_below_top(motion: &Motion) -> bool {
    motion.low() < cases::TOP_MM - 1e-9
}

/// What is wrong with a plan of a body.
fn faults(body: &Body, job: &Job, plan: &Plan) -> Vec<String> {
    let (scene, motions) = (Scene::new(body), motions(&plan.toolpath));
    let mut faults = Vec::new();
    for motion in motions.iter().filter(|motion| is_below_top(motion)) {
        let points = motion.piece.points(0.002, 0.5);
        let least = points.iter().map(|p| scene.distance_from_part(*p)).fold(f64::INFINITY, f64::min);
        if least < scene.radius + job.allowance_mm - GOUGE_MM {
            faults.push(format!("{:.4} mm into the part near {:?}", scene.radius - least, points[0]));
        }
    }
    let floor: Vec<&Motion> = motions
        .iter()
        .filter(|motion| motion.is_level() && (motion.low() - job.floor_z_mm).abs() < 1e-6)
        .filter(|motion| matches!(motion.kind, Kind::Feed(_)))
        .collect();
    let is_cut = |p: P| floor.iter().any(|motion| motion.piece.is_within(p, scene.radius + SLACK_MM));
    let uncut: Vec<P> = scene.places().into_iter().filter(|p| !is_cut(*p)).collect();
    if !uncut.is_empty() {
        let first = &uncut[..uncut.len().min(9)];
        faults.push(format!("{} places are not cut, for example {first:?}", uncut.len()));
    }
    faults
}

/// Where the cutter comes down first on each level, and whether it ever comes down on a slope.
fn entries(job: &Job, motions: &[Motion]) -> (Vec<P>, bool) {
    let mut first: BTreeMap<i64, P> = BTreeMap::new();
    for motion in motions.iter().filter(|motion| motion.is_vertical() && is_below_top(motion)) {
        let z = (motion.low() / (0.01 * job.stepdown_max_mm)).round() as i64;
        first.entry(z).or_insert(motion.piece.at(1.0));
    }
    let slopes = motions.iter().any(|motion| matches!(motion.kind, Kind::Feed(Role::Ramp | Role::Plunge)));
    (first.into_values().collect(), slopes)
}

fn planned(job: &Job) -> Plan {
    plan(job, &Budget::unlimited()).expect("a plan")
}

/// Plans a body with all patterns, and asserts that it is whole and entered from outside.
fn is_cut_from_outside(body: &Body) {
    let job = body.job(&PATTERNS);
    let plan = planned(&job);
    assert_eq!(faults(body, &job, &plan), [""; 0], "{body:?}");
    let (scene, motions) = (Scene::new(body), motions(&plan.toolpath));
    let (first, slopes) = entries(&job, &motions);
    assert!(!slopes, "a helix or a ramp in {body:?}");
    for p in first {
        assert!(
            scene.distance_from_pocket(p) > scene.radius - 0.06,
            "down into the material at {p:?} in {body:?}"
        );
    }
}

fn face() -> Body {
    Body::new(&box_of(0.0, 0.0, 90.0, 50.0), &[], &[0, 1, 2, 3], &[])
}

/// A step at the right end of a block.
fn step() -> Body {
    Body::new(&box_of(40.0, 0.0, 40.0, 50.0), &[], &[0, 1, 2], &[&box_of(-60.0, 0.0, 100.0, 50.0)])
}

fn slot(width: f64, open: &[usize]) -> Body {
    let (below, above) = (box_of(0.0, -60.0, 80.0, 60.0), box_of(0.0, width, 80.0, 60.0));
    let [left, right] = [box_of(-60.0, -60.0, 60.0, 160.0), box_of(80.0, -60.0, 60.0, 160.0)];
    let mut stays: Vec<&[P]> = vec![&below, &above];
    if !open.contains(&1) {
        stays.push(&right);
    }
    if !open.contains(&3) {
        stays.push(&left);
    }
    Body::new(&box_of(0.0, 0.0, 80.0, width), &[], open, &stays)
}

fn boss() -> Body {
    let island = [[35.0, 25.0], [60.0, 22.0], [66.0, 45.0], [40.0, 50.0]];
    Body::new(&box_of(0.0, 0.0, 100.0, 80.0), &[&island], &[0, 1, 2, 3], &[])
}

/// A triangle between a slanting wall and two open sides, with an acute corner at both ends of the wall.
fn slanting() -> Body {
    Body::new(
        &[[0.0, 0.0], [70.0, 0.0], [70.0, 50.0]],
        &[],
        &[0, 1],
        &[&[[0.0, 0.0], [70.0, 50.0], [0.0, 50.0]]],
    )
}

#[test]
fn a_face_is_whole_and_entered_from_outside() {
    is_cut_from_outside(&face());
    // The cutter is wider than the face.
    let mut narrow = Body::new(&box_of(0.0, 0.0, 60.0, 12.0), &[], &[0, 1, 2, 3], &[]);
    narrow.case.diameter_mm = 40.0;
    narrow.case.stepover_mm = 16.0;
    is_cut_from_outside(&narrow);
}

#[test]
fn a_step_is_whole_and_entered_from_outside() {
    is_cut_from_outside(&step());
    let mut deep = step();
    deep.case.floor_mm = -12.0;
    is_cut_from_outside(&deep);
}

#[test]
fn slots_are_whole_and_entered_from_outside() {
    for width in [10.0, 10.2, 14.0, 19.9, 20.0, 33.0] {
        for open in [&[1][..], &[3], &[1, 3]] {
            is_cut_from_outside(&slot(width, open));
        }
    }
}

#[test]
fn a_boss_is_whole_and_entered_from_outside() {
    is_cut_from_outside(&boss());
}

#[test]
fn a_wall_at_an_acute_corner_is_cut_up_to_its_ends() {
    is_cut_from_outside(&slanting());
}

#[test]
fn every_pattern_keeps_away_from_the_part() {
    for body in [face(), step(), slot(25.0, &[1]), boss(), slanting()] {
        for pattern in PATTERNS {
            let job = body.job(&[pattern]);
            match plan(&job, &Budget::unlimited()) {
                Ok(plan) => assert_eq!(faults(&body, &job, &plan), [""; 0], "{pattern:?} {body:?}"),
                Err(error) => panic!("{pattern:?}: {error} in {body:?}"),
            }
        }
    }
}

#[test]
fn a_path_that_is_moved_into_the_part_or_cut_short_is_found() {
    let body = step();
    let job = body.job(&PATTERNS);
    let plan = planned(&job);
    let mut moved = body.clone();
    moved.stays[0] = box_of(-60.0, 0.0, 100.01, 50.0).to_vec();
    assert!(faults(&moved, &job, &plan).iter().any(|fault| fault.contains("into the part")));
    let mut longer = body;
    longer.case.boundary = polygon(&box_of(40.0, 0.0, 60.0, 50.0));
    assert!(faults(&longer, &job, &plan).iter().any(|fault| fault.contains("not cut")));
}

#[test]
fn walls_beside_open_edges_are_finished_beyond_both_ends() {
    let body = slot(25.0, &[1, 3]);
    let finish = Finish {
        walls: Some(FinishWalls {
            passes: 1,
            stepover_mm: None,
            stepdown_mm: None,
            feed: None,
            spring_passes: 1,
        }),
        floor: None,
    };
    let job = Job { allowance_mm: 0.4, finish, ..body.job(&PATTERNS) };
    let plan = planned(&job);
    let finished = Job { allowance_mm: 0.0, ..job.clone() };
    assert_eq!(faults(&body, &finished, &plan), [""; 0]);
    // Each wall is followed twice, from one air to the other.
    let is_on_wall = |motion: &&Motion| {
        let y = motion.piece.at(0.5)[1];
        motion.kind == Kind::Feed(Role::Cut)
            && motion.is_level()
            && [5.0, 20.0].iter().any(|at| (y - at).abs() < 1e-4)
    };
    let motions = motions(&plan.toolpath);
    let length: f64 = motions.iter().filter(is_on_wall).map(|motion| motion.piece.length()).sum();
    assert!(length > 4.0 * 88.0 && length < 4.0 * 105.0, "{length}");
}

#[test]
fn what_is_outside_the_stock_is_not_cut() {
    let body = face();
    let standing = |corners: [f64; 4]| {
        let [x, y, width, height] = corners;
        let boundary = elements(&polygon(&box_of(x, y, width, height)));
        Some(Standing { outlines: Outlines { boundary, islands: vec![] }, bottom_z_mm: -50.0 })
    };
    let whole = planned(&body.job(&PATTERNS));
    let half = planned(&Job { stock: standing([-5.0, -5.0, 45.0, 60.0]), ..body.job(&PATTERNS) });
    let cut = |plan: &Plan| plan.report.total_time_s;
    assert!(cut(&half) < 0.75 * cut(&whole), "{} of {}", cut(&half), cut(&whole));
    // Stock stands in front of the left half: there the sides count as walls.
    let stands =
        [box_of(-5.0, -5.0, 5.0, 60.0), box_of(-5.0, -5.0, 45.0, 5.0), box_of(-5.0, 50.0, 45.0, 5.0)];
    let stands = stands.each_ref().map(<[P; 4]>::as_slice);
    let beside = Body::new(&box_of(0.0, 0.0, 90.0, 50.0), &[], &body.open, &stands);
    let faults = faults(&beside, &body.job(&PATTERNS), &half);
    assert!(faults.iter().all(|fault| !fault.contains("into the part")), "{faults:?}");
    let rightmost = motions(&half.toolpath)
        .iter()
        .filter(|motion| is_below_top(motion))
        .fold(0.0, |most, motion| f64::max(most, motion.piece.at(1.0)[0]));
    assert!(rightmost < 60.0, "{rightmost}");
    let nowhere = standing([200.0, 0.0, 10.0, 10.0]);
    assert!(plan(&Job { stock: nowhere, ..body.job(&PATTERNS) }, &Budget::unlimited()).is_err());
}

/// Random numbers that are the same in every run.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

type Cell = (i32, i32);

/// The cells connected to a cell by their sides.
fn connected(free: &BTreeSet<Cell>, first: Cell) -> BTreeSet<Cell> {
    let (mut found, mut open) = (BTreeSet::from([first]), vec![first]);
    while let Some((x, y)) = open.pop() {
        for next in [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)] {
            if free.contains(&next) && found.insert(next) {
                open.push(next);
            }
        }
    }
    found
}

/// The loops around cells, each as corners with whether the side behind a corner is on the stock's edge. None
/// where cells meet at a corner alone.
fn loops(cells: &BTreeSet<Cell>, size: [i32; 2]) -> Option<Vec<Vec<(Cell, bool)>>> {
    let mut next: BTreeMap<Cell, (Cell, bool)> = BTreeMap::new();
    for &(x, y) in cells {
        let sides = [
            ((x, y - 1), (x, y), (x + 1, y)),
            ((x + 1, y), (x + 1, y), (x + 1, y + 1)),
            ((x, y + 1), (x + 1, y + 1), (x, y + 1)),
            ((x - 1, y), (x, y + 1), (x, y)),
        ];
        for (beside, from, to) in sides.into_iter().filter(|(beside, ..)| !cells.contains(beside)) {
            let is_edge = !(0..size[0]).contains(&beside.0) || !(0..size[1]).contains(&beside.1);
            if next.insert(from, (to, is_edge)).is_some() {
                return None;
            }
        }
    }
    let mut loops = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let (mut one, mut at) = (Vec::new(), start);
        while let Some((to, is_edge)) = next.remove(&at) {
            one.push((at, is_edge));
            at = to;
        }
        loops.push(one);
    }
    Some(loops)
}

fn area(points: &[(Cell, bool)]) -> i32 {
    (0..points.len())
        .map(|k| {
            let (a, b) = (points[k].0, points[(k + 1) % points.len()].0);
            a.0 * b.1 - a.1 * b.0
        })
        .sum()
}

/// A block of which some cells stay and the others are cut, down from outside.
fn random_body(chance: &mut Chance) -> Option<Body> {
    let size = [3 + chance.below(3) as i32, 3 + chance.below(3) as i32];
    let unit = [13.0, 14.0, 17.5, 20.0, 26.0][chance.below(5) as usize];
    let all: Vec<Cell> = (0..size[0]).flat_map(|x| (0..size[1]).map(move |y| (x, y))).collect();
    let free: BTreeSet<Cell> = all.iter().copied().filter(|_| chance.below(10) < 7).collect();
    let cells = connected(&free, *free.first()?);
    let mut loops = loops(&cells, size)?;
    loops.sort_by_key(|one| std::cmp::Reverse(area(one)));
    let at = |cell: Cell| [unit * f64::from(cell.0), unit * f64::from(cell.1)];
    let open: Vec<usize> =
        loops[0].iter().enumerate().filter(|(_, (_, is_edge))| *is_edge).map(|(k, _)| k).collect();
    if open.is_empty() {
        return None;
    }
    let corners: Vec<Vec<P>> =
        loops.iter().map(|one| one.iter().map(|(cell, _)| at(*cell)).collect()).collect();
    let islands: Vec<&[P]> = corners[1..].iter().map(Vec::as_slice).collect();
    let kept: Vec<[P; 4]> = all
        .iter()
        .filter(|cell| !cells.contains(cell))
        .map(|cell| box_of(at(*cell)[0], at(*cell)[1], unit, unit))
        .collect();
    let stays: Vec<&[P]> = kept.iter().map(<[P; 4]>::as_slice).collect();
    let mut body = Body::new(&corners[0], &islands, &open, &stays);
    body.case.diameter_mm = [6.0, 10.0, 12.0][chance.below(3) as usize];
    body.case.stepover_mm = [0.2, 0.4, 0.5][chance.below(3) as usize] * body.case.diameter_mm;
    Some(body)
}

#[test]
fn random_blocks_are_whole_and_entered_from_outside() {
    let mut chance = Chance(38);
    let mut count = 0;
    while count < 24 {
        if let Some(body) = random_body(&mut chance) {
            is_cut_from_outside(&body);
            count += 1;
        }
    }
}

#[test]
fn a_turned_and_shifted_open_pocket_takes_as_long() {
    let body = step();
    let base = planned(&body.job(&PATTERNS)).report.total_time_s;
    for angle in [0.5_f64, 1.2, 2.9] {
        let (sin, cos) = angle.sin_cos();
        let turned = |p: P| [cos * p[0] - sin * p[1] + 31.7, sin * p[0] + cos * p[1] - 12.3];
        let boundary: Vec<P> =
            body.case.boundary.iter().map(|vertex| turned([vertex[0], vertex[1]])).collect();
        let stays: Vec<P> = body.stays[0].iter().map(|p| turned(*p)).collect();
        let moved = Body::new(&boundary, &[], &body.open, &[&stays]);
        is_cut_from_outside(&moved);
        let time = planned(&moved.job(&PATTERNS)).report.total_time_s;
        assert!((time / base - 1.0).abs() < 0.02, "{time} s, and {base} s as it is");
        assert!(apart(boundary[0], turned([40.0, 0.0])) < 1e-9);
    }
}
