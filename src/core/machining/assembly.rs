//! A cutter with what holds it: sections of the shank and of the holder above the tip, all turning about one
//! axis.
//!
//! Material below a height, at or beyond a distance from the axis, is a *quadrant* in the half plane of the
//! axis. A section is nearer to a quadrant if the quadrant comes nearer to the axis or rises higher. So the
//! least distance along a piece of the path is bounded by the least distance in plan and the lowest place of
//! the tip.

use super::cutter::Cutter;

/// A section of the shank or of the holder: a frustum of a cone about the axis. Heights are those over the
/// tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frustum {
    pub bottom_mm: f64,
    pub top_mm: f64,
    pub bottom_radius_mm: f64,
    pub top_radius_mm: f64,
}

/// A cutter and the sections above it. The cutter's own shank has the cutter's radius, and no end.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    pub cutter: Cutter,
    pub sections: Vec<Frustum>,
}

impl Assembly {
    /// A cutter that is held by nothing.
    pub fn bare(cutter: Cutter) -> Self {
        Self { cutter, sections: Vec::new() }
    }

    /// The least distance of the sections from the material at or beyond `away` mm from the axis, up to `top`
    /// mm above the tip; zero where they overlap, infinite without sections.
    pub fn clearance(&self, away: f64, top: f64) -> f64 {
        self.sections.iter().map(|section| section.clearance(away, top)).fold(f64::INFINITY, f64::min)
    }

    /// The height of the lowest section over the tip, mm; infinite without sections.
    pub fn lowest_section(&self) -> f64 {
        self.sections.iter().map(|section| section.bottom_mm).fold(f64::INFINITY, f64::min)
    }

    /// The largest radius of a section, mm; zero without sections.
    pub fn widest_section(&self) -> f64 {
        let radii = self.sections.iter().map(|section| section.bottom_radius_mm.max(section.top_radius_mm));
        radii.fold(0.0, f64::max)
    }
}

impl Frustum {
    /// The radius at a height over the tip between bottom and top, mm.
    fn radius_at(&self, height: f64) -> f64 {
        let span = self.top_mm - self.bottom_mm;
        let share = if span > 0.0 { ((height - self.bottom_mm) / span).clamp(0.0, 1.0) } else { 1.0 };
        self.bottom_radius_mm + (self.top_radius_mm - self.bottom_radius_mm) * share
    }

    /// Its distance from the material at or beyond `away` mm from the axis, up to `top` mm above the tip.
    fn clearance(&self, away: f64, top: f64) -> f64 {
        if top >= self.bottom_mm {
            let widest = self.bottom_radius_mm.max(self.radius_at(top.min(self.top_mm)));
            if widest >= away {
                return 0.0;
            }
        }
        // Both are convex, so a corner of one is nearest to the other.
        let corners = [[self.bottom_radius_mm, self.bottom_mm], [self.top_radius_mm, self.top_mm]];
        let from_corner =
            |[radius, height]: [f64; 2]| (away - radius).max(0.0).hypot((height - top).max(0.0));
        let edges = [[[0.0, self.bottom_mm], corners[0]], corners, [corners[1], [0.0, self.top_mm]]];
        let to_corner = edges.map(|edge| distance_to_edge([away.max(0.0), top], edge));
        corners.map(from_corner).into_iter().chain(to_corner).fold(f64::INFINITY, f64::min)
    }
}

/// The distance of a point from a straight edge, in the half plane of the axis, mm.
fn distance_to_edge([x, y]: [f64; 2], [from, to]: [[f64; 2]; 2]) -> f64 {
    let way = [to[0] - from[0], to[1] - from[1]];
    let squared = way[0] * way[0] + way[1] * way[1];
    let along = (x - from[0]) * way[0] + (y - from[1]) * way[1];
    let t = if squared > 0.0 { (along / squared).clamp(0.0, 1.0) } else { 0.0 };
    (x - from[0] - way[0] * t).hypot(y - from[1] - way[1] * t)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The least distance of many places of the section from many places of the quadrant.
    fn sampled(section: &Frustum, away: f64, top: f64) -> f64 {
        let shares = (0..=60).map(|k| f64::from(k) / 60.0);
        let mut least = f64::INFINITY;
        for (s, t) in shares.clone().flat_map(|s| shares.clone().map(move |t| (s, t))) {
            let height = section.bottom_mm + (section.top_mm - section.bottom_mm) * s;
            let radius = section.radius_at(height) * t;
            least = least.min((away - radius).max(0.0).hypot((height - top).max(0.0)));
        }
        least
    }

    proptest! {
        #[test]
        fn the_clearance_is_the_least_distance(
            bottom in 0.0f64..30.0, height in 0.0f64..20.0, radii in prop::array::uniform2(0.5f64..20.0),
            away in 0.0f64..30.0, top in -10.0f64..60.0,
        ) {
            let section = Frustum {
                bottom_mm: bottom,
                top_mm: bottom + height,
                bottom_radius_mm: radii[0],
                top_radius_mm: radii[1],
            };
            let (clearance, sampled) = (section.clearance(away, top), sampled(&section, away, top));
            prop_assert!(clearance <= sampled + 1e-9 && clearance >= sampled - 0.6, "{clearance} {sampled}");
        }

        #[test]
        fn material_that_is_nearer_or_higher_leaves_less_clearance(
            height in 0.0f64..20.0, radii in prop::array::uniform2(0.5f64..20.0),
            away in 0.0f64..30.0, top in -10.0f64..60.0, by in prop::array::uniform2(0.0f64..5.0),
        ) {
            let section = Frustum {
                bottom_mm: 10.0,
                top_mm: 10.0 + height,
                bottom_radius_mm: radii[0],
                top_radius_mm: radii[1],
            };
            let assembly = Assembly { cutter: Cutter::ball(1.0), sections: vec![section] };
            let nearer = assembly.clearance((away - by[0]).max(0.0), top + by[1]);
            prop_assert!(nearer <= assembly.clearance(away, top) + 1e-12);
        }
    }
}
