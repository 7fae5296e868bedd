//! An independent check of a program, at many places of every move.
//!
//! The judge knows distances from rectangles and heights of a patch, and nothing of the package. The stock is
//! a grid of heights. The judge finds less than there is, because the judge looks at places alone.

use toolpathd_core::operations::verification::Kind;

use super::block::{At, Way, ways};
use super::scene::{Box3, Pocket, Scene, Shape, TOLERANCE_MM, Tool};
use super::sheet::{SIZE, Sheet, places_under};

/// Distances between places of a move for gouges and for the stock, mm.
const STEP: f64 = 0.1;
const STOCK_EVERY: usize = 3;

/// Distance between columns of the stock, mm.
const GRID: f64 = 0.5;

/// Depth in the stock, or what is left, that the judge's grid does not make by itself, mm.
const STOCK_DEPTH: f64 = 0.1;
const LEFT: f64 = 0.014;

/// The kinds that need the stock.
pub const OF_STOCK: [Kind; 4] =
    [Kind::RapidThroughStock, Kind::HolderNearStock, Kind::DeeperThanFlutes, Kind::MaterialLeft];

/// What is wrong on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offence {
    pub kind: Kind,
    pub line: u32,
    pub amount: f64,
}

/// The worst offence of each kind on each line.
#[derive(Debug, Default)]
pub struct Offences(pub Vec<Offence>);

impl Offences {
    fn add(&mut self, kind: Kind, line: u32, amount: f64) {
        match self.0.iter_mut().find(|own| own.kind == kind && own.line == line) {
            Some(own) => own.amount = own.amount.max(amount),
            None => self.0.push(Offence { kind, line, amount }),
        }
    }
}

/// How deep the point at a distance from the axis and a height over the tip lies in a tool, mm.
fn depth(tool: &Tool, away: f64, height: f64) -> f64 {
    let out = away - (tool.radius - tool.corner);
    let below = tool.corner - height;
    match (out > 0.0, below > 0.0) {
        (true, true) => tool.corner - out.hypot(below),
        (true, false) => tool.corner - out,
        (false, true) => height,
        (false, false) => height.min(tool.corner - out),
    }
}

impl Pocket {
    /// The distance in plan from the nearest wall, mm; zero in the part.
    fn away(&self, x: f64, y: f64) -> f64 {
        let [w, h] = self.size;
        let q = [(x - 0.5 * w).abs() - 0.5 * w + self.corner, (y - 0.5 * h).abs() - 0.5 * h + self.corner];
        let wall = self.corner - q[0].max(0.0).hypot(q[1].max(0.0)) - q[0].max(q[1]).min(0.0);
        let island = self.corridor.map_or(f64::INFINITY, |d| {
            let q = [(x - 0.5 * w).abs() - 0.5 * w + d, (y - 0.5 * h).abs() - 0.5 * h + d];
            q[0].max(0.0).hypot(q[1].max(0.0)) + q[0].max(q[1]).min(0.0)
        });
        wall.min(island).max(0.0)
    }

    /// Whether a place lies near two walls that meet.
    fn is_corner(&self, x: f64, y: f64, radius: f64) -> bool {
        let [w, h] = self.size;
        x.min(w - x) < radius && y.min(h - y) < radius
    }

    /// Places of the outer wall with the ways into the pocket.
    fn wall(&self) -> Vec<([f64; 2], [f64; 2])> {
        let ([w, h], r) = (self.size, self.corner);
        let mut places = Vec::new();
        let mut side = |from: [f64; 2], to: [f64; 2], inward: [f64; 2]| {
            let n = 40;
            let at = |k: i32| {
                let t = f64::from(k) / f64::from(n);
                [from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t]
            };
            places.extend((0..=n).map(|k| (at(k), inward)));
        };
        side([r, 0.0], [w - r, 0.0], [0.0, 1.0]);
        side([w, r], [w, h - r], [-1.0, 0.0]);
        side([w - r, h], [r, h], [0.0, -1.0]);
        side([0.0, h - r], [0.0, r], [1.0, 0.0]);
        for (x, y, turn) in [(w - r, r, -1.0), (w - r, h - r, 0.0), (r, h - r, 1.0), (r, r, 2.0)] {
            for k in 0..=20 {
                let a = (f64::from(k) / 20.0 + turn) * std::f64::consts::FRAC_PI_2;
                places.push(([x + r * a.cos(), y + r * a.sin()], [-a.cos(), -a.sin()]));
            }
        }
        places
    }
}

/// What is wrong with a program, of some kinds at least.
pub fn offences(scene: &Scene, kinds: &[Kind]) -> Offences {
    let asks = |of: &[Kind]| kinds.iter().any(|kind| of.contains(kind));
    let mut found = Offences::default();
    let mut all = ways(&scene.blocks, scene.start, scene.zero, STEP);
    for way in &all {
        part(scene, way, &mut found);
        beside(scene, way, &mut found);
    }
    if asks(&OF_STOCK) {
        stock(scene, &all, &mut found);
    }
    if let (Shape::Pocket(pocket), true) = (&scene.shape, asks(&[Kind::MaterialLeft])) {
        walls(scene, pocket, &all, &mut found);
    }
    if scene.is_dog_leg {
        all.retain(|way| way.is_rapid);
        for mut way in all {
            way.points = dog_leg(&way.points);
            part(scene, &way, &mut found);
            beside(scene, &way, &mut found);
        }
    }
    found
}

/// The places of a rapid whose axes run at one speed.
fn dog_leg(points: &[At]) -> Vec<At> {
    let (from, to) = (points[0], points[points.len() - 1]);
    let longest = (0..3).map(|k| (to[k] - from[k]).abs()).fold(0.0, f64::max);
    let n = (longest / STEP).ceil().max(1.0) as usize;
    let at = |run: f64| [0, 1, 2].map(|k| from[k] + (to[k] - from[k]).clamp(-run, run));
    (0..=n).map(|k| at(longest * k as f64 / n as f64)).collect()
}

/// Entries of the cutter into the part.
fn part(scene: &Scene, way: &Way, found: &mut Offences) {
    let tool = scene.tool(way.tool);
    let kind = if way.is_rapid { Kind::RapidThroughPart } else { Kind::Gouge };
    let deepest = |p: &At| match &scene.shape {
        Shape::Pocket(pocket) => {
            let of_walls = if p[2] < 0.0 { depth(tool, pocket.away(p[0], p[1]), -p[2]) } else { 0.0 };
            of_walls.max(-pocket.depth - p[2])
        }
        Shape::Sheet(sheet) if p[2] > sheet.highest() => 0.0,
        Shape::Sheet(sheet) => sheet_depth(sheet, tool, p),
    };
    let worst = way.points.iter().map(deepest).fold(0.0, f64::max);
    if worst > TOLERANCE_MM {
        found.add(kind, way.line, worst);
    }
}

/// How deep the deepest place of a patch lies in the tool.
fn sheet_depth(sheet: &Sheet, tool: &Tool, p: &At) -> f64 {
    let at = |x: f64, y: f64| {
        sheet.height(x, y).map_or(f64::MIN, |z| depth(tool, (x - p[0]).hypot(y - p[1]), z - p[2]))
    };
    let mut best = (f64::MIN, p[0], p[1]);
    for (dx, dy) in places_under(tool.radius, [p[0], p[1]]) {
        let [x, y] = [p[0] + dx, p[1] + dy];
        let own = at(x, y);
        if own > best.0 {
            best = (own, x, y);
        }
    }
    let mut step = tool.radius / 10.0;
    while step > 1e-4 {
        let [x, y] = [best.1 - p[0], best.2 - p[1]];
        let away = x.hypot(y).max(step);
        let [x, y] = [step * x / away, step * y / away];
        // Along the axes, and along and across the spoke.
        let ways = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step), (x, y), (-x, -y), (-y, x), (y, -x)];
        let next = ways.map(|(a, b)| (at(best.1 + a, best.2 + b), best.1 + a, best.2 + b));
        let next = next.into_iter().fold(best, |best, own| if own.0 > best.0 { own } else { best });
        if next.0 > best.0 { best = next } else { step *= 0.5 }
    }
    best.0
}

/// Holders near the part, the clamp, and the travel.
fn beside(scene: &Scene, way: &Way, found: &mut Offences) {
    let tool = scene.tool(way.tool);
    let near = |away: f64, bottom: f64, top: f64, radius: f64| {
        (away - radius).max(0.0).hypot((bottom - top).max(0.0))
    };
    let is_near = |distance: f64| distance < scene.clearance - 0.02;
    for p in &way.points {
        if let Shape::Pocket(pocket) = &scene.shape {
            let distance = near(pocket.away(p[0], p[1]), p[2] + tool.stickout, 0.0, tool.holder);
            if is_near(distance) {
                found.add(Kind::HolderNearPart, way.line, scene.clearance - distance);
            }
        }
        let [low, high] = &scene.clamp;
        let out = |k: usize| (low[k] - p[k]).max(p[k] - high[k]).max(0.0);
        let away = out(0).hypot(out(1));
        let of_cutter = near(away, p[2], high[2], tool.radius);
        let distance = of_cutter.min(near(away, p[2] + tool.stickout, high[2], tool.holder));
        if is_near(distance) {
            found.add(Kind::FixtureNear, way.line, scene.clearance - distance);
        }
        let [low, high] = &scene.travel;
        let beyond = (0..3).map(|k| (low[k] - p[k]).max(p[k] - high[k])).fold(f64::MIN, f64::max);
        if beyond > 1e-6 {
            found.add(Kind::OutsideTravel, way.line, beyond);
        }
    }
}

/// Columns of material over a grid in plan.
struct Columns {
    low: [f64; 2],
    n: [usize; 2],
    top: Vec<f64>,
}

impl Columns {
    fn new(scene: &Scene) -> Self {
        let around: Box3 = scene.stock.unwrap_or_else(|| match &scene.shape {
            Shape::Pocket(pocket) => [[0.0; 3], [pocket.size[0], pocket.size[1], 0.0]],
            Shape::Sheet(_) => [[0.0; 3]; 2],
        });
        let [low, high] = around;
        let n = [0, 1].map(|k| ((high[k] - low[k]) / GRID).floor() as usize + 1);
        let mut columns = Self { low: [low[0] + 0.01, low[1] + 0.01], n, top: vec![high[2]; n[0] * n[1]] };
        if let (Shape::Pocket(pocket), None) = (&scene.shape, scene.stock) {
            for k in 0..columns.top.len() {
                let [x, y] = columns.place(k);
                if pocket.away(x, y) <= 0.0 {
                    columns.top[k] = f64::MIN;
                }
            }
        }
        columns
    }

    fn place(&self, k: usize) -> [f64; 2] {
        [self.low[0] + GRID * (k % self.n[0]) as f64, self.low[1] + GRID * (k / self.n[0]) as f64]
    }

    /// The columns near a place, with their distances in plan.
    fn near(&self, x: f64, y: f64, reach: f64) -> Vec<(usize, f64)> {
        let range = |at: f64, low: f64, n: usize| {
            let from = ((at - reach - low) / GRID).ceil().max(0.0) as usize;
            let to = ((at + reach - low) / GRID).floor().clamp(-1.0, n as f64 - 1.0);
            from..(to + 1.0) as usize
        };
        let mut near = Vec::new();
        for j in range(y, self.low[1], self.n[1]) {
            for i in range(x, self.low[0], self.n[0]) {
                let away = (self.low[0] + GRID * i as f64 - x).hypot(self.low[1] + GRID * j as f64 - y);
                if away <= reach {
                    near.push((j * self.n[0] + i, away));
                }
            }
        }
        near
    }
}

/// What the moves do to the stock, and what they leave on the floor or the surface.
fn stock(scene: &Scene, all: &[Way], found: &mut Offences) {
    let mut columns = Columns::new(scene);
    let highest = columns.top.iter().copied().fold(f64::MIN, f64::max);
    for way in all {
        let tool = scene.tool(way.tool);
        let last = way.points.len() - 1;
        for (k, p) in way.points.iter().enumerate() {
            if !(k % STOCK_EVERY == 0 || k == last) || p[2] > highest + 1.0 {
                continue;
            }
            if p[2] + tool.stickout < highest {
                for (column, _) in columns.near(p[0], p[1], tool.holder) {
                    if columns.top[column] > p[2] + tool.stickout {
                        found.add(
                            Kind::HolderNearStock,
                            way.line,
                            columns.top[column] - p[2] - tool.stickout,
                        );
                    }
                }
            }
            for (column, away) in columns.near(p[0], p[1], tool.radius) {
                let before = columns.top[column];
                let after = p[2] + tool.lower(away);
                if before <= after {
                    continue;
                }
                if way.is_rapid {
                    let own = depth(tool, away, before - p[2]);
                    if own > STOCK_DEPTH {
                        found.add(Kind::RapidThroughStock, way.line, own);
                    }
                } else if before - p[2] > tool.flute + TOLERANCE_MM {
                    found.add(Kind::DeeperThanFlutes, way.line, before - p[2] - tool.flute);
                }
                columns.top[column] = after;
            }
        }
    }
    if let Shape::Pocket(pocket) = &scene.shape {
        let radius = scene.tools[0].radius;
        for (k, top) in columns.top.iter().enumerate() {
            let [x, y] = columns.place(k);
            let above = top + pocket.depth;
            if pocket.away(x, y) > GRID && !pocket.is_corner(x, y, radius) && above > LEFT {
                found.add(Kind::MaterialLeft, 0, above);
            }
        }
    }
    if let Shape::Sheet(sheet) = &scene.shape {
        let most = left_on_sheet(sheet, scene, all);
        if most > scene.allowed {
            found.add(Kind::MaterialLeft, 0, most);
        }
    }
}

/// The largest distance of places of a patch from the tool on its way, mm.
pub fn left_on_sheet(sheet: &Sheet, scene: &Scene, all: &[Way]) -> f64 {
    let feeds = all.iter().filter(|way| !way.is_rapid);
    let tips: Vec<(&Tool, &At)> = feeds
        .flat_map(|way| {
            [0, way.points.len() / 2, way.points.len() - 1].map(|k| (scene.tool(way.tool), &way.points[k]))
        })
        .collect();
    let n = [42, 36];
    let mut most = 0.0f64;
    for (i, j) in (0..=n[0]).flat_map(|i| (0..=n[1]).map(move |j| (i, j))) {
        let [x, y] = [SIZE[0] * f64::from(i) / f64::from(n[0]), SIZE[1] * f64::from(j) / f64::from(n[1])];
        let Some(z) = sheet.height(x, y) else { continue };
        let mut least = f64::INFINITY;
        for (tool, p) in &tips {
            if (x - p[0]).abs() < tool.radius + 1.0 {
                least = least.min(-depth(tool, (x - p[0]).hypot(y - p[1]), z - p[2]));
            }
        }
        most = most.max(least);
    }
    most
}

/// What is left at the outer walls where the last cutter along them can touch them.
fn walls(scene: &Scene, pocket: &Pocket, all: &[Way], found: &mut Offences) {
    let floor = -pocket.depth + TOLERANCE_MM;
    let cuts = all.iter().filter(|way| !way.is_rapid && scene.tool(way.tool).corner == 0.0);
    let discs: Vec<(f64, u32, &At)> = cuts
        .flat_map(|way| way.points.iter().map(|p| (scene.tool(way.tool).radius, way.line, p)))
        .filter(|(_, _, p)| p[2] <= floor)
        .collect();
    let used = |number: u32| all.iter().any(|way| way.tool == number && scene.tool(number).corner == 0.0);
    let radii = scene.tools.iter().filter(|tool| used(tool.number)).map(|tool| tool.radius);
    let least = radii.fold(f64::INFINITY, f64::min);
    for (p, inward) in pocket.wall() {
        let center = [p[0] + inward[0] * least, p[1] + inward[1] * least];
        if pocket.away(center[0], center[1]) < least - 1e-9 {
            continue;
        }
        let left = |radius: f64, at: &At| ((p[0] - at[0]).powi(2) + (p[1] - at[1]).powi(2)).sqrt() - radius;
        let left = discs.iter().map(|(radius, line, at)| (left(*radius, at), *line));
        let nearest = left.min_by(|one, other| one.0.total_cmp(&other.0));
        if let Some((left, line)) = nearest.filter(|(left, _)| *left > LEFT) {
            found.add(Kind::MaterialLeft, line, left);
        }
    }
}
