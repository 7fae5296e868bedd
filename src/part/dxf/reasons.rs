//! Why entities are left out.

pub const NOT_FLAT: &str = "its height changes, so that it is no curve in the plane";
pub const TILTED: &str = "its plane is not parallel to that of the drawing";
pub const NO_RADIUS: &str = "it has no radius above zero";
pub const NO_LENGTH: &str = "it has no length";
pub const NO_SCALE: &str = "its scale is zero";
pub const NO_BLOCK: &str = "the file has no block of its name";
pub const REFERENCE: &str = "its block is in another file";
pub const CLIPPED: &str = "blocks are drawn whole and not clipped by a boundary";
pub const MESH: &str = "meshes are no outlines";
pub const FEW_POINTS: &str = "it has too few points";
pub const NO_CURVE: &str = "its degree, knots, points and weights make no curve";
pub const DEGREE: &str = "splines of a degree above 7 are not supported";
pub const FAR: &str = "it lies more than 1e9 mm from the origin";
pub const ON_PAPER: &str = "it is drawn in paper space";
pub const INVISIBLE: &str = "it is invisible";
pub const FROZEN: &str = "its layer is frozen";
pub const OFF: &str = "its layer is off";
pub const NOT_ASKED: &str = "its layer is not among the layers that are asked for";
pub const BEHIND_END: &str = "bytes behind the end of the drawing are ignored";
pub const NO_END: &str = "the file ends without it";

/// Why no entity of a kind is read.
pub fn of_kind(kind: &[u8]) -> &'static str {
    match kind {
        b"TEXT" | b"MTEXT" | b"RTEXT" | b"ARCALIGNEDTEXT" | b"ATTRIB" | b"ATTDEF" => "texts are no outlines",
        b"DIMENSION"
        | b"ARC_DIMENSION"
        | b"LARGE_RADIAL_DIMENSION"
        | b"LEADER"
        | b"MULTILEADER"
        | b"MLEADER"
        | b"TOLERANCE"
        | b"ACAD_TABLE" => "dimensions and notes are no outlines",
        b"HATCH" | b"MPOLYGON" => "hatches are no outlines",
        b"SOLID" | b"TRACE" | b"3DFACE" => "filled faces are no outlines",
        b"POINT" => "points are no outlines",
        b"XLINE" | b"RAY" => "it has no end",
        b"3DSOLID" | b"BODY" | b"REGION" | b"SURFACE" | b"EXTRUDEDSURFACE" | b"LOFTEDSURFACE"
        | b"REVOLVEDSURFACE" | b"SWEPTSURFACE" | b"PLANESURFACE" | b"NURBSURFACE" => {
            "solids and surfaces are not read from drawings"
        }
        b"MESH" => MESH,
        b"VIEWPORT" | b"IMAGE" | b"WIPEOUT" | b"UNDERLAY" | b"PDFUNDERLAY" | b"DWFUNDERLAY"
        | b"DGNUNDERLAY" | b"OLEFRAME" | b"OLE2FRAME" | b"LIGHT" | b"SUN" => {
            "views and pictures are no outlines"
        }
        _ => "entities of this kind are not supported",
    }
}
