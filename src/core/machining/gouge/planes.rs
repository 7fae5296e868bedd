//! Bounds how deep a part of a patch lies in the cutter, by planes at right angles to several unit vectors m.

use nalgebra::Vector3;

/// The bound by another m replaces the bound by the part's normal only if it is less than this share of it. A
/// sharp rim in a slope reaches below the surface by up to sqrt(2) times the depth of any surface point in
/// the cutter. The larger depth counts, and only the bound by the normal covers it.
const OTHER_SHARE: f64 = 0.6;

/// The depths by a plane at right angles to m.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    pub(super) m: Vector3<f64>,
    /// The depth of the centre of the part, mm.
    pub(super) at_center: f64,
    /// Upper bound of the depth of the whole part, mm.
    pub(super) bound: f64,
}

/// The bounds by several m for one part.
pub(super) struct Planes {
    /// A bound up to this is good enough, mm.
    enough: f64,
    /// The bound by the m against the part's normal. It covers how far the cutter reaches below the part.
    along_normal: Option<Shown>,
    /// The least bound by any other m.
    other: Option<Shown>,
    count: usize,
    /// The m along which pairs are halved: the first that was added, or a later one with a clearly smaller
    /// depth.
    halved: Option<Shown>,
}

impl Planes {
    pub(super) fn new(enough: f64) -> Self {
        Self { enough, along_normal: None, other: None, count: 0, halved: None }
    }

    /// Adds the bound by one m. Returns whether the part is settled: the bound is good enough.
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
        // The m against the normal may follow later. Only a bound up to OTHER_SHARE of `enough` stands
        // whatever that m shows.
        let enough =
            if self.count == 1 && self.along_normal.is_none() { OTHER_SHARE } else { 1.0 } * self.enough;
        self.bound() <= enough
    }

    /// The bound by the part's normal, or the least bound by another m if that is clearly less.
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

    /// Two m: the one with the least depth at the part's centre, and the one that gave the bound. The search
    /// halves what extends farthest along them.
    pub(super) fn halved(&self) -> [Vector3<f64>; 2] {
        let first = self.halved.map_or(-Vector3::z(), |shown| shown.m);
        let is_by_normal = self.along_normal.filter(|normal| normal.bound == self.bound());
        [first, is_by_normal.map_or(first, |normal| normal.m)]
    }
}

/// The level unit vector towards the point at `off`; `None` if the point is on the axis.
pub(super) fn sideways(off: &Vector3<f64>) -> Option<Vector3<f64>> {
    Vector3::new(off.x, off.y, 0.0).try_normalize(0.0)
}
