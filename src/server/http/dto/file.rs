//! References to files in requests, and what is told of the files.

use axum::body::Bytes;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::decode::files::FileReading;
use crate::http::error::FieldCode;
use crate::http::messages::{WarningCode, left_out};
use crate::http::pointer::Pointer;
use toolpathd_part::dxf::DxfOptions;
use toolpathd_part::fault::Unreadable;
use toolpathd_part::format::Format;
use toolpathd_part::left_out::LeftOut;
use toolpathd_part::step::Model;
use toolpathd_part::unit::Unit;

/// The unit of the lengths of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FileUnits {
    /// Micrometres.
    Um,
    Mm,
    Cm,
    M,
    Inch,
    Foot,
}

impl From<FileUnits> for Unit {
    fn from(units: FileUnits) -> Self {
        match units {
            FileUnits::Um => Self::Micrometre,
            FileUnits::Mm => Self::Millimetre,
            FileUnits::Cm => Self::Centimetre,
            FileUnits::M => Self::Metre,
            FileUnits::Inch => Self::Inch,
            FileUnits::Foot => Self::Foot,
        }
    }
}

impl From<Unit> for FileUnits {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Micrometre => Self::Um,
            Unit::Millimetre => Self::Mm,
            Unit::Centimetre => Self::Cm,
            Unit::Metre => Self::M,
            Unit::Inch => Self::Inch,
            Unit::Foot => Self::Foot,
        }
    }
}

/// A reference to a file: what it is called, and where in the request the reference stands.
pub struct Reference<'a> {
    pub at: &'a Pointer,
    pub name: &'a str,
    pub base64: Option<&'a str>,
    pub units: Option<FileUnits>,
}

impl Reference<'_> {
    /// The bytes of the file; `None` with a violation where there is no such file.
    pub fn bytes(&self, reading: &mut FileReading) -> Option<Bytes> {
        reading.file(self.at, self.name, self.base64)
    }

    /// Adds a violation about the contents of the file.
    pub fn blame(&self, code: FieldCode, detail: &str, reading: &mut FileReading) {
        reading.violations.add(&self.at.field("name"), code, format!("`{}`: {detail}", self.name));
    }

    /// What a reader has read; `None` with a violation where the file is not readable.
    pub fn read<T>(&self, result: Result<T, Unreadable>, reading: &mut FileReading) -> Option<T> {
        match result {
            Ok(read) => Some(read),
            Err(Unreadable::Stopped(stopped)) => {
                reading.stop(stopped);
                None
            }
            Err(fault) => {
                self.blame(FieldCode::UnreadableFile, &fault.to_string(), reading);
                None
            }
        }
    }

    /// Millimetres in a unit of the file: the unit that the request states, or else the file.
    pub fn mm(&self, stated: Option<Unit>, reading: &mut FileReading) -> Option<f64> {
        let sent = self.units.map(Unit::from);
        if let (Some(sent), Some(stated)) = (sent, stated)
            && sent != stated
        {
            let detail = units_overridden(self.name, stated, sent);
            reading.warn(self.at, WarningCode::UnitsOverridden, detail);
        }
        let unit = sent.or(stated);
        if unit.is_none() {
            let detail = "the file states no unit of length: send `units`";
            self.blame(FieldCode::UnitMissing, detail, reading);
        }
        unit.map(Unit::mm)
    }

    /// Millimetres in each unit of the lengths of a model, which are mm where the file states a unit.
    pub fn mm_of_model(&self, model: &Model, reading: &mut FileReading) -> Option<f64> {
        // A unit that has no name here has its length in the file all the same.
        if model.is_unit_stated && self.units.is_none() {
            return Some(1.0);
        }
        self.mm(model.unit, reading).map(|mm| mm / model.mm_per_unit)
    }

    /// Tells what was left out of the file.
    pub fn tell_left_out(&self, all: &[LeftOut], reading: &mut FileReading) {
        if let Some(detail) = left_out(self.name, all) {
            reading.warn(self.at, WarningCode::FileLeftOut, detail);
        }
    }
}

/// The sentence about a file that states another unit than the request.
pub fn units_overridden(name: &str, stated: Unit, sent: Unit) -> String {
    format!("`{name}` states {}, and is read in {}, as `units` says", words(stated), words(sent))
}

/// Most curves of a drawing for each vertex that an outline may have.
const CURVES_FOR_EACH_VERTEX: usize = 4;

/// How a drawing is read.
pub fn drawing_options(
    limits: &Limits,
    layer: Option<String>,
    units: Option<FileUnits>,
    gap_mm: f64,
    tolerance_mm: f64,
) -> DxfOptions {
    DxfOptions {
        layers: layer.map(|layer| vec![layer]),
        gap_mm,
        tolerance_mm,
        unit: units.map(Unit::from),
        curve_limit: CURVES_FOR_EACH_VERTEX * limits.curve_points,
        vertex_limit: limits.curve_points,
    }
}

/// A unit in words.
fn words(unit: Unit) -> &'static str {
    match unit {
        Unit::Micrometre => "micrometres",
        Unit::Millimetre => "mm",
        Unit::Centimetre => "cm",
        Unit::Metre => "metres",
        Unit::Inch => "inches",
        Unit::Foot => "feet",
    }
}

/// A format in words.
pub fn format_name(format: Format) -> &'static str {
    match format {
        Format::Dxf => "DXF",
        Format::Points => "a text of points",
        Format::Step => "STEP",
        Format::Other(name) => name,
    }
}
