//! Points in plan by the cells of a grid, and the neighbours of a point on all sides.

use super::frame::Frame;

/// Points for each cell, on average over the convex hull.
const POINTS_PER_CELL: f64 = 2.0;

/// The most cells along a side of the frame.
const MOST_CELLS: usize = 4096;

/// Directions around a point, counted counterclockwise.
pub const SECTORS: usize = 8;

/// The direction at which sector 0 begins, as its sine and cosine: 10 degrees. The rows of a grid are then
/// inside of sectors, where rounding does not move points to another sector.
const FIRST: [f64; 2] = [0.173_648_177_666_930_33, 0.984_807_753_012_208];

/// Neighbours in each sector; more points than a quadratic polynomial has coefficients in any half of them.
const PER_SECTOR: usize = 5;

/// Neighbours at the edges of the part, where sectors are empty.
const LEAST: usize = 24;

/// Rings of cells around a point that are searched for neighbours.
const MOST_RINGS: usize = 8;

/// A neighbour of a point.
#[derive(Debug, Clone, Copy)]
pub struct Near {
    pub index: usize,
    pub sector: usize,
    /// From the point, mm.
    pub offset: [f64; 2],
    pub distance: f64,
}

/// The points of a frame by the cells of a grid.
pub struct Cells<'a> {
    places: &'a [[f64; 2]],
    size: [usize; 2],
    side: f64,
    /// The points of cell k are `points[starts[k]..starts[k + 1]]`, in their order.
    starts: Vec<usize>,
    points: Vec<usize>,
}

impl<'a> Cells<'a> {
    /// The cells of the points at `places` of the frame.
    pub fn new(places: &'a [[f64; 2]], frame: &Frame) -> Self {
        let longest = frame.lengths[0].max(frame.lengths[1]);
        let area = frame.hull_area.max(0.0);
        let side = (POINTS_PER_CELL * area / places.len() as f64).sqrt().max(longest / MOST_CELLS as f64);
        let side = if side > 0.0 { side } else { 1.0 };
        let size = frame.lengths.map(|length| (length / side) as usize + 1);
        let mut cells =
            Self { places, size, side, starts: vec![0; size[0] * size[1] + 1], points: Vec::new() };
        let of: Vec<usize> = places.iter().map(|place| cells.number(cells.cell(place))).collect();
        of.iter().for_each(|cell| cells.starts[cell + 1] += 1);
        (0..size[0] * size[1]).for_each(|k| cells.starts[k + 1] += cells.starts[k]);
        let mut next = cells.starts.clone();
        cells.points = vec![0; places.len()];
        for (k, cell) in of.into_iter().enumerate() {
            cells.points[next[cell]] = k;
            next[cell] += 1;
        }
        cells
    }

    /// The side of a cell, mm.
    pub fn side(&self) -> f64 {
        self.side
    }

    fn cell(&self, place: &[f64; 2]) -> [usize; 2] {
        [0, 1].map(|k| ((place[k] / self.side).max(0.0) as usize).min(self.size[k] - 1))
    }

    fn number(&self, [i, j]: [usize; 2]) -> usize {
        i * self.size[1] + j
    }

    /// Calls `visit` with the points in the cells of ring `ring` around the cell of `place`; ring 0 is the
    /// cell. `false` where the ring lies outside the frame.
    pub fn visit_ring(&self, place: &[f64; 2], ring: usize, mut visit: impl FnMut(usize)) -> bool {
        let center = self.cell(place).map(|k| k as i64);
        let ring = ring as i64;
        let inside = |k: usize, at: i64| (0..self.size[k] as i64).contains(&at);
        let mut is_inside = false;
        for i in (center[0] - ring)..=(center[0] + ring) {
            if !inside(0, i) {
                continue;
            }
            let is_side = (i - center[0]).abs() == ring;
            let step = if is_side || ring == 0 { 1 } else { 2 * ring };
            for j in ((center[1] - ring)..=(center[1] + ring)).step_by(step as usize) {
                if inside(1, j) {
                    is_inside = true;
                    let cell = self.number([i as usize, j as usize]);
                    self.points[self.starts[cell]..self.starts[cell + 1]]
                        .iter()
                        .copied()
                        .for_each(&mut visit);
                }
            }
        }
        is_inside
    }

    /// The nearest neighbours of point `k` in each sector among the points that `is_kept` has, by their
    /// distance.
    pub fn around(&self, k: usize, is_kept: &[bool]) -> Vec<Near> {
        let place = &self.places[k];
        let mut near: Vec<Near> = Vec::with_capacity(64);
        let mut counts = [0; SECTORS];
        for ring in 0..=MOST_RINGS {
            let is_inside = self.visit_ring(place, ring, |index| {
                if index != k && is_kept[index] {
                    let offset = [0, 1].map(|axis| self.places[index][axis] - place[axis]);
                    let sector = sector(offset);
                    counts[sector] += 1;
                    near.push(Near { index, sector, offset, distance: offset[0].hypot(offset[1]) });
                }
            });
            // The next ring may hold points that are nearer than those of this one's corners.
            if !is_inside || ring > 0 && counts.iter().all(|count| *count >= PER_SECTOR) {
                break;
            }
        }
        near.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.index.cmp(&b.index)));
        let mut counts = [0; SECTORS];
        let mut chosen = Vec::with_capacity(SECTORS * PER_SECTOR);
        let mut others = Vec::new();
        for one in near {
            counts[one.sector] += 1;
            let list = if counts[one.sector] <= PER_SECTOR { &mut chosen } else { &mut others };
            list.push(one);
        }
        let missing = LEAST.saturating_sub(chosen.len());
        chosen.extend(others.into_iter().take(missing));
        chosen
    }

    /// The distance from `place` to the nearest point, mm.
    pub fn nearest(&self, place: &[f64; 2]) -> f64 {
        let mut nearest = f64::INFINITY;
        for ring in 0..=self.size[0].max(self.size[1]) {
            // The points of a ring are at least this far.
            if nearest <= (ring as f64 - 1.0) * self.side {
                break;
            }
            self.visit_ring(place, ring, |index| {
                let other = &self.places[index];
                nearest = nearest.min((other[0] - place[0]).hypot(other[1] - place[1]));
            });
        }
        nearest
    }
}

/// The sector of a direction.
fn sector([x, y]: [f64; 2]) -> usize {
    let [sin, cos] = FIRST;
    let [x, y] = [cos * x + sin * y, cos * y - sin * x];
    let quarter = match (x > 0.0, y > 0.0) {
        (true, true) => 0,
        (false, true) => 1,
        (false, false) => 2,
        (true, false) => 3,
    };
    let is_flat = x.abs() > y.abs();
    let is_second = if quarter % 2 == 0 { !is_flat } else { is_flat };
    2 * quarter + usize::from(is_second)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn sectors_run_counterclockwise_from_ten_degrees() {
        for k in 0..36 {
            let angle = (10.0 * f64::from(k) + 13.0).to_radians();
            let expected = (10 * k as usize + 3) % 360 / 45;
            assert_eq!(sector([angle.cos(), angle.sin()]), expected, "{k}");
        }
    }

    #[test]
    fn a_point_has_neighbours_on_all_sides_and_the_nearest_point_is_found() {
        let points: Vec<Point2<f64>> =
            (0..400).map(|k| Point2::new((k % 20) as f64, (k / 20) as f64)).collect();
        let frame = Frame::around(&points);
        let places: Vec<[f64; 2]> = points.iter().map(|p| frame.place(p)).collect();
        let cells = Cells::new(&places, &frame);
        let near = cells.around(210, &[true; 400]);
        assert_eq!(near.len(), SECTORS * PER_SECTOR);
        assert!((0..SECTORS).all(|k| near.iter().filter(|one| one.sector == k).count() == PER_SECTOR));
        assert_eq!(near[0].distance, 1.0);
        assert_eq!(cells.around(0, &[true; 400]).len(), LEAST);
        assert!((cells.nearest(&[3.25, 4.0]) - 0.25).abs() < 1e-12);
    }
}
