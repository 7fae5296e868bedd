//! Trimmed faces as triangles within a proved distance.
//!
//! # Method
//! 1. The edges of the faces are found, each once for all faces of its body that share it (`edges`), and
//!    divided so finely that their chords are near, by bounds of second derivatives (`curve_bounds`).
//! 2. The bounds of each face become polygons in its parameters, whose corners are the places of its edges
//!    (`polygons`). Where the strip between a polygon and its edge is too wide (`strip`), or where sides of
//!    polygons cross, edges are divided further, until no face asks for more.
//! 3. Each face is filled with triangles (`fill`), by bounds of the second derivatives of its surface
//!    (`surface_bounds`).
//!
//! # Guarantees
//! * Every point of a face is within [`FaceTriangles::chord_mm`] of the triangles, and every point of the
//!   triangles is as near to a face. The distance of the file's edges from its surfaces is part of it.
//! * Faces of a body that share their edges share the vertices on them: a closed body has closed triangles.
//! * Triangles go counterclockwise seen from the side without material.
//! * The same faces give the same triangles.
//!
//! # Known limitations
//! * The distance of edges from surfaces is measured at places. So is, at the poles of surfaces, for sides
//!   shorter than the chord, and for edges far off a surface that bends sharply, how far the parameters of an
//!   edge are beside the line between two corners: twice the measured distance counts.
//! * Faces that meet along different edges of the file are not joined.
//!
//! # Reference
//! L. P. Chew, *Guaranteed-quality mesh generation for curved surfaces*, Symposium on Computational Geometry,
//! 1993: triangles are divided at the centres of their circumscribed circles.

mod bezier_bounds;
mod curve_bounds;
mod edges;
mod fill;
mod inside;
mod lattice;
mod mesh;
mod polygons;
mod spline_bounds;
mod strip;
mod surface_bounds;
mod trimmed_face;
mod unfilled;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Point3;
use toolpathd_core::budget::{Budget, Stopped};

use self::edges::{Edges, Use};
use self::fill::{Filling, check_sides, fill};
use self::polygons::{Node, Polygons, Side, Unbounded};
use self::strip::{STRIP_SHARE, strips};
use self::surface_bounds::SurfaceBounds;
use self::trimmed_face::TrimmedFace;
use self::unfilled::Unfilled;
use super::face_building;
use super::model::{Face, Model};
use super::parameter_search::ParameterSearch;
use super::trim::Untrimmed;

/// The part of the allowed deviation that is for the inside of faces.
const INSIDE_SHARE: f64 = 0.55;

/// Times that edges are divided further for the sake of faces.
const MOST_ROUNDS: usize = 24;

/// Triangles of faces, in the order of the faces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FaceTriangles {
    /// mm.
    pub vertices: Vec<[f64; 3]>,
    /// Places in `vertices`, counterclockwise seen from the side without material.
    pub triangles: Vec<[u32; 3]>,
    /// The face of each triangle, as its place in [`Model::faces`].
    pub face_of: Vec<u32>,
    /// The largest distance between the faces and the triangles, both ways, mm.
    pub chord_mm: f64,
    /// The largest distance of an edge from the surfaces and vertices that it joins, mm.
    pub edge_gap_max_mm: f64,
}

/// Why faces have no triangles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Untessellated {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the faces need more than {most} triangles")]
    TooMany { most: usize },
    #[error("the chord is {chord_mm} mm; it must be above 0")]
    BadChord { chord_mm: f64 },
    #[error("there is no face {face}")]
    NoFace { face: usize },
    #[error("face {face} (#{entity}) cannot be triangulated: {reason}")]
    Face {
        /// The place of the face in [`Model::faces`].
        face: usize,
        /// The number of its instance.
        entity: u64,
        /// Why, as a clause.
        reason: &'static str,
    },
}

/// A face with what it asked for last.
struct Work<'a> {
    place: usize,
    face: &'a Face,
    trimmed: TrimmedFace<'a>,
    /// How often its seams are halved more.
    halvings: u32,
    /// Whether its edges have changed since it was looked at.
    is_open: bool,
    width_mm: f64,
    gap_mm: f64,
}

/// What a face asks for.
struct Wish {
    divisions: Vec<(usize, f64)>,
    halvings: u32,
    width_mm: f64,
    gap_mm: f64,
}

/// The triangles of faces of a model, given by their places. Each triangle is within `chord_mm` of its face,
/// apart from the distance of edges from surfaces.
///
/// # Errors
/// A face is missing or cannot be triangulated, there are more than `most_triangles`, or the budget has
/// ended.
pub fn triangles(
    model: &Model,
    faces: &[usize],
    chord_mm: f64,
    most_triangles: usize,
    budget: &Budget,
) -> Result<FaceTriangles, Untessellated> {
    if !(chord_mm > 0.0 && chord_mm.is_finite()) {
        return Err(Untessellated::BadChord { chord_mm });
    }
    let most = most_triangles.min(u32::MAX as usize / 4);
    let found = |place: &usize| model.faces.get(*place).ok_or(Untessellated::NoFace { face: *place });
    let chosen: Vec<&Face> = faces.iter().map(found).collect::<Result<_, _>>()?;
    let (mut edges, uses) = Edges::of(&chosen);
    budget.check()?;
    let mut works = trimmed(faces, &chosen, &uses, budget)?;
    divide(&mut edges, &works, chord_mm, most, budget)?;
    settle(&mut edges, &mut works, chord_mm, most, budget)?;
    let n_made = AtomicUsize::new(0);
    let fillings = budget.in_order(works.len(), |k| {
        budget.progress("triangles", k, works.len());
        let filling = filled(&works[k], &edges, chord_mm, most, budget)?;
        let before = n_made.fetch_add(filling.triangles.len(), Ordering::Relaxed);
        if before + filling.triangles.len() > most {
            return Err(Untessellated::TooMany { most: most_triangles });
        }
        Ok(filling)
    })?;
    Ok(collect(&edges, &works, fillings))
}

/// The faces with their trims.
fn trimmed<'a>(
    places: &[usize],
    faces: &[&'a Face],
    uses: &[Vec<Use>],
    budget: &Budget,
) -> Result<Vec<Work<'a>>, Untessellated> {
    budget.in_order(faces.len(), |k| {
        budget.check()?;
        let (place, face) = (places[k], faces[k]);
        let refuse = |reason| Untessellated::Face { face: place, entity: face.entity, reason };
        let search = ParameterSearch::new(&face.surface);
        let (trim, edges) =
            face_building::trim(face, &search, budget).map_err(|untrimmed| match untrimmed {
                Untrimmed::Unbounded(reason) => refuse(reason),
                Untrimmed::Stopped(stopped) => stopped.into(),
            })?;
        let uses = directed(face, uses[k].clone());
        let trimmed = TrimmedFace { bounds: SurfaceBounds::new(&face.surface, budget)?, trim, edges, uses };
        Ok(Work { place, face, trimmed, halvings: 0, is_open: true, width_mm: 0.0, gap_mm: 0.0 })
    })
}

/// The uses of a face's edges as its loops go round the normal of the surface.
fn directed(face: &Face, mut uses: Vec<Use>) -> Vec<Use> {
    if face.is_clockwise {
        let mut first = 0;
        for one in &face.loops {
            uses[first..first + one.edges.len()].reverse();
            first += one.edges.len();
        }
    }
    uses
}

/// Divides the edges so finely that their chords are near.
fn divide(
    edges: &mut Edges,
    works: &[Work],
    chord_mm: f64,
    most: usize,
    budget: &Budget,
) -> Result<(), Untessellated> {
    let mut n_places = 0.0;
    for record in 0..edges.records.len() {
        n_places += edges.n_places(record, STRIP_SHARE * chord_mm);
    }
    if n_places > most as f64 {
        return Err(Untessellated::TooMany { most });
    }
    for work in works {
        budget.check()?;
        for (record, t) in work.trimmed.cuts(edges) {
            edges.divide(record, &[t]);
        }
    }
    for record in 0..edges.records.len() {
        budget.check()?;
        edges.divide_evenly(record, STRIP_SHARE * chord_mm);
    }
    Ok(())
}

/// Divides edges further until no face asks for more.
fn settle(
    edges: &mut Edges,
    works: &mut [Work],
    chord_mm: f64,
    most: usize,
    budget: &Budget,
) -> Result<(), Untessellated> {
    for _ in 0..MOST_ROUNDS {
        let open: Vec<usize> = (0..works.len()).filter(|k| works[*k].is_open).collect();
        if open.is_empty() {
            return Ok(());
        }
        let wishes = budget.in_order(open.len(), |k| wish(&works[open[k]], edges, chord_mm, budget))?;
        let mut divisions: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for (k, wish) in open.into_iter().zip(wishes) {
            let work = &mut works[k];
            (work.width_mm, work.gap_mm) = (wish.width_mm, wish.gap_mm);
            work.is_open = wish.halvings > 0;
            work.halvings += wish.halvings;
            for (record, t) in wish.divisions {
                divisions.entry(record).or_default().push(t);
            }
        }
        let mut changed = vec![false; edges.records.len()];
        for (record, at) in divisions {
            changed[record] = edges.divide(record, &at);
        }
        for work in works.iter_mut() {
            work.is_open |= work.trimmed.uses.iter().any(|at| changed[at.record]);
        }
        if edges.vertices.len() > most {
            return Err(Untessellated::TooMany { most });
        }
    }
    match works.iter().find(|work| work.is_open) {
        Some(work) => Err(refused(work, "its bounds touch or cross")),
        None => Ok(()),
    }
}

fn refused(work: &Work, reason: &'static str) -> Untessellated {
    Untessellated::Face { face: work.place, entity: work.face.entity, reason }
}

fn polygons_of(
    work: &Work,
    edges: &Edges,
    chord_mm: f64,
    budget: &Budget,
) -> Result<Polygons, Untessellated> {
    let polygons = work.trimmed.polygons(edges, STRIP_SHARE * chord_mm, work.halvings, budget);
    polygons.map_err(|unbounded| match unbounded {
        Unbounded::Open(reason) => refused(work, reason),
        Unbounded::Stopped(stopped) => stopped.into(),
    })
}

/// What a face asks for with the edges as they are.
fn wish(work: &Work, edges: &Edges, chord_mm: f64, budget: &Budget) -> Result<Wish, Untessellated> {
    budget.check()?;
    let polygons = polygons_of(work, edges, chord_mm, budget)?;
    let found = strips(&work.trimmed, &polygons, edges, chord_mm);
    let mut wish =
        Wish { divisions: found.wanted, halvings: 0, width_mm: found.width_mm, gap_mm: found.gap_mm };
    if !wish.divisions.is_empty() {
        return Ok(wish);
    }
    match check_sides(&work.trimmed.bounds, &polygons, edges, INSIDE_SHARE * chord_mm, budget) {
        Ok(()) => {}
        Err(Unfilled::Crossed(sides)) => {
            for [i, k] in sides {
                match polygons.loops[i][k].side {
                    Side::Edge { edge, t, .. } => {
                        let used = work.trimmed.uses[edge];
                        let middle = edges.records[used.record].turned((t[0] + t[1]) / 2.0, used.is_turned);
                        wish.divisions.push((used.record, middle));
                    }
                    Side::Line => wish.halvings = 1,
                }
            }
        }
        Err(unfilled) => return Err(of_unfilled(work, unfilled, usize::MAX)),
    }
    Ok(wish)
}

fn of_unfilled(work: &Work, unfilled: Unfilled, most: usize) -> Untessellated {
    match unfilled {
        Unfilled::Crossed(_) => refused(work, "its bounds touch or cross"),
        Unfilled::Failed(reason) => refused(work, reason),
        Unfilled::TooMany => Untessellated::TooMany { most },
        Unfilled::Stopped(stopped) => stopped.into(),
    }
}

fn filled(
    work: &Work,
    edges: &Edges,
    chord_mm: f64,
    most: usize,
    budget: &Budget,
) -> Result<Filling, Untessellated> {
    budget.check()?;
    let polygons = polygons_of(work, edges, chord_mm, budget)?;
    fill(&work.trimmed.bounds, &polygons, edges, INSIDE_SHARE * chord_mm, most, budget)
        .map_err(|unfilled| of_unfilled(work, unfilled, most))
}

/// The triangles of all faces with one numbering of their vertices.
fn collect(edges: &Edges, works: &[Work], fillings: Vec<Filling>) -> FaceTriangles {
    let n: usize = fillings.iter().map(|filling| filling.triangles.len()).sum();
    let coordinates = |point: &Point3<f64>| [point.x, point.y, point.z];
    let mut all = FaceTriangles {
        vertices: edges.vertices.iter().map(coordinates).collect(),
        triangles: Vec::with_capacity(n),
        face_of: Vec::with_capacity(n),
        chord_mm: 0.0,
        edge_gap_max_mm: edges.gap_mm,
    };
    for (work, filling) in works.iter().zip(fillings) {
        let first = all.vertices.len() as u32;
        all.vertices.extend(filling.own.iter().map(coordinates));
        let number = |node: Node| match node {
            Node::Shared(vertex) => vertex,
            Node::Own(vertex) => first + vertex,
        };
        for nodes in filling.triangles {
            let [a, b, c] = nodes.map(number);
            all.triangles.push(if work.face.is_reversed { [a, c, b] } else { [a, b, c] });
            all.face_of.push(work.place as u32);
        }
        let of_face = filling.deviation_mm + work.width_mm + 3.0 * work.gap_mm;
        all.chord_mm = all.chord_mm.max(of_face);
        all.edge_gap_max_mm = all.edge_gap_max_mm.max(work.gap_mm);
    }
    all
}
