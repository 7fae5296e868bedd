use std::f64::consts::PI;

use super::*;
use crate::geometry::region::{Containment, Outline};
use crate::operations::pocketing::conditions::tests::conditions;

fn rectangle(x: f64, width: f64, height: f64) -> Outline {
    let corner = [[x, 0.0], [x + width, 0.0], [x + width, height], [x, height]].map(Point2::from);
    let side = |k: usize| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] };
    Outline::new(&(0..4).map(side).collect::<Vec<_>>(), &Budget::unlimited()).unwrap()
}

fn region(outlines: &[Outline]) -> Region {
    Region::new(outlines, &[], &Budget::unlimited()).unwrap()
}

fn line(a: [f64; 2], b: [f64; 2]) -> Vec<Segment> {
    vec![Segment::Line { start: a.into(), end: b.into() }]
}

#[test]
fn a_part_without_room_for_an_entry_is_left_out_and_told() {
    let (conditions, budget) = (conditions(5.0, 3.0), Budget::unlimited());
    let centers = region(&[rectangle(0.0, 40.0, 20.0), rectangle(60.0, 0.02, 0.02)]);
    let mut router = Router::new(&conditions, &centers, &[], &budget);
    router.cut_chain(&line([60.0, 0.01], [60.02, 0.01])).unwrap();
    router.cut_chain(&line([5.0, 10.0], [35.0, 10.0])).unwrap();
    let left: Vec<f64> = router.left_out().map(Region::area).collect();
    assert!(left.len() == 1 && (left[0] - 4e-4).abs() < 1e-9, "{left:?}");
    let runs = router.finish();
    assert!(runs.iter().flat_map(Run::chain).all(|element| element.end().x < 41.0));
    assert_eq!(runs.len(), 1);
}

#[test]
fn a_region_of_which_no_part_has_room_for_an_entry_is_refused() {
    let (conditions, budget) = (conditions(5.0, 3.0), Budget::unlimited());
    let centers = region(&[rectangle(0.0, 0.02, 0.02), rectangle(60.0, 0.02, 0.02)]);
    let mut router = Router::new(&conditions, &centers, &[], &budget);
    router.cut_chain(&line([60.0, 0.01], [60.02, 0.01])).unwrap();
    let refused = router.cut_chain(&line([0.0, 0.01], [0.02, 0.01]));
    assert!(matches!(refused, Err(PocketError::NoEntry { .. })), "{refused:?}");
}

#[test]
fn a_stroke_without_room_for_a_helix_is_come_to_from_where_one_fits() {
    let (conditions, budget) = (conditions(5.0, 3.0), Budget::unlimited());
    // A room, and a corridor in which the centre may move by half a millimetre.
    let corridor = rectangle(39.0, 41.0, 0.5);
    let centers = region(&[rectangle(0.0, 40.0, 30.0), corridor]);
    let mut router = Router::new(&conditions, &centers, &[], &budget);
    let stroke = line([60.0, 0.25], [80.0, 0.25]);
    router.cut_chain(&stroke).unwrap();
    let runs = router.finish();
    assert_eq!(runs.len(), 1);
    let Entry::Helix { center, .. } = runs[0].entry else { panic!("{:?}", runs[0].entry) };
    assert!(((runs[0].start - center).norm() - 4.5).abs() < 1e-3);
    let steps: Vec<Segment> = runs[0].steps.iter().map(|step| step.element).collect();
    assert_eq!(steps[steps.len() - 1].end(), Point2::new(80.0, 0.25));
    for (element, k) in steps.iter().zip(0..) {
        assert!(centers.contains(element, 1e-5), "{k}: {element:?}");
    }
}

#[test]
fn the_cutter_comes_down_where_the_caller_says() {
    let (usual, budget) = (conditions(5.0, 3.0), Budget::unlimited());
    let centers = region(&[rectangle(0.0, 60.0, 30.0)]);
    let at = Point2::new(45.0, 12.0);
    for is_predrilled in [false, true] {
        let entry = super::super::job::EntryLimits { at: Some(at), is_predrilled, ..usual.entry };
        let conditions = Conditions { entry, ..usual.clone() };
        let mut router = Router::new(&conditions, &centers, &[], &budget);
        router.cut_chain(&line([5.0, 10.0], [20.0, 10.0])).unwrap();
        let run = &router.finish()[0];
        match &run.entry {
            Entry::Plunge => assert!(is_predrilled && run.start == at),
            Entry::Helix { center, .. } => assert!(!is_predrilled && *center == at),
            other => panic!("{other:?}"),
        }
        let turn = |pair: &[Step]| pair[0].element.direction(1.0).angle(&pair[1].element.direction(0.0));
        assert!(run.steps.windows(2).all(|pair| turn(pair) < PI / 6.0));
    }
    assert_eq!(centers.place(at, 0.0), Containment::Inside);
}

#[test]
fn a_link_to_a_place_beside_what_is_cleared_is_clear_all_along() {
    let (conditions, budget) = (conditions(5.0, 3.0), Budget::unlimited());
    let centers = region(&[rectangle(0.0, 60.0, 30.0)]);
    let emptied: Vec<Vec<Segment>> = [0.0, 4.0, 8.0, 12.0, 16.0].map(|y| line([0.0, y], [60.0, y])).to_vec();
    let mut router = Router::new(&conditions, &centers, &emptied, &budget);
    router.begin(Point2::new(10.0, 8.0), Entry::Open);
    router.follow(&line([10.0, 8.0], [20.0, 8.0]), Purpose::Cut).unwrap();
    let stroke = line([20.0, 14.0], [10.0, 14.0]);
    assert!(router.come_to(&stroke).unwrap());
    let runs = router.finish();
    assert_eq!(runs.len(), 1, "the cutter is lifted");
    let links: Vec<&Step> = runs[0].steps.iter().filter(|step| step.purpose == Purpose::Link).collect();
    assert!(!links.is_empty() && links.iter().flat_map(|step| &step.angles).all(Stretch::is_clear));
    let elements: Vec<Segment> = runs[0].steps.iter().map(|step| step.element).chain(stroke).collect();
    for pair in elements.windows(2) {
        assert!(pair[0].direction(1.0).angle(&pair[1].direction(0.0)) < PI / 6.0, "{pair:?}");
    }
}
