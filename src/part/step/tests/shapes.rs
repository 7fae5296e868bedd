//! Faces that several tests read, and what every face must keep.

use toolpathd_core::geometry::surface::Surface as _;

use super::writer::{UP, Writer};
use crate::step::Face;
use crate::step::parameter_search::ParameterSearch;

/// A plane face at a height, counterclockwise seen from above.
pub fn level(w: &mut Writer, bounds: &[usize], height: f64) -> usize {
    let frame = w.upright([0.0, 0.0, height]);
    let plane = w.add(format!("PLANE('',#{frame})"));
    w.face(bounds, plane, true)
}

pub fn square(w: &mut Writer, side: f64, height: f64) -> usize {
    let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(|[x, y]| [x, y, height]);
    let bound = w.polygon(&corners);
    level(w, &[bound], height)
}

/// The edge of a circle about the z axis.
pub fn ring(w: &mut Writer, radius: f64, height: f64) -> usize {
    let frame = w.upright([0.0, 0.0, height]);
    w.circle(frame, radius, [radius, 0.0, height])
}

/// The wall of a cylinder about the z axis between two heights, with no seam. Seen from inside if it is a
/// hole.
pub fn wall(w: &mut Writer, radius: f64, rings: [usize; 2], is_hole: bool) -> usize {
    let frame = w.upright([0.0; 3]);
    let cylinder = w.add(format!("CYLINDRICAL_SURFACE('',#{frame},{radius:?})"));
    let bounds = [w.bound(&[(rings[0], !is_hole)]), w.bound(&[(rings[1], is_hole)])];
    w.face(&bounds, cylinder, !is_hole)
}

/// The edge of a whole circle in the plane of two directions.
pub fn circle(w: &mut Writer, origin: [f64; 3], z: [f64; 3], x: [f64; 3], radius: f64) -> usize {
    let frame = w.frame(origin, z, x);
    let start = [0, 1, 2].map(|k| origin[k] + radius * x[k]);
    w.circle(frame, radius, start)
}

pub fn sphere(w: &mut Writer, radius: f64) -> usize {
    let frame = w.frame([0.0; 3], UP, [1.0, 0.0, 0.0]);
    w.add(format!("SPHERICAL_SURFACE('',#{frame},{radius:?})"))
}

/// The area is as expected within 1e-9, and the points of the B-spline lie on the surface and in the box.
pub fn check(face: &Face, area: f64) {
    assert!((face.area_mm2 / area - 1.0).abs() < 1e-9, "the area is {}, not {area}", face.area_mm2);
    let surface = face.nurbs.surface().unwrap();
    let search = ParameterSearch::new(&face.surface);
    let [nu, nv] = surface.spans();
    for k in 0..40 {
        let place = |n: usize, step: f64| n as f64 * (f64::from(k) * step).fract();
        let point = surface.jet(place(nu, 0.618), place(nv, 0.445)).point;
        let miss = search.miss(&point, search.of(&point, None));
        assert!(miss < 1e-9, "{point} is {miss:e} mm from the surface");
        if face.is_untrimmed {
            let [low, high] = face.bounds_mm;
            let is_inside = (0..3).all(|k| point[k] > low[k] - 1e-6 && point[k] < high[k] + 1e-6);
            assert!(is_inside, "{point} is not between {low} and {high}");
        }
    }
}

pub fn check_box(face: &Face, low: [f64; 3], high: [f64; 3]) {
    let found = face.bounds_mm.map(|corner| [corner.x, corner.y, corner.z]);
    for k in 0..3 {
        let gap = (found[0][k] - low[k]).abs().max((found[1][k] - high[k]).abs());
        assert!(gap < 1e-6, "the box is {found:?}, not {low:?} to {high:?}");
    }
}
