//! Finds where a section ends, by bisection between a position that counts and one that does not.

use super::{END_MM, HIGHER_MM, Probe, Trace};
use crate::geometry::surface::patch::Patch;
use crate::machining::drop_cutter::Contact;
use crate::machining::offset_section::SectionError;

/// Largest number of halvings between a position that counts and one that does not.
const HALVINGS: usize = 60;

impl<P: Patch> Trace<'_, P> {
    /// The last position that counts on the way from `counting` to `outside`, which does not count; and a
    /// position just beyond it.
    pub(super) fn last_counting(&self, counting: Contact, outside: f64) -> Result<[Probe; 2], SectionError> {
        // Mostly it is the last position to which Newton's method can follow the contact.
        let followed = self.last(counting, outside, |at, near| Ok(self.followed(at, near)))?;
        if let [Probe { at, contact: Some(last) }, beyond] = followed {
            let found = self.probe(at, Some(last.place))?.contact;
            let beyond = self.probe(beyond.at, Some(last.place))?;
            if found.is_some_and(|found| found.tip.z <= last.tip.z + HIGHER_MM) && beyond.contact.is_none() {
                return Ok([Probe { at, contact: found }, beyond]);
            }
        }
        self.last(counting, outside, |at, near| Ok(self.probe(at, Some(near))?.contact))
    }

    fn last(
        &self,
        mut counting: Contact,
        mut outside: f64,
        look: impl Fn(f64, [f64; 2]) -> Result<Option<Contact>, SectionError>,
    ) -> Result<[Probe; 2], SectionError> {
        for _ in 0..HALVINGS {
            let at = self.at(&counting);
            if (at - outside).abs() <= END_MM {
                break;
            }
            let middle = 0.5 * (at + outside);
            match look(middle, counting.place)? {
                Some(contact) => counting = contact,
                None => outside = middle,
            }
        }
        let last = Probe { at: self.at(&counting), contact: Some(counting) };
        Ok([last, Probe { at: outside, contact: None }])
    }
}
