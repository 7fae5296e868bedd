//! The offset of a surface along its normal, as a point and its first derivatives. A ball that rolls on the
//! surface has its centre on the offset.

use nalgebra::{Point3, Vector3};

use super::Jet;

/// A point of the offset surface S + R n with its first derivatives; mm per unit of parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetJet {
    pub point: Point3<f64>,
    /// Unit normal of the surface. It is also the unit normal of the offset where the offset does not fold.
    pub normal: Vector3<f64>,
    pub du: Vector3<f64>,
    pub dv: Vector3<f64>,
}

/// The offset by `radius` mm of the surface with this jet (Ju eq. 2). The derivatives of the normal follow
/// from Weingarten's equations. `None` where the surface has no normal.
pub fn offset(jet: &Jet, radius: f64) -> Option<OffsetJet> {
    let cross = jet.normal();
    let length = cross.norm();
    if length.is_nan() || length <= 0.0 {
        return None;
    }
    let normal = cross / length;
    let turned = |d: Vector3<f64>| (d - normal * normal.dot(&d)) * (radius / length);
    let cross_u = jet.duu.cross(&jet.dv) + jet.du.cross(&jet.duv);
    let cross_v = jet.duv.cross(&jet.dv) + jet.du.cross(&jet.dvv);
    Some(OffsetJet {
        point: jet.point + normal * radius,
        normal,
        du: jet.du + turned(cross_u),
        dv: jet.dv + turned(cross_v),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_of_a_sphere_is_a_sphere() {
        let (u, v) = (0.4f64, 0.9f64);
        let (r, offset_by) = (40.0, 5.0);
        let on = |u: f64, v: f64| Vector3::new(u.cos() * v.sin(), u.sin() * v.sin(), v.cos()) * r;
        let (su, cu, sv, cv) = (u.sin(), u.cos(), v.sin(), v.cos());
        let jet = Jet {
            point: Point3::from(on(u, v)),
            // Parameters are exchanged so that the normal points outward.
            du: Vector3::new(cu * cv, su * cv, -sv) * r,
            dv: Vector3::new(-su * sv, cu * sv, 0.0) * r,
            duu: -on(u, v),
            duv: Vector3::new(-su * cv, cu * cv, 0.0) * r,
            dvv: Vector3::new(-cu * sv, -su * sv, 0.0) * r,
        };
        let off = offset(&jet, offset_by).unwrap();
        assert!((off.point.coords - on(u, v) * (45.0 / 40.0)).norm() < 1e-12);
        assert!((off.du - jet.du * (45.0 / 40.0)).norm() < 1e-12);
        assert!((off.dv - jet.dv * (45.0 / 40.0)).norm() < 1e-12);
    }
}
