//! The part that stays: a surface, or the walls and the floor of a pocket.

use nalgebra::Vector3;

use super::motions::farthest;
use super::{Error, Owner, Part, region};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::Curve;
use crate::geometry::surface::Patch;
use crate::geometry::surface::any_surface::AnySurface;
use crate::machining::cutter::Cutter;
use crate::machining::gouge::{GougeProof, Penetration};
use crate::machining::prism::{Asked, Material, Prism, depth_in_floor};

/// A part, ready for proofs.
pub(super) enum PartProof {
    Surface { surface: AnySurface, allowance_mm: f64 },
    Pocket { walls: Prism, floor_mm: f64 },
}

/// How deep a tool enters the part on one curve.
pub(super) trait Depths: Sync {
    /// # Errors
    /// Only the budget's stop.
    fn penetration(
        &self,
        tip: &Curve,
        slack: f64,
        gap: f64,
        known: Penetration,
        budget: &Budget,
    ) -> Result<Penetration, Stopped>;
}

impl PartProof {
    pub(super) fn new(part: &Part, budget: &Budget) -> Result<Self, Error> {
        Ok(match part {
            Part::Surface { source, allowance_mm } => {
                Self::Surface { surface: source.surface()?, allowance_mm: *allowance_mm }
            }
            Part::Pocket { outlines, top_mm, floor_mm } => {
                let region = region(outlines, Owner::Part, budget)?;
                let walls = Prism { region, material: Material::Outside, top_mm: *top_mm };
                Self::Pocket { walls, floor_mm: *floor_mm }
            }
        })
    }

    /// How deep the moves of a cutter enter the part. A surface is grown by `by` mm along its normals.
    pub(super) fn depths(&self, cutter: &Cutter, by: f64) -> Box<dyn Depths + '_> {
        match self {
            Self::Surface { surface, allowance_mm } => {
                let by = by + allowance_mm;
                match surface {
                    AnySurface::Bicubic(surface) => Box::new(GougeProof::new(surface, cutter, by)),
                    AnySurface::Rational(surface) => Box::new(GougeProof::new(surface, cutter, by)),
                    AnySurface::HighDegree(surface) => Box::new(GougeProof::new(surface, cutter, by)),
                }
            }
            Self::Pocket { walls, floor_mm } => {
                Box::new(PocketProof { walls, floor_mm: *floor_mm, cutter: *cutter })
            }
        }
    }
}

impl<P: Patch> Depths for GougeProof<'_, P> {
    fn penetration(
        &self,
        tip: &Curve,
        slack: f64,
        gap: f64,
        known: Penetration,
        budget: &Budget,
    ) -> Result<Penetration, Stopped> {
        let mut deepest = known;
        self.penetrate(tip, slack, gap, &mut deepest, budget)?;
        Ok(deepest)
    }
}

/// The walls and the floor of a pocket, for one cutter.
struct PocketProof<'a> {
    walls: &'a Prism,
    floor_mm: f64,
    cutter: Cutter,
}

impl Depths for PocketProof<'_> {
    fn penetration(
        &self,
        tip: &Curve,
        slack: f64,
        gap: f64,
        known: Penetration,
        budget: &Budget,
    ) -> Result<Penetration, Stopped> {
        let asked =
            Asked { slack_mm: slack, gap_mm: gap, enough_mm: known.bound_mm.max(known.found_mm + gap) };
        let of_walls = self.walls.depth(&self.cutter, tip, asked, budget)?;
        let walls = Penetration {
            bound_mm: of_walls.bound.max(0.0),
            found_mm: of_walls.found.max(0.0),
            at: of_walls.at,
        };
        let lowest = farthest(tip, 2, -1.0);
        let least = -tip.support(&-Vector3::z());
        let depth = |z: f64| depth_in_floor(&self.cutter, self.floor_mm, z).max(0.0);
        let floor =
            Penetration { bound_mm: depth(least - slack), found_mm: depth(lowest.z), at: Some(lowest) };
        let own = walls.or_deeper(floor);
        Ok(known.or_deeper(Penetration { at: own.at.filter(|_| own.found_mm > 0.0), ..own }))
    }
}
