//! The three coordinate planes in which a machine runs arcs. Each plane has a local frame: two axes in the
//! plane, and its normal.

use nalgebra::{Point3, Vector3};

/// The plane of an arc: `xy` (G17), `zx` (G18) or `yz` (G19).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize, utoipa::ToSchema))]
#[cfg_attr(feature = "wire", serde(rename_all = "snake_case"), schema(as = ArcPlane))]
pub enum Plane {
    /// The first axis is x, the second y and the normal z: right-handed in this order, as in all three. Arcs
    /// are counterclockwise as seen from the positive side of the normal.
    Xy,
    /// The first axis is z, the second x and the normal y.
    Zx,
    /// The first axis is y, the second z and the normal x.
    Yz,
}

impl Plane {
    pub const ALL: [Plane; 3] = [Plane::Xy, Plane::Zx, Plane::Yz];

    /// The indices in (x, y, z) of the first axis, the second axis and the normal.
    pub const fn axes(self) -> [usize; 3] {
        match self {
            Plane::Xy => [0, 1, 2],
            Plane::Zx => [2, 0, 1],
            Plane::Yz => [1, 2, 0],
        }
    }

    /// The coordinates (first, second, normal) of a workpiece point, mm.
    ///
    /// # Example
    /// ```
    /// use nalgebra::{Point3, Vector3};
    /// use toolpathd_core::geometry::plane::Plane;
    ///
    /// let p = Point3::new(1.0, 2.0, 3.0);
    /// let local = Plane::Zx.to_local(&p);
    /// assert_eq!(local, Vector3::new(3.0, 1.0, 2.0));
    /// assert_eq!(Plane::Zx.to_workpiece(&local), p);
    /// ```
    pub fn to_local(self, p: &Point3<f64>) -> Vector3<f64> {
        let [a, b, n] = self.axes();
        Vector3::new(p[a], p[b], p[n])
    }

    /// The workpiece point with coordinates (first, second, normal), mm.
    pub fn to_workpiece(self, local: &Vector3<f64>) -> Point3<f64> {
        let [a, b, n] = self.axes();
        let mut p = Point3::origin();
        (p[a], p[b], p[n]) = (local.x, local.y, local.z);
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_right_handed_and_invertible() {
        for plane in Plane::ALL {
            let unit = |k: usize| {
                let mut v = Vector3::zeros();
                v[k] = 1.0;
                v
            };
            let [a, b, n] = plane.axes().map(unit);
            assert_eq!(a.cross(&b), n);
            let p = Point3::new(1.0, 2.0, 3.0);
            assert_eq!(plane.to_workpiece(&plane.to_local(&p)), p);
        }
    }
}
