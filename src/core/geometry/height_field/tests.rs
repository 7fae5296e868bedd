use nalgebra::{Point2, Vector3};

use super::*;
use crate::geometry::surface::BicubicPatch;

fn grid(columns: usize, rows: usize, height: impl Fn(f64, f64) -> f64) -> HeightGrid {
    let row = |j: usize| (0..columns).map(|i| height(i as f64, j as f64)).collect();
    HeightGrid { origin: Point2::origin(), spacing_mm: 1.0, rows: (0..rows).map(row).collect() }
}

fn below(grid: &HeightGrid, z_mm: f64) -> Region {
    HeightField::of_grid(grid).region_below(z_mm, &Budget::unlimited()).unwrap()
}

#[test]
fn the_low_part_of_a_slope_is_a_rectangle() {
    let slope = grid(11, 5, |x, _| -x);
    for z in [-2.5, -4.0, -9.99] {
        let region = below(&slope, z);
        assert!((region.area() - 4.0 * (10.0 + z)).abs() < 1e-4, "{z}: {}", region.area());
        assert_eq!(region.parts().len(), 1);
    }
    assert!(below(&slope, -10.5).is_empty());
    assert!((below(&slope, 1.0).area() - 40.0).abs() < 1e-9);
}

#[test]
fn a_step_on_a_level_is_cleared_and_a_block_is_an_island() {
    // A plane at -5 with a block up to 0; level with the plane.
    let block =
        grid(11, 11, |x, y| if (4.0..=6.0).contains(&x) && (4.0..=6.0).contains(&y) { 0.0 } else { -5.0 });
    let region = below(&block, -5.0);
    // The foot of the block is on the points around it.
    assert!((region.area() - (100.0 - 16.0)).abs() < 1e-3, "{}", region.area());
    assert_eq!(region.faces()[0].islands.len(), 1);
    let half = below(&block, -2.5);
    assert!((half.area() - (100.0 - 9.0)).abs() < 0.4, "{}", half.area());
}

#[test]
fn level_curves_that_meet_in_a_saddle_bound_two_parts() {
    let saddle = grid(3, 3, |x, y| -(x - 1.0) * (y - 1.0));
    let region = below(&saddle, -1e-5);
    assert_eq!(region.parts().len(), 2);
    assert!(below(&saddle, 0.0).area() > 2.0 - 1e-3);
}

#[test]
fn rotated_and_mirrored_grids_have_the_same_areas() {
    let height = |x: f64, y: f64| (0.9 * x).sin() * (0.7 * y).cos() - 0.1 * x;
    let straight = grid(12, 9, height);
    let rotated = grid(9, 12, |x, y| height(y, 8.0 - x));
    let mirrored = grid(12, 9, |x, y| height(11.0 - x, y));
    for z in [-1.2, -0.5, 0.0, 0.3] {
        let area = below(&straight, z).area();
        assert!((below(&rotated, z).area() - area).abs() < 1e-6);
        assert!((below(&mirrored, z).area() - area).abs() < 1e-6);
    }
}

/// z = x² / 40 - 5 over 20 by 20 mm, with u along x, or along -x.
fn trough(is_reversed: bool) -> AnySurface {
    let side = if is_reversed { -1.0 } else { 1.0 };
    AnySurface::Bicubic(BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                // The Bezier points of the square of x, from -10 to 10.
                let square = [100.0, -100.0 / 3.0, -100.0 / 3.0, 100.0][a];
                let x = side * (-10.0 + 20.0 * a as f64 / 3.0);
                Vector3::new(x, -10.0 + 20.0 * b as f64 / 3.0, square / 40.0 - 5.0)
            })
        }),
    }))
}

#[test]
fn the_triangles_of_a_surface_lie_within_the_deviation() {
    for is_reversed in [false, true] {
        let surface = trough(is_reversed);
        let field = HeightField::of_surface(&surface, 1e-3, &Budget::unlimited()).unwrap();
        // x = sqrt(40 (z + 5)) on the surface; chords of a parabola lie above it.
        for z in [-4.5f64, -3.0, -2.6] {
            let width = 2.0 * (40.0 * (z + 5.0)).sqrt();
            let region = field.region_below(z, &Budget::unlimited()).unwrap();
            let found = region.area() / 20.0;
            let slope = width / 40.0;
            assert!(
                found <= width + 2.1e-3 && found >= width - (2.0 * 1e-3 / slope + 2.0 * 1e-3),
                "{z}: {found} {width}"
            );
        }
    }
}

#[test]
fn an_overhang_is_refused() {
    let curl = AnySurface::Bicubic(BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let (x, z) = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)][a];
                Vector3::new(x, b as f64, z)
            })
        }),
    }));
    let refused = HeightField::of_surface(&curl, 1e-2, &Budget::unlimited());
    assert!(matches!(refused, Err(HeightFieldError::Overhang { .. })), "{refused:?}");
}
