//! The computations of toolpathd, without input or output: geometry, cutters, machines, toolpaths, and one
//! module for each operation. Each operation has a function `plan(&job, &budget)`. With the feature `wire`,
//! reports, enums and plain settings are JSON by serde, and have schemas by utoipa.
//!
//! Points and vectors are types of `nalgebra`. Lengths are mm, and angles are radians unless a name says
//! otherwise.
//!
//! # Example
//! From the points of a surface to a toolpath with proved figures: a ball cutter of radius 5 mm mills a plane
//! that rises 1 mm in 2 mm.
//!
//! ```
//! use nalgebra::Point3;
//! use toolpathd_core::budget::Budget;
//! use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
//! use toolpathd_core::geometry::surface::source::Source;
//! use toolpathd_core::operations::surface_milling::{Job, plan};
//! use toolpathd_core::toolpath::tool::Tool;
//! use toolpathd_core::toolpath::units::{FeedRate, Tolerance};
//!
//! let places = [0.0, 10.0, 20.0, 30.0];
//! let points = places.map(|x| places.map(|y| Point3::new(x, y, x / 2.0)).to_vec()).to_vec();
//! let grid = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual };
//! let surface = Source::PointGrid(grid);
//! let tolerance = Tolerance::from_mm(0.01).unwrap();
//! let feed = FeedRate::from_mm_per_min(1000.0).unwrap();
//! let job = Job::new(surface, Tool::ball(5.0), 1.0, tolerance, feed);
//! let plan = plan(&job, &Budget::unlimited()).unwrap();
//!
//! // Each pass is one line, and no move cuts deeper into the plane than the tolerance.
//! let report = plan.report;
//! assert_eq!((report.n_lines, report.n_arcs), (report.n_passes, 0));
//! assert!(report.deviation_max_mm <= 0.01 && report.gouge_max_mm <= 0.01);
//! // Between two passes the ball comes no nearer to the plane than this. The bound is a little above it.
//! let half = 0.5 * report.stepover_mm;
//! let left = f64::hypot(5.0, half) - 5.0;
//! assert!((left..1.2 * left).contains(&report.scallop_max_mm.unwrap()));
//! ```

pub mod budget;
pub mod geometry;
pub mod language;
pub mod machine;
pub mod machining;
pub mod operations;
pub mod parallel;
pub mod toolpath;
#[cfg(feature = "wire")]
pub mod wire;
