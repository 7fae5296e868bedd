//! Surfaces of a file.

use std::f64::consts::FRAC_PI_2;

use toolpathd_core::geometry::surface::nurbs::Nurbs;

use super::curve_reading::{KnotPlace, check, check_weights, degree};
use super::instance::Instance;
use super::placement::Geometry;
use super::refusal::Refusal;
use super::spline_surface::SplineSurface;
use super::surface::Surface;

/// How deep surfaces refer to surfaces.
const DEEPEST: usize = 8;

/// The least half angle of a cone, radians, and its least distance from a right angle. A cone of a smaller
/// angle is a cylinder within 1e-6 mm over a metre.
const LEAST_ANGLE: f64 = 1e-9;

impl Geometry<'_> {
    /// A surface, without the limits of a trimmed surface.
    ///
    /// # Errors
    /// The file is broken, or the surface is of a kind that is left out.
    pub fn surface(&self, number: u32) -> Result<Surface, Refusal> {
        self.surface_below(number, 0)
    }

    fn surface_below(&self, number: u32, depth: usize) -> Result<Surface, Refusal> {
        let instance = self.source.get(number)?;
        if depth > DEEPEST {
            return Err(instance.fault("surfaces refer to surfaces in a circle, or too deep").into());
        }
        let part = instance.attributes();
        let frame = || self.frame(part.reference(1)?);
        let positive = |k: usize| self.length(&instance, part, k);
        match instance.kind() {
            "PLANE" => Ok(Surface::Plane { frame: frame()? }),
            "CYLINDRICAL_SURFACE" => Ok(Surface::Cylinder { frame: frame()?, radius_mm: positive(2)? }),
            "CONICAL_SURFACE" => self.cone(&instance),
            "SPHERICAL_SURFACE" => Ok(Surface::Sphere { frame: frame()?, radius_mm: positive(2)? }),
            "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => Ok(Surface::Torus {
                frame: frame()?,
                major_radius_mm: positive(2)?,
                minor_radius_mm: positive(3)?,
                is_inner: part.enumeration(4) == Some("F"),
            }),
            "SURFACE_OF_LINEAR_EXTRUSION" => Ok(Surface::Extrusion {
                curve: self.curve(part.reference(1)?)?,
                along: self.vector(part.reference(2)?)?,
            }),
            "SURFACE_OF_REVOLUTION" => Ok(Surface::Revolution {
                curve: self.curve(part.reference(1)?)?,
                frame: self.frame(part.reference(2)?)?,
                range: self.trimmed_range(part.reference(1)?)?,
            }),
            "RECTANGULAR_TRIMMED_SURFACE" | "CURVE_BOUNDED_SURFACE" => {
                self.surface_below(part.reference(1)?, depth + 1)
            }
            "B_SPLINE_SURFACE_WITH_KNOTS"
            | "UNIFORM_SURFACE"
            | "QUASI_UNIFORM_SURFACE"
            | "BEZIER_SURFACE" => self.spline_surface(&instance),
            _ if instance.has("B_SPLINE_SURFACE") => self.spline_surface(&instance),
            _ => {
                let reason = "surfaces of this kind are not read";
                Err(Refusal::shape(&instance.name(), reason, instance.place()))
            }
        }
    }

    fn cone(&self, instance: &Instance) -> Result<Surface, Refusal> {
        let part = instance.attributes();
        let frame = self.frame(part.reference(1)?)?;
        let radius_mm = part.real(2)? * self.units.mm;
        let half_angle_rad = part.real(3)? * self.units.radians;
        if !(radius_mm >= 0.0 && radius_mm.is_finite()) {
            return Err(instance.fault("the radius of a cone must not be below zero").into());
        }
        let size = half_angle_rad.abs();
        if !(LEAST_ANGLE..FRAC_PI_2 - LEAST_ANGLE).contains(&size) {
            if size < LEAST_ANGLE && radius_mm > 0.0 {
                return Ok(Surface::Cylinder { frame, radius_mm });
            }
            return Err(instance
                .fault("half the angle of a cone must be between 0 and a right angle")
                .into());
        }
        Ok(Surface::Cone { frame, radius_mm, half_angle_rad })
    }

    fn spline_surface(&self, instance: &Instance) -> Result<Surface, Refusal> {
        let (part, first) = if instance.is_complex() {
            (instance.part("B_SPLINE_SURFACE")?, 0)
        } else {
            (instance.attributes(), 1)
        };
        let degree = [degree(instance, part, first)?, degree(instance, part, first + 1)?];
        let rows = part.rows_of_references(first + 2)?;
        let columns = rows.first().map_or(0, Vec::len);
        if columns == 0 || rows.iter().any(|row| row.len() != columns) {
            return Err(instance.fault("the rows of control points differ in length, or are empty").into());
        }
        let counts = [rows.len(), columns];
        let mut knots = [Vec::new(), Vec::new()];
        for along in [0, 1] {
            let place = KnotPlace { instance, curve_or_surface: "SURFACE", along, after: first + 7 };
            knots[along] = place.knots(degree[along], counts[along])?;
            check(instance, degree[along], &knots[along], counts[along])?;
        }
        let weights = if instance.has("RATIONAL_B_SPLINE_SURFACE") {
            let weights = instance.part("RATIONAL_B_SPLINE_SURFACE")?.rows_of_reals(0)?;
            if weights.len() != rows.len() || weights.iter().any(|row| row.len() != columns) {
                return Err(instance.fault("the weights do not fit the control points").into());
            }
            check_weights(instance, &weights.concat(), rows.len() * columns)?;
            Some(weights)
        } else {
            None
        };
        let control_points = rows.iter().map(|row| self.points(row)).collect::<Result<_, _>>()?;
        Ok(Surface::Spline(SplineSurface::new(Nurbs { degree, knots, control_points, weights })))
    }
}
