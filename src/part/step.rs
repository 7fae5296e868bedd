//! Solids and sheets in STEP files: ISO 10303-21 with the shapes of AP203, AP214 and AP242.
//!
//! # Method
//! 1. One pass finds where the instances are (`index`); values are read when they are asked for (`text`).
//! 2. The representations are walked from the top of the assembly (`representation`, `assembly`) to the faces
//!    of each body (`bodies`), which are read once and placed as often as they occur.
//! 3. A face is a surface with edges in space. The edges are taken into the plane of its parameters (`trim`),
//!    where its area (`area`) and its B-spline (`nurbs_form`) come from.
//! 4. Holes and levels are found among the placed faces (`features`).
//!
//! # Guarantees
//! * A file with a broken instance that a shape needs is refused, with the number of the instance. A face of
//!   a kind that is not read, or whose bounds do not close, is listed as left out.
//! * Representations, curves and surfaces that contain themselves are refused.
//!
//! # Known limitations
//! * The limits of trimmed surfaces and the curves in the plane of the parameters are not used: the edges in
//!   space are the bounds.
//! * Offset surfaces and curves, composite curves as edges, wireframes and triangles are left out.
//!
//! # Reference
//! ISO 10303-21:2016, ISO 10303-42:2021.

pub mod curve;
pub mod frame;
pub mod model;
pub mod spline_curve;
pub mod spline_surface;
pub mod surface;

mod area;
mod assembly;
mod basis;
mod bodies;
mod chain;
mod curve_reading;
mod extent;
mod face_building;
mod face_reading;
mod features;
mod gauss;
mod index;
mod instance;
mod nurbs_form;
mod parameter_search;
mod piece;
mod placement;
mod refusal;
mod representation;
mod seam;
mod string;
mod surface_reading;
mod text;
mod trim;
mod units;

pub use model::{Body, Edge, Face, Hole, LevelFaces, Loop, Model};

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;
use toolpathd_core::budget::Budget;

use self::assembly::PlacedItem;
use self::bodies::{MOST_FACES, SHAPES, Shells, shells};
use self::frame::Similarity;
use self::index::Index;
use self::instance::Source;
use self::placement::Geometry;
use self::refusal::{Omission, Refusal};
use self::representation::placed_items;
use self::units::Units;
use super::fault::{Place, Unreadable};
use super::left_out::LeftOuts;

/// A face in a scale: its number, and the bits of the mm in its unit.
type Key = (u32, u64);

/// Reads a STEP file.
///
/// # Errors
/// The file is no STEP file, is broken where a shape needs it, or has more than the reader takes; or the
/// budget has ended.
pub fn read(bytes: &[u8], budget: &Budget) -> Result<Model, Unreadable> {
    let source = Source { bytes, index: Index::of(bytes, budget)? };
    let mut left_out = LeftOuts::default();
    let placed = placed_bodies(&source, &mut left_out, budget)?;
    let faces = distinct_faces(&source, &placed, &mut left_out, budget)?;
    let mut model = Model {
        schema: source.index.schema.clone(),
        unit: None,
        mm_per_unit: 1.0,
        is_unit_stated: false,
        bodies: Vec::new(),
        faces: Vec::new(),
        holes: Vec::new(),
        levels: Vec::new(),
        left_out: Vec::new(),
        bounds_mm: None,
    };
    if let Some((item, _)) = placed.first() {
        model.unit = item.units.length();
        model.mm_per_unit = item.units.mm;
        model.is_unit_stated = item.units.has_length;
    }
    for (item, shells) in &placed {
        add_body(&mut model, item, shells, &faces, budget)?;
    }
    budget.check()?;
    model.bounds_mm = whole_box(&model.faces);
    model.holes = features::holes(&model.bodies, &model.faces);
    model.levels = features::levels(&model.faces);
    model.left_out = left_out.list();
    Ok(model)
}

/// The bodies of the file at their places.
fn placed_bodies(
    source: &Source,
    left_out: &mut LeftOuts,
    budget: &Budget,
) -> Result<Vec<(PlacedItem, Shells)>, Unreadable> {
    let assembly::Found { mut items, empty } = placed_items(source, budget)?;
    for node in empty {
        let reason = "it has no shape; the part may be in a file of its own";
        left_out.add("SHAPE_REPRESENTATION", reason, Place::Entity(u64::from(node)));
    }
    let found: BTreeSet<u32> = items.iter().map(|item| item.item).collect();
    let units = items.first().map_or_else(Units::unstated, |item| item.units);
    for (number, _) in source.index.roots.iter().filter(|(_, name)| SHAPES.contains(&name.as_str())) {
        if !found.contains(number) {
            items.push(PlacedItem { item: *number, units, by: Similarity::identity() });
        }
    }
    let mut known: BTreeMap<u32, Option<Shells>> = BTreeMap::new();
    let mut placed = Vec::new();
    let mut n_faces = 0;
    for item in items {
        budget.check()?;
        let body = match known.entry(item.item) {
            Entry::Occupied(found) => found.into_mut(),
            Entry::Vacant(free) => free.insert(kept(shells(source, item.item), left_out)?.flatten()),
        };
        let Some(body) = body else { continue };
        n_faces += body.faces.len();
        if n_faces > MOST_FACES {
            let place = Place::Entity(u64::from(item.item));
            return Err(Unreadable::at(place, format!("there are more than {MOST_FACES} faces")));
        }
        placed.push((item, body.clone()));
    }
    Ok(placed)
}

/// What was read, or `None` with a note of what is left out.
fn kept<T>(read: Result<T, Refusal>, left_out: &mut LeftOuts) -> Result<Option<T>, Unreadable> {
    match read {
        Ok(found) => Ok(Some(found)),
        Err(Refusal::File(unreadable)) => Err(unreadable),
        Err(Refusal::Shape(Omission { kind, reason, entity })) => {
            left_out.add(&kind, &reason, Place::Entity(entity));
            Ok(None)
        }
    }
}

/// The mm in the unit of an item, with the scale of its place.
fn scale(item: &PlacedItem) -> f64 {
    item.units.mm * item.by.scale
}

/// Each face that occurs, once for each scale.
fn distinct_faces(
    source: &Source,
    placed: &[(PlacedItem, Shells)],
    left_out: &mut LeftOuts,
    budget: &Budget,
) -> Result<BTreeMap<Key, Face>, Unreadable> {
    let mut wanted: Vec<(u32, Units)> = Vec::new();
    let mut seen: BTreeSet<Key> = BTreeSet::new();
    for (item, body) in placed {
        let units = Units { mm: scale(item), ..item.units };
        for (number, _) in &body.faces {
            if seen.insert((*number, units.mm.to_bits())) {
                wanted.push((*number, units));
            }
        }
    }
    let n = wanted.len();
    let read = |k: usize| -> Result<Result<Face, Omission>, Unreadable> {
        budget.check()?;
        budget.progress("faces", k, n);
        let (number, units) = wanted[k];
        let outline = (Geometry { source, units, budget }).face(number);
        match outline.and_then(|outline| face_building::face(outline, budget)) {
            Ok(face) => Ok(Ok(face)),
            Err(Refusal::Shape(omission)) => Ok(Err(omission)),
            Err(Refusal::File(unreadable)) => Err(unreadable),
        }
    };
    let mut faces = BTreeMap::new();
    for ((number, units), face) in wanted.iter().zip(budget.in_order(n, read)?) {
        if let Some(face) = kept(face.map_err(Refusal::Shape), left_out)? {
            faces.insert((*number, units.mm.to_bits()), face);
        }
    }
    Ok(faces)
}

/// Adds a body with its faces at their place.
fn add_body(
    model: &mut Model,
    item: &PlacedItem,
    shells: &Shells,
    faces: &BTreeMap<Key, Face>,
    budget: &Budget,
) -> Result<(), Unreadable> {
    let first = model.faces.len();
    for (number, is_turned) in &shells.faces {
        budget.check()?;
        let Some(face) = faces.get(&(*number, scale(item).to_bits())) else { continue };
        let mut copy = face_building::placed(face, &item.by.placement, model.bodies.len());
        copy.is_reversed ^= is_turned;
        if !copy.bounds_mm.iter().flat_map(|corner| corner.iter()).all(|x| x.is_finite()) {
            let place = Place::Entity(u64::from(*number));
            return Err(Unreadable::at(place, "the coordinates of the face are too large"));
        }
        model.faces.push(copy);
    }
    model.bodies.push(Body {
        entity: u64::from(shells.entity),
        name: shells.name.clone(),
        is_solid: shells.is_solid,
        faces: first..model.faces.len(),
    });
    Ok(())
}

fn whole_box(faces: &[Face]) -> Option<[Point3<f64>; 2]> {
    let boxes = faces.iter().map(|face| face.bounds_mm);
    boxes.reduce(|[low, high], [lower, higher]| [low.inf(&lower), high.sup(&higher)])
}

#[cfg(test)]
mod tests;
