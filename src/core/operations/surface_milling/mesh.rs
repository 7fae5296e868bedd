//! Plans the finishing of a mesh of triangles in passes along parallel planes.
//!
//! The CL curves are the tips of the cutter in contact with the mesh. Passes, links, proofs and figures are
//! those of any surface: each triangle is a patch. Upright walls and undersides are gouged by no move, but
//! what is left on them is not told: the cutter does not finish them from above.

use super::cl_cartesian::{CONTACT_HEIGHT_SHARE, Depth, Found, Milled, plan_with};
use super::deviation::Seam;
use super::job::CONTACT_SHARE;
use super::planes::{COARSE, ClCurves, raised, with_sections};
use super::scallop::LEAST_SHARE;
use super::{Boundary, Engine, Error, Job, Plan, Spacing};
use crate::budget::Budget;
use crate::geometry::surface::patch::FlatPatch;
use crate::geometry::surface::triangle_mesh::{TriangleMesh, facing_up};
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::mesh_contact::MeshContacts;
use crate::machining::mesh_contact::sections::MeshSections;
use crate::machining::offset_section::{Chain, PlaneAt, SectionError, Spacing as PointSpacing};
use crate::machining::regularity::Slope;

/// CL curves by direct contact of the cutter with a mesh, enlarged by the allowance `stock` mm.
struct MeshCurves<'a> {
    sections: MeshSections<'a>,
    stock: f64,
}

impl ClCurves for MeshCurves<'_> {
    fn reach(&self) -> [f64; 2] {
        self.sections.extent()
    }

    fn extent(&self, reach: [f64; 2], budget: &Budget) -> Result<[f64; 2], SectionError> {
        with_sections(reach, |at| self.sections.has_any(PlaneAt::new(at), COARSE, budget))
    }

    fn chains(
        &self,
        plane: PlaneAt,
        spacing: PointSpacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        Ok(raised(self.sections.chains(plane, spacing, budget)?, self.stock))
    }

    fn chains_over_edges(
        &self,
        plane: PlaneAt,
        spacing: PointSpacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        Ok(raised(self.sections.chains_over_edges(plane, spacing, budget)?, self.stock))
    }
}

/// Plans the passes on a mesh, whose triangles are `surface`.
///
/// # Errors
/// One of [`Error`]; no toolpath is returned with one.
pub(super) fn plan(
    mesh: &TriangleMesh,
    surface: &BezierSurface<FlatPatch>,
    job: &Job,
    budget: &Budget,
) -> Result<Plan, Error> {
    let is_plain = job.engine == Engine::Contact && job.boundary == Boundary::On;
    if !is_plain || matches!(job.spacing, Spacing::WirePitch(_)) {
        return Err(Error::NotForMeshes);
    }
    let part = facing_up(surface).ok_or(Error::NothingToCut)?;
    let (contacts, axis) = (MeshContacts::new(mesh, job.cutter()), job.plane.normal_axis());
    let sections = MeshSections::new(contacts, axis);
    let found = Found {
        curves: &MeshCurves { sections, stock: job.allowance_mm },
        milled: &Milled { part: &part, surface, contacts: &contacts },
        slopes: slopes(&part, axis),
        seam: Seam::NONE,
        chord_height_share: CONTACT_HEIGHT_SHARE,
        point_limit: (CONTACT_SHARE * job.point_limit as f64) as usize,
        depth: Depth::Tolerance,
    };
    plan_with(&found, job, budget)
}

/// Level ground, and the steepest triangle. The curvature for which triangles stand is not known.
fn slopes(part: &BezierSurface<FlatPatch>, axis: usize) -> Vec<Slope> {
    let share = |patch: &FlatPatch| {
        let normal = patch.jet(0.5, 0.5).normal().try_normalize(0.0)?;
        Some((1.0 - normal[axis] * normal[axis]).max(0.0).sqrt())
    };
    let steepest = part.patches().iter().filter_map(share).fold(1.0, f64::min).max(LEAST_SHARE);
    [1.0, steepest].map(|share| Slope { share, concavity: 0.0 }).to_vec()
}
