//! Reliefs in requests for pockets: measured heights or a surface, and how islands are found in them.

use nalgebra::Point2;
use serde::Deserialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::point_faults::{self, Outliers};
use crate::http::dto::schema::{array_of, number, schema_of};
use crate::http::dto::surface::Surface;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::height_field::HeightGrid;
use toolpathd_core::geometry::point_judge::judge_heights;
use toolpathd_core::operations::pocketing as core;

/// The default size of the cells of labelling on a surface, in diameters of the cutter.
const DEFAULT_CELL: f64 = 0.1;

/// Measured heights at the points of a grid with rows parallel to x and columns parallel to y. Between four
/// neighbouring points, the part is taken to be four triangles. They meet in the middle, at the mean of the
/// four heights.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Heights {
    /// The place `[x, y]` of the first height, in mm.
    #[schema(min_items = 2, max_items = 2)]
    origin: [f64; 2],
    /// Distance of neighbouring places along x and along y, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    spacing_mm: f64,
    /// Heights in mm: `z[j][i]` at `[x0 + i spacing_mm, y0 + j spacing_mm]`. At least 2 rows of at least 2
    /// heights; every row is as long as the first row.
    #[schema(value_type = HeightRows)]
    z: Vec<Vec<f64>>,
    /// What to do with heights that look like mistakes: numbers that stand for missing values, and heights
    /// off the surface of their neighbours. `refuse`: the answer is a problem that names each of them.
    /// `accept`: they are heights of the part.
    #[serde(default)]
    #[schema(default = "refuse")]
    outliers: Outliers,
}

schema_of!(HeightRows, "Rows of heights, in mm. Every row is as long as the first row.", {
    let most = Limits::DEFAULT.surface_points / 2;
    array_of(array_of(number(Range::COORDINATE), 2, most), 2, most)
});

/// How the islands of a level are found in `heights` or `surface`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum IslandsBy {
    /// Exactly, from the level curves.
    #[default]
    Slicing,
    /// From the grid points that are higher than the level's floor, as in the paper. Islands are then as
    /// coarse as the grid, and the path may cut into the part.
    Labelling,
}

/// The members of a request that describe a relief, and whether there is a region.
pub struct SentRelief {
    pub surface: Option<Surface>,
    pub heights: Option<Heights>,
    pub islands_by: IslandsBy,
    pub cell_mm: Option<f64>,
    pub roughing_allowance_mm: Option<f64>,
    /// Whether the request has a region.
    pub has_region: bool,
}

impl SentRelief {
    /// The heights in the core's terms, and how islands are found. Adds violations to `violations`.
    pub fn convert(
        self,
        diameter_mm: f64,
        limits: &Limits,
        violations: &mut Violations,
    ) -> (Option<core::Relief>, core::IslandsBy) {
        let root = Pointer::root();
        let Self { surface, heights, islands_by, cell_mm, roughing_allowance_mm, has_region } = self;
        violations.optional(&root.field("cell_mm"), cell_mm, Range::POSITIVE, "mm");
        let allowance = root.field("roughing_allowance_mm");
        violations.optional(&allowance, roughing_allowance_mm, Range::POSITIVE, "mm");
        let is_grid = heights.is_some();
        let relief = match (surface, heights) {
            (Some(_), Some(_)) => {
                let detail = "send `heights` or `surface`, not both";
                violations.add(&root.field("heights"), FieldCode::Conflict, detail);
                None
            }
            (Some(surface), None) => {
                surface.check(&root.field("surface"), limits, violations);
                // A surface with violations cannot be converted; the caller stops at them.
                (violations.total() == 0).then(|| core::Relief::Surface(surface.into()))
            }
            (None, Some(heights)) => heights.convert(&root.field("heights"), limits, violations),
            (None, None) => {
                if !has_region {
                    let detail = "the pocket has no shape: send `region`, `regions`, `heights` or `surface`";
                    violations.add(&root.field("region"), FieldCode::MissingField, detail);
                }
                let without = [
                    ("roughing_allowance_mm", roughing_allowance_mm.is_some()),
                    ("cell_mm", cell_mm.is_some()),
                    ("islands_by", islands_by == IslandsBy::Labelling),
                ];
                for (field, _) in without.into_iter().filter(|(_, is_sent)| *is_sent) {
                    let detail =
                        "this member belongs to `heights` or `surface`: send one of them, or leave this out";
                    violations.add(&root.field(field), FieldCode::Conflict, detail);
                }
                None
            }
        };
        if cell_mm.is_some() && (is_grid || relief.is_some() && islands_by == IslandsBy::Slicing) {
            let detail = "`cell_mm` belongs to a `surface` with `islands_by: labelling`; leave it out";
            violations.add(&root.field("cell_mm"), FieldCode::Conflict, detail);
        }
        let islands_by = match islands_by {
            IslandsBy::Slicing => core::IslandsBy::Slicing,
            IslandsBy::Labelling => {
                core::IslandsBy::Labelling { cell_mm: cell_mm.unwrap_or(DEFAULT_CELL * diameter_mm) }
            }
        };
        (relief, islands_by)
    }
}

impl Heights {
    fn convert(self, at: &Pointer, limits: &Limits, violations: &mut Violations) -> Option<core::Relief> {
        let Self { origin, spacing_mm, z, outliers } = self;
        for (axis, value) in origin.into_iter().enumerate() {
            violations.number(&at.field("origin").index(axis), value, Range::COORDINATE, "mm");
        }
        violations.number(&at.field("spacing_mm"), spacing_mm, Range::POSITIVE, "mm");
        let rows = at.field("z");
        let total: usize = z.iter().map(|row| row.len().max(1)).sum();
        if total > limits.surface_points {
            let detail = format!("there are {total} heights; send at most {}", limits.surface_points);
            violations.add(&rows, FieldCode::LimitExceeded, detail);
            return None;
        }
        if z.len() < 2 {
            let detail = format!("there are {} rows; send at least 2", z.len());
            violations.add(&rows, FieldCode::TooFewPoints, detail);
        }
        let columns = z.first().map_or(0, Vec::len);
        for (j, row) in z.iter().enumerate() {
            if row.len() < 2 {
                let detail = format!("the row has {} heights; send at least 2", row.len());
                violations.add(&rows.index(j), FieldCode::TooFewPoints, detail);
            } else if row.len() != columns {
                let detail =
                    format!("the row has {} heights and row 0 has {columns}; send equally many", row.len());
                violations.add(&rows.index(j), FieldCode::RaggedGrid, detail);
            }
            for (i, value) in row.iter().enumerate().filter(|(_, value)| !Range::COORDINATE.holds(**value)) {
                violations.number(&rows.index(j).index(i), *value, Range::COORDINATE, "mm");
            }
        }
        let is_legal = z.iter().flatten().all(|height| Range::COORDINATE.holds(*height));
        if outliers == Outliers::Refuse && is_legal {
            point_faults::add(&rows, &judge_heights(spacing_mm, &z).faults, violations);
        }
        Some(core::Relief::Grid(HeightGrid { origin: Point2::from(origin), spacing_mm, rows: z }))
    }
}
