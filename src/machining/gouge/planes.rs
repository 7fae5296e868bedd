//! What planes show of the depth of a part in the cutter.

use nalgebra::Vector3;

/// A sharp rim in a slope reaches farther below the surface than any point of it is deep in the cutter, by up
/// to the root of 2. The larger counts: what other m show counts where it is less than this part of what the
/// part's normal shows.
const OTHER_SHARE: f64 = 0.6;

/// What a plane at right angles to m shows.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    pub(super) m: Vector3<f64>,
    /// The depth of the centre of the part, mm.
    pub(super) at_center: f64,
    /// The depth of the whole part, mm.
    pub(super) bound: f64,
}

/// What planes at right angles to several m show of a part.
pub(super) struct Planes {
    /// Depths below this do not matter, mm.
    enough: f64,
    /// By the m against the part's normal: it shows how far the cutter reaches below the part.
    along_normal: Option<Shown>,
    /// The least by any other.
    other: Option<Shown>,
    count: usize,
    /// The one that is halved along: the first, or a later one that shows clearly less.
    halved: Option<Shown>,
}

impl Planes {
    pub(super) fn new(enough: f64) -> Self {
        Self { enough, along_normal: None, other: None, count: 0, halved: None }
    }

    /// Whether the part is settled.
    pub(super) fn add(&mut self, shown: Shown, is_along_normal: bool) -> bool {
        self.count += 1;
        let at_center = |shown: &Shown| shown.at_center.max(self.enough);
        if self.halved.is_none_or(|known| at_center(&shown) < OTHER_SHARE * at_center(&known)) {
            self.halved = Some(shown);
        }
        let known = if is_along_normal { &mut self.along_normal } else { &mut self.other };
        if known.is_none_or(|known| shown.bound < known.bound) {
            *known = Some(shown);
        }
        // The first m may be followed by the normal, which shows up to 1 / OTHER_SHARE of its depth.
        let enough =
            if self.count == 1 && self.along_normal.is_none() { OTHER_SHARE } else { 1.0 } * self.enough;
        self.bound() <= enough
    }

    /// What the part's normal shows, or the least that another m shows, if it is clearly less.
    pub(super) fn bound(&self) -> f64 {
        match (self.along_normal, self.other) {
            (Some(normal), Some(other)) if other.bound >= OTHER_SHARE * normal.at_center.max(self.enough) => {
                normal.bound
            }
            (normal, other) => other.or(normal).map_or(f64::INFINITY, |shown| shown.bound),
        }
    }

    /// The depth of the part's centre along its normal, mm, but no less than `enough`.
    pub(super) fn along_normal(&self) -> Option<f64> {
        self.along_normal.map(|shown| shown.at_center.max(self.enough))
    }

    /// Two m: one with the least depth at the part's centre, and the one that gave the bound. What reaches
    /// farthest along them is halved.
    pub(super) fn halved(&self) -> [Vector3<f64>; 2] {
        let first = self.halved.map_or(-Vector3::z(), |shown| shown.m);
        let is_by_normal = self.along_normal.filter(|normal| normal.bound == self.bound());
        [first, is_by_normal.map_or(first, |normal| normal.m)]
    }
}

/// The level unit vector towards the point at `off`.
pub(super) fn sideways(off: &Vector3<f64>) -> Option<Vector3<f64>> {
    Vector3::new(off.x, off.y, 0.0).try_normalize(0.0)
}
