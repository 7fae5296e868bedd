//! The pockets that the tests plan and judge, as data, and the jobs that are made from them.

use std::f64::consts::{PI, TAU};

use nalgebra::Point2;
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::operations::pocketing::{Job, Outlines, Pattern};
use toolpathd_core::toolpath::cutting::CuttingRequest;
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::units::FeedRate;

use super::plane::{Piece, Vertex};

/// All patterns.
pub const PATTERNS: [Pattern; 7] = [
    Pattern::IslandOffset,
    Pattern::IslandStockOffset,
    Pattern::ZigzagOffset,
    Pattern::ZigzagStockOffset,
    Pattern::ContinuousOffset,
    Pattern::ContinuousStockOffset,
    Pattern::Engagement,
];

pub const FEED: f64 = 800.0;
pub const SLOT_FEED: f64 = 320.0;

/// A pocket. The top of its stock is at zero.
#[derive(Debug, Clone)]
pub struct Case {
    pub boundary: Vec<Vertex>,
    pub islands: Vec<Vec<Vertex>>,
    pub diameter_mm: f64,
    pub stepover_mm: f64,
    pub floor_mm: f64,
    pub stepdown_mm: f64,
}

impl Case {
    /// The same pocket with a stepover of this part of the diameter.
    pub fn with_stepover(&self, part: f64) -> Self {
        Self { stepover_mm: part * self.diameter_mm, ..self.clone() }
    }
}

/// A pocket 5 mm deep for a tool of 10 mm with a stepover of 3 mm.
pub fn pocket(boundary: Vec<Vertex>, islands: Vec<Vec<Vertex>>) -> Case {
    Case { boundary, islands, diameter_mm: 10.0, stepover_mm: 3.0, floor_mm: -5.0, stepdown_mm: 5.0 }
}

pub fn polygon(points: &[[f64; 2]]) -> Vec<Vertex> {
    points.iter().map(|p| [p[0], p[1], 0.0]).collect()
}

/// A rectangle from its lower left corner and its size.
pub fn box_at(x: f64, y: f64, width: f64, height: f64) -> Vec<Vertex> {
    polygon(&[[x, y], [x + width, y], [x + width, y + height], [x, y + height]])
}

/// A circle of two half circles.
pub fn circle_at(x: f64, y: f64, radius: f64) -> Vec<Vertex> {
    vec![[x - radius, y, 1.0], [x + radius, y, 1.0]]
}

pub fn rectangle() -> Case {
    pocket(box_at(0.0, 0.0, 100.0, 60.0), vec![])
}

pub fn ell() -> Case {
    let corners = [[0.0, 0.0], [100.0, 0.0], [100.0, 40.0], [40.0, 40.0], [40.0, 100.0], [0.0, 100.0]];
    pocket(polygon(&corners), vec![])
}

pub fn circle() -> Case {
    pocket(circle_at(0.0, 0.0, 40.0), vec![])
}

pub fn central_island() -> Case {
    pocket(box_at(0.0, 0.0, 100.0, 80.0), vec![box_at(35.0, 30.0, 30.0, 20.0)])
}

pub fn corner_island() -> Case {
    pocket(box_at(0.0, 0.0, 100.0, 80.0), vec![box_at(66.0, 46.0, 18.0, 18.0)])
}

/// The tool does not fit between the islands.
pub fn three_islands() -> Case {
    let islands = [30.0, 50.0, 70.0].map(|x| box_at(x, 30.0, 15.0, 20.0));
    pocket(box_at(0.0, 0.0, 120.0, 80.0), islands.to_vec())
}

/// One island overlaps the left wall. Two others overlap each other and the upper wall.
pub fn islands_on_walls() -> Case {
    let islands =
        [box_at(-5.0, 30.0, 25.0, 20.0), box_at(40.0, 60.0, 20.0, 30.0), box_at(55.0, 55.0, 15.0, 30.0)];
    pocket(box_at(0.0, 0.0, 100.0, 80.0), islands.to_vec())
}

/// A bar with five teeth of 20 mm.
pub fn comb() -> Case {
    let mut corners = vec![[0.0, 0.0], [120.0, 0.0]];
    for k in (0..5).rev() {
        let x = 25.0 * f64::from(k);
        corners.extend([[x + 20.0, 80.0], [x, 80.0]]);
        if k > 0 {
            corners.extend([[x, 30.0], [x - 5.0, 30.0]]);
        }
    }
    Case { diameter_mm: 8.0, stepover_mm: 2.4, ..pocket(polygon(&corners), vec![]) }
}

/// A wavy outline of 1000 vertices with noise of 0.3 mm to either side.
pub fn noisy() -> Case {
    let mut state = 88_172_645_463_325_252u64;
    let mut noise = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        0.6 * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
    };
    let vertex = |k: i32| {
        let angle = f64::from(k) / 1000.0 * TAU;
        let radius = 50.0 * (1.0 + 0.15 * (3.0 * angle).sin() + 0.1 * (7.0 * angle).cos()) + noise();
        [radius * angle.cos(), radius * angle.sin(), 0.0]
    };
    pocket((0..1000).map(vertex).collect(), vec![])
}

pub fn hundred_islands() -> Case {
    let place = |k: u32| 10.0 + 16.0 * f64::from(k);
    let islands = (0..100).map(|k| box_at(place(k % 10), place(k / 10), 6.0, 6.0)).collect();
    Case { diameter_mm: 6.0, stepover_mm: 1.8, ..pocket(box_at(0.0, 0.0, 170.0, 170.0), islands) }
}

/// Two squares of 40 mm, joined by a neck of 20 mm length.
pub fn dumbbell(neck_mm: f64) -> Case {
    let [low, high] = [20.0 - 0.5 * neck_mm, 20.0 + 0.5 * neck_mm];
    let corners = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, low],
        [60.0, low],
        [60.0, 0.0],
        [100.0, 0.0],
        [100.0, 40.0],
        [60.0, 40.0],
        [60.0, high],
        [40.0, high],
        [40.0, 40.0],
        [0.0, 40.0],
    ];
    pocket(polygon(&corners), vec![])
}

/// Arcs only, with a round island.
pub fn arcs() -> Case {
    let outline = vec![[-40.0, 0.0, 0.6], [0.0, -30.0, 0.4], [40.0, 0.0, 0.6], [0.0, 30.0, 0.4]];
    pocket(outline, vec![circle_at(0.0, 0.0, 8.0)])
}

/// A rectangle with rounded corners.
pub fn filleted(radius: f64) -> Case {
    let (width, height, bulge) = (100.0, 60.0, (PI / 8.0).tan());
    let outline = vec![
        [radius, 0.0, 0.0],
        [width - radius, 0.0, bulge],
        [width, radius, 0.0],
        [width, height - radius, bulge],
        [width - radius, height, 0.0],
        [radius, height, bulge],
        [0.0, height - radius, 0.0],
        [0.0, radius, bulge],
    ];
    pocket(outline, vec![])
}

/// Two levels of the full stepdown, and one of what is left.
pub fn three_levels() -> Case {
    let pocket = pocket(box_at(0.0, 0.0, 70.0, 50.0), vec![box_at(30.0, 20.0, 12.0, 10.0)]);
    Case { floor_mm: -13.0, ..pocket }
}

/// The elements of an outline, in the terms of the library.
pub fn elements(outline: &[Vertex]) -> Vec<Segment> {
    let element = |(from, to): (&Vertex, &Vertex)| {
        let (start, end) = (Point2::new(from[0], from[1]), Point2::new(to[0], to[1]));
        match Piece::with_bulge([from[0], from[1]], [to[0], to[1]], from[2]) {
            Piece::Line { .. } => Segment::Line { start, end },
            Piece::Arc { center, radius, sweep, .. } => {
                Segment::about(center.into(), radius, [start, end], sweep)
            }
        }
    };
    outline.iter().zip(outline.iter().cycle().skip(1)).map(element).collect()
}

/// The top of the stock of every case.
pub const TOP_MM: f64 = 0.0;

/// The job of a case. Without a slot feed, slots are cut at the feed.
pub fn job(case: &Case, patterns: &[Pattern], slot_feed: Option<f64>) -> Job {
    let feed = |mm_per_min: f64| FeedRate::from_mm_per_min(mm_per_min).unwrap();
    let area = Outlines {
        boundary: elements(&case.boundary),
        islands: case.islands.iter().map(|island| elements(island)).collect(),
    };
    let tool = Tool { shape: Shape::Flat, ..Tool::ball(0.5 * case.diameter_mm) };
    Job {
        top_z_mm: Some(TOP_MM),
        stepdown_max_mm: case.stepdown_mm,
        patterns: patterns.to_vec(),
        cutting: CuttingRequest { slot_feed: slot_feed.map(feed), ..CuttingRequest::at_feed(feed(FEED)) },
        ..Job::new(area, case.floor_mm, tool, case.stepover_mm, feed(FEED))
    }
}
