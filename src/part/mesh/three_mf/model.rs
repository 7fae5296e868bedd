//! A model of a 3MF file: its objects, and what is built of them.

use std::collections::BTreeMap;

use toolpathd_core::budget::Budget;

use super::tags::{Start, Tags};
use crate::fault::{Place, Unreadable};
use crate::left_out::LeftOuts;
use crate::mesh::{STEPS_PER_CHECK, is_coordinate};
use crate::unit::Unit;

/// Most objects that are placed. Assemblies of assemblies may name more without end in a small file.
pub const MOST_PLACED: usize = 1_000_000;

/// The namespaces of elements and attributes that are read.
const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
const PRODUCTION: &str = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";

/// Extensions that a model may require: they change no shape, or they are read.
const READ: [&str; 4] = [
    CORE,
    PRODUCTION,
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
];

/// Most names of elements that are listed as left out.
const MOST_NAMES: usize = 50;

/// A model.
pub struct Model {
    pub unit: Unit,
    pub objects: BTreeMap<u32, Object>,
    pub build: Vec<Component>,
}

/// An object: triangles, or other objects.
#[derive(Default)]
pub struct Object {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub components: Vec<Component>,
    /// Whether it is for the support of a part that is printed.
    pub is_support: bool,
}

/// An object with its place.
pub struct Component {
    /// The part of the archive with its model; `None` for the same model.
    pub path: Option<String>,
    pub object: u32,
    /// Rows of a matrix; a point is a row before it: the images of x, y and z, and the image of the origin.
    pub rows: [[f64; 3]; 4],
    pub place: Place,
}

/// Reads the text of a part that is a model.
///
/// # Errors
/// When it is no model, requires extensions that are not read, or has more than `most_triangles` triangles.
pub fn read(
    text: &str,
    part: &str,
    most_triangles: usize,
    left_out: &mut LeftOuts,
    budget: &Budget,
) -> Result<Model, Unreadable> {
    let mut tags = Tags::new(text, part);
    let root = tags.root()?;
    let names = Names::of(&root, &tags)?;
    if names.core(&root) != Some("model") {
        return Err(tags.fault("it is no model of the core specification of 3MF"));
    }
    let unit = match attribute(&root, "", "unit", &tags)?.as_deref() {
        None | Some("millimeter") => Unit::Millimetre,
        Some("micron") => Unit::Micrometre,
        Some("centimeter") => Unit::Centimetre,
        Some("meter") => Unit::Metre,
        Some("inch") => Unit::Inch,
        Some("foot") => Unit::Foot,
        Some(other) => return Err(tags.fault(&format!("\"{other}\" is no unit of 3MF"))),
    };
    let model = Model { unit, objects: BTreeMap::new(), build: Vec::new() };
    let mut reading = ModelReading {
        names,
        model,
        n_left: most_triangles,
        left_out,
        listed: Vec::new(),
        n_placed: 0,
        n_passed: 0,
        budget,
    };
    tags.children(|tags, start| match reading.names.core(&start) {
        Some("resources") => tags.children(|tags, start| match reading.names.core(&start) {
            Some("object") => reading.object(tags, &start),
            _ => reading.leave_out(tags, &start),
        }),
        Some("build") => tags.children(|tags, start| match reading.names.core(&start) {
            Some("item") => {
                reading.count(tags)?;
                let item = reading.names.component(&start, tags)?;
                reading.model.build.push(item);
                tags.skip(&start)
            }
            _ => reading.leave_out(tags, &start),
        }),
        _ => reading.leave_out(tags, &start),
    })?;
    Ok(reading.model)
}

/// The prefixes of the namespaces, as the root of a model gives them.
struct Names {
    core: Vec<String>,
    production: Vec<String>,
}

impl Names {
    /// # Errors
    /// When the model requires an extension that is not read.
    fn of(root: &Start, tags: &Tags) -> Result<Self, Unreadable> {
        let mut prefixes = BTreeMap::new();
        let mut required = String::new();
        for attribute in root.attributes() {
            match attribute.map_err(|fault| tags.fault(&fault))? {
                (("xmlns", prefix), value) => drop(prefixes.insert(prefix.to_owned(), value.into_owned())),
                (("", "xmlns"), value) => drop(prefixes.insert(String::new(), value.into_owned())),
                (("", "requiredextensions"), value) => required = value.into_owned(),
                _ => {}
            }
        }
        for prefix in required.split_ascii_whitespace() {
            let name = prefixes.get(prefix).map_or(prefix, String::as_str);
            if !READ.contains(&name) {
                return Err(
                    tags.fault(&format!("the model requires the extension {name}, which is not read"))
                );
            }
        }
        let of = |name| {
            let own = prefixes.iter().filter(|(_, value)| *value == name);
            own.map(|(prefix, _)| prefix.clone()).collect()
        };
        Ok(Self { core: of(CORE), production: of(PRODUCTION) })
    }

    /// The name of an element of the core specification; `None` for other elements.
    fn core<'s>(&self, start: &'s Start) -> Option<&'s str> {
        let (prefix, name) = start.name();
        self.core.iter().any(|own| own == prefix).then_some(name)
    }

    /// A component of an object, or an item of the build.
    fn component(&self, start: &Start, tags: &Tags) -> Result<Component, Unreadable> {
        let object = attribute(start, "", "objectid", tags)?;
        let object = object.and_then(|id| id.trim().parse().ok());
        let object = object.ok_or_else(|| tags.fault("it names no object"))?;
        let mut path = None;
        for prefix in self.production.iter().filter(|prefix| !prefix.is_empty()) {
            path = path.or(attribute(start, prefix, "path", tags)?);
        }
        let rows = match attribute(start, "", "transform", tags)? {
            Some(text) => {
                rows(&text).ok_or_else(|| tags.fault("a place has twelve numbers, and makes nothing flat"))?
            }
            None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]],
        };
        Ok(Component { path, object, rows, place: tags.place() })
    }
}

/// The rows of a matrix in a text; `None` where it has no inverse.
fn rows(text: &str) -> Option<[[f64; 3]; 4]> {
    let numbers = text.split_ascii_whitespace().map(|word| word.parse().ok().filter(|m| is_coordinate(*m)));
    let numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
    let numbers: [f64; 12] = numbers.try_into().ok()?;
    let rows = [0, 3, 6, 9].map(|k| [numbers[k], numbers[k + 1], numbers[k + 2]]);
    (determinant(&rows) != 0.0).then_some(rows)
}

/// How much larger a volume becomes; negative where it is mirrored.
pub fn determinant([x, y, z, _]: &[[f64; 3]; 4]) -> f64 {
    let cross = crate::mesh::welding::cross(*x, *y);
    crate::mesh::welding::dot(cross, *z)
}

/// A model that is being read.
struct ModelReading<'r> {
    names: Names,
    model: Model,
    /// How many triangles may still be read.
    n_left: usize,
    left_out: &'r mut LeftOuts,
    /// The names of elements that are listed as left out.
    listed: Vec<String>,
    /// Objects, components and items that were read.
    n_placed: usize,
    /// Elements that were passed over.
    n_passed: usize,
    budget: &'r Budget,
}

impl ModelReading<'_> {
    fn object<'a>(&mut self, tags: &mut Tags<'a>, start: &Start<'a>) -> Result<(), Unreadable> {
        self.count(tags)?;
        let id = attribute(start, "", "id", tags)?.and_then(|id| id.trim().parse::<u32>().ok());
        let id = id.ok_or_else(|| tags.fault("an object has no number"))?;
        let kind = attribute(start, "", "type", tags)?;
        let is_support = matches!(kind.as_deref(), Some("support" | "solidsupport"));
        let mut object = Object { is_support, ..Object::default() };
        tags.children(|tags, start| match self.names.core(&start) {
            Some("mesh") => self.mesh(tags, &mut object),
            Some("components") => tags.children(|tags, start| match self.names.core(&start) {
                Some("component") => {
                    self.count(tags)?;
                    object.components.push(self.names.component(&start, tags)?);
                    tags.skip(&start)
                }
                _ => self.leave_out(tags, &start),
            }),
            _ => self.leave_out(tags, &start),
        })?;
        if self.model.objects.insert(id, object).is_some() {
            return Err(tags.fault(&format!("two objects have the number {id}")));
        }
        Ok(())
    }

    fn mesh(&mut self, tags: &mut Tags, object: &mut Object) -> Result<(), Unreadable> {
        tags.children(|tags, start| match self.names.core(&start) {
            Some("vertices") => tags.children(|tags, start| match self.names.core(&start) {
                Some("vertex") => {
                    self.check_budget(object.vertices.len())?;
                    object.vertices.push(vertex(&start, tags)?);
                    tags.skip(&start)
                }
                _ => self.leave_out(tags, &start),
            }),
            Some("triangles") => tags.children(|tags, start| match self.names.core(&start) {
                Some("triangle") => {
                    self.check_budget(object.triangles.len())?;
                    object.triangles.push(triangle(&start, object.vertices.len(), tags)?);
                    let left = self.n_left.checked_sub(1);
                    self.n_left = left.ok_or_else(|| tags.fault("there are too many triangles"))?;
                    tags.skip(&start)
                }
                _ => self.leave_out(tags, &start),
            }),
            _ => self.leave_out(tags, &start),
        })
    }

    /// Counts an object, a component or an item.
    fn count(&mut self, tags: &Tags) -> Result<(), Unreadable> {
        self.n_placed += 1;
        self.check_budget(self.n_placed)?;
        if self.n_placed > MOST_PLACED {
            let detail = format!("there are more than {MOST_PLACED} objects, components and items");
            return Err(tags.fault(&detail));
        }
        Ok(())
    }

    fn check_budget(&self, n: usize) -> Result<(), Unreadable> {
        if n.is_multiple_of(STEPS_PER_CHECK) {
            self.budget.check()?;
        }
        Ok(())
    }

    /// Passes over an element that is not read.
    fn leave_out<'a>(&mut self, tags: &mut Tags<'a>, start: &Start<'a>) -> Result<(), Unreadable> {
        self.n_passed += 1;
        self.check_budget(self.n_passed)?;
        let (_, name) = start.name();
        let is_listed = self.listed.iter().any(|listed| listed == name);
        let kind = if is_listed || self.listed.len() < MOST_NAMES { name } else { "element" };
        if !is_listed && kind == name {
            self.listed.push(name.to_owned());
        }
        self.left_out.add(kind, "elements of its name are not read", tags.place());
        tags.skip(start)
    }
}

fn vertex(start: &Start, tags: &Tags) -> Result<[f64; 3], Unreadable> {
    let mut point = [None; 3];
    for attribute in start.attributes() {
        let (name, value) = attribute.map_err(|fault| tags.fault(&fault))?;
        let value = || value.trim().parse().ok().filter(|value| is_coordinate(*value));
        match name {
            ("", "x") => point[0] = value(),
            ("", "y") => point[1] = value(),
            ("", "z") => point[2] = value(),
            _ => {}
        }
    }
    let [Some(x), Some(y), Some(z)] = point else { return Err(tags.fault("a vertex lacks a coordinate")) };
    Ok([x, y, z])
}

fn triangle(start: &Start, n_vertices: usize, tags: &Tags) -> Result<[u32; 3], Unreadable> {
    let mut corners = [None; 3];
    for attribute in start.attributes() {
        let (name, value) = attribute.map_err(|fault| tags.fault(&fault))?;
        let value = || value.trim().parse().ok().filter(|corner: &u32| (*corner as usize) < n_vertices);
        match name {
            ("", "v1") => corners[0] = value(),
            ("", "v2") => corners[1] = value(),
            ("", "v3") => corners[2] = value(),
            _ => {}
        }
    }
    let [Some(a), Some(b), Some(c)] = corners else {
        let detail = format!("a corner of a triangle is none of the {n_vertices} vertices before it");
        return Err(tags.fault(&detail));
    };
    Ok([a, b, c])
}

/// The value of an attribute.
fn attribute(start: &Start, prefix: &str, name: &str, tags: &Tags) -> Result<Option<String>, Unreadable> {
    for attribute in start.attributes() {
        let (found, value) = attribute.map_err(|fault| tags.fault(&fault))?;
        if found == (prefix, name) {
            return Ok(Some(value.into_owned()));
        }
    }
    Ok(None)
}
