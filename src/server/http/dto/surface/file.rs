//! The surface kind `file` in requests: a surface in a file that is sent with the request.

use serde::Deserialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::{Nurbs, PointGrid, Surface};
use crate::http::decode::files::FileReading;
use crate::http::decode::tagged::Kind;
use crate::http::dto::check::Range;
use crate::http::dto::file::{FileUnits, Reference, format_name};
use crate::http::dto::point::Coordinates;
use crate::http::dto::schema::{array_of, schema_of};
use crate::http::error::FieldCode;
use crate::http::messages::{WarningCode, no_grid};
use crate::http::pointer::Pointer;
use toolpathd_part::format::Format;
use toolpathd_part::points::grid::{Grid, NoGrid, grid};
use toolpathd_part::points::{self, PointText};
use toolpathd_part::step::{self, Face, Model};

/// A surface in a file: a text of measured points that make a grid, or a face of a solid in STEP.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceFile {
    #[serde(rename = "kind")]
    #[schema(ignore)]
    _kind: Kind,
    /// The name of the file: that of its part of the body (`multipart/form-data`), or any name beside
    /// `base64`.
    #[schema(max_length = 200)]
    name: String,
    /// The file in base64. Default: the part of the body with this name.
    #[schema(max_length = 16_777_216)]
    base64: Option<String>,
    /// The unit of the file. Default: the unit that the file states; a file that states none is refused.
    units: Option<FileUnits>,
    /// The face of a STEP file, by its number in `/v1/parts/inspect`, counted from 0. The face has to be the
    /// whole of its surface (`is_untrimmed`). Default: the only face.
    #[schema(value_type = Option<FaceNumbers>)]
    faces: Option<Vec<usize>>,
    /// How far a point may be from its row and its column in plan, in mm. Points in any order are put into
    /// rows and columns, which may be turned in plan and have any spacing. Default: a tenth of the least
    /// spacing.
    #[schema(minimum = 0, maximum = 1000)]
    grid_within_mm: Option<f64>,
}

schema_of!(FaceNumbers, "Numbers of faces, counted from 0.", {
    let number = ObjectBuilder::new().schema_type(Type::Integer).minimum(Some(0)).maximum(Some(1_000_000));
    array_of(number, 1, 1)
});

/// Legal distances from rows and columns, mm.
const WITHIN: Range = Range { min: 0.0, max: 1000.0 };

impl SurfaceFile {
    /// The name by which the request refers to the file.
    pub fn file_name(&self) -> &str {
        &self.name
    }

    /// The surface of the file; `None` with a violation where there is none.
    pub fn surface(&self, at: &Pointer, reading: &mut FileReading) -> Option<Surface> {
        let before = reading.violations.total();
        reading.violations.optional(&at.field("grid_within_mm"), self.grid_within_mm, WITHIN, "mm");
        if reading.violations.total() > before {
            return None;
        }
        let reference = Reference { at, name: &self.name, base64: self.base64.as_deref(), units: self.units };
        let bytes = reference.bytes(reading)?;
        match Format::of(&self.name, &bytes) {
            Format::Points => self.point_grid(&reference, &bytes, reading).map(Surface::PointGrid),
            Format::Step => self.face(&reference, &bytes, reading).map(Surface::Nurbs),
            other => {
                let detail = format!(
                    "a surface is read from STEP or a text of points, and this is {}",
                    format_name(other)
                );
                reference.blame(FieldCode::Unsupported, &detail, reading);
                None
            }
        }
    }

    /// The face of a STEP file.
    fn face(&self, file: &Reference, bytes: &[u8], reading: &mut FileReading) -> Option<Nurbs> {
        if self.grid_within_mm.is_some() {
            let detail = "this member belongs to points; leave it out";
            reading.violations.add(&file.at.field("grid_within_mm"), FieldCode::Conflict, detail);
            return None;
        }
        let model = file.read(step::read(bytes, reading.budget), reading)?;
        let mm = file.mm_of_model(&model, reading)?;
        let face = self.chosen(&model, file.at, reading)?;
        file.tell_left_out(&model.left_out, reading);
        Some(Nurbs::scaled(&face.nurbs, mm))
    }

    /// The face that `faces` chooses, or the only one; `None` with a violation where it is not milled.
    fn chosen<'m>(&self, model: &'m Model, at: &Pointer, reading: &mut FileReading) -> Option<&'m Face> {
        let (at, n_faces) = (at.field("faces"), model.faces.len());
        let violations = &mut reading.violations;
        let number = match self.faces.as_deref() {
            Some([number]) => *number,
            Some(_) => {
                let detail = "one face is milled at a time: send one number";
                violations.add(&at, FieldCode::WrongLength, detail);
                return None;
            }
            None if n_faces == 1 => 0,
            None => {
                let detail = format!(
                    "there are {n_faces} faces: choose one, such as [3]; `/v1/parts/inspect` lists them"
                );
                violations.add(&at, FieldCode::MissingField, detail);
                return None;
            }
        };
        let face = model.faces.get(number);
        if face.is_none() {
            let detail = format!("there are {n_faces} faces, counted from 0");
            violations.add(&at.index(0), FieldCode::OutOfRange, detail);
        }
        let face = face?;
        if !face.is_untrimmed {
            let detail =
                "the face is a part of its surface, within edges of its own: such a face is not milled yet";
            violations.add(&at.index(0), FieldCode::Unsupported, detail);
            return None;
        }
        Some(face)
    }

    fn point_grid(&self, file: &Reference, bytes: &[u8], reading: &mut FileReading) -> Option<PointGrid> {
        if self.faces.is_some() {
            let detail = "this member belongs to STEP; leave it out";
            reading.violations.add(&file.at.field("faces"), FieldCode::Conflict, detail);
            return None;
        }
        let text = points::read(bytes, reading.limits.surface_points, reading.budget);
        let text = file.read(text, reading)?;
        if text.columns[2].is_none() {
            file.blame(
                FieldCode::UnreadableFile,
                "the points have no z; a surface needs x, y and z",
                reading,
            );
            return None;
        }
        let mm = file.mm(text.unit, reading)?;
        let points: Vec<[f64; 3]> = text.points.iter().map(|point| point.map(|value| value * mm)).collect();
        let found = match grid(&points, self.grid_within_mm, reading.budget) {
            Ok(found) => found,
            Err(NoGrid::Stopped(stopped)) => {
                reading.stop(stopped);
                return None;
            }
            Err(fault) => {
                file.blame(FieldCode::UnreadableFile, &no_grid(&fault, &text.lines), reading);
                return None;
            }
        };
        file.tell_left_out(&text.left_out, reading);
        reading.warn(file.at, WarningCode::PointsGridded, gridded(file.name, &text, &found));
        // Along u from left to right, along v from below.
        let (n_columns, rows) = (found.rows[0].len(), &found.rows);
        let of = |i: usize| rows.iter().map(|row| Coordinates(points[row[i]])).collect();
        Some(PointGrid::of_points((0..n_columns).map(of).collect()))
    }
}

/// What was understood of a text of points.
fn gridded(name: &str, text: &PointText, found: &Grid) -> String {
    let Grid { rows, angle, off, spacing } = found;
    let turned = if angle.abs() < 1e-9 {
        String::new()
    } else {
        format!(", turned by {:.4} degrees", angle.to_degrees())
    };
    format!(
        "`{name}` is read as numbers between {}, with a decimal {}: {} points in {} rows and {} columns{turned}, at least {spacing:.4} mm apart, at most {off:.4} mm off their rows and columns",
        text.writing.separator_name(),
        if text.writing.has_decimal_comma { "comma" } else { "point" },
        text.points.len(),
        rows.len(),
        rows[0].len(),
    )
}
