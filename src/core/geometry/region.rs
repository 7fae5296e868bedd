//! Regions of the plane that are bounded by lines and arcs: their union, intersection, difference, offset
//! and area, and whether a place lies inside.
//!
//! # Method
//! 1. All outlines are cut where they meet each other. The pieces are called edges (`arrangement`).
//! 2. The windings of the places to the left and to the right of each edge are computed (`winding`). The
//!    winding of an outline about a place is the number of turns that the outline makes about the place. Each
//!    operation has a rule that decides from the windings whether a place belongs to the result.
//! 3. The edges divide the plane into faces (`orbits`). The rule says of each face whether it belongs to the
//!    result. An edge with the result on exactly one of its sides lies on the boundary of the result; these
//!    edges are joined to outlines (`trace`).
//! 4. An offset moves all outlines aside first ([`offset`](crate::geometry::offset)). Then steps 1 to 3 are
//!    done with the moved outlines (`grown`).
//!
//! # Guarantees
//! * Outer outlines run counterclockwise and islands clockwise. The outlines of one region do not cross each
//!   other. They meet at most in single points.
//! * The boundary of a result lies within a few snaps of the exact boundary. A snap is 1e-6 mm, or up to
//!   16e-6 mm if outlines run very close to each other for a long way. Parts of a region that are narrower
//!   than 1e-6 mm are dropped. An empty region is a valid result.
//! * Outlines may touch, nearly touch and coincide. Two edges of one face may contradict each other: by one
//!   of them the face belongs to the result, by the other it does not. Then all edges are cut again, and with
//!   a larger snap if need be. A region is refused only if edges of more than 1e-3 mm still contradict each
//!   other, or if the region needs more than a million elements.
//!
//! # Cost
//! O(n log n + k) for n elements, where k is the number of pairs of elements whose boxes meet. In addition,
//! one search along a ray is needed for each place where outlines meet.
//!
//! # Reference
//! A. Margalit, G. D. Knott, *An algorithm for computing the union, intersection or difference of two
//! polygons*, Computers & Graphics 13, 1989.

mod arrangement;
mod contacts;
mod front;
mod grown;
mod narrow;
mod orbits;
mod outline;
mod trace;
mod winding;

use nalgebra::Point2;

use crate::budget::{Budget, Stopped};
use crate::geometry::offset::OffsetError;
use crate::geometry::offset::tree::{Bounds, Tree};
use crate::geometry::segment::Segment;
use arrangement::{Arrangement, ArrangementError, Loop, SNAP_MM};
pub use front::Stretches;
pub use outline::{Outline, OutlineError, area};

/// The snaps, mm, and the numbers of passes that are tried one after the other, until no edges of one face
/// contradict each other. Edges that run within a snap of each other for a long way may be made to cross by
/// snapping. More passes cut them where they cross; a larger snap makes one edge of them.
const ATTEMPTS: [(f64, usize); 4] = [(SNAP_MM, 1), (SNAP_MM, 6), (4.0 * SNAP_MM, 6), (16.0 * SNAP_MM, 6)];

/// The longest boundary that may stay on the wrong side if no attempt is free of contradictions, mm. Sides
/// that contradict their face are no longer than the edges between which they cross.
const MOST_WRONG_MM: f64 = 1e-3;

/// An outline with the islands in it: a connected part of a region.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Counterclockwise.
    pub outer: Outline,
    /// Clockwise.
    pub islands: Vec<Outline>,
}

/// A part of the plane bounded by lines and arcs.
///
/// # Example
/// A square of 10 mm grows by 2 mm on all sides.
///
/// ```
/// use std::f64::consts::PI;
/// use nalgebra::Point2;
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::region::{Outline, Region};
/// use toolpathd_core::geometry::segment::Segment;
///
/// let corner = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]].map(Point2::from);
/// let sides = [0, 1, 2, 3].map(|k| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] });
/// let budget = Budget::unlimited();
/// let square = Region::new(&[Outline::new(&sides, &budget).unwrap()], &[], &budget).unwrap();
/// let grown = square.offset_outward(2.0, &budget).unwrap();
/// // The square, a strip along each side, and a quarter of a circle about each corner.
/// assert!((grown.area() - (100.0 + 4.0 * 20.0 + 4.0 * PI)).abs() < 1e-3);
/// let rim = grown.difference(&square, &budget).unwrap();
/// assert_eq!((rim.faces().len(), rim.faces()[0].islands.len()), (1, 1));
/// ```
#[derive(Debug, Clone)]
pub struct Region {
    faces: Vec<Face>,
    /// The boundary, as elements along which y only rises or only falls.
    boundary: Tree,
}

/// Where a place lies relative to a region.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Containment {
    Inside,
    OnBoundary,
    Outside,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RegionError {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Offset(OffsetError),
    #[error("the region needs more than {limit} elements")]
    TooMany { limit: usize },
    #[error("near {at} outlines run so close to each other that inside and outside cannot be told apart")]
    Tangled { at: Point2<f64> },
    #[error("the distance of an offset is {distance_mm} mm; give a distance above zero")]
    Distance { distance_mm: f64 },
}

impl Region {
    /// The region inside any of the outlines and outside all islands. Outlines may overlap, touch and
    /// contain each other, and so may islands.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn new(outlines: &[Outline], islands: &[Outline], budget: &Budget) -> Result<Self, RegionError> {
        let loops = loops(outlines, 0).chain(loops(islands, 1)).collect();
        Self::of(loops, |[outlines, islands]| outlines > 0 && islands <= 0, budget)
    }

    /// The region inside an odd number of the outlines: an outline within an island is filled again.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn nested(outlines: &[Outline], budget: &Budget) -> Result<Self, RegionError> {
        Self::of(loops(outlines, 0).collect(), |[winding, _]| winding % 2 != 0, budget)
    }

    /// The region without any place.
    pub fn empty() -> Self {
        Self::of_faces(Vec::new())
    }

    /// The places to the left of closed chains of lines and arcs, which may touch each other and themselves.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn on_the_left(chains: &[Vec<Segment>], budget: &Budget) -> Result<Self, RegionError> {
        let loops = chains.iter().map(|elements| Loop { group: 0, elements }).collect();
        Self::of(loops, |[winding, _]| winding > 0, budget)
    }

    /// The places that are in any of the regions.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn union(regions: &[&Self], budget: &Budget) -> Result<Self, RegionError> {
        let loops = regions.iter().flat_map(|region| loops(region.outlines(), 0)).collect();
        Self::of(loops, |[winding, _]| winding > 0, budget)
    }

    /// The places that are in both regions.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn intersection(&self, other: &Self, budget: &Budget) -> Result<Self, RegionError> {
        let loops = loops(self.outlines(), 0).chain(loops(other.outlines(), 1)).collect();
        Self::of(loops, |[one, other]| one > 0 && other > 0, budget)
    }

    /// The places that are in this region and not in the other.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn difference(&self, other: &Self, budget: &Budget) -> Result<Self, RegionError> {
        let loops = loops(self.outlines(), 0).chain(loops(other.outlines(), 1)).collect();
        Self::of(loops, |[one, other]| one > 0 && other <= 0, budget)
    }

    /// The region with x negated.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mirrored = |outline: &Outline| outline.mirrored();
        let face = |face: &Face| Face {
            outer: mirrored(&face.outer),
            islands: face.islands.iter().map(mirrored).collect(),
        };
        Self::of_faces(self.faces.iter().map(face).collect())
    }

    /// The region of parts of a region.
    pub fn of_parts(parts: &[Self]) -> Self {
        Self::of_faces(parts.iter().flat_map(|part| part.faces.iter().cloned()).collect())
    }

    /// The connected parts.
    pub fn parts(&self) -> Vec<Self> {
        self.faces.iter().map(|face| Self::of_faces(vec![face.clone()])).collect()
    }

    /// The parts of a line or an arc that lie in the region, in order. Each part is a range of the element's
    /// length, where 0 is the start of the element and 1 its end.
    ///
    /// The element is divided where it meets the boundary. A piece counts as inside if its middle is in the
    /// region or nearer to the boundary than `tolerance_mm`. Adjacent pieces inside become one part.
    pub fn ranges_inside(&self, element: &Segment, tolerance_mm: f64) -> Vec<[f64; 2]> {
        let mut cuts = vec![0.0, 1.0];
        let length = element.length();
        let mut met = Vec::new();
        self.boundary.meeting(&Bounds::of(element), |_, other| {
            met.clear();
            contacts::append(element, other, SNAP_MM, &mut met);
            met.extend([other.start(), other.end()]);
            for p in &met {
                let foot = element.foot(*p);
                if foot.distance.abs() <= SNAP_MM && foot.u > 0.0 && foot.u < 1.0 {
                    cuts.push(foot.u);
                }
            }
        });
        cuts.sort_unstable_by(f64::total_cmp);
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        for pair in cuts.windows(2).filter(|pair| (pair[1] - pair[0]) * length > SNAP_MM) {
            if self.place(element.at(0.5 * (pair[0] + pair[1])), tolerance_mm) == Containment::Outside {
                continue;
            }
            match ranges.last_mut() {
                Some(last) if (pair[0] - last[1]) * length <= SNAP_MM => last[1] = pair[1],
                _ => ranges.push([pair[0], pair[1]]),
            }
        }
        ranges
    }

    /// Whether a line or an arc runs in the region, or nearer to its boundary than `tolerance_mm`.
    pub fn contains(&self, element: &Segment, tolerance_mm: f64) -> bool {
        let inside = |t: f64| self.place(element.at(t), tolerance_mm) != Containment::Outside;
        let length = element.length();
        inside(0.0)
            && inside(1.0)
            && (length <= SNAP_MM
                || matches!(self.ranges_inside(element, tolerance_mm)[..], [[from, to]]
                    if (from + 1.0 - to) * length <= SNAP_MM))
    }

    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// All outlines, each outer one followed by its islands.
    pub fn outlines(&self) -> impl Iterator<Item = &Outline> {
        self.faces.iter().flat_map(|face| [&face.outer].into_iter().chain(&face.islands))
    }

    /// The area, mm².
    pub fn area(&self) -> f64 {
        self.outlines().map(Outline::area).sum()
    }

    /// The lowest and the highest coordinates, mm; `None` for an empty region.
    pub fn bounding_box(&self) -> Option<[Point2<f64>; 2]> {
        let boxes = self.faces.iter().map(|face| face.outer.bounding_box());
        boxes.reduce(|[low, high], [a, b]| [low.inf(&a), high.sup(&b)])
    }

    /// Where `p` lies; on the boundary if it is nearer to the boundary than `tolerance_mm`.
    pub fn place(&self, p: Point2<f64>, tolerance_mm: f64) -> Containment {
        if self.boundary.nearest(p, tolerance_mm) < tolerance_mm {
            return Containment::OnBoundary;
        }
        let mut winding = 0;
        winding::along_ray(&self.boundary, p, |_, sense| winding += sense);
        if winding > 0 { Containment::Inside } else { Containment::Outside }
    }

    /// The distance of `p` from the boundary, mm; infinite for an empty region.
    pub fn distance_to_boundary(&self, p: Point2<f64>) -> f64 {
        self.boundary.nearest(p, f64::INFINITY)
    }

    /// The least distance of a line or an arc from the boundary, mm, if it is less than `bound_mm`; else
    /// `bound_mm`.
    pub fn clearance(&self, element: &Segment, bound_mm: f64) -> f64 {
        let (middle, reach) = element.disc();
        let mut least = bound_mm;
        self.boundary.near(middle, bound_mm + reach, |k, _| {
            least = least.min(element.distance_between(&self.boundary.elements()[k]).0);
            true
        });
        least
    }

    fn of(
        loops: Vec<Loop>,
        is_inside: impl Fn([i32; 2]) -> bool,
        budget: &Budget,
    ) -> Result<Self, RegionError> {
        let mut best: Option<(f64, Vec<Face>)> = None;
        let mut doubtful = None;
        for (snap_mm, passes) in ATTEMPTS {
            let arrangement = Arrangement::new(&loops, snap_mm, passes, budget)?;
            let bounded = trace::bounded(&arrangement, &is_inside, budget)?;
            if bounded.doubt_mm == 0.0 {
                return Ok(Self::of_faces(bounded.faces(budget)?));
            }
            doubtful = doubtful.or(bounded.doubtful);
            if best.as_ref().is_none_or(|(least, _)| bounded.wrong_mm < *least) {
                best = Some((bounded.wrong_mm, bounded.faces(budget)?));
            }
        }
        match best {
            Some((wrong_mm, faces)) if wrong_mm <= MOST_WRONG_MM => Ok(Self::of_faces(faces)),
            _ => Err(RegionError::Tangled { at: doubtful.unwrap_or_else(Point2::origin) }),
        }
    }

    fn of_faces(faces: Vec<Face>) -> Self {
        let mut elements = Vec::new();
        for outline in faces.iter().flat_map(|face| [&face.outer].into_iter().chain(&face.islands)) {
            for element in outline.elements() {
                arrangement::append_monotone(element, &mut elements);
            }
        }
        Self { faces, boundary: Tree::new(elements) }
    }
}

fn loops<'a>(
    outlines: impl IntoIterator<Item = &'a Outline>,
    group: usize,
) -> impl Iterator<Item = Loop<'a>> {
    outlines.into_iter().map(move |outline| Loop { group, elements: outline.elements() })
}

impl From<OffsetError> for RegionError {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Stopped(stopped) => Self::Stopped(stopped),
            OffsetError::TooMany { limit } => Self::TooMany { limit },
            other => Self::Offset(other),
        }
    }
}

impl From<ArrangementError> for RegionError {
    fn from(error: ArrangementError) -> Self {
        match error {
            ArrangementError::Stopped(stopped) => Self::Stopped(stopped),
            ArrangementError::TooMany { limit } => Self::TooMany { limit },
        }
    }
}

impl From<ArrangementError> for OutlineError {
    fn from(error: ArrangementError) -> Self {
        match error {
            ArrangementError::Stopped(stopped) => Self::Stopped(stopped),
            ArrangementError::TooMany { limit } => Self::TooMany { limit },
        }
    }
}

#[cfg(test)]
mod tests;
