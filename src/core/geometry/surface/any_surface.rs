//! A surface whose patches may be of any of the supported types.

use super::{BezierSurface, BicubicPatch, Jet, RationalPatch, Surface};

/// Most patches of a surface of degree up to 3: about sixty megabytes.
pub const PATCH_LIMIT: usize = 125_000;
/// Most patches of a surface of a higher degree: also about sixty megabytes.
pub const HIGH_DEGREE_PATCH_LIMIT: usize = 30_000;

/// A surface of patches of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum AnySurface {
    Bicubic(BezierSurface<BicubicPatch>),
    /// Of degree up to 3.
    Rational(BezierSurface<RationalPatch<4>>),
    /// Of a higher degree, rational or not.
    HighDegree(BezierSurface<RationalPatch>),
}

impl AnySurface {
    /// The control points of all patches together.
    pub fn n_control_points(&self) -> usize {
        fn of<const N: usize>(patches: &[RationalPatch<N>]) -> usize {
            let points = |degree: [usize; 2]| degree.map(|degree| degree + 1).iter().product::<usize>();
            patches.iter().map(|patch| points(patch.degree())).sum()
        }
        match self {
            Self::Bicubic(surface) => 16 * surface.patches().len(),
            Self::Rational(surface) => of(surface.patches()),
            Self::HighDegree(surface) => of(surface.patches()),
        }
    }
}

impl Surface for AnySurface {
    fn spans(&self) -> [usize; 2] {
        match self {
            Self::Bicubic(surface) => surface.spans(),
            Self::Rational(surface) => surface.spans(),
            Self::HighDegree(surface) => surface.spans(),
        }
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        match self {
            Self::Bicubic(surface) => surface.jet(u, v),
            Self::Rational(surface) => surface.jet(u, v),
            Self::HighDegree(surface) => surface.jet(u, v),
        }
    }
}
