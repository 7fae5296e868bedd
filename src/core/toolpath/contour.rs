//! The toolpath along chains of curves that are cut once each. For each chain, the tool goes down at its
//! start, follows it, and goes up at its end.

use nalgebra::Point3;

use super::cutting::Cutting;
use super::linking::at_height;
use super::{PathError, Role, Toolpath};
use crate::geometry::curve::Curve;

/// The height of the part's top where nothing else gives it, mm. A higher point of the path counts as the top
/// instead.
pub const TOP_MM: f64 = 0.0;

/// Height above the part's top at which the tool crosses from chain to chain where there are no cutting
/// conditions, mm.
const LIFT_MM: f64 = 2.0;

/// Goes along each chain. Without cutting conditions no move has a feed, and a single chain has no moves
/// before or after it. Several chains are then joined by rapids a little above `top_mm`.
///
/// # Errors
/// When the curves of a chain do not follow each other.
pub fn contour(chains: &[Vec<Curve>], top_mm: f64, cutting: Option<&Cutting>) -> Result<Toolpath, PathError> {
    let is_lifted = cutting.is_some() || chains.len() > 1;
    let lifted_mm = cutting.map_or(top_mm + LIFT_MM, |cutting| cutting.retract_z_mm);
    let feed = |role: Role| cutting.map(|cutting| cutting.feed_of(role));
    let start = chains.iter().flatten().next().map_or(Point3::origin(), Curve::start);
    let mut builder = Toolpath::builder(if is_lifted { at_height(start, lifted_mm) } else { start });
    for chain in chains {
        let Some(first) = chain.first() else { continue };
        builder.begin_pass(None);
        if is_lifted {
            builder.rapid_over(first.start(), lifted_mm, lifted_mm)?;
            builder.line(first.start(), feed(Role::Plunge), Role::Plunge)?;
        }
        for curve in chain {
            builder.follow(*curve, feed(Role::Cut), Role::Cut)?;
        }
        if is_lifted {
            builder.rapid_to_height(lifted_mm)?;
        }
    }
    builder.finish()
}
