//! Rapids end 2 mm above the stock. Entries and exits are those of the job, unless they do not clear the
//! part. Links join neighbouring passes.

use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::geometry::surface::point_grid::Ends;
use toolpathd_core::operations::surface_milling::{
    CutDirection, Entry, Exit, Job, Plan, Spacing, Stock, Warning, plan,
};
use toolpathd_core::toolpath::{Move, Role};

use super::jobs::{PLANES, die, heights, job};
use super::motion::{Kind, planned};
use super::verdict::judge;

const BALL: f64 = 5.0;
const CAP: f64 = 40.0;

/// A spherical cap of 40 mm about the origin, over a square whose corners slope by 60 degrees.
fn cap() -> Job {
    let half = CAP * 0.75f64.sqrt() / 2f64.sqrt();
    let surface =
        heights(61, [-half, half], Ends::NotAKnot, |x: f64, y: f64| (CAP * CAP - x * x - y * y).sqrt());
    Job { direction: CutDirection::OneWay, ..job(surface, 2.0 * BALL, 4.0, 0.01, 3) }
}

/// The end of each rapid that a feed move follows, with the curve and the role of the feed move.
fn descents(plan: &Plan) -> Vec<(Point3<f64>, Curve, Role)> {
    let moves: Vec<&Move> = plan.toolpath.moves().collect();
    let mut descents = Vec::new();
    for pair in moves.windows(2) {
        if let (Move::Rapid { line }, Move::Feed { along, role, .. }) = (pair[0], pair[1]) {
            descents.push((line.end, *along, *role));
        }
    }
    descents
}

/// The height of the tip over a place of the cap, if `stock` mm of stock are left between ball and cap.
fn tip_over_cap(place: &Point3<f64>, stock: f64) -> f64 {
    let reach = CAP + BALL + stock;
    (reach * reach - place.x * place.x - place.y * place.y).sqrt() - BALL
}

#[test]
fn rapids_come_down_to_two_millimetres_above_the_surface_or_the_stock_on_it() {
    for thickness_mm in [None, Some(0.0), Some(0.5), Some(3.0)] {
        let stock = thickness_mm.map(|thickness_mm| Stock::OnSurface { thickness_mm });
        let (plan, _) = judge(&Job { stock, ..cap() }).unwrap();
        let descents = descents(&plan);
        assert_eq!(descents.len(), plan.report.n_passes);
        for (end, along, role) in descents {
            let above = end.z - tip_over_cap(&end, thickness_mm.unwrap_or(0.0));
            let retract = plan.cutting.retract_z_mm;
            assert!(
                end.z <= retract && (above > 1.97 || end.z == retract),
                "{end} is only {above} mm above the stock"
            );
            assert!(above < 2.1, "{end} is {above} mm above the stock; the retract plane is at {retract}");
            assert_eq!(role, Role::Plunge);
            assert_eq!(along.end().xy(), end.xy());
        }
        let warned = plan.warnings.contains(&Warning::StockNotGiven { approach_mm: 2.0 });
        assert_eq!(warned, stock.is_none());
    }
}

#[test]
fn over_a_block_rapids_and_the_retract_plane_are_two_millimetres_above_block_and_surface() {
    for top_z_mm in [CAP + 12.0, CAP - 12.0] {
        let (plan, _) = judge(&Job { stock: Some(Stock::Block { top_z_mm }), ..cap() }).unwrap();
        let top = top_z_mm.max(CAP);
        assert!((plan.cutting.retract_z_mm - top - 2.0).abs() < 1e-3);
        let descents = descents(&plan);
        assert_eq!(descents.len(), plan.report.n_passes);
        for (end, ..) in descents {
            let tip = tip_over_cap(&end, 0.0);
            assert!(
                (end.z - (top_z_mm + 2.0).max(tip + 2.0)).abs() < 0.02,
                "{end} is not 2 mm above the block at {top_z_mm} and the tip at {tip}"
            );
        }
    }
}

#[test]
fn a_rapid_beside_a_wall_ends_above_the_stock_of_the_wall() {
    // A wall 10 mm high stands beside a floor, with 2 mm of stock on both. Over the floor beside the wall the
    // side of the ball would meet the stock of the wall.
    let surface = heights(41, [0.0, 40.0], Ends::NotAKnot, |x, _| 5.0 * ((x - 20.0) * 1.2).tanh());
    let stock = Some(Stock::OnSurface { thickness_mm: 2.0 });
    let base = Job { stock, direction: CutDirection::OneWay, ..job(surface, 8.0, 4.0, 0.01, 3) };
    let plan = plan(&Job { plane: PLANES[1], ..base.clone() }, &Budget::unlimited()).unwrap();
    // The stock begins where a ball larger by its thickness touches the surface.
    let descents = descents(&plan);
    assert_eq!(descents.len(), plan.report.n_passes);
    for (end, along, _) in descents {
        let free = end.z - along.end().z;
        assert!(free > 3.99, "the rapid to {end} ends only {free} mm above the cut");
        // A ball 2 mm below the end of the rapid does not touch the stock: no place of the surface is within
        // the radius plus the stock.
        let centre = end - nalgebra::Vector3::z() * 2.0 + nalgebra::Vector3::z() * 4.0;
        for k in 0..=4000 {
            let x = 40.0 * f64::from(k) / 4000.0;
            let z = 5.0 * ((x - 20.0) * 1.2).tanh();
            // The spline differs from the closed form by some hundredths of a millimetre.
            let away = (x - centre.x).hypot(z - centre.z);
            assert!(
                away > 6.0 - 0.06 || end.z >= plan.cutting.retract_z_mm,
                "the ball at {end} is {away} mm from the surface at x = {x}, within the stock"
            );
        }
    }
}

#[test]
fn every_pass_has_the_entry_and_exit_asked_for_or_is_counted_in_a_warning() {
    for (entry, role) in [
        (Entry::Ramp { slope: 5f64.to_radians().tan() }, Role::Ramp),
        (Entry::Arc { radius_mm: 3.0 }, Role::LeadIn),
    ] {
        for plane in PLANES {
            for stock in [Stock::OnSurface { thickness_mm: 0.5 }, Stock::Block { top_z_mm: 11.0 }] {
                let exit = Exit::Arc { radius_mm: 2.0 };
                let die = die(plane, CutDirection::OneWay);
                let job = Job { entry, exit, stock: Some(stock), spacing: Spacing::Stepover(6.0), ..die };
                let (plan, _) = judge(&job).unwrap();
                let moves: Vec<&Move> = plan.toolpath.moves().collect();
                let feeds: Vec<(Curve, Role)> = moves
                    .iter()
                    .filter_map(|step| match step {
                        Move::Feed { along, role, .. } => Some((*along, *role)),
                        _ => None,
                    })
                    .collect();
                let (mut entered, mut left) = (0, 0);
                for pair in feeds.windows(2) {
                    let ((before, first), (after, second)) = (pair[0], pair[1]);
                    let along = |curve: &Curve, end: usize| curve.tangents()[end].normalize();
                    if first == role && second == Role::Cut {
                        entered += 1;
                        if role == Role::LeadIn {
                            assert!((along(&before, 1) - along(&after, 0)).norm() < 1e-6);
                            assert!(before.start().z > before.end().z);
                        } else {
                            assert!((along(&before, 1).z + 5f64.to_radians().sin()).abs() < 1e-9);
                        }
                    }
                    if first == Role::Cut && second == Role::LeadOut {
                        left += 1;
                        assert!((along(&before, 1) - along(&after, 0)).norm() < 1e-6);
                    }
                }
                let n_not_clear = plan.warnings.iter().find_map(|warning| match warning {
                    Warning::EntryNotClear { count } => Some(*count),
                    _ => None,
                });
                let asked = 2 * plan.report.n_passes;
                assert_eq!(
                    entered + left + n_not_clear.unwrap_or(0),
                    asked,
                    "{entry:?} {stock:?}: some are missing"
                );
                assert!(
                    entered + left > asked / 2,
                    "{entry:?} {stock:?}: only {entered} entries and {left} exits of {asked}"
                );
            }
        }
    }
}

#[test]
fn an_entry_without_room_becomes_a_plunge_with_a_warning() {
    // On slopes under 40 degrees an arc of 5,000 mm, and one of a sixteenth of it, begins far above the retract plane.
    let entry = Entry::Arc { radius_mm: 5000.0 };
    let job = Job { entry, ..die(PLANES[0], CutDirection::OneWay) };
    let plan = plan(&job, &Budget::unlimited()).unwrap();
    assert!(plan.warnings.contains(&Warning::EntryNotClear { count: plan.report.n_passes }));
    let descents = descents(&plan);
    assert_eq!(descents.len(), plan.report.n_passes);
    assert!(descents.iter().all(|(_, _, role)| *role == Role::Plunge));
}

#[test]
fn neighbouring_passes_of_the_die_are_joined_by_links_and_not_by_rapids() {
    for plane in PLANES {
        let (plan, _) = judge(&die(plane, CutDirection::Zigzag)).unwrap();
        let n_links = planned(&plan).iter().flatten().filter(|(kind, _)| *kind == Kind::Link).count();
        assert!(n_links > plan.report.n_passes / 2, "{n_links} links, {} passes", plan.report.n_passes);
        for step in plan.toolpath.moves() {
            let Move::Rapid { line } = step else { continue };
            let across = (line.end - line.start).xy().norm();
            assert!(across == 0.0 || across > 5.0, "{plane:?}: a rapid joins neighbouring passes: {line:?}");
        }
    }
}
