//! What a reader leaves out of a file.

use super::fault::Place;

/// Entities of one kind that were left out for one reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// The kind, as the file writes it, such as `TEXT`.
    pub kind: String,
    /// Why, as a clause for people: `texts are no outlines`.
    pub reason: String,
    /// How many there are; at least 1.
    pub count: usize,
    /// The place of the first.
    pub first: Place,
}

/// Collects what is left out, by kind and reason, in the order of the first places.
#[derive(Debug, Clone, Default)]
pub struct LeftOuts(Vec<LeftOut>);

impl LeftOuts {
    /// Counts one entity.
    pub fn add(&mut self, kind: &str, reason: &str, place: Place) {
        match self.0.iter_mut().find(|one| one.kind == kind && one.reason == reason) {
            Some(one) => one.count += 1,
            None => {
                let (kind, reason) = (kind.to_owned(), reason.to_owned());
                self.0.push(LeftOut { kind, reason, count: 1, first: place });
            }
        }
    }

    pub fn list(self) -> Vec<LeftOut> {
        self.0
    }
}
