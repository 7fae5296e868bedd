//! Normals for pictures.

use super::super::shading::Shaded;
use super::solids::Triangles;
use super::writing::obj;
use super::*;

fn shaded(mesh: &Triangles) -> (MeshFile, Shaded) {
    let mesh = read_whole(MeshFormat::Obj, obj(mesh).as_bytes());
    let shaded = Shaded::of(&mesh, &Budget::unlimited()).unwrap();
    for (own, other) in shaded.triangles.iter().zip(&mesh.triangles) {
        let points = own.map(|corner| shaded.points[corner as usize]);
        assert_eq!(points, mesh.corners(other));
    }
    (mesh, shaded)
}

#[test]
fn the_edges_of_a_box_are_sharp() {
    let (_, shaded) = shaded(&Triangles::cuboid([0.0; 3], [1.0, 2.0, 3.0]));
    assert_eq!(shaded.points.len(), 24);
    for (point, normal) in shaded.points.iter().zip(&shaded.normals) {
        // The normal is one of an axis, and points out of the side on which the point lies.
        let axis = normal.iter().position(|x| x.abs() == 1.0).unwrap();
        assert_eq!(normal[axis] > 0.0, point[axis] > 0.0, "{point:?} {normal:?}");
    }
}

#[test]
fn a_sphere_is_smooth() {
    let (mesh, shaded) = shaded(&Triangles::icosphere(2.0, 3));
    assert_eq!(shaded.points.len(), mesh.vertices.len());
    for (point, normal) in shaded.points.iter().zip(&shaded.normals) {
        let along: f64 = (0..3).map(|k| point[k] * normal[k]).sum::<f64>() / 2.0;
        assert!((along - 1.0).abs() < 1e-3, "{along}");
    }
}

#[test]
fn the_tip_of_a_fine_cone_has_a_normal_for_each_triangle() {
    let n = 1000;
    let mut cone = Triangles { points: vec![[0.0, 0.0, 1.0]], triangles: Vec::new() };
    for k in 0..n {
        let (sin, cos) = (k as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
        cone.points.push([cos, sin, 0.0]);
        cone.triangles.push([0, 1 + k, 1 + (k + 1) % n]);
    }
    let (_, shaded) = shaded(&cone);
    assert_eq!(shaded.points.len(), 2 * n);
    assert!(shaded.normals.iter().all(|normal| (normal[2] - 0.5_f64.sqrt()).abs() < 1e-2));
}
