//! The queue of a branch and bound search: each item has a bound, and the item with the largest bound leaves
//! the queue first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Items with their bounds.
#[derive(Debug)]
pub struct BestFirst<T> {
    heap: BinaryHeap<Entry>,
    items: Vec<Option<T>>,
    /// Indices in `items` whose items were taken.
    free: Vec<usize>,
}

#[derive(Debug, PartialEq)]
struct Entry {
    bound: f64,
    place: usize,
}

impl<T> Default for BestFirst<T> {
    fn default() -> Self {
        Self { heap: BinaryHeap::new(), items: Vec::new(), free: Vec::new() }
    }
}

impl<T> BestFirst<T> {
    pub fn push(&mut self, bound: f64, item: T) {
        let place = match self.free.pop() {
            Some(place) => {
                self.items[place] = Some(item);
                place
            }
            None => {
                self.items.push(Some(item));
                self.items.len() - 1
            }
        };
        self.heap.push(Entry { bound, place });
    }

    /// Takes the item with the largest bound.
    pub fn pop(&mut self) -> Option<(f64, T)> {
        let Entry { bound, place } = self.heap.pop()?;
        self.free.push(place);
        self.items[place].take().map(|item| (bound, item))
    }
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then(self.place.cmp(&other.place))
    }
}
