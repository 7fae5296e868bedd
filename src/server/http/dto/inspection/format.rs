//! The formats of files in reports.

use serde::Serialize;
use utoipa::ToSchema;

use toolpathd_part::mesh::MeshFormat;

/// A format of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FileFormat {
    Dxf,
    Points,
    Step,
    Stl,
    Obj,
    Ply,
    #[serde(rename = "3mf")]
    ThreeMf,
}

impl From<MeshFormat> for FileFormat {
    fn from(format: MeshFormat) -> Self {
        match format {
            MeshFormat::Stl => Self::Stl,
            MeshFormat::Obj => Self::Obj,
            MeshFormat::Ply => Self::Ply,
            MeshFormat::ThreeMf => Self::ThreeMf,
        }
    }
}
