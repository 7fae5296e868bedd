//! Decides whether a section runs through a contact.

use super::TipSections;
use crate::geometry::surface::patch::Patch;
use crate::machining::drop_cutter::Contact;

/// Distance from the rim of the flat, as a share of the flat's radius, up to which a contact counts as on the
/// rim. Rounding hides how steep it is.
const ON_RIM: f64 = 1e-6;

/// Slope up to which a cutter that touches an edge alone follows it. On a steeper contact a ball would dip
/// far below the edge.
const ROLLING_SLOPE: f64 = 1.0;

/// Which contacts count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Counting {
    /// Those through which a section runs.
    Touching,
    /// Those too at which the cutter touches an edge of the surface alone.
    Rolling,
}

impl<P: Patch> TipSections<'_, P> {
    /// Whether a section runs through a contact. It does not where the cutter touches an edge at which the
    /// surface ends. Where the cutter stands level, it does only while its axis is over the surface.
    pub(super) fn counts(&self, counting: Counting, contact: &Contact) -> bool {
        let contacts = self.contacts;
        if counting == Counting::Rolling {
            let along = 1 - self.axis;
            let ends = contacts.bounds().min[along]..=contacts.bounds().max[along];
            return contact.slope <= ROLLING_SLOPE && ends.contains(&contact.tip[along]);
        }
        if contact.is_rolling {
            return false;
        }
        let is_level = contact.slope <= contacts.level_slope() && {
            let off = (contact.point - contact.tip).xy().norm();
            let [flat, corner] = [contacts.cutter.flat_radius(), contacts.cutter.corner_radius()];
            off < (1.0 - ON_RIM) * flat || flat > 0.0 && (corner > 0.0 || contacts.is_level_at(contact.place))
        };
        !is_level || contacts.is_over(contact)
    }
}
