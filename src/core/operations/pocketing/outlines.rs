//! The outlines of a pocket, of its stock and of emptied places, as regions.

use nalgebra::Point2;

use super::PocketError;
use super::job::Outlines;
use crate::budget::Budget;
use crate::geometry::polyline;
use crate::geometry::region::{Outline, OutlineError, Region, Stretches};
use crate::geometry::segment::Segment;

/// Outlines with more elements get arcs in place of lines. The arcs stay within `FITTED_MM` of the lines, mm.
const MOST_EXACT: usize = 2_000;
pub const FITTED_MM: f64 = 5e-4;

/// The most elements of a region.
const MOST_ELEMENTS: usize = 20_000;

impl Outlines {
    /// The region inside the wall and outside all islands.
    ///
    /// # Errors
    /// When an outline is none, or the region cannot be computed.
    pub fn region(&self, budget: &Budget) -> Result<Region, PocketError> {
        Ok(Walls::new(self, &[], budget)?.region)
    }
}

/// The wall of a pocket, its islands, and which stretches of the wall are open.
pub struct Walls {
    pub boundary: Outline,
    pub islands: Vec<Outline>,
    pub open: Stretches,
    /// The region inside the wall and outside all islands.
    pub region: Region,
}

impl Walls {
    /// The walls of outlines, where `open` are elements of the wall that are open.
    pub fn new(area: &Outlines, open: &[Segment], budget: &Budget) -> Result<Self, PocketError> {
        let is_fitted = is_fitted(area);
        let open = Stretches::new(open);
        let outline = |elements: &[Segment], island: Option<usize>| {
            let outline = if is_fitted {
                // Arcs may cross each other where the lines only come near.
                match Outline::new(&with_arcs(elements, &open, budget)?, budget) {
                    Err(OutlineError::Crosses { .. }) => Outline::new(elements, budget),
                    outline => outline,
                }
            } else {
                Outline::new(elements, budget)
            };
            outline.map_err(|error| match error {
                OutlineError::Stopped(stopped) => PocketError::Stopped(stopped),
                error => PocketError::Outline { island, error },
            })
        };
        let boundary = outline(&area.boundary, None)?;
        let islands = area.islands.iter().enumerate().map(|(k, island)| outline(island, Some(k)));
        let islands = islands.collect::<Result<Vec<_>, _>>()?;
        let region = Region::new(std::slice::from_ref(&boundary), &islands, budget)?;
        if region.outlines().map(|outline| outline.elements().len()).sum::<usize>() > MOST_ELEMENTS {
            return Err(PocketError::OutlinesTooFine { limit: MOST_ELEMENTS, within_mm: FITTED_MM });
        }
        if region.is_empty() {
            return Err(PocketError::NothingToCut);
        }
        Ok(Self { boundary, islands, open, region })
    }
}

/// Whether arcs replace the lines of outlines: of those with very many.
pub fn is_fitted(area: &Outlines) -> bool {
    area.boundary.len() + area.islands.iter().map(Vec::len).sum::<usize>() > MOST_EXACT
}

/// The elements of an outline with arcs in place of runs of lines. Open lines stay lines.
fn with_arcs(elements: &[Segment], open: &Stretches, budget: &Budget) -> Result<Vec<Segment>, PocketError> {
    let mut fitted = Vec::new();
    let mut run: Vec<Point2<f64>> = Vec::new();
    for element in elements {
        match element {
            Segment::Line { start, end } if !open.has(element) => {
                if run.is_empty() {
                    run.push(*start);
                }
                run.push(*end);
            }
            _ => {
                fitted.extend(polyline::as_arcs(&std::mem::take(&mut run), FITTED_MM, budget)?);
                fitted.push(*element);
            }
        }
    }
    fitted.extend(polyline::as_arcs(&run, FITTED_MM, budget)?);
    Ok(fitted)
}
