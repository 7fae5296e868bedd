//! Solids and sheets of a file: which faces they have.

use super::instance::{Instance, Source};
use super::refusal::Refusal;

/// The most faces of a file, with all copies.
pub const MOST_FACES: usize = 200_000;

/// Names of bodies, which are read even if no representation has them.
pub const SHAPES: [&str; 5] = [
    "MANIFOLD_SOLID_BREP",
    "BREP_WITH_VOIDS",
    "FACETED_BREP",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
];

/// The faces of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Shells {
    pub entity: u32,
    pub name: String,
    pub is_solid: bool,
    /// The numbers of the faces, each with whether its shell is turned inside out.
    pub faces: Vec<(u32, bool)>,
}

/// The body of a representation's item. `None` for what has no shape, such as a placement.
///
/// # Errors
/// The file is broken, or the item is of a kind that is left out.
pub fn shells(source: &Source, number: u32) -> Result<Option<Shells>, Refusal> {
    let instance = source.get(number)?;
    let part = instance.attributes();
    let add = |body: &mut Shells, numbers: &[u32]| -> Result<(), Refusal> {
        numbers.iter().try_for_each(|number| body.add_shell(source, *number, 0))
    };
    let mut body = Shells { entity: number, name: part.text(0), is_solid: true, faces: Vec::new() };
    match instance.kind() {
        "MANIFOLD_SOLID_BREP" | "FACETED_BREP" => add(&mut body, &[part.reference(1)?])?,
        "BREP_WITH_VOIDS" => {
            let mut numbers = vec![part.reference(1)?];
            numbers.extend(part.references(2)?);
            add(&mut body, &numbers)?;
        }
        "SHELL_BASED_SURFACE_MODEL" | "FACE_BASED_SURFACE_MODEL" => {
            let numbers = part.references(1)?;
            body.is_solid = !numbers.is_empty();
            for number in &numbers {
                body.is_solid &= source.get(*number)?.kind() == "CLOSED_SHELL";
            }
            add(&mut body, &numbers)?;
        }
        "CLOSED_SHELL" | "OPEN_SHELL" | "CONNECTED_FACE_SET" => {
            body.is_solid = instance.kind() == "CLOSED_SHELL";
            body.add_shell(source, number, 0)?;
        }
        "ADVANCED_FACE" | "FACE_SURFACE" => {
            body.is_solid = false;
            body.faces.push((number, false));
        }
        _ if is_solid_of_several_parts(&instance) => return complex(source, &instance),
        _ if has_no_shape(&instance) => return Ok(None),
        _ => return Err(left_out(&instance)),
    }
    Ok(Some(body))
}

fn is_solid_of_several_parts(instance: &Instance) -> bool {
    instance.is_complex() && instance.has("MANIFOLD_SOLID_BREP")
}

/// A solid whose attributes stand in several parts.
fn complex(source: &Source, instance: &Instance) -> Result<Option<Shells>, Refusal> {
    let name = instance.part("REPRESENTATION_ITEM").map_or(String::new(), |part| part.text(0));
    let mut body = Shells { entity: instance.number, name, is_solid: true, faces: Vec::new() };
    body.add_shell(source, instance.part("MANIFOLD_SOLID_BREP")?.reference(0)?, 0)?;
    if instance.has("BREP_WITH_VOIDS") {
        for void in instance.part("BREP_WITH_VOIDS")?.references(0)? {
            body.add_shell(source, void, 0)?;
        }
    }
    Ok(Some(body))
}

/// Items that place or measure, and are no shapes.
pub fn has_no_shape(instance: &Instance) -> bool {
    let kind = instance.kind();
    kind.contains("PLACEMENT")
        || kind.contains("TRANSFORMATION")
        || kind.contains("REPRESENTATION_ITEM")
        || matches!(kind, "CARTESIAN_POINT" | "DIRECTION" | "VECTOR" | "CAMERA_MODEL_D3")
}

fn left_out(instance: &Instance) -> Refusal {
    let kind = instance.name();
    let reason = match kind.as_str() {
        "GEOMETRIC_CURVE_SET" | "GEOMETRIC_SET" => "sets of points and curves have no faces",
        _ if kind.contains("WIREFRAME") => "wireframes have no faces",
        _ if kind.starts_with("TESSELLATED") => "triangles are no surfaces",
        _ => "items of this kind have no faces that are read",
    };
    Refusal::shape(&kind, reason, instance.place())
}

impl Shells {
    fn add_shell(&mut self, source: &Source, number: u32, depth: usize) -> Result<(), Refusal> {
        let instance = source.get(number)?;
        let part = instance.attributes();
        match instance.kind() {
            "CLOSED_SHELL" | "OPEN_SHELL" | "CONNECTED_FACE_SET" => {
                for face in part.references(1)? {
                    self.add_face(source, face)?;
                }
                Ok(())
            }
            "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL" if depth == 0 => {
                let before = self.faces.len();
                self.add_shell(source, part.reference(2)?, depth + 1)?;
                if !part.truth(3)? {
                    self.faces[before..].iter_mut().for_each(|(_, is_turned)| *is_turned ^= true);
                }
                Ok(())
            }
            kind => Err(Refusal::shape(kind, "shells of this kind are not read", instance.place())),
        }
    }

    fn add_face(&mut self, source: &Source, number: u32) -> Result<(), Refusal> {
        let instance = source.get(number)?;
        if self.faces.len() == MOST_FACES {
            return Err(instance.fault(format!("there are more than {MOST_FACES} faces")).into());
        }
        if instance.kind() == "ORIENTED_FACE" {
            let part = instance.attributes();
            self.faces.push((part.reference(2)?, !part.truth(3)?));
        } else {
            self.faces.push((number, false));
        }
        Ok(())
    }
}
