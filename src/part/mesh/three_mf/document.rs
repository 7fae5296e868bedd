//! All models of a 3MF file that its build needs.

use std::collections::BTreeMap;

use toolpathd_core::budget::Budget;

use super::model::{self, Component, Model, Object};
use super::tags::Tags;
use super::zip::Archive;
use crate::fault::{Place, Unreadable};
use crate::left_out::LeftOuts;
use crate::unit::Unit;

/// The kind of the relationship that names the model of the file.
const MODEL_RELATIONSHIP: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

/// Where the model is by custom.
const USUAL_MODEL: &str = "3D/3dmodel.model";

/// The models of a file.
pub struct Models {
    /// The unit of all models.
    pub unit: Unit,
    /// The name of the part with the build.
    pub main: String,
    pub models: BTreeMap<String, Model>,
}

impl Models {
    /// The object that a component names, and the part that holds it. `part` is that of the component.
    pub fn object(&self, part: &str, component: &Component) -> Option<(&str, &Object)> {
        let part = component.path.as_deref().map_or_else(|| part.to_owned(), normal);
        let (part, model) = self.models.get_key_value(&part)?;
        Some((part, model.objects.get(&component.object)?))
    }
}

/// Reads the model of a file, and those that it names.
///
/// # Errors
/// When a model is missing or broken, or all have more than `most_triangles` triangles.
pub fn read(
    archive: &mut Archive,
    most_triangles: usize,
    left_out: &mut LeftOuts,
    budget: &Budget,
) -> Result<Models, Unreadable> {
    let main = normal(&name_of_model(archive, budget)?);
    let mut models = BTreeMap::new();
    let mut unit = Unit::Millimetre;
    let mut wanted = vec![main.clone()];
    let mut n_left = most_triangles;
    while let Some(name) = wanted.pop() {
        if models.contains_key(&name) {
            continue;
        }
        let text = archive.text(&name, budget)?;
        let model = model::read(&text, &name, n_left, left_out, budget)?;
        n_left = n_left.saturating_sub(model.objects.values().map(|object| object.triangles.len()).sum());
        if name == main {
            unit = model.unit;
        } else if model.unit != unit {
            return Err(Unreadable::at(Place::File, format!("{name} has another unit than {main}")));
        }
        let components = model.objects.values().flat_map(|object| &object.components);
        wanted.extend(components.chain(&model.build).filter_map(|own| own.path.as_deref()).map(normal));
        models.insert(name, model);
    }
    leave_out_parts(archive, &models, left_out);
    Ok(Models { unit, main, models })
}

/// The name of a part as it is compared: without a slash before it, in lower case.
fn normal(name: &str) -> String {
    name.trim_start_matches('/').to_ascii_lowercase()
}

fn name_of_model(archive: &mut Archive, budget: &Budget) -> Result<String, Unreadable> {
    let has = |archive: &Archive, name: &str| archive.names().any(|own| normal(own) == normal(name));
    let mut found = None;
    if has(archive, "_rels/.rels") {
        let text = archive.text("_rels/.rels", budget)?;
        let mut tags = Tags::new(&text, "_rels/.rels");
        tags.root()?;
        tags.children(|tags, start| {
            let (mut kind, mut target) = (None, None);
            for attribute in start.attributes() {
                match attribute.map_err(|fault| tags.fault(&fault))? {
                    (("", "Type"), value) => kind = Some(value.into_owned()),
                    (("", "Target"), value) => target = Some(value.into_owned()),
                    _ => {}
                }
            }
            if kind.as_deref() == Some(MODEL_RELATIONSHIP) && found.is_none() {
                found = target;
            }
            tags.skip(&start)
        })?;
    }
    match found {
        Some(name) => Ok(name),
        None if has(archive, USUAL_MODEL) => Ok(USUAL_MODEL.to_owned()),
        None => Err(Unreadable::at(Place::File, "the ZIP archive holds no model of 3MF")),
    }
}

/// Counts the parts that are not read, apart from those that only tell what the others are.
fn leave_out_parts(archive: &Archive, models: &BTreeMap<String, Model>, left_out: &mut LeftOuts) {
    let is_read = |name: &String| {
        models.contains_key(name)
            || name.ends_with(".rels")
            || name == "[content_types].xml"
            || name.ends_with('/')
    };
    let n_others = archive.names().map(normal).filter(|name| !is_read(name)).count();
    left_out.add_many("part of the archive", "it holds no object of the build", n_others, Place::File);
}
