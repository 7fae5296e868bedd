//! Walks an assembly from its top to the items of its parts.
//!
//! # Degenerate input
//! An assembly that contains itself is refused, as is one that is nested too deep or has too many copies.

use std::collections::{BTreeMap, BTreeSet};

use toolpathd_core::budget::Budget;

use super::frame::Similarity;
use super::units::Units;
use crate::fault::{Place, Unreadable};

/// The deepest nesting of assemblies.
const DEEPEST: usize = 64;

/// The most placed items of a file, with all copies.
const MOST_ITEMS: usize = 200_000;

/// An item of a representation at its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedItem {
    pub item: u32,
    pub units: Units,
    pub by: Similarity,
}

/// A use of a node in another.
#[derive(Debug, Clone, Copy)]
pub struct Use {
    pub child: u32,
    pub by: Similarity,
}

/// What an assembly has.
#[derive(Debug, Clone, Default)]
pub struct Found {
    pub items: Vec<PlacedItem>,
    /// The nodes of parts without a shape, once for each place.
    pub empty: Vec<u32>,
}

/// The way from the top, and what was found on all ways.
pub struct Walk<'a> {
    uses: &'a BTreeMap<u32, Vec<Use>>,
    items: &'a BTreeMap<u32, Vec<PlacedItem>>,
    budget: &'a Budget,
    path: Vec<u32>,
    visited: BTreeSet<u32>,
    found: Found,
    n_visits: usize,
}

impl<'a> Walk<'a> {
    /// The items of all nodes, from the nodes that no other uses on.
    ///
    /// # Errors
    /// A node contains itself, the limits are exceeded, or the budget has ended.
    pub fn over(
        uses: &'a BTreeMap<u32, Vec<Use>>,
        items: &'a BTreeMap<u32, Vec<PlacedItem>>,
        nodes: &BTreeSet<u32>,
        budget: &'a Budget,
    ) -> Result<Found, Unreadable> {
        let used: BTreeSet<u32> = uses.values().flatten().map(|one| one.child).collect();
        let found = Found::default();
        let (path, visited) = (Vec::new(), BTreeSet::new());
        let mut walk = Self { uses, items, budget, path, visited, found, n_visits: 0 };
        for top in nodes.difference(&used) {
            walk.place(*top, &Similarity::identity())?;
        }
        match nodes.iter().find(|node| !walk.visited.contains(*node)) {
            None => Ok(walk.found),
            Some(node) => Err(contains_itself(*node)),
        }
    }

    fn place(&mut self, node: u32, by: &Similarity) -> Result<(), Unreadable> {
        self.budget.check()?;
        let place = Place::Entity(u64::from(node));
        if self.path.contains(&node) {
            return Err(contains_itself(node));
        }
        if self.path.len() == DEEPEST {
            return Err(Unreadable::at(place, format!("assemblies are nested more than {DEEPEST} deep")));
        }
        let items = self.items.get(&node).map_or(&[][..], Vec::as_slice);
        let uses = self.uses.get(&node).map_or(&[][..], Vec::as_slice);
        self.n_visits += 1;
        if self.n_visits.max(self.found.items.len() + items.len()) > MOST_ITEMS {
            return Err(Unreadable::at(place, format!("there are more than {MOST_ITEMS} placed items")));
        }
        self.visited.insert(node);
        self.found.items.extend(items.iter().map(|item| PlacedItem { by: *by, ..*item }));
        if items.is_empty() && uses.is_empty() && !self.path.is_empty() {
            self.found.empty.push(node);
        }
        self.path.push(node);
        for one in uses {
            self.place(one.child, &by.after(&one.by))?;
        }
        self.path.pop();
        Ok(())
    }
}

fn contains_itself(node: u32) -> Unreadable {
    let detail = "the representation contains itself through others";
    Unreadable::at(Place::Entity(u64::from(node)), detail)
}
