//! PLY: elements with properties, as text or binary; the header tells how they are written.
//!
//! # Method
//! The header names elements in the order of the file, with their counts and properties. The element `vertex`
//! has the properties `x`, `y` and `z`, and `face` a list `vertex_indices` (or `vertex_index`). All other
//! elements and properties are passed over, and counted as left out.

mod header;
mod values;

use toolpathd_core::budget::Budget;

use super::STEPS_PER_CHECK;
use super::polygon;
use super::welding::Welding;
use crate::fault::{Place, Unreadable};
use header::{Header, Kind, Table};
use values::Values;

pub fn read(bytes: &[u8], welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    let header = Header::of(bytes)?;
    let mut values = Values::new(bytes, &header);
    let mut vertices = None;
    let mut faces_before = None;
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices = Some(read_vertices(element, &mut values, welding, budget)?),
            "face" => match &vertices {
                Some(vertices) => read_faces(element, &mut values, vertices, welding, budget)?,
                None => {
                    faces_before = Some((element, values.clone()));
                    pass_over(element, &mut values, budget)?;
                }
            },
            name => {
                let reason = "only vertices and faces are read";
                welding.left_out.add_many(name, reason, count(element), element.place);
                pass_over(element, &mut values, budget)?;
            }
        }
    }
    if let Some((n, place)) = values.behind() {
        welding.left_out.add_many("byte", "it stands behind the last element", n, place);
    }
    if let (Some((element, mut values)), Some(vertices)) = (faces_before, &vertices) {
        read_faces(element, &mut values, vertices, welding, budget)?;
    }
    Ok(())
}

/// How many elements the header states, and the file turned out to hold.
fn count(element: &Table) -> usize {
    usize::try_from(element.count).unwrap_or(usize::MAX)
}

/// The numbers of the vertices, in the order of the file.
fn read_vertices(
    element: &Table,
    values: &mut Values,
    welding: &mut Welding,
    budget: &Budget,
) -> Result<Vec<u32>, Unreadable> {
    let mut places = [0; 3];
    for (place, name) in places.iter_mut().zip(["x", "y", "z"]) {
        *place = element.scalar(name)?;
    }
    let mut vertices = Vec::new();
    let mut row = vec![0.0; element.properties.len()];
    for k in 0..element.count {
        if k.is_multiple_of(STEPS_PER_CHECK as u64) {
            budget.check()?;
        }
        let at = values.row(element, |property, value, _| {
            row[property] = value;
            Ok(())
        })?;
        vertices.push(welding.vertex(places.map(|place| row[place]), at)?);
    }
    leave_out(element, &places, welding);
    Ok(vertices)
}

fn read_faces(
    element: &Table,
    values: &mut Values,
    vertices: &[u32],
    welding: &mut Welding,
    budget: &Budget,
) -> Result<(), Unreadable> {
    let list = element.list(&["vertex_indices", "vertex_index"])?;
    let mut corners = Vec::new();
    for k in 0..element.count {
        if k.is_multiple_of(STEPS_PER_CHECK as u64) {
            budget.check()?;
        }
        corners.clear();
        let at = values.row(element, |property, value, place| {
            if property == list {
                corners.push(corner(value, vertices, place)?);
            }
            Ok(())
        })?;
        polygon::add(&corners, at, welding, budget)?;
    }
    leave_out(element, &[list], welding);
    Ok(())
}

/// The vertex with a number of the file, counted from 0.
fn corner(value: f64, vertices: &[u32], place: Place) -> Result<u32, Unreadable> {
    let index = (value >= 0.0 && value.fract() == 0.0).then_some(value as usize);
    index.and_then(|index| vertices.get(index).copied()).ok_or_else(|| {
        let detail = format!("there is no vertex {value}; the file has {}, counted from 0", vertices.len());
        Unreadable::at(place, detail)
    })
}

/// Counts the properties that are not read.
fn leave_out(element: &Table, read: &[usize], welding: &mut Welding) {
    for (_, property) in element.properties.iter().enumerate().filter(|(k, _)| !read.contains(k)) {
        let kind = format!("{} {}", element.name, property.name);
        let reason = match property.kind {
            Kind::Scalar(_) => "it is no coordinate",
            Kind::List(..) => "it is no list of corners",
        };
        welding.left_out.add_many(&kind, reason, count(element), property.place);
    }
}

/// Passes over the rows of an element.
fn pass_over(element: &Table, values: &mut Values, budget: &Budget) -> Result<(), Unreadable> {
    // Rows without properties take no place in the file, however many the header states.
    let n_rows = if element.properties.is_empty() { 0 } else { element.count };
    for k in 0..n_rows {
        if k.is_multiple_of(STEPS_PER_CHECK as u64) {
            budget.check()?;
        }
        values.row(element, |_, _, _| Ok(()))?;
    }
    Ok(())
}
