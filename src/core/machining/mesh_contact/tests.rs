use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;

use super::lift::lift;
use super::*;
use crate::budget::Budget;
use crate::machining::mesh_contact::sections::MeshSections;
use crate::machining::offset_section::{PlaneAt, Spacing};

fn cutters() -> [Cutter; 4] {
    [Cutter::ball(3.0), Cutter::bull_nose(3.0, 0.0), Cutter::bull_nose(3.0, 1.0), Cutter::bull_nose(3.0, 2.5)]
}

/// A wave of heights over `n` x `n` cells of `size` mm, two triangles each.
fn wave(n: usize, size: f64) -> TriangleMesh {
    let height = |x: f64, y: f64| 2.0 * (x / 5.0).sin() * (y / 7.0).cos() + if x > 12.0 { 1.5 } else { 0.0 };
    let at = |k: usize| k as f64 * size;
    let points = (0..=n).flat_map(|i| (0..=n).map(move |j| (at(i), at(j))));
    let points = points.map(|(x, y)| Point3::new(x, y, height(x, y))).collect();
    let cell = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        [[cell(i, j), cell(i + 1, j), cell(i + 1, j + 1)], [cell(i, j), cell(i + 1, j + 1), cell(i, j + 1)]]
    });
    TriangleMesh::new(points, triangles.collect(), 0.0, &Budget::unlimited()).unwrap()
}

/// The largest lift over dense points of a triangle.
fn dense(cutter: &Cutter, [a, b, c]: &[Vector3<f64>; 3], axis: &Vector2<f64>) -> f64 {
    const N: usize = 200;
    let mut best = f64::NEG_INFINITY;
    for i in 0..=N {
        for j in 0..=N - i {
            let (s, t) = (i as f64 / N as f64, j as f64 / N as f64);
            let p = a + (b - a) * s + (c - a) * t;
            best = best.max(p.z - cutter.height((p.xy() - axis).norm()));
        }
    }
    best
}

fn corner() -> impl Strategy<Value = Vector3<f64>> {
    // Round numbers make walls, level sides and corners on the rim.
    let coordinate = || prop_oneof![-6.0..6.0f64, (-6..6i32).prop_map(f64::from)];
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

proptest! {
    /// No point of a triangle lifts the tip higher, and some point nearly as high.
    #[test]
    fn the_lift_of_a_triangle_is_that_of_its_highest_point(
        a in corner(), b in corner(), c in corner(), x in -4.0..4.0f64, y in -4.0..4.0f64, k in 0..4usize,
    ) {
        let (cutter, axis, corners) = (cutters()[k], Vector2::new(x, y), [a, b, c]);
        let found = lift(&cutter, &corners, &axis);
        let sampled = dense(&cutter, &corners, &axis);
        if let Some(found) = found {
            prop_assert!(found.tip_z >= sampled - 1e-9, "{found:?} {sampled}");
            let own = found.point.z - height(&cutter, (found.point.xy() - axis).norm());
            prop_assert!((own - found.tip_z).abs() < 1e-7);
            let nearest = box_of(&corners);
            prop_assert!((0..3).all(|k| (nearest.min[k] - 1e-9..=nearest.max[k] + 1e-9).contains(&found.point[k])));
        } else {
            prop_assert_eq!(sampled, f64::NEG_INFINITY);
        }
    }

    /// Along a line, the lift is below its tangents and above its chords.
    #[test]
    fn the_lift_of_a_triangle_is_concave_along_a_line(
        a in corner(), b in corner(), c in corner(), from in corner(), to in corner(), k in 0..4usize,
    ) {
        let (cutter, corners) = (cutters()[k], [a, b, c]);
        let way = (to - from).xy();
        let lifts: Vec<_> = (0..=40)
            .filter_map(|n| {
                let t = n as f64 / 40.0;
                let axis = from.xy() + way * t;
                lift(&cutter, &corners, &axis).map(|lift| (t, lift.tip_z, lift.rise(&axis, &way)))
            })
            .collect();
        for &(t, z, rise) in &lifts {
            for &(u, w, _) in lifts.iter().filter(|_| rise.is_finite()) {
                prop_assert!(w <= z + rise * (u - t) + 1e-6 * (1.0 + rise.abs()), "{t} {z} {rise} {u} {w}");
            }
        }
    }
}

/// The normals of these triangles are rounding alone: the sides tell how high the cutter is lifted.
#[test]
fn triangles_on_one_line_lift_the_cutter_by_their_sides() {
    let ball = Cutter::ball(3.0);
    let line = [[-1.0, 0.5, -13.2], [-2.4, 1.3, -9.2], [-4.5, 2.5, -3.2]].map(Vector3::from);
    for ([x, y], expected) in [([-1.0, 0.5], -8.176), ([-2.4, 1.3], -4.425), ([-4.5, 2.5], -3.2)] {
        let found = lift(&ball, &line, &Vector2::new(x, y)).unwrap();
        assert!((found.tip_z - expected).abs() < 1e-3, "{found:?} {expected}");
    }
    let far = [[-2.0, 7.3, 1.0], [-0.2, 4.3, 5.2], [-1.7, 6.8, 1.7]].map(Vector3::from);
    assert_eq!(lift(&ball, &far, &Vector2::new(0.5, 0.8)), None);
}

/// In the valley between two steep walls, the tips turn back: vertical distances tell it.
#[test]
fn a_valley_between_steep_walls_is_not_cut_off() {
    let at = |x: f64, z: f64| [Point3::new(x, -5.0, z), Point3::new(x, 5.0, z)];
    let points: Vec<_> = [at(-2.0, 56.0), at(0.0, 0.0), at(4.0, 48.0)].concat();
    let triangles = (0..2u32).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]]);
    let mesh = TriangleMesh::new(points, triangles.collect(), 0.0, &Budget::unlimited()).unwrap();
    let spacing = Spacing { chord_height_mm: 6e-4, step_length_mm: f64::INFINITY };
    for radius in [0.3, 0.5, 0.7, 1.0] {
        let contacts = MeshContacts::new(&mesh, Cutter::ball(radius));
        let sections = MeshSections::new(contacts, 1);
        let chains = sections.chains(PlaneAt::new(0.1), spacing, &Budget::unlimited()).unwrap();
        let points: Vec<_> = chains.iter().flat_map(|chain| &chain.points).collect();
        let lowest = points.iter().map(|point| point.z).fold(f64::INFINITY, f64::min);
        let tips = (0..=20_000)
            .map(|k| -1.0 + 2e-4 * f64::from(k))
            .filter_map(|x| contacts.drop(Vector2::new(x, 0.1)));
        let valley = tips.map(|contact| contact.tip.z).fold(f64::INFINITY, f64::min);
        assert!(lowest <= valley + 6e-4, "{radius} {lowest} {valley}");
    }
}

#[test]
fn a_drop_finds_the_triangle_that_lifts_the_tip_highest() {
    let mesh = wave(40, 0.6);
    for cutter in cutters() {
        let contacts = MeshContacts::new(&mesh, cutter);
        for k in 0..60 {
            let at = Vector2::new(0.37 * k as f64 - 1.0, (k * k % 23) as f64 + 0.1);
            let all = (0..mesh.triangles().len()).filter_map(|k| lift(&cutter, &mesh.corners(k), &at));
            let best = all.map(|lift| lift.tip_z).fold(f64::NEG_INFINITY, f64::max);
            let found = contacts.drop(at).map_or(f64::NEG_INFINITY, |contact| contact.tip.z);
            assert_eq!(found, best, "{cutter:?} {at}");
        }
    }
}

/// Sections are near the tips of dense drops, and end at the outline.
#[test]
fn sections_stay_near_the_tips_between_their_points() {
    let mesh = wave(40, 0.6);
    let spacing = Spacing { chord_height_mm: 1e-3, step_length_mm: f64::INFINITY };
    for cutter in cutters() {
        let contacts = MeshContacts::new(&mesh, cutter);
        for axis in [0, 1] {
            let sections = MeshSections::new(contacts, axis);
            for at in [6.0, 11.3, 12.0, 17.9] {
                let chains = sections.chains(PlaneAt::new(at), spacing, &Budget::unlimited()).unwrap();
                assert_eq!(chains.len(), 1);
                let points = &chains[0].points;
                let along = 1 - axis;
                assert!(points[0][along] < 1.5 && points[points.len() - 1][along] > 22.5);
                for pair in points.windows(2).filter(|pair| pair[1][along] - pair[0][along] > 1e-5) {
                    for n in 1..20 {
                        let on = pair[0] + (pair[1] - pair[0]) * (n as f64 / 20.0);
                        let tip = contacts.drop(on.xy().coords).unwrap().tip;
                        let steep = ((pair[1].z - pair[0].z) / (pair[1][along] - pair[0][along])).abs();
                        assert!((tip.z - on.z).abs() <= 1.01e-3 * (1.0 + steep), "{cutter:?} {on} {tip}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_section_climbs_an_upright_wall_and_ends_at_the_outline() {
    // A step of 4 mm at x = 10, in a strip from 0 to 20.
    let at = |x: f64, z: f64| [Point3::new(x, 0.0, z), Point3::new(x, 10.0, z)];
    let points: Vec<_> = [at(0.0, 0.0), at(10.0, 0.0), at(10.0, 4.0), at(20.0, 4.0)].concat();
    let triangles = (0..3u32).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]]);
    let mesh = TriangleMesh::new(points, triangles.collect(), 0.0, &Budget::unlimited()).unwrap();
    let spacing = Spacing { chord_height_mm: 1e-3, step_length_mm: f64::INFINITY };
    for cutter in cutters() {
        let sections = MeshSections::new(MeshContacts::new(&mesh, cutter), 1);
        let chains = sections.chains(PlaneAt::new(5.0), spacing, &Budget::unlimited()).unwrap();
        assert_eq!(chains.len(), 1, "{cutter:?}");
        let points = &chains[0].points;
        let (first, last) = (points[0], points[points.len() - 1]);
        assert!(first.x.abs() < 1e-6 && first.z.abs() < 1e-9, "{cutter:?} {first}");
        assert!((last.x - 20.0).abs() < 1e-6 && (last.z - 4.0).abs() < 1e-9, "{cutter:?} {last}");
        let foot = points.iter().rfind(|point| point.z < 1e-6).unwrap();
        assert!((foot.x - 7.0).abs() < 2e-6, "{cutter:?} {foot}");
    }
}
