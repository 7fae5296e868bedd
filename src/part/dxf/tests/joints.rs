//! How curves are joined to loops, and how loops lie in each other.

use proptest::prelude::*;

use super::*;

fn with_gap(text: &str, gap_mm: f64) -> Drawing {
    read(text.as_bytes(), &DxfOptions { gap_mm, ..options() }, &Budget::unlimited()).unwrap()
}

/// Four lines about a square of 10, each shifted by up to `gap`.
fn gapped(gap: f64) -> String {
    [
        line([0.0, 0.0], [10.0, 0.0]),
        line([10.0, gap], [10.0, 10.0]),
        line([10.0, 10.0], [0.0, 10.0]),
        line([0.0, 0.0], [0.0, 10.0 - 0.5 * gap]),
    ]
    .concat()
}

#[test]
fn gaps_are_bridged_halfway_and_told() {
    let text = file(&gapped(0.008));
    let drawing = with_gap(&text, 0.01);
    assert_near(drawing.bridged_max_mm, 0.008);
    let corners: Vec<_> = only(&drawing).vertices.iter().map(|v| [v[0], v[1]]).collect();
    assert_eq!(corners, [[0.0, 0.0], [10.0, 0.004], [10.0, 10.0], [0.0, 0.5 * 10.0 + 0.5 * 9.996]]);
    let open = with_gap(&text, 0.0);
    assert_eq!((open.loops.len(), open.open.len(), open.bridged_max_mm), (0, 2, 0.0));
    let gaps: Vec<f64> = open.open.iter().map(|chain| chain.gap_mm).collect();
    assert_near(gaps[0], f64::hypot(10.0, 9.996));
    assert_near(gaps[1], f64::hypot(10.0, 10.0 - 0.008));
}

#[test]
fn ends_that_differ_by_rounding_are_no_gap() {
    // The ends of the arc are computed from its angles.
    let text = file(&(arc([0.1, 0.2], 7.0, 30.0, 150.0) + &rounded_chord()));
    for gap_mm in [0.0, 0.01] {
        let drawing = with_gap(&text, gap_mm);
        assert_eq!((only(&drawing).vertices.len(), drawing.bridged_max_mm), (2, 0.0));
    }
}

/// The chord of the arc, with the last digits of its ends altered.
fn rounded_chord() -> String {
    let (x, y) = (7.0 * 0.75f64.sqrt(), 3.7f64.next_up().next_up());
    line([0.1 + x.next_down(), y], [0.1 - x.next_up(), y])
}

#[test]
fn the_end_of_an_arc_moves_to_the_point_that_the_file_has() {
    // A line ends 0.004 mm beside the end of the arc.
    let text = file(&(arc([0.0, 0.0], 5.0, 0.0, 180.0) + &line([-5.0, -0.004], [5.0, 0.0])));
    let drawing = with_gap(&text, 0.01);
    assert_eq!(only(&drawing).vertices, [[5.0, 0.0, 1.0], [-5.0, -0.004, 0.0]]);
}

#[test]
fn the_nearest_ends_are_joined_first() {
    // Three ends within the gap: the nearest two are joined, and the third is told.
    let text = file(
        &(gapped(0.0).replace("21 0\n0 LINE\n8 0\n10 10", "21 -0.001\n0 LINE\n8 0\n10 10")
            + &line([10.0, 0.005], [20.0, 0.0])),
    );
    let drawing = with_gap(&text, 0.01);
    assert_eq!((drawing.loops.len(), drawing.open.len()), (1, 1));
    assert_near(drawing.bridged_max_mm, 0.001);
    let [branch] = &drawing.branches[..] else { panic!("{:?}", drawing.branches) };
    assert_eq!((branch.at, branch.n_open), ([10.0, 0.005], 1));
}

#[test]
fn a_line_that_ends_nowhere_does_not_break_the_loop_at_its_corner() {
    let tail = line([10.0, 10.0], [15.0, 15.0]) + &line([15.0, 15.0], [20.0, 15.0]);
    let drawing = drawing(&file(&(tail + &gapped(0.0))));
    assert_eq!((drawing.loops.len(), drawing.open.len()), (1, 1));
    assert_eq!(drawing.branches, [crate::drawing::Branch { at: [10.0, 10.0], n_ends: 3, n_open: 1 }]);
}

#[test]
fn squares_that_share_a_corner_are_two_loops() {
    let shifted = [
        line([10.0, 10.0], [20.0, 10.0]),
        line([20.0, 10.0], [20.0, 20.0]),
        line([20.0, 20.0], [10.0, 20.0]),
        line([10.0, 20.0], [10.0, 10.0]),
    ];
    let drawing = drawing(&file(&(gapped(0.0) + &shifted.concat())));
    assert_eq!(drawing.loops.iter().map(|one| one.area_mm2).collect::<Vec<_>>(), [100.0, 100.0]);
    assert_eq!(drawing.branches, [crate::drawing::Branch { at: [10.0, 10.0], n_ends: 4, n_open: 0 }]);
}

#[test]
fn loops_that_touch_in_two_places_are_told_apart_by_the_even_odd_rule() {
    // A square, and a kite that touches two of its corners. Between them lies a triangle, which is outside.
    let kite = [[10.0, 10.0], [12.0, 5.0], [10.0, 0.0], [20.0, 5.0]];
    let sides: String = (0..4).map(|k| line(kite[k], kite[(k + 1) % 4])).collect();
    let touching = drawing(&file(&(sides + &gapped(0.0))));
    assert_eq!(touching.loops.iter().map(|one| one.area_mm2).collect::<Vec<_>>(), [40.0, 100.0]);
    assert!(touching.open.is_empty());
    assert!(touching.branches.iter().all(|branch| (branch.n_ends, branch.n_open) == (4, 0)));
    // A slot and a circle that touches both of its sides from inside.
    let slot = [
        line([-20.0, 0.0], [0.0, 0.0]),
        line([0.0, 0.0], [20.0, 0.0]),
        arc([20.0, 5.0], 5.0, 270.0, 90.0),
        line([20.0, 10.0], [0.0, 10.0]),
        line([0.0, 10.0], [-20.0, 10.0]),
        arc([-20.0, 5.0], 5.0, 90.0, 270.0),
        arc([0.0, 5.0], 5.0, 270.0, 90.0),
        arc([0.0, 5.0], 5.0, 90.0, 270.0),
    ];
    let tangent = drawing(&file(&slot.concat()));
    assert_eq!((tangent.loops.len(), tangent.open.len()), (2, 0));
    for half in &tangent.loops {
        assert_near(half.area_mm2, 200.0);
    }
}

#[test]
fn a_square_with_a_diagonal_stays_open_because_there_is_a_choice() {
    let drawing = drawing(&file(&(gapped(0.0) + &line([0.0, 0.0], [10.0, 10.0]))));
    assert_eq!((drawing.loops.len(), drawing.open.len()), (0, 3));
    assert!(drawing.branches.iter().all(|branch| (branch.n_ends, branch.n_open) == (3, 3)));
    assert_eq!(drawing.branches.len(), 2);
}

#[test]
fn curves_of_one_layer_are_joined_first() {
    let diagonal = line([0.0, 0.0], [10.0, 10.0]).replace("8 0", "8 notes");
    let drawing = drawing(&file(&(diagonal + &gapped(0.0))));
    assert_eq!((drawing.loops.len(), drawing.open.len(), drawing.branches.len()), (1, 1, 0));
    // What stays open within a layer is joined across layers.
    let text = file(&gapped(0.0).replacen("8 0", "8 other", 1));
    assert_eq!(only(&super::drawing(&text)).layer, "other");
}

#[test]
fn curves_that_are_drawn_twice_count_once() {
    let square = rectangle([0.0, 0.0], [3.0, 2.0]);
    let turned = polygon(&[[3.0, 2.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
    let lines = line([7.0, 0.0], [9.0, 1.0]) + &line([9.0, 1.0], [7.0, 0.0]);
    let arcs = arc([0.0, 9.0], 2.0, 10.0, 50.0) + &arc([0.0, 9.0], 2.0, 10.0, 50.0);
    let drawing = drawing(&file(&(square + &turned + &lines + &arcs)));
    assert_eq!((drawing.loops.len(), drawing.open.len()), (1, 2));
    let expected = [("LWPOLYLINE", "drawn twice", 1), ("LINE", "drawn twice", 1), ("ARC", "drawn twice", 1)];
    assert_eq!(left_out(&drawing), expected);
}

#[test]
fn loops_that_repeat_another_within_the_gap_count_once() {
    // The second square is four lines, shifted by less than the gap; the third by more.
    let shifted = gapped(0.0).replace("10 0\n", "10 0.003\n").replace("11 0\n", "11 0.003\n");
    let square = rectangle([0.0, 0.0], [10.0, 10.0]);
    let beside = rectangle([0.02, 0.0], [10.0, 10.0]);
    let drawing = with_gap(&file(&(square + &shifted + &beside)), 0.01);
    assert_eq!((drawing.loops.len(), drawing.open.len()), (2, 0));
    assert_eq!(left_out(&drawing), [("LINE", "drawn twice", 1)]);
    // Pieces of a fine outline that are shorter than the gap are no copies of each other.
    let at = |k: u32| {
        let angle = f64::from(k % 1000) * std::f64::consts::TAU / 1000.0;
        [angle.cos(), angle.sin()]
    };
    let fine = with_gap(&file(&(0..1000).map(|k| line(at(k), at(k + 1))).collect::<String>()), 0.01);
    assert_eq!(only(&fine).vertices.len(), 1000);
    assert!(fine.left_out.is_empty());
}

#[test]
fn loops_without_area_are_left_out() {
    let there_and_back = polygon(&[[0.0, 0.0, 0.0], [5.0, 5.0, 0.0], [9.0, 9.0, 0.0]]);
    assert_eq!(
        left_out(&drawing(&file(&there_and_back))),
        [("LWPOLYLINE", "it is closed and bounds no area", 1)]
    );
}

#[test]
fn loops_are_nested_by_depth_also_where_they_touch() {
    // Circles that touch the walls and each other, a wall in an island, and a neighbour with a common side.
    let shapes = [
        circle([2.0, 5.0], 2.0),
        circle([6.0, 5.0], 2.0),
        circle([6.0, 5.0], 1.0),
        rectangle([0.0, 0.0], [10.0, 10.0]),
        rectangle([10.0, 0.0], [14.0, 10.0]),
        polygon(&[[0.0, 10.0, 0.0], [0.0, 8.0, 0.0], [2.0, 10.0, 0.0]]),
    ];
    let drawing = drawing(&file(&shapes.concat()));
    let nests: Vec<_> = drawing.loops.iter().map(|one| (one.depth, one.parent)).collect();
    let expected = [(0, None), (0, None), (1, Some(0)), (1, Some(0)), (1, Some(0)), (2, Some(3))];
    assert_eq!(nests, expected, "{:?}", drawing.loops);
    assert_eq!(drawing.loops[5].vertices[0], [7.0, 5.0, 1.0]);
}

#[test]
fn loops_in_a_row_or_a_column_are_nested_alike() {
    let rings = |along: fn(f64) -> [f64; 2]| {
        let pair = |k: u32| {
            let center = along(10.0 * f64::from(k));
            let island = [[1.0, 0.0, 0.0], [-1.0, 1.0, 0.5], [-1.0, -1.0, 0.0]];
            let island = island.map(|[x, y, bulge]| [center[0] + x, center[1] + y, bulge]);
            circle(center, 4.0) + &polygon(&island)
        };
        drawing(&file(&(0..30).map(pair).collect::<String>()))
    };
    for drawing in [rings(|x| [x, 0.0]), rings(|y| [0.0, y])] {
        let nests: Vec<_> = drawing.loops.iter().map(|one| (one.depth, one.parent)).collect();
        let expected: Vec<_> = (0..30).map(|_| (0, None)).chain((0..30).map(|k| (1, Some(k)))).collect();
        assert_eq!(nests, expected);
    }
}

#[test]
fn an_arc_that_bulges_around_a_circle_holds_it() {
    // The circle lies beside the chord of the bow, between chord and arc.
    let bow = polygon(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.9]]);
    let beside = polygon(&[[0.0, 0.0, 0.0], [10.0, 0.0, -0.9]]);
    let drawing = drawing(&file(&(bow + &beside + &circle([5.0, 2.5], 1.0) + &circle([5.0, -8.0], 1.0))));
    let nests: Vec<_> = drawing.loops.iter().map(|one| (one.depth, one.parent)).collect();
    assert_eq!(nests, [(0, None), (0, None), (0, None), (1, Some(0))]);
}

/// The loops without regard to their first vertices, and the open chains without regard to direction.
fn forms(drawing: &Drawing) -> Vec<Vec<[u64; 3]>> {
    let bits = |v: &Vec<[f64; 3]>| -> Vec<[u64; 3]> {
        v.iter().map(|vertex| vertex.map(|x| (x + 0.0).to_bits())).collect()
    };
    let mut forms: Vec<_> = drawing
        .loops
        .iter()
        .map(|one| {
            let mut form = bits(&one.vertices);
            let least = (0..form.len()).min_by_key(|k| form[*k]).unwrap();
            form.rotate_left(least);
            form
        })
        .collect();
    forms.sort();
    forms
}

/// Lines and arcs of some rounded rectangles side by side, with their gaps.
fn curves() -> Vec<([f64; 3], [f64; 3])> {
    let mut curves = Vec::new();
    for k in 0..4 {
        let (x, y, gap) = (30.0 * f64::from(k), 7.0 * f64::from(k), 1e-3 * f64::from(k));
        let corners = [
            [x + 2.0, y, 0.0],
            [x + 18.0, y, 0.4],
            [x + 20.0, y + 2.0, 0.0],
            [x + 20.0, y + 8.0 + gap, 0.0],
            [x, y + 9.0, 0.0],
            [x, y + 2.0, 0.3],
        ];
        for (n, from) in corners.iter().enumerate() {
            let to = corners[(n + 1) % corners.len()];
            curves.push((*from, [to[0] + gap, to[1], 0.0]));
        }
        // A tail at a corner.
        curves.push(([x, y + 9.0, 0.0], [x - 3.0, y + 12.0, 0.0]));
    }
    curves
}

fn drawn(curves: &[([f64; 3], [f64; 3])]) -> Drawing {
    let one = |(from, to): &([f64; 3], [f64; 3])| {
        let vertex = |v: &[f64; 3]| format!("10 {}\n20 {}\n42 {}\n", v[0], v[1], v[2]);
        format!("0 LWPOLYLINE\n8 0\n90 2\n70 0\n{}{}", vertex(from), vertex(to))
    };
    with_gap(&file(&curves.iter().map(one).collect::<String>()), 0.01)
}

/// Lines of shapes that touch in one place, in two, and along a side.
fn touching() -> Vec<([f64; 3], [f64; 3])> {
    let shapes: [&[[f64; 2]]; 5] = [
        &[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]],
        &[[10.0, 10.0], [12.0, 5.0], [10.0, 0.0], [20.0, 5.0]],
        &[[0.0, 10.0], [0.0, 20.0], [-10.0, 20.0]],
        &[[50.0, 0.0], [60.0, 0.0], [60.0, 10.0], [50.0, 10.0]],
        &[[60.0, 10.0], [60.0, 0.0], [70.0, 0.0], [70.0, 10.0]],
    ];
    let at = |[x, y]: [f64; 2]| [x, y, 0.0];
    let sides = |shape: &[[f64; 2]]| -> Vec<_> {
        (0..shape.len()).map(|k| (at(shape[k]), at(shape[(k + 1) % shape.len()]))).collect()
    };
    shapes.into_iter().flat_map(sides).collect()
}

proptest! {
    #[test]
    fn order_and_direction_of_touching_curves_do_not_matter(
        (order, turned) in (
            Just((0..19).collect::<Vec<usize>>()).prop_shuffle(),
            prop::collection::vec(any::<bool>(), 19),
        )
    ) {
        let curves = touching();
        let shuffled: Vec<_> = order
            .iter()
            .zip(&turned)
            .map(|(k, is_turned)| if *is_turned { (curves[*k].1, curves[*k].0) } else { curves[*k] })
            .collect();
        let (usual, other) = (drawn(&curves), drawn(&shuffled));
        // The side that two squares share is drawn twice and counts once. Then there is a choice.
        prop_assert_eq!((usual.loops.len(), usual.open.len()), (3, 3));
        prop_assert_eq!(left_out(&usual), [("LWPOLYLINE", "drawn twice", 1)]);
        prop_assert_eq!(forms(&usual), forms(&other));
        prop_assert_eq!(usual.open.len(), other.open.len());
        prop_assert_eq!(usual.branches.len(), other.branches.len());
    }

    #[test]
    fn order_and_direction_of_curves_do_not_matter(
        (order, turned) in (Just((0..28).collect::<Vec<usize>>()).prop_shuffle(), prop::collection::vec(any::<bool>(), 28))
    ) {
        let curves = curves();
        let shuffled: Vec<_> = order
            .iter()
            .zip(&turned)
            .map(|(k, is_turned)| {
                let (from, to) = curves[*k];
                if *is_turned { ([to[0], to[1], -from[2]], [from[0], from[1], 0.0]) } else { (from, to) }
            })
            .collect();
        let (usual, other) = (drawn(&curves), drawn(&shuffled));
        prop_assert_eq!(usual.loops.len(), 4);
        prop_assert_eq!(forms(&usual), forms(&other));
        prop_assert_eq!(usual.open.len(), other.open.len());
        prop_assert_eq!(usual.bridged_max_mm, other.bridged_max_mm);
        prop_assert_eq!(usual.branches.len(), other.branches.len());
    }
}
