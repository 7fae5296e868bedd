//! Writes triangles as a binary STL file, in mm.
//!
//! The format holds single precision: far from the origin its numbers are coarser, by 6e-5 mm at a metre.
//! Cost O(n) for n triangles.

use nalgebra::{Point3, Vector3};

use crate::gltf::Triangles;

/// The first bytes of the file. They must not begin with `solid`, which stands for the format as text.
const TITLE: &[u8] = b"binary STL, lengths in mm";
const TITLE_BYTES: usize = 80;
const TRIANGLE_BYTES: usize = 50;

/// The file of triangles. Triangles without an area get no normal.
pub fn stl(triangles: &Triangles) -> Vec<u8> {
    let Triangles { points, triangles, .. } = triangles;
    let mut bytes = Vec::with_capacity(TITLE_BYTES + 4 + TRIANGLE_BYTES * triangles.len());
    bytes.extend_from_slice(TITLE);
    bytes.resize(TITLE_BYTES, 0);
    bytes.extend(u32::try_from(triangles.len()).unwrap_or(u32::MAX).to_le_bytes());
    for triangle in triangles {
        let [a, b, c]: [Point3<f64>; 3] = triangle.map(|k| points[k as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or(Vector3::zeros());
        for vector in [normal, a.coords, b.coords, c.coords] {
            bytes.extend(vector.iter().flat_map(|x| (*x as f32).to_le_bytes()));
        }
        bytes.extend([0, 0]);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid;

    #[test]
    fn a_block_has_twelve_triangles_with_its_corners_and_normals() {
        let file = stl(&solid::block([0.0; 3].into(), [1.0, 2.0, 3.0].into()));
        assert_eq!((file.len(), &file[80..84]), (84 + 12 * 50, &12_u32.to_le_bytes()[..]));
        assert!(!file.starts_with(b"solid"));
        let number = |at: usize| f32::from_le_bytes(file[at..at + 4].try_into().unwrap());
        let mut volume = 0.0;
        for first in (84..file.len()).step_by(50) {
            let vector = |k: usize| Vector3::from_fn(|axis, _| number(first + 12 * k + 4 * axis));
            let [normal, a, b, c] = [0, 1, 2, 3].map(vector);
            assert!(((b - a).cross(&(c - a)).normalize() - normal).norm() < 1e-6);
            volume += a.dot(&b.cross(&c)) / 6.0;
        }
        assert!((volume - 6.0).abs() < 1e-5);
    }
}
