//! 3MF: a ZIP archive with models in XML, which hold objects of triangles and tell where each is placed.
//!
//! # Method
//! 1. The part `_rels/.rels` names the model (Open Packaging Conventions); `archive` unpacks the parts.
//! 2. `model` reads each model that is needed: objects are meshes, or assemblies of other objects; the build
//!    lists the objects that make the part. Objects in other parts of the archive (Production Extension) are
//!    read too.
//! 3. `placing` follows the build, and adds each object at its place. A mirrored object has the order of its
//!    corners reversed, so that outside stays outside.
//!
//! # Guarantees
//! * A model that requires an extension which is not read is refused, as the specification demands.
//! * Objects that contain themselves, and assemblies of too many objects, are refused.
//!
//! # Reference
//! 3MF Consortium, "3D Manufacturing Format, Core Specification", version 1.3; "Production Extension",
//! version 1.1.

mod document;
mod model;
mod placing;
mod tags;
mod zip;

use toolpathd_core::budget::Budget;

use super::welding::Welding;
use crate::fault::Unreadable;
use crate::unit::Unit;
use zip::Archive;

/// Bytes of unpacked models in any case.
const LEAST_UNPACKED: usize = 16 << 20;

/// Bytes of unpacked models for each triangle that may be read: a triangle and half a vertex take some 100.
const UNPACKED_PER_TRIANGLE: usize = 256;

/// Most bytes of unpacked models.
const MOST_UNPACKED: usize = 1 << 30;

pub fn read(
    bytes: &[u8],
    most_triangles: usize,
    welding: &mut Welding,
    budget: &Budget,
) -> Result<Unit, Unreadable> {
    let by_triangles = most_triangles.saturating_mul(UNPACKED_PER_TRIANGLE).saturating_add(LEAST_UNPACKED);
    let mut archive = Archive::of(bytes, by_triangles.min(MOST_UNPACKED))?;
    let models = document::read(&mut archive, most_triangles, &mut welding.left_out, budget)?;
    placing::place(&models, welding, budget)?;
    Ok(models.unit)
}
