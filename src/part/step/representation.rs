//! Representations and how assemblies place them.
//!
//! # Method
//! 1. Representations that a relation without a transformation joins are one node.
//! 2. A relation with a transformation, or with a use in an assembly, places the node of the part in the node
//!    of the assembly. A mapped item places the node that it maps.
//! 3. The nodes that no other places are walked from the top, with the product of the similarities on the
//!    way.

use std::collections::{BTreeMap, BTreeSet};

use toolpathd_core::budget::Budget;

use super::assembly::{Found, PlacedItem, Use, Walk};
use super::bodies::{SHAPES, has_no_shape};
use super::frame::Similarity;
use super::instance::{Instance, Source};
use super::placement::Geometry;
use super::units::Units;
use crate::fault::Unreadable;

/// A representation with its items.
struct Representation {
    items: Vec<u32>,
    units: Units,
}

/// Representations by number; nodes by the least number of their representations.
struct Graph<'a> {
    source: &'a Source<'a>,
    budget: &'a Budget,
    representations: BTreeMap<u32, Representation>,
    node_of: BTreeMap<u32, u32>,
    uses: BTreeMap<u32, Vec<Use>>,
    items: BTreeMap<u32, Vec<PlacedItem>>,
    /// Representations of the shapes of products. Others are of parts of shapes, such as a face with a note.
    of_products: BTreeSet<u32>,
}

/// A relation of two representations.
struct Relation {
    number: u32,
    ends: [u32; 2],
    /// The number of the transformation.
    by: Option<u32>,
}

/// The items of all representations at their places.
///
/// # Errors
/// The file is broken, an assembly contains itself, or there are too many copies.
pub fn placed_items(source: &Source, budget: &Budget) -> Result<Found, Unreadable> {
    let mut graph = Graph {
        source,
        budget,
        representations: BTreeMap::new(),
        node_of: BTreeMap::new(),
        uses: BTreeMap::new(),
        items: BTreeMap::new(),
        of_products: BTreeSet::new(),
    };
    graph.read_representations()?;
    let relations = graph.relations()?;
    let children = graph.children_of_uses()?;
    graph.join(&relations, &children);
    graph.read_uses(&relations, &children)?;
    graph.read_items(budget)?;
    let nodes = graph.node_of.values().copied().collect();
    Walk::over(&graph.uses, &graph.items, &nodes, budget)
}

fn is_representation(name: &str) -> bool {
    (name.ends_with("SHAPE_REPRESENTATION") && name != "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION")
        || name == "SHAPE_REPRESENTATION_WITH_PARAMETERS"
}

impl Graph<'_> {
    fn roots(&self, name: &'static str) -> impl Iterator<Item = u32> + '_ {
        self.source.index.roots.iter().filter(move |(_, found)| found == name).map(|(number, _)| *number)
    }

    fn read_representations(&mut self) -> Result<(), Unreadable> {
        let roots = &self.source.index.roots;
        let simple: Vec<u32> =
            roots.iter().filter(|(_, name)| is_representation(name)).map(|(number, _)| *number).collect();
        for number in simple {
            self.add(number)?;
        }
        for number in self.source.index.complex.clone() {
            let instance = self.source.get(number)?;
            if instance.has("REPRESENTATION") && instance.has("SHAPE_REPRESENTATION") {
                self.add(number)?;
            }
        }
        Ok(())
    }

    /// Reads a representation if it is not read yet.
    fn add(&mut self, number: u32) -> Result<(), Unreadable> {
        if self.representations.contains_key(&number) {
            return Ok(());
        }
        let instance = self.source.get(number)?;
        let (part, first) = if instance.is_complex() {
            (instance.part("REPRESENTATION")?, 0)
        } else {
            (instance.attributes(), 0)
        };
        let items = part.references(first + 1)?;
        let units = match part.optional_reference(first + 2)? {
            Some(assigned) => Units::of(self.source, assigned)?,
            None => Units::unstated(),
        };
        self.representations.insert(number, Representation { items, units });
        Ok(())
    }

    fn relations(&mut self) -> Result<Vec<Relation>, Unreadable> {
        let mut relations = Vec::new();
        let names = ["SHAPE_REPRESENTATION_RELATIONSHIP", "REPRESENTATION_RELATIONSHIP"];
        let simple: Vec<u32> = names.into_iter().flat_map(|name| self.roots(name)).collect();
        for number in simple.into_iter().chain(self.source.index.complex.clone()) {
            let instance = self.source.get(number)?;
            let (part, by) = if !instance.is_complex() {
                (instance.attributes(), None)
            } else if instance.has("REPRESENTATION_RELATIONSHIP") {
                let name = "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION";
                let by = if instance.has(name) { Some(instance.part(name)?.reference(0)?) } else { None };
                (instance.part("REPRESENTATION_RELATIONSHIP")?, by)
            } else {
                continue;
            };
            let ends = [part.reference(2)?, part.reference(3)?];
            // Other representations, such as those of texts, are related too.
            if ends.iter().all(|end| self.representations.contains_key(end)) {
                relations.push(Relation { number, ends, by });
            }
        }
        Ok(relations)
    }

    /// For each relation that an assembly uses, the representations of the part that is placed.
    fn children_of_uses(&mut self) -> Result<BTreeMap<u32, BTreeSet<u32>>, Unreadable> {
        let mut shapes: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        let definitions: Vec<u32> = self.roots("SHAPE_DEFINITION_REPRESENTATION").collect();
        for number in definitions {
            let instance = self.source.get(number)?;
            let part = instance.attributes();
            let (shape, representation) = (part.reference(0)?, part.reference(1)?);
            if let Some(product) = self.definition(shape)? {
                shapes.entry(product).or_default().insert(representation);
            }
        }
        for (product, representations) in &shapes {
            if self.source.get(*product)?.kind().starts_with("PRODUCT_DEFINITION") {
                self.of_products.extend(representations);
            }
        }
        let mut children = BTreeMap::new();
        for number in self.roots("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION") {
            let instance = self.source.get(number)?;
            let part = instance.attributes();
            let (relation, shape) = (part.reference(0)?, part.reference(1)?);
            let Some(usage) = self.definition(shape)? else { continue };
            let usage = self.source.get(usage)?;
            if usage.kind() == "NEXT_ASSEMBLY_USAGE_OCCURRENCE" {
                let related = usage.attributes().reference(4)?;
                children.insert(relation, shapes.get(&related).cloned().unwrap_or_default());
            }
        }
        Ok(children)
    }

    /// What a product's shape is the shape of.
    fn definition(&self, shape: u32) -> Result<Option<u32>, Unreadable> {
        let instance = self.source.get(shape)?;
        if instance.kind() == "PRODUCT_DEFINITION_SHAPE" {
            return instance.attributes().optional_reference(2);
        }
        Ok(None)
    }

    /// Joins representations to nodes.
    fn join(&mut self, relations: &[Relation], children: &BTreeMap<u32, BTreeSet<u32>>) {
        let numbers: Vec<u32> = self.representations.keys().copied().collect();
        let mut node_of: BTreeMap<u32, u32> = numbers.iter().map(|number| (*number, *number)).collect();
        for relation in relations.iter().filter(|one| one.by.is_none() && !children.contains_key(&one.number))
        {
            let tops = relation.ends.map(|end| top(&mut node_of, end));
            let (least, other) = (tops[0].min(tops[1]), tops[0].max(tops[1]));
            node_of.insert(other, least);
        }
        self.node_of = numbers.iter().map(|number| (*number, top(&mut node_of, *number))).collect();
    }

    fn read_uses(
        &mut self,
        relations: &[Relation],
        children: &BTreeMap<u32, BTreeSet<u32>>,
    ) -> Result<(), Unreadable> {
        for relation in relations {
            let uses = children.get(&relation.number);
            if relation.by.is_none() && uses.is_none() {
                continue;
            }
            let nodes = relation.ends.map(|end| self.node_of[&end]);
            let is_child = |node: u32| {
                uses.is_some_and(|uses| uses.iter().any(|child| self.node_of.get(child) == Some(&node)))
            };
            // The first representation is the part, unless the use of the product tells otherwise.
            let child = usize::from(!is_child(nodes[0]) && is_child(nodes[1]));
            let by = match relation.by {
                None => Similarity::identity(),
                Some(by) => self.transformation(by, relation.ends, child)?,
            };
            self.uses.entry(nodes[1 - child]).or_default().push(Use { child: nodes[child], by });
        }
        Ok(())
    }

    fn geometry(&self, representation: u32) -> Geometry<'_> {
        let units = self.representations[&representation].units;
        Geometry { source: self.source, units, budget: self.budget }
    }

    /// The similarity from the child to its parent.
    fn transformation(&self, number: u32, ends: [u32; 2], child: usize) -> Result<Similarity, Unreadable> {
        let instance = self.source.get(number)?;
        if instance.kind() != "ITEM_DEFINED_TRANSFORMATION" {
            let detail = format!("a transformation between two items is expected, not {}", instance.name());
            return Err(instance.fault(detail));
        }
        let part = instance.attributes();
        let items = [part.reference(2)?, part.reference(3)?];
        let frame = |k: usize| self.geometry(ends[k]).frame(items[k]);
        Ok(Similarity::between(&frame(child)?, &frame(1 - child)?, 1.0))
    }

    /// Sorts the items of all representations into bodies and uses of other nodes.
    fn read_items(&mut self, budget: &Budget) -> Result<(), Unreadable> {
        let mut open: Vec<u32> = self.representations.keys().copied().collect();
        while let Some(number) = open.pop() {
            budget.check()?;
            let node = *self.node_of.entry(number).or_insert(number);
            let (items, units) = {
                let representation = &self.representations[&number];
                (representation.items.clone(), representation.units)
            };
            for item in items {
                let instance = self.source.get(item)?;
                if instance.has("MAPPED_ITEM") {
                    let (mapped, by) = self.mapping(&instance, units, &mut open)?;
                    let child = self.node_of.get(&mapped).copied().unwrap_or(mapped);
                    self.uses.entry(node).or_default().push(Use { child, by });
                } else if !has_no_shape(&instance) {
                    let placed = PlacedItem { item, units, by: Similarity::identity() };
                    self.items.entry(node).or_default().push(placed);
                }
            }
        }
        // The representations were taken from the last to the first.
        self.items.values_mut().for_each(|items| items.sort_by_key(|placed| placed.item));
        self.drop_repeated();
        Ok(())
    }

    /// Drops an item from nodes that stand alone and are no product, if another node has it, too. Beside
    /// products, such nodes have faces, edges and texts of notes: there only bodies count.
    fn drop_repeated(&mut self) {
        let products: BTreeSet<u32> =
            self.of_products.iter().filter_map(|number| self.node_of.get(number)).copied().collect();
        let used: BTreeSet<u32> = self.uses.values().flatten().map(|one| one.child).collect();
        let is_alone =
            |node: &u32| !products.contains(node) && !used.contains(node) && !self.uses.contains_key(node);
        let mut nodes_of: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (node, items) in &self.items {
            for placed in items {
                nodes_of.entry(placed.item).or_default().push(*node);
            }
        }
        let roots = &self.source.index.roots;
        let bodies: BTreeSet<u32> = roots
            .iter()
            .filter(|(_, name)| SHAPES.contains(&name.as_str()))
            .map(|(number, _)| *number)
            .collect();
        // Of nodes that are all alone, the first keeps it.
        let is_kept = |node: u32, item: u32| {
            let nodes = &nodes_of[&item];
            let is_first = || nodes[0] == node && nodes.iter().all(is_alone);
            !is_alone(&node) || (is_first() && (products.is_empty() || bodies.contains(&item)))
        };
        let kept: BTreeMap<u32, Vec<PlacedItem>> = self
            .items
            .iter()
            .map(|(node, items)| {
                let mut kept = items.clone();
                kept.dedup_by_key(|placed| placed.item);
                kept.retain(|placed| is_kept(*node, placed.item));
                (*node, kept)
            })
            .collect();
        self.items = kept;
    }

    /// The representation that a mapped item maps, with its similarity.
    fn mapping(
        &mut self,
        instance: &Instance,
        units: Units,
        open: &mut Vec<u32>,
    ) -> Result<(u32, Similarity), Unreadable> {
        let (part, first) = if instance.is_complex() {
            (instance.part("MAPPED_ITEM")?, 0)
        } else {
            (instance.attributes(), 1)
        };
        let map = self.source.get(part.reference(first)?)?;
        let of = map.attributes();
        let (origin, mapped) = (of.reference(0)?, of.reference(1)?);
        if !self.representations.contains_key(&mapped) {
            self.add(mapped)?;
            open.push(mapped);
        }
        let origin = self.geometry(mapped).frame(origin)?;
        let geometry = Geometry { source: self.source, units, budget: self.budget };
        Ok((mapped, geometry.mapping(&origin, part.reference(first + 1)?)?))
    }
}

/// The number that stands for all that `at` is joined with. All numbers on the way then lead to it at once.
fn top(node_of: &mut BTreeMap<u32, u32>, at: u32) -> u32 {
    let mut way = vec![at];
    let mut last = at;
    while node_of[&last] != last {
        last = node_of[&last];
        way.push(last);
    }
    for number in way {
        node_of.insert(number, last);
    }
    last
}
