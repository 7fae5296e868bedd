//! The curves of the model space, with those of the blocks that are placed in it.

use std::collections::{HashMap, HashSet};

use super::DxfOptions;
use super::curves::{Drafting, Undrawn};
use super::entity::Entity;
use super::file::{Definition, File};
use super::names::key;
use super::placement::Placement;
use super::reasons;
use super::shape::{Content, Insert, Shape};
use crate::drawing::Layer;
use crate::drawing::assembly::Curve;
use crate::fault::{Place, Unreadable};
use crate::left_out::LeftOuts;

/// The most blocks within each other.
const DEEPEST: usize = 16;

/// The most copies of blocks, as a multiple of the most curves: copies may hold no curve.
const COPIES_A_CURVE: usize = 4;

/// The most entities that are kept of a file, as a multiple of the most curves: blocks may not be placed.
pub const ENTITIES_A_CURVE: usize = 4;

/// The most kinds that are told by their names. A file with more is no drawing.
const MOST_KINDS: usize = 200;

/// Entities between two checks of the budget.
const ENTITIES_BETWEEN_CHECKS: usize = 256;

/// What was drawn.
#[derive(Debug)]
pub struct DrawnFile {
    pub curves: Vec<Curve>,
    pub layers: Vec<Layer>,
    pub left_out: LeftOuts,
    pub deviation_max_mm: f64,
}

/// # Errors
/// When there are too many curves, vertices or copies, blocks are too deep in each other, or the budget ends.
pub fn draw(
    file: File,
    options: &DxfOptions,
    scale: f64,
    drafting: &Drafting,
) -> Result<DrawnFile, Unreadable> {
    let asked = options.layers.as_ref().map(|names| names.iter().map(|name| key(name)).collect());
    let mut space = ModelSpace {
        blocks: &file.blocks,
        hidden: &file.hidden,
        asked,
        options,
        drafting,
        curves: Vec::new(),
        layers: Vec::new(),
        layer_by_key: HashMap::new(),
        left_out: file.left_out.clone(),
        kinds: HashSet::new(),
        deviation_max_mm: 0.0,
        n_curves: 0,
        n_vertices: 0,
        n_copies: 0,
        n_entities: 0,
        open: Vec::new(),
    };
    space.entities(&file.entities, &Placement::scaled(scale), None)?;
    Ok(DrawnFile {
        curves: space.curves,
        layers: space.layers,
        left_out: space.left_out,
        deviation_max_mm: space.deviation_max_mm,
    })
}

struct ModelSpace<'a> {
    blocks: &'a HashMap<String, Definition>,
    hidden: &'a HashMap<String, &'static str>,
    /// The keys of the layers that are read; `None` for all.
    asked: Option<HashSet<String>>,
    options: &'a DxfOptions,
    drafting: &'a Drafting<'a>,
    curves: Vec<Curve>,
    layers: Vec<Layer>,
    layer_by_key: HashMap<String, usize>,
    left_out: LeftOuts,
    kinds: HashSet<String>,
    deviation_max_mm: f64,
    n_curves: usize,
    n_vertices: usize,
    n_copies: usize,
    n_entities: usize,
    /// The keys of the blocks around the entity that is drawn.
    open: Vec<&'a str>,
}

impl<'a> ModelSpace<'a> {
    /// Draws entities. `around` is the layer of the block that holds them.
    fn entities(
        &mut self,
        entities: &'a [Entity],
        placement: &Placement,
        around: Option<&str>,
    ) -> Result<(), Unreadable> {
        for entity in entities {
            self.n_entities += 1;
            if self.n_entities.is_multiple_of(ENTITIES_BETWEEN_CHECKS) {
                self.drafting.budget.check()?;
            }
            // The layer 0 of a block is that of the place where the block is put.
            let layer = around.filter(|_| &*entity.layer == "0").unwrap_or(&entity.layer);
            match self.reason_to_skip(entity, layer) {
                Some(reason) => self.leave_out_all(entity, reason)?,
                None => match &entity.content {
                    Content::Curve(shape) => self.curve(entity, shape, layer, placement)?,
                    Content::Insert(insert) => self.insert(entity, insert, layer, placement)?,
                    Content::LeftOut(reason) => self.leave_out_all(entity, reason)?,
                },
            }
        }
        Ok(())
    }

    fn reason_to_skip(&self, entity: &Entity, layer: &str) -> Option<&'static str> {
        if entity.is_on_paper {
            return Some(reasons::ON_PAPER);
        }
        if entity.is_invisible {
            return Some(reasons::INVISIBLE);
        }
        let layer = key(layer);
        let hidden = self.hidden.get(&layer).copied();
        match &entity.content {
            Content::LeftOut(_) => hidden,
            // What is on a layer that is asked for is read.
            _ if self.asked.as_ref().is_some_and(|asked| asked.contains(&layer)) => None,
            // A block whose layer is off still shows its entities on other layers.
            Content::Insert(_) => hidden.filter(|reason| *reason == reasons::FROZEN),
            Content::Curve(_) => hidden,
        }
    }

    fn curve(
        &mut self,
        entity: &Entity,
        shape: &Shape,
        name: &str,
        placement: &Placement,
    ) -> Result<(), Unreadable> {
        self.n_curves += 1;
        let limit = self.options.curve_limit;
        if self.n_curves > limit {
            return Err(Unreadable::at(entity.place, format!("there are more than {limit} curves")));
        }
        let layer = self.layer(name);
        self.layers[layer].n_curves += 1;
        if self.asked.as_ref().is_some_and(|asked| !asked.contains(&key(name))) {
            self.leave_out(entity, reasons::NOT_ASKED);
            return Ok(());
        }
        let drawn = match self.drafting.draw(shape, placement, entity.place) {
            Ok(drawn) => drawn,
            Err(Undrawn::Refused(unreadable)) => return Err(unreadable),
            Err(Undrawn::LeftOut(reason)) => {
                self.leave_out(entity, reason);
                return Ok(());
            }
        };
        self.n_vertices += drawn.vertices.len();
        let limit = self.options.vertex_limit;
        if self.n_vertices > limit {
            return Err(Unreadable::at(entity.place, format!("there are more than {limit} vertices")));
        }
        self.deviation_max_mm = self.deviation_max_mm.max(drawn.deviation_mm);
        self.curves.push(Curve {
            vertices: drawn.vertices,
            is_closed: drawn.is_closed,
            has_written_ends: drawn.has_written_ends,
            layer,
            kind: entity.kind.to_string(),
            place: entity.place,
        });
        Ok(())
    }

    fn insert(
        &mut self,
        entity: &Entity,
        insert: &Insert,
        layer: &str,
        placement: &Placement,
    ) -> Result<(), Unreadable> {
        let Some((name, block)) = self.blocks.get_key_value(&insert.block) else {
            self.leave_out(entity, reasons::NO_BLOCK);
            return Ok(());
        };
        if block.is_in_another_file {
            self.leave_out(entity, reasons::REFERENCE);
            return Ok(());
        }
        if self.open.contains(&name.as_str()) {
            return Err(Unreadable::at(entity.place, format!("the block \"{name}\" holds itself")));
        }
        if self.open.len() == DEEPEST {
            let detail = format!("blocks lie more than {DEEPEST} deep in each other");
            return Err(Unreadable::at(entity.place, detail));
        }
        self.open.push(name);
        let [columns, rows] = insert.counts;
        for row in 0..rows {
            for column in 0..columns {
                self.count_copy(entity.place)?;
                let placed = placement.after(&insert.placement(block.base, [column, row]));
                match placed.is_finite() {
                    true => self.entities(&block.entities, &placed, Some(layer))?,
                    false => self.leave_out(entity, reasons::FAR),
                }
            }
        }
        self.open.pop();
        Ok(())
    }

    fn count_copy(&mut self, place: Place) -> Result<(), Unreadable> {
        self.n_copies += 1;
        if self.n_copies.is_multiple_of(ENTITIES_BETWEEN_CHECKS) {
            self.drafting.budget.check()?;
        }
        let limit = self.options.curve_limit.saturating_mul(COPIES_A_CURVE);
        match self.n_copies > limit {
            true => Err(Unreadable::at(place, format!("there are more than {limit} copies of blocks"))),
            false => Ok(()),
        }
    }

    /// The number of a layer that holds a curve.
    fn layer(&mut self, name: &str) -> usize {
        let next = self.layers.len();
        let number = *self.layer_by_key.entry(key(name)).or_insert(next);
        if number == next {
            self.layers.push(Layer { name: name.to_owned(), n_curves: 0 });
        }
        number
    }

    /// Leaves out all entities that this one stands for.
    fn leave_out_all(&mut self, entity: &Entity, reason: &str) -> Result<(), Unreadable> {
        for k in 0..entity.count {
            if k % ENTITIES_BETWEEN_CHECKS == ENTITIES_BETWEEN_CHECKS - 1 {
                self.drafting.budget.check()?;
            }
            self.leave_out(entity, reason);
        }
        Ok(())
    }

    fn leave_out(&mut self, entity: &Entity, reason: &str) {
        let is_known = self.kinds.contains(&*entity.kind) || self.kinds.len() < MOST_KINDS;
        if is_known {
            self.kinds.insert(entity.kind.to_string());
        }
        let kind = if is_known { &*entity.kind } else { "other kinds" };
        self.left_out.add(kind, reason, entity.place);
    }
}
