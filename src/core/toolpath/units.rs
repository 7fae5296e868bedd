//! Feed rates and accelerations as two types of their own, so that a number of one kind cannot be taken for
//! the other. Each type has a legal range.

/// A feed rate in mm/min, finite and above zero.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct FeedRate(f64);

impl FeedRate {
    /// The traverse rate that is assumed for an unknown machine.
    pub const DEFAULT_RAPID: FeedRate = FeedRate(10_000.0);

    pub fn from_mm_per_min(value: f64) -> Option<Self> {
        (value.is_finite() && value > 0.0).then_some(Self(value))
    }

    pub fn mm_per_min(self) -> f64 {
        self.0
    }

    pub fn mm_per_s(self) -> f64 {
        self.0 / 60.0
    }
}

/// An acceleration in mm/s2, finite and above zero.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Acceleration(f64);

impl Acceleration {
    /// The acceleration that is assumed for an unknown machine: that of a mid-sized machining centre, a tenth
    /// of gravity.
    pub const DEFAULT: Acceleration = Acceleration(1000.0);

    pub fn from_mm_per_s2(value: f64) -> Option<Self> {
        (value.is_finite() && value > 0.0).then_some(Self(value))
    }

    pub fn mm_per_s2(self) -> f64 {
        self.0
    }
}

/// A tolerance in mm, in 1e-6..=10.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Tolerance(f64);

impl Tolerance {
    pub const MIN_MM: f64 = 1e-6;
    pub const MAX_MM: f64 = 10.0;

    pub fn from_mm(value: f64) -> Option<Self> {
        (Self::MIN_MM..=Self::MAX_MM).contains(&value).then_some(Self(value))
    }

    pub fn mm(self) -> f64 {
        self.0
    }
}

/// A bound in mm or degrees, rounded up to the four decimals that people are shown.
pub fn rounded_up(bound: f64) -> f64 {
    (bound * 1e4).ceil() / 1e4
}
