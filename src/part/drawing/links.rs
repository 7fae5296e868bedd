//! Which ends of open curves are joined.
//!
//! # Method
//! 1. Ends in exactly one place are joined if there are two of them. Where there are more, the place is a
//!    branch.
//! 2. Of the ends that are alone in their places, the two nearest to each other are joined, then the next
//!    two, up to the gap.
//! 3. At each branch, a chain that ends nowhere is taken away, because it bounds nothing; a chain that leaves
//!    the branch and returns to it is closed; and if two ends remain, they are joined. This is repeated until
//!    nothing changes. Where more ends than two remain, they are joined around faces ([`faces`]), or stay
//!    open: any choice among them would be a guess.
//! 4. An end that is still alone may lie within the gap of two joined ends whose chain is open. The three are
//!    then a branch, as in step 3. The two are joined again if that leads to no other pair.
//!
//! The result depends neither on the order of the curves nor on their directions, except where two pairs of
//! ends are equally far apart and in the same places.
//!
//! # Cost
//! O(n log n), and one step for each pair of lone ends within the gap. Their number is limited.

use std::collections::{BTreeMap, HashMap};

use toolpathd_core::budget::Budget;

use super::Branch;
use super::faces::{self, Leaving};
use super::grid::Grid;
use crate::fault::{Place, Unreadable};

/// The most pairs of ends within the gap, for each end and at least. More mean that the gap is larger than
/// the details of the drawing.
const PAIRS_AN_END: usize = 50;
const PAIRS_AT_LEAST: usize = 100_000;

/// How far ends of one place may lie apart by rounding, as a part of the largest coordinate: they are
/// computed from angles, or moved with a block. Such a distance is no gap.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A curve whose ends are joined to each other is longer than this many times the gap.
const LEAST_LENGTH: f64 = 4.0;

/// The ends of open curves: curve k starts at end 2 k and ends at end 2 k + 1.
#[derive(Debug, Clone)]
pub struct Links {
    pub places: Vec<[f64; 2]>,
    pub mates: Vec<Option<usize>>,
    rounding_mm: f64,
    /// The largest gap, where it is more than rounding.
    pub bridged_max_mm: f64,
    pub branches: Vec<Branch>,
    /// The end at the other side of the chain, for each end of a chain.
    opposite: Vec<usize>,
    /// The ends that were alone in their places.
    lone: Vec<usize>,
}

/// What an end is like besides its place.
#[derive(Debug, Clone, Copy)]
pub struct EndOf {
    /// Whether the place is one that the file has.
    pub is_written: bool,
    /// The length of the curve.
    pub length_mm: f64,
    /// The area between the origin and the curve that starts at this end, as in [`faces::joints`].
    pub swept_mm2: f64,
    pub leaving: Leaving,
}

/// # Errors
/// When there are too many pairs of ends within the gap, or the budget ends.
pub fn links(
    places: Vec<[f64; 2]>,
    ends: &[EndOf],
    gap_mm: f64,
    budget: &Budget,
) -> Result<Links, Unreadable> {
    let n = places.len();
    let largest = places.as_flattened().iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let rounding_mm = ROUNDING * largest;
    let gap_mm = gap_mm.max(rounding_mm);
    let mut links = Links {
        places,
        mates: vec![None; n],
        rounding_mm,
        bridged_max_mm: 0.0,
        branches: Vec::new(),
        opposite: (0..n).map(|end| end ^ 1).collect(),
        lone: Vec::new(),
    };
    let (lone, branches) = links.join_in_places();
    budget.check()?;
    links.join_within_gap(&lone, ends, gap_mm, budget)?;
    links.resolve(branches, ends);
    links.lone = lone;
    links.reconsider(ends, gap_mm);
    Ok(links)
}

impl Links {
    /// Joins two ends of chains.
    fn join(&mut self, [a, b]: [usize; 2]) {
        self.mates[a] = Some(b);
        self.mates[b] = Some(a);
        let [far_a, far_b] = [self.opposite[a], self.opposite[b]];
        self.opposite[far_a] = far_b;
        self.opposite[far_b] = far_a;
    }

    fn bridge(&mut self, distance_mm: f64) {
        if distance_mm > self.rounding_mm {
            self.bridged_max_mm = self.bridged_max_mm.max(distance_mm);
        }
    }

    /// Joins two ends in one place. Returns the ends that are alone in theirs, and those of each branch.
    fn join_in_places(&mut self) -> (Vec<usize>, Vec<Vec<usize>>) {
        let mut order: Vec<usize> = (0..self.places.len()).collect();
        order.sort_by(|a, b| compare(self.places[*a], self.places[*b]));
        let (mut lone, mut branches) = (Vec::new(), Vec::new());
        let mut rest = order.as_slice();
        while let Some(first) = rest.first() {
            let place = self.places[*first];
            let count = rest.iter().take_while(|end| self.places[**end] == place).count();
            let (here, others) = rest.split_at(count);
            match here {
                [one] => lone.push(*one),
                [a, b] => self.join([*a, *b]),
                more => branches.push(more.to_vec()),
            }
            rest = others;
        }
        (lone, branches)
    }

    fn join_within_gap(
        &mut self,
        lone: &[usize],
        ends: &[EndOf],
        gap_mm: f64,
        budget: &Budget,
    ) -> Result<(), Unreadable> {
        if gap_mm == 0.0 {
            return Ok(());
        }
        let grid = Grid::new(lone.iter().map(|end| (*end, self.places[*end])), gap_mm);
        let most = PAIRS_AT_LEAST.max(PAIRS_AN_END * lone.len());
        let mut pairs: Vec<(f64, [usize; 2])> = Vec::new();
        for end in lone {
            budget.check()?;
            for other in grid.near(self.places[*end]) {
                let distance = distance(self.places[*end], self.places[other]);
                let is_own = other == *end ^ 1 && ends[*end].length_mm <= LEAST_LENGTH * gap_mm;
                if other <= *end || distance > gap_mm || is_own {
                    continue;
                }
                pairs.push((distance, self.in_order([*end, other])));
                if pairs.len() > most {
                    let detail = format!(
                        "more than {most} pairs of ends lie within the gap of {gap_mm} mm; use a smaller gap"
                    );
                    return Err(Unreadable::at(Place::File, detail));
                }
            }
        }
        let place = |end: usize| self.places[end];
        pairs.sort_by(|(near, [a, b]), (far, [c, d])| {
            near.total_cmp(far)
                .then_with(|| compare(place(*a), place(*c)))
                .then_with(|| compare(place(*b), place(*d)))
        });
        for (distance, [a, b]) in pairs {
            if self.mates[a].is_none() && self.mates[b].is_none() {
                let joint = joint([a, b].map(|end| (self.places[end], ends[end].is_written)));
                self.join([a, b]);
                self.places[a] = joint;
                self.places[b] = joint;
                self.bridge(distance);
            }
        }
        Ok(())
    }

    /// The two ends, the one with the lesser place first.
    fn in_order(&self, [a, b]: [usize; 2]) -> [usize; 2] {
        if compare(self.places[a], self.places[b]).is_gt() { [b, a] } else { [a, b] }
    }

    /// Joins ends at branches as far as there is no choice, and tells the branches.
    fn resolve(&mut self, branches: Vec<Vec<usize>>, ends: &[EndOf]) {
        let remaining = self.join_at(branches.clone());
        let joints = {
            let swept = |end: usize| {
                let mut area = ends[end].swept_mm2;
                let mut at = end ^ 1;
                while let Some(next) = self.mates[at] {
                    area += ends[next].swept_mm2;
                    at = next ^ 1;
                }
                area
            };
            faces::joints(&remaining, |end| ends[end].leaving, |end| self.opposite[end], swept)
        };
        for joint in joints {
            self.join(joint);
        }
        for ends in branches {
            let n_open = ends.iter().filter(|end| self.mates[**end].is_none()).count();
            self.branches.push(Branch { at: self.places[ends[0]], n_ends: ends.len(), n_open });
        }
    }

    /// Joins ends at branches where there is no choice. Returns the ends at each branch that has a choice.
    fn join_at(&mut self, mut branches: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
        let mut branch_of: HashMap<usize, usize> = HashMap::new();
        for (number, ends) in branches.iter().enumerate() {
            branch_of.extend(ends.iter().map(|end| (*end, number)));
        }
        let mut waiting: Vec<usize> = (0..branches.len()).collect();
        while let Some(number) = waiting.pop() {
            let mut remaining = Vec::new();
            for end in std::mem::take(&mut branches[number]) {
                if self.mates[end].is_some() {
                    continue;
                }
                let other = self.opposite[end];
                match branch_of.get(&other) {
                    Some(same) if *same == number => {
                        branch_of.remove(&end);
                        branch_of.remove(&other);
                        self.join([end, other]);
                    }
                    Some(_) => remaining.push(end),
                    None => {
                        branch_of.remove(&end);
                    }
                }
            }
            if let [a, b] = remaining[..] {
                waiting.extend([a, b].iter().filter_map(|end| branch_of.get(&self.opposite[*end])));
                branch_of.remove(&a);
                branch_of.remove(&b);
                self.join([a, b]);
                remaining.clear();
            } else if let [end] = remaining[..] {
                // It ends here, and so the chain ends nowhere.
                waiting.extend(branch_of.get(&self.opposite[end]));
                branch_of.remove(&end);
                remaining.clear();
            }
            branches[number] = remaining;
        }
        for ends in &mut branches {
            ends.retain(|end| self.mates[*end].is_none());
        }
        branches.retain(|ends| !ends.is_empty());
        branches
    }

    /// Joins lone ends with ends that were joined to others, where the chain of these is open.
    fn reconsider(&mut self, ends: &[EndOf], gap_mm: f64) {
        let left = self.left();
        if left.is_empty() || gap_mm == 0.0 {
            return;
        }
        let pairs = self.pairs_on_open_chains();
        let grid = Grid::new(pairs.iter().map(|end| (*end, self.places[*end])), gap_mm);
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for lone in left {
            let place = self.places[lone];
            let is_short = ends[lone].length_mm <= LEAST_LENGTH * gap_mm;
            let is_own = |pair: usize| is_short && (pair == lone ^ 1 || self.mates[pair] == Some(lone ^ 1));
            let near = grid
                .near(place)
                .map(|pair| (distance(self.places[pair], place), pair))
                .filter(|(distance, pair)| *distance <= gap_mm && !is_own(*pair))
                .min_by(|(near, a), (far, b)| {
                    near.total_cmp(far).then_with(|| compare(self.places[*a], self.places[*b]))
                });
            if let Some((_, pair)) = near {
                groups.entry(pair).or_default().push(lone);
            }
        }
        let mut branches = Vec::new();
        for (a, lone) in groups {
            let Some(b) = self.mates[a].take() else { continue };
            self.mates[b] = None;
            branches.push([vec![a, b], lone].concat());
        }
        self.follow_chains();
        self.join_at(branches.clone());
        for branch in branches {
            let [a, b] = [branch[0], branch[1]];
            if self.mates[a].is_none() && self.mates[b].is_none() {
                self.join([a, b]);
            }
            let at = self.places[a];
            let n_open = branch.iter().filter(|end| self.mates[**end].is_none()).count();
            let moved: Vec<usize> =
                branch[2..].iter().copied().filter(|end| self.mates[*end].is_some()).collect();
            for end in &moved {
                self.bridge(distance(self.places[*end], at));
                self.places[*end] = at;
            }
            if !moved.is_empty() {
                self.branches.push(Branch { at, n_ends: branch.len(), n_open });
            }
        }
    }

    /// One end of each joined pair on a chain that is open.
    fn pairs_on_open_chains(&self) -> Vec<usize> {
        let mut pairs = Vec::new();
        for start in (0..self.mates.len()).filter(|end| self.mates[*end].is_none()) {
            let mut at = start;
            while let Some(next) = self.mates[at ^ 1] {
                pairs.push(next.min(at ^ 1));
                at = next;
            }
        }
        // Each chain is walked from both of its ends.
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Finds the opposite ends of all open chains.
    fn follow_chains(&mut self) {
        for start in 0..self.mates.len() {
            if self.mates[start].is_none() {
                let mut at = start ^ 1;
                while let Some(next) = self.mates[at] {
                    at = next ^ 1;
                }
                self.opposite[start] = at;
            }
        }
    }

    /// The lone ends that are joined to no other.
    fn left(&self) -> Vec<usize> {
        self.lone.iter().copied().filter(|end| self.mates[*end].is_none()).collect()
    }

    /// A lone end within the gap of joined ends or of a branch is a branch as well.
    pub fn tell_lone_ends_beside_others(&mut self, gap_mm: f64) {
        let left = self.left();
        if left.is_empty() || gap_mm == 0.0 {
            return;
        }
        let mut places: Vec<[f64; 2]> = self.places.clone();
        places.sort_by(|a, b| compare(*a, *b));
        places.dedup();
        let grid = Grid::new(places.iter().copied().enumerate(), gap_mm);
        for end in left {
            let own = self.places[end];
            let beside = grid.near(own).find(|other| {
                let is_near = distance(places[*other], own) <= gap_mm;
                is_near && places[*other] != own && places[*other] != self.places[end ^ 1]
            });
            if beside.is_some() {
                self.branches.push(Branch { at: own, n_ends: 3, n_open: 1 });
            }
        }
    }
}

/// Where two ends are joined: at the one that the file has, or halfway.
fn joint([(a, a_is_written), (b, b_is_written)]: [([f64; 2], bool); 2]) -> [f64; 2] {
    match (a_is_written, b_is_written) {
        (true, false) => a,
        (false, true) => b,
        _ => [0.5 * a[0] + 0.5 * b[0], 0.5 * a[1] + 0.5 * b[1]],
    }
}

fn compare(a: [f64; 2], b: [f64; 2]) -> std::cmp::Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    f64::hypot(b[0] - a[0], b[1] - a[1])
}
