//! A surface given as a grid of bicubic Bezier control nets.

use nalgebra::Point3;

use super::bezier::BezierSurface;
use super::patch::BicubicPatch;

/// The control net of one patch, `net[a][b]`, a along u; mm.
pub type ControlNet = [[Point3<f64>; 4]; 4];

/// Nets `nets[i][j]`, i along u. Neighbouring nets share their boundaries; mm.
#[derive(Debug, Clone, PartialEq)]
pub struct NetGrid {
    pub nets: Vec<Vec<ControlNet>>,
}

/// Why the nets make no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NetGridError {
    #[error("the surface has no patches; it needs at least one")]
    Empty,
    #[error("row {row} has {found} patches where row 0 has {expected}")]
    Ragged { row: usize, found: usize, expected: usize },
    #[error("patch [{i}][{j}] has a control point that is not finite")]
    NotFinite { i: usize, j: usize },
}

impl NetGrid {
    /// The surface of the nets. Whether neighbours meet is not checked here, but by
    /// [`joints`](super::joints).
    ///
    /// # Errors
    /// When there is no patch, a row is longer or shorter than the first row, or a number is not finite.
    pub fn surface(&self) -> Result<BezierSurface, NetGridError> {
        let columns = self.nets.first().map_or(0, Vec::len);
        if columns == 0 {
            return Err(NetGridError::Empty);
        }
        for (row, nets) in self.nets.iter().enumerate() {
            if nets.len() != columns {
                return Err(NetGridError::Ragged { row, found: nets.len(), expected: columns });
            }
            let is_finite = |net: &ControlNet| net.iter().flatten().all(|p| p.iter().all(|x| x.is_finite()));
            if let Some(j) = nets.iter().position(|net| !is_finite(net)) {
                return Err(NetGridError::NotFinite { i: row, j });
            }
        }
        Ok(BezierSurface::from_fn([self.nets.len(), columns], |i, j| BicubicPatch {
            net: self.nets[i][j].map(|row| row.map(|p| p.coords)),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_grid_is_refused_with_the_place_of_its_fault() {
        let net = [[Point3::origin(); 4]; 4];
        let surface = |nets: Vec<Vec<ControlNet>>| NetGrid { nets }.surface();
        assert!(surface(vec![vec![net]]).is_ok());
        assert_eq!(surface(vec![]), Err(NetGridError::Empty));
        assert_eq!(surface(vec![vec![], vec![]]), Err(NetGridError::Empty));
        let ragged = surface(vec![vec![net, net], vec![net]]);
        assert_eq!(ragged, Err(NetGridError::Ragged { row: 1, found: 1, expected: 2 }));
        let mut broken = net;
        broken[3][1].z = f64::INFINITY;
        assert_eq!(surface(vec![vec![net, broken]]), Err(NetGridError::NotFinite { i: 0, j: 1 }));
    }
}
