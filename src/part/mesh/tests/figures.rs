//! Areas, volumes, bodies and edges.

use super::solids::Triangles;
use super::writing::stl_text;
use super::*;

fn cube(from: f64, to: f64) -> Triangles {
    Triangles::cuboid([from; 3], [to; 3])
}

fn figures(mesh: &Triangles) -> Figures {
    figures_of(&read_whole(MeshFormat::Stl, stl_text(mesh).as_bytes()))
}

#[test]
fn a_void_is_taken_off_the_volume() {
    let found = figures(&cube(0.0, 4.0).and(cube(1.0, 2.0).turned()));
    let solid = found.solid.unwrap();
    assert_eq!((solid.volume, solid.n_inward_bodies, solid.is_outward), (63.0, 1, true));
    assert_eq!(found.n_bodies, 2);
}

#[test]
fn a_solid_that_is_turned_inside_out_is_told() {
    for (mesh, volume, n_inward) in [
        (cube(0.0, 2.0).turned(), -8.0, 1),
        (cube(0.0, 2.0).and(cube(3.0, 4.0).turned()), 7.0, 1),
        // It is no void: it is as large as the body around it.
        (cube(0.0, 2.0).turned().and(cube(0.5, 1.0)), -7.875, 1),
    ] {
        let solid = figures(&mesh).solid.unwrap();
        assert_eq!((solid.volume, solid.n_inward_bodies, solid.is_outward), (volume, n_inward, false));
    }
}

#[test]
fn open_crowded_and_turned_edges_are_counted() {
    let mut open = cube(0.0, 1.0);
    open.triangles.pop();
    let mut turned = cube(0.0, 1.0);
    turned.triangles[0].swap(0, 1);
    let mut crowded = cube(0.0, 1.0);
    crowded.points.push([5.0; 3]);
    crowded.triangles.push([0, 1, 8]);
    for (mesh, expected) in
        [(cube(0.0, 1.0), [0, 0, 0]), (open, [3, 0, 0]), (turned, [0, 0, 3]), (crowded, [2, 1, 0])]
    {
        let found = figures(&mesh);
        let counts = [found.n_open_edges, found.n_crowded_edges, found.n_turned_edges];
        assert_eq!(counts, expected);
        assert_eq!(found.solid.is_some(), expected == [0; 3]);
    }
}

#[test]
fn bodies_are_joined_through_edges_and_not_through_corners() {
    let at_a_corner = cube(0.0, 1.0).and(cube(1.0, 2.0));
    let found = figures(&at_a_corner);
    assert_eq!((found.n_bodies, found.solid.unwrap().volume), (2, 2.0));
    let at_an_edge = cube(0.0, 1.0).and(Triangles::cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    let found = figures(&at_an_edge);
    assert_eq!((found.n_bodies, found.n_crowded_edges, found.solid), (1, 1, None));
}

#[test]
fn a_sliver_keeps_a_closed_mesh_closed() {
    // The side of a cube is cut at the middle of an edge; on the other side of the edge is no such corner.
    let mut mesh = cube(0.0, 1.0);
    mesh.points.push([0.5, 0.0, 0.0]);
    let before = mesh.triangles.len();
    mesh.triangles.retain(|own| !(own.contains(&0) && own.contains(&1) && own.contains(&5)));
    assert_eq!(mesh.triangles.len(), before - 1);
    mesh.triangles.extend([[0, 8, 5], [8, 1, 5]]);
    let open = figures(&mesh);
    assert_eq!((open.n_open_edges, open.solid), (3, None));
    mesh.triangles.push([0, 1, 8]);
    let closed = figures(&mesh);
    assert_eq!((closed.n_open_edges, closed.solid.unwrap().volume, closed.area), (0, 1.0, 6.0));
}

#[test]
fn figures_of_a_mesh_far_from_the_origin_keep_their_digits() {
    let far = 1e6;
    let found = figures(&cube(far, far + 1.0));
    assert_eq!((found.area, found.solid.unwrap().volume), (6.0, 1.0));
}

#[test]
fn a_stopped_budget_ends_the_figures() {
    let mesh = read_whole(MeshFormat::Stl, stl_text(&cube(0.0, 1.0)).as_bytes());
    let edges = Edges::of(&mesh, &Budget::unlimited()).unwrap();
    let budget = Budget::unlimited();
    budget.cancel();
    assert!(Edges::of(&mesh, &budget).is_err());
    assert!(Figures::of(&mesh, &edges, &budget).is_err());
    assert!(super::super::outline::lines(&mesh, &edges, [1.0; 3], 10, &budget).is_err());
}
