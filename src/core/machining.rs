//! Cutters on surfaces: where a cutter touches a surface, how deep the cutter cuts into the surface, and
//! which curves the tip or the centre of the cutter follows. These modules know nothing of feeds, programs or
//! JSON.
//!
//! # Example
//! A ball whose tip runs 1 mm below a plane is proved to cut 1 mm deep.
//!
//! ```
//! use nalgebra::Point3;
//! use toolpathd_core::budget::Budget;
//! use toolpathd_core::geometry::curve::{Curve, Line};
//! use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
//! use toolpathd_core::machining::cutter::Cutter;
//! use toolpathd_core::machining::gouge::GougeProof;
//!
//! let points = [0.0, 40.0].map(|x| [0.0, 40.0].map(|y| Point3::new(x, y, 0.0)).to_vec()).to_vec();
//! let plane = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual }.surface().unwrap();
//! let proof = GougeProof::new(&plane, &Cutter::ball(5.0), 0.0);
//! let tip = Curve::Line(Line { start: Point3::new(10.0, 20.0, -1.0), end: Point3::new(30.0, 20.0, -1.0) });
//! let gap = 0.001;
//! let penetration = proof.penetration(&[tip], gap, &Budget::unlimited()).unwrap();
//! assert!((1.0..=1.0 + gap).contains(&penetration.bound_mm));
//! ```

pub mod assembly;
pub mod cutter;
pub mod drop_cutter;
pub mod engagement;
pub mod gouge;
pub mod offset_section;
pub mod prism;
pub mod regularity;
pub mod stock;
pub mod uncut;
pub mod upper_envelope;
pub mod walls;
pub mod wire_model;
