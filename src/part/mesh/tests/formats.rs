//! Known solids in all formats.

use super::solids::Triangles;
use super::writing::all;
use super::*;

fn is_near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-12 * expected.abs()
}

#[test]
fn every_format_gives_the_area_and_the_volume_of_a_tetrahedron() {
    let [a, b, c] = [3.0_f64, 5.0, 7.5];
    let slant = (a * b).hypot(b * c).hypot(c * a);
    for (name, format, bytes) in all(&Triangles::tetrahedron([a, b, c])) {
        let mesh = read_whole(format, &bytes);
        let found = figures_of(&mesh);
        assert!(is_near(found.area, (a * b + b * c + c * a + slant) / 2.0), "{name}: {}", found.area);
        let solid = found.solid.unwrap();
        assert!(is_near(solid.volume, a * b * c / 6.0), "{name}: {}", solid.volume);
        assert!(solid.is_outward, "{name}");
        assert_eq!((mesh.vertices.len(), mesh.triangles.len(), found.n_bodies), (4, 4, 1), "{name}");
        assert_eq!((mesh.n_degenerate, &mesh.left_out, &mesh.slivers), (0, &vec![], &vec![]), "{name}");
    }
}

#[test]
fn every_format_gives_the_box_the_area_and_the_volume_of_a_box() {
    let (from, to) = ([-1.5, 2.0, 0.25], [8.5, 6.0, 3.25]);
    let [a, b, c] = [10.0, 4.0, 3.0];
    for (name, format, bytes) in all(&Triangles::cuboid(from, to)) {
        let mesh = read_whole(format, &bytes);
        let found = figures_of(&mesh);
        assert!(is_near(found.area, 2.0 * (a * b + b * c + c * a)), "{name}: {}", found.area);
        assert!(is_near(found.solid.unwrap().volume, a * b * c), "{name}");
        assert_eq!(found.bounds, [from, to], "{name}");
        assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (8, 12), "{name}");
    }
}

#[test]
fn every_format_gives_the_area_and_the_volume_of_an_icosahedron() {
    let radius = 11.0_f64;
    let edge = radius / (2.0 * std::f64::consts::PI / 5.0).sin();
    let area = 5.0 * 3.0_f64.sqrt() * edge * edge;
    let volume = 5.0 / 12.0 * (3.0 + 5.0_f64.sqrt()) * edge.powi(3);
    for (name, format, bytes) in all(&Triangles::icosphere(radius, 0)) {
        let found = figures_of(&read_whole(format, &bytes));
        // Binary files have 24 bits of each coordinate.
        assert!((found.area / area - 1.0).abs() < 2e-7, "{name}: {}", found.area);
        assert!((found.solid.unwrap().volume / volume - 1.0).abs() < 2e-7, "{name}");
    }
}

#[test]
fn a_finer_icosphere_comes_nearer_to_the_sphere() {
    let sphere = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
    let mut error = f64::INFINITY;
    for n in 0..5 {
        let mesh = Triangles::icosphere(2.0, n).single();
        for (name, format, bytes) in all(&mesh) {
            let read = read_whole(format, &bytes);
            assert_eq!(read.triangles.len(), 20 << (2 * n), "{name}");
            assert_eq!(read.vertices.len(), (10 << (2 * n)) + 2, "{name}");
        }
        let found = figures_of(&read_whole(MeshFormat::Stl, &super::writing::stl_binary(&mesh, "")));
        let own = 1.0 - found.solid.unwrap().volume / sphere;
        assert!(own > 0.0 && own < error / 3.0, "{n}: {own} after {error}");
        error = own;
    }
    assert!(error < 3e-3, "{error}");
}

#[test]
fn all_formats_give_the_same_triangles() {
    let mesh = Triangles::icosphere(1.0, 2).single();
    let expected: Vec<[[f64; 3]; 3]> =
        mesh.triangles.iter().map(|corners| corners.map(|corner| mesh.points[corner])).collect();
    for (name, format, bytes) in all(&mesh) {
        let read = read_whole(format, &bytes);
        let found: Vec<_> = read.triangles.iter().map(|own| read.corners(own)).collect();
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn only_3mf_states_a_unit() {
    for (name, format, bytes) in all(&Triangles::tetrahedron([1.0; 3])) {
        let expected = (format == MeshFormat::ThreeMf).then_some(Unit::Millimetre);
        assert_eq!(read_whole(format, &bytes).unit, expected, "{name}");
    }
}

#[test]
fn more_triangles_than_allowed_are_refused() {
    for (name, format, bytes) in all(&Triangles::cuboid([0.0; 3], [1.0; 3])) {
        let budget = Budget::unlimited();
        assert!(read(format, &bytes, 12, &budget).is_ok(), "{name}");
        let fault = read(format, &bytes, 11, &budget).unwrap_err().to_string();
        assert!(fault.contains("triangles"), "{name}: {fault}");
    }
}

#[test]
fn a_stopped_budget_ends_every_reader() {
    let budget = Budget::unlimited();
    budget.cancel();
    for (name, format, bytes) in all(&Triangles::cuboid([0.0; 3], [1.0; 3])) {
        let found = read(format, &bytes, 12, &budget);
        assert!(matches!(found, Err(Unreadable::Stopped(_))), "{name}: {found:?}");
    }
}
