//! How long the steps of a walk are: longer where they succeed, shorter where they fail.

/// Tips this near to each other may be at any height: the wall between them is upright.
pub(super) const SHORTEST_STEP_MM: f64 = 1e-6;

/// The first step of a section, in parts of what is large.
const FIRST_STEP: f64 = 0.05;

/// How steps grow near the longest that is possible, and far below it: after so many in a row.
const GROWTH: f64 = 1.05;
const GROWTH_FAR: f64 = 1.4;
const FAR: usize = 8;
const SHRINKAGE: f64 = 0.8;

/// How long steps are.
pub(super) struct Pace {
    pub(super) step: f64,
    longest: f64,
    /// Failures and successes in a row.
    pub(super) failures: usize,
    successes: usize,
}

impl Pace {
    pub(super) fn new(scale: f64, step_length: f64) -> Self {
        let longest = step_length.min(scale);
        Self { step: longest.min(FIRST_STEP * scale), longest, failures: 0, successes: 0 }
    }

    pub(super) fn is_shortest(&self) -> bool {
        self.step <= SHORTEST_STEP_MM
    }

    pub(super) fn quicken(&mut self) {
        (self.failures, self.successes) = (0, self.successes + 1);
        self.step = (self.step * if self.successes > FAR { GROWTH_FAR } else { GROWTH }).min(self.longest);
    }

    pub(super) fn slow(&mut self) {
        (self.failures, self.successes) = (self.failures + 1, 0);
        self.step = (self.step * SHRINKAGE).max(SHORTEST_STEP_MM);
    }
}
