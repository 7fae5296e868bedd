//! What a control runs as a curve, as data.

use super::super::arc_rule::ArcRule;
use crate::geometry::curve::Arc;
use crate::geometry::plane::Plane;

/// The largest radius of an arc, mm, on controls that state none: some have run whole circles instead of
/// arcs of larger radius.
const USUAL_LARGEST_RADIUS_MM: f64 = 1e4;

/// Factor by which rounding may raise the radius of an arc that was made with the largest radius.
const RADIUS_ROUNDING: f64 = 1.0 + 1e-9;

/// Half a unit of the angle of a helix, radians: controls read ten-thousandths of a degree.
const HELIX_ANGLE: f64 = 0.5e-4 * std::f64::consts::PI / 180.0;

/// How far rounding the angle may move the end of a helix, in steps. A helix of larger radius becomes chords.
const HELIX_STEPS: f64 = 0.25;

/// The curves that a control runs. All others are written as lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curves {
    pub arcs: Arcs,
    pub parabolas: Parabolas,
    /// The largest difference of the radii at the ends of an arc that is written, mm. No more than `accepts`
    /// allows.
    pub radius_mismatch_mm: f64,
    /// What the control demands of an arc.
    pub accepts: ArcRule,
    /// The largest radius of an arc, mm. Arcs of larger radius are written as chords.
    pub largest_radius_mm: f64,
}

impl Curves {
    /// Arcs in all planes, and helices, on a control that accepts as little as most do: with few decimals one
    /// step is more than that.
    pub const ARCS: Self = Self {
        arcs: Arcs::WithHelices,
        parabolas: Parabolas::AsLines,
        radius_mismatch_mm: 0.015,
        accepts: ArcRule::USUAL,
        largest_radius_mm: USUAL_LARGEST_RADIUS_MM,
    };

    /// Whether the control runs `arc` as an arc.
    pub(super) fn run(&self, arc: &Arc, step_mm: f64) -> bool {
        match self.arcs {
            _ if arc.radius() > RADIUS_ROUNDING * self.largest_radius_mm => false,
            Arcs::AsLines => false,
            Arcs::WithHelicesAboutZ => {
                let is_exact = arc.radius() * HELIX_ANGLE <= HELIX_STEPS * step_mm;
                !is_helix(arc) || arc.plane() == Plane::Xy && is_exact
            }
            Arcs::WithHelices => true,
        }
    }

    /// How much of the accepted distance the angle of a written arc needs, in steps.
    pub(super) fn reserved_steps(&self, arc: &Arc) -> f64 {
        let states_angle = self.arcs == Arcs::WithHelicesAboutZ && is_helix(arc);
        if states_angle { HELIX_STEPS } else { 0.0 }
    }
}

fn is_helix(arc: &Arc) -> bool {
    let [_, _, normal] = arc.plane().axes();
    arc.start()[normal] != arc.end()[normal]
}

/// The arcs that a dialect writes as arcs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), serde(rename_all = "snake_case"))]
pub enum Arcs {
    /// No arcs: all become lines.
    AsLines,
    /// Arcs in the planes XY, ZX and YZ, and helices about Z, of which a block states the angle instead of
    /// the end.
    WithHelicesAboutZ,
    /// Arcs in the planes XY, ZX and YZ, and helices.
    WithHelices,
}

/// Which parabolas are written as parabolas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parabolas {
    /// None: all parabolas become lines.
    AsLines,
    /// The parabolas that lie at one height.
    InXy,
}
