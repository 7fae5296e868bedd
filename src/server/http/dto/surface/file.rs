//! The surface kind `file` in requests: a surface in a file that is sent with the request.

mod mesh;

use std::collections::BTreeSet;
use std::sync::Arc;

use nalgebra::Point3;
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
use toolpathd_core::geometry::surface::triangle_mesh::TriangleMesh;
use toolpathd_part::format::Format;
use toolpathd_part::points::grid::{Grid, NoGrid, grid};
use toolpathd_part::points::{self, PointText};
use toolpathd_part::step::{self, Model};

/// A surface in a file: a mesh of triangles (STL, OBJ, PLY, 3MF), a text of measured points that make a grid,
/// or faces of a solid in STEP.
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
    /// The faces of a STEP file, by their numbers in `/v1/parts/inspect`, counted from 0. Only these faces
    /// count: the cutter may cut into others. One face that is the whole of its surface (`is_untrimmed`) is
    /// taken exactly; several faces, and faces within edges of their own, are taken as triangles. Default:
    /// all faces.
    #[schema(value_type = Option<FaceNumbers>)]
    faces: Option<Vec<usize>>,
    /// How far the triangles that stand for faces of a STEP file may be from the faces, in mm. Where it is
    /// sent, a single face is taken as triangles too.
    #[schema(minimum = 0.000_01, maximum = 1, default = 0.001)]
    triangles_within_mm: Option<f64>,
    /// How far a point may be from its row and its column in plan, in mm. Points in any order are put into
    /// rows and columns, which may be turned in plan and have any spacing. Default: a tenth of the least
    /// spacing.
    #[schema(minimum = 0, maximum = 1000)]
    grid_within_mm: Option<f64>,
    /// The mesh of the file, once it was read.
    #[serde(skip)]
    #[schema(ignore)]
    mesh: Option<Arc<TriangleMesh>>,
}

/// What a file holds.
pub enum Found {
    Surface(Surface),
    Mesh(Arc<TriangleMesh>),
}

schema_of!(FaceNumbers, "Numbers of faces, counted from 0.", {
    let number = ObjectBuilder::new().schema_type(Type::Integer).minimum(Some(0)).maximum(Some(1_000_000));
    array_of(number, 1, MOST_FACES)
});

/// The most faces that a request names.
const MOST_FACES: usize = 10_000;

/// Legal distances of triangles from faces, mm, and the distance where the request states none.
const TRIANGLES_WITHIN: Range = Range { min: 0.000_01, max: 1.0 };
const TRIANGLES_WITHIN_MM: f64 = 0.001;

/// Legal distances from rows and columns, mm.
const WITHIN: Range = Range { min: 0.0, max: 1000.0 };

impl SurfaceFile {
    /// The name by which the request refers to the file.
    pub fn file_name(&self) -> &str {
        &self.name
    }

    /// The mesh of the file, once it was read.
    pub fn mesh(&self) -> Option<&Arc<TriangleMesh>> {
        self.mesh.as_ref()
    }

    /// Keeps the mesh of the file.
    pub fn keep(&mut self, mesh: Arc<TriangleMesh>) {
        self.mesh = Some(mesh);
    }

    /// Two opposite corners of the box of the mesh, mm.
    pub fn bounds(&self) -> Option<(Point3<f64>, Point3<f64>)> {
        self.mesh.as_ref().map(|mesh| (mesh.bounds().min.into(), mesh.bounds().max.into()))
    }

    /// What the file holds; `None` with a violation where it is no surface.
    pub fn found(&self, at: &Pointer, reading: &mut FileReading) -> Option<Found> {
        let before = reading.violations.total();
        reading.violations.optional(&at.field("grid_within_mm"), self.grid_within_mm, WITHIN, "mm");
        let (within, range) = (self.triangles_within_mm, TRIANGLES_WITHIN);
        reading.violations.optional(&at.field("triangles_within_mm"), within, range, "mm");
        if reading.violations.total() > before {
            return None;
        }
        let reference = Reference { at, name: &self.name, base64: self.base64.as_deref(), units: self.units };
        let bytes = reference.bytes(reading)?;
        match Format::of(&self.name, &bytes) {
            Format::Points => {
                self.refuse(&[self.of_step(), self.of_triangles()].concat(), at, reading)?;
                self.point_grid(&reference, &bytes, reading).map(Surface::PointGrid).map(Found::Surface)
            }
            Format::Step => {
                self.refuse(&self.of_points(), at, reading)?;
                self.of_faces(&reference, &bytes, reading)
            }
            Format::Mesh(format) => {
                self.refuse(&[self.of_step(), self.of_triangles(), self.of_points()].concat(), at, reading)?;
                mesh::of_file(&reference, format, &bytes, reading).map(Found::Mesh)
            }
            other => {
                let detail = format!(
                    "a surface is read from STEP, a mesh of triangles or a text of points, and this is {}",
                    format_name(other)
                );
                reference.blame(FieldCode::Unsupported, &detail, reading);
                None
            }
        }
    }

    fn of_step(&self) -> Vec<(&'static str, bool)> {
        vec![("faces", self.faces.is_some())]
    }

    fn of_triangles(&self) -> Vec<(&'static str, bool)> {
        vec![("triangles_within_mm", self.triangles_within_mm.is_some())]
    }

    fn of_points(&self) -> Vec<(&'static str, bool)> {
        vec![("grid_within_mm", self.grid_within_mm.is_some())]
    }

    /// Refuses members that belong to other formats, each with whether it is sent.
    fn refuse(&self, members: &[(&str, bool)], at: &Pointer, reading: &mut FileReading) -> Option<()> {
        let before = reading.violations.total();
        for (name, _) in members.iter().filter(|(_, is_sent)| *is_sent) {
            let detail = "this member belongs to another format of files; leave it out";
            reading.violations.add(&at.field(name), FieldCode::Conflict, detail);
        }
        (reading.violations.total() == before).then_some(())
    }

    /// The faces of a STEP file: one as it is, or triangles that stand for them.
    fn of_faces(&self, file: &Reference, bytes: &[u8], reading: &mut FileReading) -> Option<Found> {
        let model = file.read(step::read(bytes, reading.budget), reading)?;
        let mm = file.mm_of_model(&model, reading)?;
        let faces = self.chosen(&model, file, reading)?;
        file.tell_left_out(&model.left_out, reading);
        if let ([only], None) = (&faces[..], self.triangles_within_mm)
            && model.faces[*only].is_untrimmed
        {
            return Some(Found::Surface(Surface::Nurbs(Nurbs::scaled(&model.faces[*only].nurbs, mm))));
        }
        let within_mm = self.triangles_within_mm.unwrap_or(TRIANGLES_WITHIN_MM);
        mesh::of_faces(file, (&model, &faces), mm, within_mm, reading).map(Found::Mesh)
    }

    /// The faces that `faces` chooses, or all; `None` with a violation where there are none.
    fn chosen(&self, model: &Model, file: &Reference, reading: &mut FileReading) -> Option<Vec<usize>> {
        let (at, n_faces) = (file.at.field("faces"), model.faces.len());
        let Some(numbers) = &self.faces else {
            if n_faces == 0 {
                file.blame(FieldCode::UnreadableFile, "no face of the file is read", reading);
                return None;
            }
            if !model.left_out.is_empty() {
                let detail = "parts of the file are left out, and the cutter would cut into them: name the faces that count; `/v1/parts/inspect` lists them, and what is left out";
                reading.violations.add(&at, FieldCode::MissingField, detail);
                return None;
            }
            return Some((0..n_faces).collect());
        };
        let before = reading.violations.total();
        if numbers.is_empty() || numbers.len() > MOST_FACES {
            let detail = format!("send 1 to {MOST_FACES} numbers");
            reading.violations.add(&at, FieldCode::WrongLength, detail);
        }
        let mut seen = BTreeSet::new();
        for (k, number) in numbers.iter().enumerate() {
            if *number >= n_faces {
                let detail = format!("there are {n_faces} faces, counted from 0");
                reading.violations.add(&at.index(k), FieldCode::OutOfRange, detail);
            } else if !seen.insert(*number) {
                let detail = "the face is named twice";
                reading.violations.add(&at.index(k), FieldCode::Conflict, detail);
            }
        }
        (reading.violations.total() == before).then(|| numbers.clone())
    }

    fn point_grid(&self, file: &Reference, bytes: &[u8], reading: &mut FileReading) -> Option<PointGrid> {
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
