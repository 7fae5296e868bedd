//! The pocket as the checker sees it: what is inside, how far the walls are, and what the tool can reach.

use super::cases::Case;
use super::grid::Grid;
use super::plane::{Outline, P, Piece};

/// The distance of the centres along the edge of what the centre may reach, mm.
const EDGE_STEP_MM: f64 = 0.1;

/// How much nearer than the radius a centre may be to a wall, mm: rounding.
const ROUNDING_MM: f64 = 1e-6;

/// How much of the edge of what can be reached need not be cut, mm.
const REACH_MARGIN_MM: f64 = 0.01;

/// Steps of a bisection between two such centres.
const HALVINGS: usize = 30;

/// A grid has about as many points.
const POINTS: f64 = 600_000.0;

pub struct Area {
    boundary: Outline,
    islands: Vec<Outline>,
    low: P,
    /// The side of a bucket, mm. Each bucket lists the pieces within this distance.
    side: f64,
    columns: usize,
    buckets: Vec<Vec<Piece>>,
    pub grid: Grid,
    /// The length of the edge of what the centre may reach, mm.
    pub edge_mm: f64,
    /// The area that a pass along this edge leaves, mm².
    pub inner_mm2: f64,
    pub pocket_mm2: f64,
    pub reach_mm2: f64,
    /// Whether the tool can reach a point of the grid.
    pub reach: Vec<bool>,
}

impl Area {
    pub fn new(case: &Case) -> Self {
        let radius = 0.5 * case.diameter_mm;
        let boundary = Outline::new(&case.boundary);
        let islands: Vec<Outline> = case.islands.iter().map(|island| Outline::new(island)).collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for piece in &boundary.pieces {
            for p in piece.points(0.01, f64::INFINITY) {
                for k in 0..2 {
                    (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
                }
            }
        }
        let cell = ((high[0] - low[0]) * (high[1] - low[1]) / POINTS).sqrt().clamp(0.1, 0.2);
        let side = 2.0 * radius + 1.0;
        let [columns, rows] = [0, 1].map(|k| ((high[k] - low[k]) / side) as usize + 1);
        let mut area = Self {
            boundary,
            islands,
            low,
            side,
            columns,
            buckets: vec![Vec::new(); columns * rows],
            grid: Grid::new([low, high], cell),
            edge_mm: 0.0,
            inner_mm2: 0.0,
            pocket_mm2: 0.0,
            reach_mm2: 0.0,
            reach: Vec::new(),
        };
        area.fill_buckets(rows);
        area.find_reach(radius);
        area
    }

    fn outlines(&self) -> impl Iterator<Item = &Outline> {
        std::iter::once(&self.boundary).chain(&self.islands)
    }

    fn fill_buckets(&mut self, rows: usize) {
        let pieces: Vec<Piece> = self.outlines().flat_map(|outline| &outline.pieces).copied().collect();
        for piece in pieces {
            let bounds = piece.bounds();
            let range = |k: usize, count: usize| {
                let place = |x: f64| ((x - self.low[k]) / self.side).floor().max(0.0) as usize;
                let last = place(bounds[1][k] + self.side).min(count - 1);
                place(bounds[0][k] - self.side)..last + 1
            };
            for row in range(1, rows) {
                for column in range(0, self.columns) {
                    self.buckets[row * self.columns + column].push(piece);
                }
            }
        }
    }

    /// The distance to the nearest wall if it is at most the tool's diameter, else a larger one.
    pub fn clearance(&self, p: P) -> f64 {
        let place = |k: usize| ((p[k] - self.low[k]) / self.side).max(0.0) as usize;
        let bucket = self.buckets.get(place(1) * self.columns + place(0).min(self.columns - 1));
        bucket.into_iter().flatten().map(|piece| piece.distance(p)).fold(f64::INFINITY, f64::min)
    }

    pub fn contains(&self, p: P) -> bool {
        self.boundary.contains(p) && !self.islands.iter().any(|island| island.contains(p))
    }

    /// Whether each point of the grid is in the pocket.
    fn inside(&self) -> Vec<bool> {
        let grid = self.grid;
        let mut inside = vec![false; grid.len()];
        let mut found = Vec::new();
        for row in 0..grid.rows {
            for (k, outline) in self.outlines().enumerate() {
                found.clear();
                outline.crossings(grid.y(row), &mut found);
                found.sort_by(f64::total_cmp);
                for pair in found.chunks_exact(2) {
                    let [from, to] = [pair[0], pair[1]].map(|x| row * grid.columns + grid.column(x));
                    inside[from..to].fill(k == 0);
                }
            }
        }
        inside
    }

    /// The points of the grid in the pocket that are at least `distance` from all walls.
    fn eroded(&self, inside: &[bool], distance: f64) -> Vec<bool> {
        let mut left = inside.to_vec();
        for piece in self.outlines().flat_map(|outline| &outline.pieces) {
            for pair in piece.points(1e-4, f64::INFINITY).windows(2) {
                self.grid.near(pair[0], pair[1], distance, |range| left[range].fill(false));
            }
        }
        left
    }

    /// What the centre may reach is the pocket without all that is nearer to a wall than the radius. The disc
    /// about its edge, and what is inside this edge, is what the tool can reach.
    fn find_reach(&mut self, radius: f64) {
        let inside = self.inside();
        let area = |points: &[bool]| self.grid.area(points.iter().filter(|is_in| **is_in).count());
        self.pocket_mm2 = area(&inside);
        self.inner_mm2 = area(&self.eroded(&inside, 2.0 * radius));
        let mut exact = self.eroded(&inside, radius);
        let mut reach = exact.clone();
        let mut edge_mm = 0.0;
        for piece in self.centres_beside_walls(radius) {
            let n = (piece.length() / EDGE_STEP_MM).ceil().max(1.0);
            let is_free = |t: f64| {
                let p = piece.at(t);
                self.clearance(p) >= radius - ROUNDING_MM && self.contains(p)
            };
            let mut last: Option<(f64, bool)> = None;
            for t in (0..n as usize).map(|k| (k as f64 + 0.5) / n) {
                let is_in = is_free(t);
                // Where the centre gets stuck between two walls, the last free place counts.
                let stuck = last.filter(|(_, was_in)| *was_in != is_in).map(|(before, was_in)| {
                    let (mut free, mut held) = if was_in { (before, t) } else { (t, before) };
                    for _ in 0..HALVINGS {
                        let middle = 0.5 * (free + held);
                        if is_free(middle) { free = middle } else { held = middle }
                    }
                    free
                });
                for t in is_in.then_some(t).into_iter().chain(stuck) {
                    let p = piece.at(t);
                    self.grid.near(p, p, radius, |range| exact[range].fill(true));
                    self.grid.near(p, p, radius - REACH_MARGIN_MM, |range| reach[range].fill(true));
                }
                edge_mm += if is_in { piece.length() / n } else { 0.0 };
                last = Some((t, is_in));
            }
        }
        self.edge_mm = edge_mm;
        self.reach_mm2 = self.grid.area(exact.iter().filter(|is_in| **is_in).count());
        self.reach = reach;
    }

    /// Lines and arcs at the distance of the radius from each wall and each vertex.
    fn centres_beside_walls(&self, radius: f64) -> Vec<Piece> {
        let mut found = Vec::new();
        for outline in self.outlines() {
            for piece in &outline.pieces {
                for sign in [1.0, -1.0] {
                    match *piece {
                        Piece::Line { a, b } => {
                            let (sin, cos) = piece.heading(0.0).sin_cos();
                            let aside = |p: P| [p[0] - sign * radius * sin, p[1] + sign * radius * cos];
                            found.push(Piece::Line { a: aside(a), b: aside(b) });
                        }
                        Piece::Arc { center, radius: own, from, sweep } if own + sign * radius > 0.0 => {
                            found.push(Piece::Arc { center, radius: own + sign * radius, from, sweep });
                        }
                        Piece::Arc { .. } => {}
                    }
                }
            }
            for center in outline.vertices() {
                let sweep = std::f64::consts::TAU;
                found.push(Piece::Arc { center: *center, radius, from: 0.0, sweep });
            }
        }
        found
    }
}
