//! The raw part as a program states it: corners on the grid, around the box.

use super::{ProgramJob, WriteError};
use toolpathd_core::toolpath::program::Blank;
use toolpathd_core::toolpath::quantize::Grid;

/// The lowest and the highest corner, in steps. `None` where the program states none.
pub fn corners(job: &ProgramJob) -> Result<Option<[[i64; 3]; 2]>, WriteError> {
    let Some(Blank { low, high }) = job.program.blank.filter(|_| job.dialect.states_blank()) else {
        return Ok(None);
    };
    let grid = Grid::new(job.program.resolution);
    // Not quite half a step: a corner on the grid stays there.
    let half = 0.499_999 * grid.step_mm();
    let (low, high) = (grid.round(&low.map(|mm| mm - half))?, grid.round(&high.map(|mm| mm + half))?);
    // A control refuses a box without a volume.
    let has_volume = low.iter().zip(high).all(|(low, high)| *low < high);
    Ok(has_volume.then_some([low, high]))
}
