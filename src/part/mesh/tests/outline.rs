//! Edges that are drawn.

use super::solids::Triangles;
use super::writing::stl_binary;
use super::*;

fn lines(mesh: &Triangles, view: [f64; 3], most: usize) -> (MeshFile, Vec<[u32; 2]>) {
    let mesh = read_whole(MeshFormat::Stl, &stl_binary(mesh, ""));
    let edges = Edges::of(&mesh, &Budget::unlimited()).unwrap();
    let lines = super::super::outline::lines(&mesh, &edges, view, most, &Budget::unlimited()).unwrap();
    (mesh, lines)
}

#[test]
fn all_edges_of_a_small_mesh_are_drawn() {
    assert_eq!(lines(&Triangles::cuboid([0.0; 3], [1.0; 3]), [1.0; 3], 100).1.len(), 18);
}

#[test]
fn the_outline_of_a_sphere_is_near_its_great_circle() {
    let (mesh, lines) = lines(&Triangles::icosphere(1.0, 4), [0.0, 0.0, 1.0], 100_000);
    assert!((30..500).contains(&lines.len()), "{}", lines.len());
    for z in lines.iter().flatten().map(|end| mesh.vertices[*end as usize][2]) {
        assert!(z.abs() < 0.1, "{z}");
    }
}

#[test]
fn the_sharpest_edges_are_drawn_where_there_are_too_many() {
    // A box with a sphere beside it: its edges turn by a right angle, those of the sphere by little.
    let both = Triangles::icosphere(1.0, 3).and(Triangles::cuboid([5.0; 3], [6.0, 7.0, 8.0]));
    let (mesh, all) = lines(&both, [0.0, 0.0, 1.0], 100_000);
    let is_box = |end: &u32| mesh.vertices[*end as usize][0] > 4.0;
    assert!(all.iter().flatten().any(|end| !is_box(end)));
    assert_eq!(all.iter().filter(|ends| ends.iter().all(is_box)).count(), 12);
    for most in [0, 1, 5, 40] {
        assert_eq!(lines_of(&both, most), most);
    }
}

fn lines_of(mesh: &Triangles, most: usize) -> usize {
    lines(mesh, [0.0, 0.0, 1.0], most).1.len()
}
