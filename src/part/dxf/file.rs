//! The sections of a DXF file: its unit, layers, blocks and entities.

use std::collections::HashMap;
use std::rc::Rc;

use toolpathd_core::budget::Budget;

use super::entity::{self, Entity, SharedNames};
use super::fields::Fields;
use super::groups::{Group, Groups, is_blank};
use super::names::{decoded, key};
use super::polyline::Polyline;
use super::reasons;
use super::shape::Content;
use crate::fault::{Place, Unreadable};
use crate::left_out::LeftOuts;
use crate::unit::Unit;

/// Entities between two checks of the budget.
const ENTITIES_BETWEEN_CHECKS: usize = 256;

/// Groups outside entities between two checks of the budget.
const GROUPS_BETWEEN_CHECKS: usize = 4096;

/// Bits of a layer's flags, and of a block's flags.
const FROZEN: i64 = 1;
const IN_ANOTHER_FILE: i64 = 4 | 32;

/// What a file holds.
#[derive(Debug, Default)]
pub struct File<'a> {
    pub unit: Option<Group<'a>>,
    /// By the keys of their names: why a layer is hidden.
    pub hidden: HashMap<String, &'static str>,
    /// By the keys of their names.
    pub blocks: HashMap<String, Definition>,
    pub entities: Vec<Entity>,
    /// What lies outside the sections.
    pub left_out: LeftOuts,
}

/// A block, as it is defined.
#[derive(Debug, Default)]
pub struct Definition {
    pub base: [f64; 2],
    pub entities: Vec<Entity>,
    pub is_in_another_file: bool,
}

/// What entities that are left out alike have in common: kind, layer, whether they are on paper, whether they
/// are invisible, and the reason.
type Alike = (Rc<str>, Rc<str>, bool, bool, &'static str);

/// The entities of a section or a block. Those that are left out alike are one entity with their count.
#[derive(Debug, Default)]
struct Kept {
    entities: Vec<Entity>,
    left_out: HashMap<Alike, usize>,
}

impl Kept {
    /// Counts an entity with the one that is left out alike; `false` if there is none.
    fn is_counted(&mut self, entity: &Entity) -> bool {
        let Content::LeftOut(reason) = entity.content else { return false };
        let alike =
            (entity.kind.clone(), entity.layer.clone(), entity.is_on_paper, entity.is_invisible, reason);
        let next = self.entities.len();
        let at = *self.left_out.entry(alike).or_insert(next);
        if let Some(first) = self.entities.get_mut(at) {
            first.count += 1;
        }
        at < next
    }
}

struct Reader<'a, 'b> {
    groups: Groups<'a>,
    fields: Fields<'a>,
    budget: &'b Budget,
    n_groups: usize,
    n_entities: usize,
    names: SharedNames,
    n_kept: usize,
    entity_limit: usize,
    file: File<'a>,
}

/// # Errors
/// When the file is not whole, a group is broken, more than `entity_limit` entities have to be kept, or the
/// budget ends.
pub fn read<'a>(bytes: &'a [u8], entity_limit: usize, budget: &Budget) -> Result<File<'a>, Unreadable> {
    let groups = Groups::new(bytes);
    let mut reader = Reader {
        groups,
        fields: Fields::default(),
        budget,
        n_groups: 0,
        n_entities: 0,
        names: SharedNames::default(),
        n_kept: 0,
        entity_limit,
        file: File::default(),
    };
    reader.sections()?;
    Ok(reader.file)
}

impl<'a> Reader<'a, '_> {
    fn sections(&mut self) -> Result<(), Unreadable> {
        let mut has_entities = false;
        let mut is_first = true;
        loop {
            let place = self.groups.place();
            let Some(group) = self.groups.next()? else {
                if has_entities {
                    self.file.left_out.add("EOF", reasons::NO_END, place);
                }
                break;
            };
            if group.is(0, "EOF") {
                if !is_blank(self.groups.rest()) {
                    self.file.left_out.add("EOF", reasons::BEHIND_END, self.groups.place());
                }
                break;
            }
            if !group.is(0, "SECTION") {
                let detail = match is_first {
                    true => "this is no DXF file: it does not begin with a section",
                    false => "neither a section begins here, nor does the file end",
                };
                return Err(Unreadable::at(group.place, detail));
            }
            is_first = false;
            let name = self.next()?;
            match name.text().to_ascii_uppercase().as_slice() {
                b"HEADER" => self.header()?,
                b"TABLES" => self.tables()?,
                b"BLOCKS" => self.blocks()?,
                b"ENTITIES" => {
                    let start = self.next()?;
                    let (entities, end) = self.entities(start)?;
                    expect(end, "ENDSEC")?;
                    match self.file.entities.is_empty() {
                        true => self.file.entities = entities,
                        false => self.file.entities.extend(entities),
                    }
                    has_entities = true;
                }
                _ => self.skip_section()?,
            }
        }
        match has_entities {
            true => Ok(()),
            false => Err(Unreadable::at(Place::File, "the file has no section ENTITIES")),
        }
    }

    fn next(&mut self) -> Result<Group<'a>, Unreadable> {
        self.n_groups += 1;
        if self.n_groups.is_multiple_of(GROUPS_BETWEEN_CHECKS) {
            self.budget.check()?;
        }
        match self.groups.next()? {
            Some(group) => Ok(group),
            None => Err(Unreadable::at(self.groups.place(), "the file ends within a section")),
        }
    }

    /// A section without curves. A filter in it clips a block, which is then drawn whole.
    fn skip_section(&mut self) -> Result<(), Unreadable> {
        loop {
            let group = self.next()?;
            if group.is(0, "ENDSEC") {
                return Ok(());
            }
            if group.is(0, "SPATIAL_FILTER") {
                self.file.left_out.add("SPATIAL_FILTER", reasons::CLIPPED, group.place);
            }
        }
    }

    /// The variables, of which only the unit matters.
    fn header(&mut self) -> Result<(), Unreadable> {
        loop {
            let group = self.next()?;
            if group.is(0, "ENDSEC") {
                return Ok(());
            }
            if group.is(9, "$INSUNITS") {
                self.file.unit = Some(self.next()?);
            }
        }
    }

    /// The tables, of which only the layers matter.
    fn tables(&mut self) -> Result<(), Unreadable> {
        let mut group = self.next()?;
        loop {
            if group.is(0, "ENDSEC") {
                return Ok(());
            }
            if !group.is(0, "LAYER") {
                group = self.next()?;
                continue;
            }
            group = self.fields.read(group, &mut self.groups)?;
            let name = key(&decoded(self.fields.text(2)));
            if self.fields.integer(70)? & FROZEN != 0 {
                self.file.hidden.insert(name, reasons::FROZEN);
            } else if self.fields.integer(62)? < 0 {
                self.file.hidden.insert(name, reasons::OFF);
            }
        }
    }

    fn blocks(&mut self) -> Result<(), Unreadable> {
        let mut group = self.next()?;
        while !group.is(0, "ENDSEC") {
            if !group.is(0, "BLOCK") {
                return Err(Unreadable::at(group.place, "a block or the end of its section is expected"));
            }
            let start = self.fields.read(group, &mut self.groups)?;
            let name = key(&decoded(self.fields.text(2)));
            let [x, y] = [self.fields.real(10)?, self.fields.real(20)?].map(Option::unwrap_or_default);
            let is_in_another_file = self.fields.integer(70)? & IN_ANOTHER_FILE != 0;
            let (entities, end) = self.entities(start)?;
            expect(end, "ENDBLK")?;
            group = self.fields.read(end, &mut self.groups)?;
            self.file.blocks.insert(name, Definition { base: [x, y], entities, is_in_another_file });
        }
        Ok(())
    }

    /// The entities from the one that `start` starts, and the group with the word that ends them.
    fn entities(&mut self, start: Group<'a>) -> Result<(Vec<Entity>, Group<'a>), Unreadable> {
        let mut kept = Kept::default();
        let mut group = start;
        loop {
            if group.code != 0 {
                return Err(Unreadable::at(group.place, "an entity is expected"));
            }
            self.n_entities += 1;
            if self.n_entities.is_multiple_of(ENTITIES_BETWEEN_CHECKS) {
                self.budget.check()?;
            }
            match group.text() {
                b"ENDSEC" | b"ENDBLK" | b"EOF" | b"SECTION" | b"BLOCK" => {
                    return Ok((kept.entities, group));
                }
                b"POLYLINE" => {
                    let (entity, next) = self.polyline(group)?;
                    self.keep(entity, &mut kept)?;
                    group = next;
                }
                kind => {
                    group = self.fields.read(group, &mut self.groups)?;
                    // It ends the attributes of a block.
                    if kind != b"SEQEND" {
                        let entity = entity::read(&self.fields, &mut self.names)?;
                        self.keep(entity, &mut kept)?;
                    }
                }
            }
        }
    }

    /// Keeps an entity, or counts it with one that is left out alike.
    fn keep(&mut self, entity: Entity, kept: &mut Kept) -> Result<(), Unreadable> {
        if !kept.is_counted(&entity) {
            self.n_kept += 1;
            let limit = self.entity_limit;
            if self.n_kept > limit {
                return Err(Unreadable::at(entity.place, format!("there are more than {limit} entities")));
            }
            kept.entities.push(entity);
        }
        Ok(())
    }

    /// A POLYLINE with its vertices, and the group after it.
    fn polyline(&mut self, start: Group<'a>) -> Result<(Entity, Group<'a>), Unreadable> {
        let mut head = Fields::default();
        let mut group = head.read(start, &mut self.groups)?;
        let mut polyline = Polyline::new(&head)?;
        while group.is(0, "VERTEX") {
            group = self.fields.read(group, &mut self.groups)?;
            polyline.push(&self.fields)?;
        }
        expect(group, "SEQEND")?;
        let next = self.fields.read(group, &mut self.groups)?;
        let entity = entity::with_content(&head, polyline.content(&head)?, &mut self.names)?;
        Ok((entity, next))
    }
}

fn expect(group: Group, word: &str) -> Result<(), Unreadable> {
    match group.is(0, word) {
        true => Ok(()),
        false => Err(Unreadable::at(group.place, format!("{word} is expected"))),
    }
}

/// The unit of $INSUNITS; `None` for 0, which is no unit.
pub fn unit(value: Group) -> Result<Option<Unit>, Unreadable> {
    Ok(Some(match value.integer()? {
        0 => return Ok(None),
        1 => Unit::Inch,
        2 => Unit::Foot,
        4 => Unit::Millimetre,
        5 => Unit::Centimetre,
        6 => Unit::Metre,
        13 => Unit::Micrometre,
        other => {
            let detail = format!(
                "the unit {other} of $INSUNITS is not supported; use mm, cm, m, micrometres, inches or feet"
            );
            return Err(Unreadable::at(value.place, detail));
        }
    }))
}
