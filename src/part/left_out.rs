//! What a reader leaves out of a file.

use std::collections::HashMap;

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

/// Collects what is left out, by kind and reason.
#[derive(Debug, Clone, Default)]
pub struct LeftOuts {
    /// In the order in which their first entities were added.
    found: Vec<LeftOut>,
    /// Kind and reason, to the place in `found`.
    places: HashMap<(String, String), usize>,
}

impl LeftOuts {
    /// Counts one entity.
    pub fn add(&mut self, kind: &str, reason: &str, place: Place) {
        self.add_many(kind, reason, 1, place);
    }

    /// Counts entities, of which the first is at `place`.
    pub fn add_many(&mut self, kind: &str, reason: &str, count: usize, place: Place) {
        if count == 0 {
            return;
        }
        let key = (kind.to_owned(), reason.to_owned());
        match self.places.get(&key) {
            Some(known) => self.found[*known].count += count,
            None => {
                let (kind, reason) = key.clone();
                self.places.insert(key, self.found.len());
                self.found.push(LeftOut { kind, reason, count, first: place });
            }
        }
    }

    /// What was left out, in the order in which the first entity of each kind and reason was added.
    pub fn list(self) -> Vec<LeftOut> {
        self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entities_are_counted_by_kind_and_reason_in_the_order_of_the_first() {
        let mut left_out = LeftOuts::default();
        for (line, kind, reason) in
            [(4, "TEXT", "a"), (2, "HATCH", "a"), (7, "TEXT", "b"), (1, "HATCH", "a"), (9, "TEXT", "a")]
        {
            left_out.add(kind, reason, Place::Line(line));
        }
        let list = left_out.list();
        let found: Vec<_> =
            list.iter().map(|one| (one.kind.as_str(), one.reason.as_str(), one.count, one.first)).collect();
        let expected = [
            ("TEXT", "a", 2, Place::Line(4)),
            ("HATCH", "a", 2, Place::Line(2)),
            ("TEXT", "b", 1, Place::Line(7)),
        ];
        assert_eq!(found, expected);
    }
}
