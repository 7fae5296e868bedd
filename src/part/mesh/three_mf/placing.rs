//! Places the objects of a build.

use std::collections::HashSet;

use toolpathd_core::budget::Budget;

use super::document::Models;
use super::model::{Component, MOST_PLACED, Object, determinant};
use crate::fault::{Place, Unreadable};
use crate::mesh::STEPS_PER_CHECK;
use crate::mesh::welding::Welding;

/// Most objects within each other. A deeper object contains itself, or no program wrote the file.
const DEEPEST: usize = 64;

/// Adds all objects of the build.
///
/// # Errors
/// When an object is missing, or contains itself; when there are too many objects or triangles.
pub fn place(models: &Models, welding: &mut Welding, budget: &Budget) -> Result<(), Unreadable> {
    let mut placing = Placing { models, welding, budget, n_placed: 0, used: HashSet::new() };
    let build = models.models.get(&models.main).map_or(&[][..], |model| &model.build);
    if build.is_empty() {
        return Err(Unreadable::at(Place::File, "the build of the model has no item"));
    }
    for item in build {
        placing.component(&models.main, item, &IDENTITY, 0)?;
    }
    placing.leave_out_unused();
    Ok(())
}

const IDENTITY: Rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];

/// Rows of a matrix, as in `Component`.
type Rows = [[f64; 3]; 4];

struct Placing<'p> {
    models: &'p Models,
    welding: &'p mut Welding,
    budget: &'p Budget,
    n_placed: usize,
    /// The objects that were placed, by their parts and numbers.
    used: HashSet<(&'p str, u32)>,
}

impl<'p> Placing<'p> {
    /// Adds a component of an object in `part`, which itself is placed by `rows`.
    fn component(
        &mut self,
        part: &str,
        component: &Component,
        rows: &Rows,
        depth: usize,
    ) -> Result<(), Unreadable> {
        self.n_placed += 1;
        if self.n_placed.is_multiple_of(STEPS_PER_CHECK) {
            self.budget.check()?;
        }
        let fault = |detail: String| Unreadable::at(component.place, format!("of {part}: {detail}"));
        if self.n_placed > MOST_PLACED {
            return Err(fault(format!("more than {MOST_PLACED} objects are placed")));
        }
        if depth > DEEPEST {
            return Err(fault(format!("objects stand more than {DEEPEST} deep within each other")));
        }
        let found = self.models.object(part, component);
        let (part, object) =
            found.ok_or_else(|| fault(format!("there is no object {}", component.object)))?;
        self.used.insert((part, component.object));
        if object.is_support {
            self.welding.left_out.add("object", "it supports a part that is printed", component.place);
            return Ok(());
        }
        let rows = product(&component.rows, rows);
        self.mesh(object, &rows, component.place)?;
        object.components.iter().try_for_each(|own| self.component(part, own, &rows, depth + 1))
    }

    /// Adds the triangles of an object. A vertex that no triangle uses takes no memory, however often the
    /// object is placed.
    fn mesh(&mut self, object: &Object, rows: &Rows, place: Place) -> Result<(), Unreadable> {
        self.budget.check()?;
        if object.triangles.is_empty() {
            let n_loose = object.vertices.len();
            self.welding.left_out.add_many("vertex", "no triangle uses it", n_loose, place);
            self.welding.end_object();
            return Ok(());
        }
        let is_mirrored = determinant(rows) < 0.0;
        let mut vertices = vec![None; object.vertices.len()];
        for (k, corners) in object.triangles.iter().enumerate() {
            if k.is_multiple_of(STEPS_PER_CHECK) {
                self.budget.check()?;
            }
            let mut numbers = [0; 3];
            for (number, &corner) in numbers.iter_mut().zip(corners) {
                let known = &mut vertices[corner as usize];
                *number = match *known {
                    Some(number) => number,
                    None => self.welding.vertex(image(&object.vertices[corner as usize], rows), place)?,
                };
                *known = Some(*number);
            }
            let [a, b, c] = numbers;
            self.welding.triangle(if is_mirrored { [a, c, b] } else { [a, b, c] }, place)?;
        }
        let n_loose = vertices.iter().filter(|number| number.is_none()).count();
        self.welding.left_out.add_many("vertex", "no triangle uses it", n_loose, place);
        self.welding.end_object();
        Ok(())
    }

    fn leave_out_unused(self) {
        let objects = self.models.models.iter().flat_map(|(part, model)| {
            model.objects.iter().map(move |(number, object)| (part.as_str(), *number, object))
        });
        let unused = objects.filter(|(part, number, _)| !self.used.contains(&(*part, *number)));
        let n_unused = unused.filter(|(.., object)| !object.is_support).count();
        self.welding.left_out.add_many("object", "the build does not use it", n_unused, Place::File);
    }
}

/// The image of a point.
fn image(point: &[f64; 3], rows: &Rows) -> [f64; 3] {
    let [x, y, z] = *point;
    [0, 1, 2].map(|k| x * rows[0][k] + y * rows[1][k] + z * rows[2][k] + rows[3][k])
}

/// The matrix that does what `first` does and then what `then` does.
fn product(first: &Rows, then: &Rows) -> Rows {
    let turned = |row: &[f64; 3]| [0, 1, 2].map(|k| (0..3).map(|i| row[i] * then[i][k]).sum::<f64>());
    [turned(&first[0]), turned(&first[1]), turned(&first[2]), image(&first[3], then)]
}
