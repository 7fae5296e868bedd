//! Smooth ways of the cutter from one place to another at the floor of a level.
//!
//! # Method
//! 1. A way leaves its start on a circle that touches the motion there, and comes to its end on another
//!    (`way`). Where the line that touches both circles does not do, places are searched to go around.
//! 2. The ground is divided into cells (`ground`). Each knows whether the centre may be in it, and how many
//!    cells with material the disc of the cutter meets there. The counts follow the path as it grows.
//! 3. The shortest way over open cells is found (`search`) and pulled tight. Its corners become arcs.
//!
//! # Guarantees
//! None: a cell stands for all places in it. Whoever follows a way has to examine it.
//!
//! # Cost
//! Each cell is cleared once, in O(k) for the k cells of a disc. A search visits at most `MOST_VISITED`.

mod ground;
mod search;
mod way;

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;
use ground::Ground;
pub use ground::Room;
pub use way::{Pose, direct};

/// The radii of the circles on which a way begins and ends, in cutter radii. The smallest is about the least
/// room that a pass with a fine stepover leaves beside itself.
pub const TURNS: [f64; 3] = [0.5, 0.25, 0.1];

/// How far from the start or the end of a way open ground may begin, in cutter radii.
const BESIDE: f64 = 1.0;

/// How far aside of the start and the end open ground is looked for, in cutter radii: a pass has cleared
/// ground on its left.
const ASIDE: f64 = 0.25;

/// What has been swept of a level, and where ways lead over it.
pub struct Links<'a> {
    centers: &'a Region,
    radius_mm: f64,
    ground: Option<Ground>,
    /// Whether the ground has too many cells.
    is_too_large: bool,
    /// What has been swept, and of how many of these elements the cells know.
    swept: Vec<Segment>,
    known: usize,
}

impl<'a> Links<'a> {
    pub fn new(centers: &'a Region, radius_mm: f64) -> Self {
        Self { centers, radius_mm, ground: None, is_too_large: false, swept: Vec::new(), known: 0 }
    }

    /// Says that the cutter has followed an element.
    pub fn sweep(&mut self, element: &Segment) {
        self.swept.push(*element);
    }

    /// From now on the centre may be in another region.
    pub fn move_within(&mut self, centers: &'a Region) {
        self.centers = centers;
        (self.ground, self.is_too_large, self.known) = (None, false, 0);
    }

    /// Ways that are no longer than `most_mm` around what is not open, the shortest first.
    ///
    /// # Errors
    /// When the budget ends.
    pub fn around(
        &mut self,
        ends: [Pose; 2],
        room: Room,
        most_mm: f64,
        budget: &Budget,
    ) -> Result<Vec<Vec<Segment>>, Stopped> {
        let radius = self.radius_mm;
        let Some(ground) = self.ground(budget)? else { return Ok(Vec::new()) };
        let cell = |pose: &Pose| {
            let aside = pose.center(ASIDE * radius);
            ground.open_near(aside, BESIDE * radius, room)
        };
        let [Some(from), Some(to)] = [cell(&ends[0]), cell(&ends[1])] else { return Ok(Vec::new()) };
        let Some(cells) = search::shortest(ground, [from, to], room, most_mm, budget)? else {
            return Ok(Vec::new());
        };
        let stops: Vec<Point2<f64>> =
            search::pulled_tight(ground, &cells, room).into_iter().map(|cell| ground.middle(cell)).collect();
        let inner = if stops.len() > 2 { &stops[1..stops.len() - 1] } else { &[][..] };
        let radii = TURNS.map(|turn| turn * radius);
        let mut ways = way::through(ends, inner, radii);
        ways.extend(way::through(ends, &stops, radii));
        ways.retain(|way| way::length(way) <= most_mm);
        ways.sort_by(|a, b| way::length(a).total_cmp(&way::length(b)));
        Ok(ways)
    }

    fn ground(&mut self, budget: &Budget) -> Result<Option<&Ground>, Stopped> {
        if self.is_too_large {
            return Ok(None);
        }
        let mut ground = match self.ground.take() {
            Some(ground) => ground,
            None => match Ground::new(self.centers, self.radius_mm, budget)? {
                Some(ground) => ground,
                None => {
                    self.is_too_large = true;
                    return Ok(None);
                }
            },
        };
        for element in &self.swept[self.known..] {
            budget.check()?;
            ground.sweep(element);
        }
        self.known = self.swept.len();
        Ok(Some(&*self.ground.insert(ground)))
    }
}

#[cfg(test)]
mod tests;
