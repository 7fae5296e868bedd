//! What a control demands of the ends and the centre of an arc before it runs the arc. A program states all
//! three rounded, so that they agree only nearly.
//!
//! # Method
//! 1. *Radii.* The distances of the two ends from the stated centre may differ by a fixed length, or by a
//!    part of the radius at the start where that part is longer, and by no more than a largest length.
//! 2. *Centre.* Some controls compute a centre of their own: the point that is as far from the start as the
//!    stated centre, on the perpendicular bisector of the ends, on the side of the stated centre. They run
//!    the arc about their own centre. They refuse an arc that has no such point, and an arc on which the two
//!    centres, seen from the start, lie in too different directions.
//!
//! A full circle has no chord. The control runs a full circle about the stated centre.
//!
//! Near half a turn the own centre is sensitive: a radius at the start that is too long by d moves the own
//! centre of a half circle of radius r by sqrt(2 r d).
//!
//! # Reference
//! SINUMERIK 840D sl, *Diagnostics Manual*, alarm 14040 (radii, own centre); SINUMERIK 840C, *Installation
//! Guide*, 03.95, p. 6-10 (the control runs the circle about the corrected centre).

use nalgebra::Vector2;

/// The part of each limit that is written. The rest is for the rounding in the arithmetic of a control. A
/// part nearer to 1 would let a control with another arithmetic refuse arcs at the limit.
const WRITTEN_PART: f64 = 0.99;

/// How much shorter than half the chord the radius at the start may be, mm, so that an own centre still
/// exists: the middle of the chord. Coordinates read from a program are wrong by 1e-12 mm at 10 m. A length
/// above 1e-6 mm would hide steps of the last decimal.
const LACK_MM: f64 = 1e-9;

/// Squares of lengths that differ by a smaller part are equal: the rounding of two sums of products.
const SAME_SQUARES: f64 = 8.0 * f64::EPSILON;

/// The rules of one control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArcRule {
    /// The difference of the two radii that the control accepts at every radius, mm.
    pub mismatch_mm: f64,
    /// The part of the radius at the start that the control accepts as a difference, where that is longer.
    pub mismatch_part: f64,
    /// The largest difference that the control accepts, however large the radius, mm.
    pub most_mismatch_mm: f64,
    /// The angle between the stated and the own centre, seen from the start, from which on the control
    /// refuses the arc, radians. None where the control runs the arc about the stated centre.
    pub turn: Option<f64>,
}

/// Why a control refuses an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ArcRefusal {
    /// The two radii differ by too much.
    Radii { mismatch_mm: f64 },
    /// No point of the bisector is as near to the start as the stated centre.
    NoOwnCenter,
    /// The stated and the own centre lie in too different directions, radians.
    Turned { angle: f64 },
}

impl ArcRule {
    /// A control without known figures: the least difference that a manual of another control gives
    /// (Heidenhain).
    pub const USUAL: Self = Self::fixed(0.016);

    /// A control that accepts the same difference at every radius, mm, and runs arcs about the stated centre.
    pub const fn fixed(mismatch_mm: f64) -> Self {
        Self { mismatch_mm, mismatch_part: 0.0, most_mismatch_mm: mismatch_mm, turn: None }
    }

    /// The same rules for a reader that accepts no larger difference of the radii than `most_mm`.
    pub fn capped(self, most_mm: f64) -> Self {
        Self { most_mismatch_mm: self.most_mismatch_mm.min(most_mm), ..self }
    }

    /// Why the control refuses the arc; `None` where the control runs the arc. `center` and `end` are the
    /// stated centre and the end of the arc, seen from its start, along the two axes of its plane, mm.
    pub fn refusal(&self, center: &Vector2<f64>, end: &Vector2<f64>) -> Option<ArcRefusal> {
        self.refusal_at(center, end, 1.0)
    }

    /// Whether the arc keeps the rules with a margin. `center` and `end` as in [`ArcRule::refusal`].
    pub fn may_write(&self, center: &Vector2<f64>, end: &Vector2<f64>) -> bool {
        self.refusal_at(center, end, WRITTEN_PART).is_none()
    }

    /// The centre about which the control runs the arc, seen from the start, mm; `None` where that is the
    /// stated centre. `center` and `end` as in [`ArcRule::refusal`].
    pub fn own_center(&self, center: &Vector2<f64>, end: &Vector2<f64>) -> Option<Vector2<f64>> {
        self.turn.filter(|_| *end != Vector2::zeros()).and_then(|_| own_center(center, end, LACK_MM))
    }

    /// The refusal by `part` of each limit.
    fn refusal_at(&self, center: &Vector2<f64>, end: &Vector2<f64>, part: f64) -> Option<ArcRefusal> {
        let radius = center.norm();
        let mismatch_mm = (radius - (end - center).norm()).abs();
        let accepted_mm = self.mismatch_mm.max(self.mismatch_part * radius).min(self.most_mismatch_mm);
        if mismatch_mm > part * accepted_mm {
            return Some(ArcRefusal::Radii { mismatch_mm });
        }
        let limit = self.turn.filter(|_| *end != Vector2::zeros())?;
        let Some(own) = own_center(center, end, part * LACK_MM) else {
            return Some(ArcRefusal::NoOwnCenter);
        };
        // A stated centre on the chord says no side; the angle is the same on both.
        let angle = center.perp(&own).atan2(center.dot(&own)).abs();
        (angle >= part * limit).then_some(ArcRefusal::Turned { angle })
    }
}

/// The point of the bisector that is as far from the start as `center`, on its side; `None` where the
/// distance is shorter than half the chord by more than `lack_mm`. The chord leads to `end`.
fn own_center(center: &Vector2<f64>, end: &Vector2<f64>, lack_mm: f64) -> Option<Vector2<f64>> {
    let half = end / 2.0;
    if half.norm() - center.norm() > lack_mm {
        return None;
    }
    let (radius_squared, half_squared) = (center.norm_squared(), half.norm_squared());
    let squared = radius_squared - half_squared;
    let height = if squared <= SAME_SQUARES * radius_squared { 0.0 } else { squared.sqrt() };
    let across = Vector2::new(-half.y, half.x) / half.norm();
    Some(half + across * if across.dot(center) < 0.0 { -height } else { height })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rules of SINUMERIK.
    const SINUMERIK: ArcRule = ArcRule {
        mismatch_mm: 0.01,
        mismatch_part: 0.001,
        most_mismatch_mm: f64::INFINITY,
        turn: Some(0.031_622),
    };

    fn v(x: f64, y: f64) -> Vector2<f64> {
        Vector2::new(x, y)
    }

    #[test]
    fn the_difference_of_the_radii_may_be_a_length_or_a_part_of_the_radius_up_to_a_largest_length() {
        let rule = ArcRule { mismatch_mm: 0.005, mismatch_part: 0.001, most_mismatch_mm: 0.5, turn: None };
        let accepts =
            |radius: f64, off: f64| rule.refusal(&v(radius, 0.0), &v(2.0 * radius + off, 0.0)).is_none();
        for (radius, most) in [(0.1, 0.005), (4.0, 0.005), (20.0, 0.02), (400.0, 0.4), (2000.0, 0.5)] {
            assert!(accepts(radius, 0.999 * most) && accepts(radius, -0.999 * most), "{radius}");
            assert!(!accepts(radius, 1.001 * most) && !accepts(radius, -1.001 * most), "{radius}");
        }
        let refusal = rule.capped(0.001).refusal(&v(1.0, 0.0), &v(2.002, 0.0));
        assert!(
            matches!(refusal, Some(ArcRefusal::Radii { mismatch_mm }) if (mismatch_mm - 0.002).abs() < 1e-9)
        );
    }

    /// The angle is acos(0.4995 / 0.5), as a hand computes it.
    #[test]
    fn a_half_circle_whose_radius_is_half_a_unit_too_long_turns_its_centre_too_far() {
        let refusal = SINUMERIK.refusal(&v(0.5, 0.0), &v(0.999, 0.0));
        let Some(ArcRefusal::Turned { angle }) = refusal else { panic!("{refusal:?}") };
        assert!((angle.to_degrees() - 2.5626).abs() < 1e-4, "{angle}");
        assert_eq!(SINUMERIK.refusal(&v(0.499, 0.0), &v(0.999, 0.0)), Some(ArcRefusal::NoOwnCenter));
        assert_eq!(SINUMERIK.refusal(&v(0.5, 0.0), &v(1.0, 0.0)), None);
        // Ten times as large, the same half unit turns the centre by a third of the angle.
        assert_eq!(SINUMERIK.refusal(&v(5.0, 0.0), &v(9.999, 0.0)), None);
    }

    #[test]
    fn the_own_centre_is_as_far_from_both_ends_as_the_stated_centre_is_from_the_start() {
        for (center, end) in
            [(v(3.0, 4.0), v(7.0, 1.0)), (v(3.0, -4.0), v(7.0, 1.0)), (v(-0.2, 5.0), v(1.0, 0.1))]
        {
            let own = SINUMERIK.own_center(&center, &end).unwrap();
            assert!((own.norm() - center.norm()).abs() < 1e-12);
            assert!(((own - end).norm() - center.norm()).abs() < 1e-12);
            assert!(end.perp(&own) * end.perp(&center) > 0.0, "it lies on the other side");
            assert_eq!(ArcRule::USUAL.own_center(&center, &end), None);
        }
        assert_eq!(SINUMERIK.own_center(&v(3.0, 4.0), &v(0.0, 0.0)), None);
        assert_eq!(SINUMERIK.own_center(&v(5.0, 0.0), &v(10.0, 0.0)), Some(v(5.0, 0.0)));
    }

    #[test]
    fn what_is_written_keeps_a_margin_to_what_is_accepted() {
        let rule = ArcRule::fixed(0.016);
        for (off, is_accepted, is_written) in
            [(0.0158, true, true), (0.0159, true, false), (0.0161, false, false)]
        {
            let (center, end) = (v(1.0, 0.0), v(2.0 + off, 0.0));
            assert_eq!(rule.refusal(&center, &end).is_none(), is_accepted, "{off}");
            assert_eq!(rule.may_write(&center, &end), is_written, "{off}");
        }
    }
}
