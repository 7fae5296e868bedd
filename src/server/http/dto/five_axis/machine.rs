//! Machines with five axes in requests and answers.

use std::array::from_fn;

use nalgebra::{Point3, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::mtconnect;
use crate::http::decode::object;
use crate::http::dto::axis::{self, AxisDirection};
use crate::http::dto::check::{Range, Violations};
use crate::http::dto::point::{Coordinates, Point};
use crate::http::dto::schema::{array_of, number, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use toolpathd_core::machine::{Kind, Machine, RotaryAxis, named};

/// Legal ends of the travel of a rotary axis, degrees.
const TRAVEL_DEG: Range = Range { min: -1e6, max: 1e6 };

/// A machine with three linear axes and two rotary axes: the `name` of a machine of `/v1/machines` alone, or
/// `kind` and `axes`, or `mtconnect` and `kind`. At zero of all axes the tool points along z, and the
/// workpiece has the directions of the machine.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Machine)]
pub struct SentMachine {
    /// Name of a machine of `/v1/machines`.
    name: Option<String>,
    /// The probe document of the machine's MTConnect agent, as XML: the directions, the points and the travel
    /// of the axes. Other members of the machine complete and replace what it states.
    mtconnect: Option<String>,
    /// What the rotary axes carry. Required without `name`.
    kind: Option<Kind>,
    /// The letters of the two rotary axes, such as `AC`. A axis turns about x, B about y, C about z, unless
    /// `rotary` says otherwise. With `table_table` and `head_head`, the first axis carries the second axis.
    /// With `head_table`, the first axis belongs to the head. Required without `name`, unless `mtconnect`
    /// states which axis carries the other one.
    #[schema(pattern = "^[ABC][ABC]$")]
    axes: Option<String>,
    /// More about the two rotary axes, in the order of `axes`. Default: the defaults of all members.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<RotaryPair>)]
    rotary: Option<Vec<SentRotary>>,
    /// Travel of the linear axes. Default: without ends.
    #[serde(default, deserialize_with = "object::optional")]
    travel_mm: Option<LinearTravel>,
    /// Distance from the tip of the tool to the rotary centre of the head, in mm. Default: 0.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    pivot_mm: Option<f64>,
}

schema_of!(RotaryPair of SentRotary, "Two rotary axes.", { array_of(reference::<SentRotary>(), 2, 2) });

/// A rotary axis of a machine.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = RotaryAxis)]
pub struct SentRotary {
    /// The direction about which positive angles turn right-handed what the axis carries, of any length:
    /// three plain numbers without a unit. Default: the direction of the axis letter in `axes`.
    #[schema(value_type = Option<AxisDirection>)]
    direction: Option<Coordinates<3>>,
    /// A point on the axis when all axes are at zero, in mm. For a head it is measured from the rotary
    /// centre. Default: the origin of the part.
    #[schema(value_type = Option<Point>)]
    point_mm: Option<Point>,
    /// Lowest and highest angle, in degrees. Default: without ends.
    #[schema(value_type = Option<AngleRange>)]
    travel_deg: Option<[f64; 2]>,
    /// Whether the axis turns without end. Its angles in `samples` are then from 0 to 360 degrees.
    #[serde(default)]
    wrapped: bool,
    /// Whether positive angles turn the other way.
    #[serde(default)]
    mirrored: bool,
}

schema_of!(AngleRange, "Lowest and highest angle, in degrees.", { array_of(number(TRAVEL_DEG), 2, 2) });
schema_of!(LengthRange, "Lowest and highest position, in mm.", { array_of(number(Range::COORDINATE), 2, 2) });

/// Travel of the linear axes.
#[derive(Debug, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearTravel {
    /// Lowest and highest position of X, in mm. Default: without ends.
    #[serde(rename = "X", skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<LengthRange>)]
    x: Option<[f64; 2]>,
    /// Lowest and highest position of Y, in mm. Default: without ends.
    #[serde(rename = "Y", skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<LengthRange>)]
    y: Option<[f64; 2]>,
    /// Lowest and highest position of Z, in mm. Default: without ends.
    #[serde(rename = "Z", skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<LengthRange>)]
    z: Option<[f64; 2]>,
}

impl SentMachine {
    /// The machine in the core's terms. Adds violations to `violations`.
    pub fn convert(self, at: &Pointer, violations: &mut Violations) -> Option<Machine> {
        if self.mtconnect.is_some() && self.name.is_none() {
            return self.probed(at, violations)?.convert(at, violations);
        }
        let Self { name, mtconnect, kind, axes, rotary, travel_mm, pivot_mm } = self;
        if let Some(name) = name {
            if kind.is_some()
                || mtconnect.is_some()
                || axes.is_some()
                || rotary.is_some()
                || travel_mm.is_some()
                || pivot_mm.is_some()
            {
                let detail = "`name` stands alone: leave out the other members, or leave out `name`";
                violations.add(at, FieldCode::Conflict, detail);
            }
            let found = named::by_name(&name);
            if found.is_none() {
                let known: Vec<_> = named::named().iter().map(|own| own.name().to_owned()).collect();
                let detail = format!("this machine is unknown; use one of `{}`", known.join("`, `"));
                violations.add(&at.field("name"), FieldCode::UnknownValue, detail);
            }
            return found;
        }
        let (Some(kind), Some(axes)) = (kind, axes) else {
            let detail = "send `name`, or `kind` with `axes`";
            violations.add(at, FieldCode::MissingField, detail);
            return None;
        };
        let letters: Vec<char> = axes.chars().collect();
        let known = |letter: &char| ('A'..='C').contains(letter);
        let (&[first, second], true) = (&letters[..], letters.iter().all(known)) else {
            let detail = "send two of the letters A, B and C";
            violations.add(&at.field("axes"), FieldCode::OutOfRange, detail);
            return None;
        };
        let mut sent = rotary.unwrap_or_else(|| vec![SentRotary::default(), SentRotary::default()]);
        if sent.len() != 2 {
            let detail = "a machine has two rotary axes; send two objects, or leave `rotary` out";
            violations.add(&at.field("rotary"), FieldCode::WrongLength, detail);
        }
        sent.resize_with(2, SentRotary::default);
        let before = violations.total();
        let mut sent =
            sent.into_iter().zip([first, second]).enumerate().map(|(k, (rotary, letter))| {
                rotary.convert(letter, &at.field("rotary").index(k), violations)
            });
        let rotary = [sent.next().flatten(), sent.next().flatten()];
        drop(sent);
        let LinearTravel { x, y, z } = travel_mm.unwrap_or_default();
        let travels = [x, y, z];
        for (name, travel) in ["X", "Y", "Z"].into_iter().zip(travels) {
            for (k, end) in travel.into_iter().flatten().enumerate() {
                let end_at = at.field("travel_mm").field(name).index(k);
                violations.number(&end_at, end, Range::COORDINATE, "mm");
            }
        }
        violations.optional(&at.field("pivot_mm"), pivot_mm, Range::COORDINATE, "mm");
        let ([Some(first), Some(second)], true) = (rotary, violations.total() == before) else { return None };
        match Machine::new("custom", kind, [first, second], travels, pivot_mm.unwrap_or(0.0)) {
            Ok(machine) => Some(machine),
            Err(error) => {
                violations.add(at, FieldCode::OutOfRange, error.to_string());
                None
            }
        }
    }
}

impl SentMachine {
    /// Reads the MTConnect document into the members that the request leaves out. Adds a violation for each
    /// member that neither states.
    fn probed(mut self, at: &Pointer, violations: &mut Violations) -> Option<Self> {
        let text = self.mtconnect.take().unwrap_or_default();
        let probed = match mtconnect::read(&text) {
            Ok(probed) => probed,
            Err(detail) => {
                violations.add(&at.field("mtconnect"), FieldCode::OutOfRange, detail);
                return None;
            }
        };
        let before = violations.total();
        if self.kind.is_none() {
            let detail = "an MTConnect document does not state which axes carry the tool: send `kind`";
            violations.add(&at.field("kind"), FieldCode::MissingField, detail);
        }
        let axes = self.axes.take().or_else(|| probed.order().map(|letters| letters.iter().collect()));
        if axes.is_none() {
            let found: Vec<String> = probed.rotary.iter().map(|own| own.letter.to_string()).collect();
            let detail = format!(
                "the document has the rotary axes `{}` and does not state that one of two carries the other: send `axes`",
                found.join(", ")
            );
            violations.add(&at.field("axes"), FieldCode::MissingField, detail);
        }
        let letters: Vec<char> = axes.iter().flat_map(|axes| axes.chars()).collect();
        let mut sent = self.rotary.take().unwrap_or_default();
        sent.resize_with(sent.len().max(2), SentRotary::default);
        for (k, (own, letter)) in sent.iter_mut().zip(letters).enumerate() {
            own.complete(
                probed.rotary.iter().find(|of| of.letter == letter),
                &at.field("rotary").index(k),
                violations,
            );
        }
        let LinearTravel { x, y, z } = self.travel_mm.take().unwrap_or_default();
        let [x, y, z] = from_fn(|k| [x, y, z][k].or(probed.travel_mm[k]));
        (violations.total() == before).then_some(Self {
            axes,
            rotary: Some(sent),
            travel_mm: Some(LinearTravel { x, y, z }),
            ..self
        })
    }
}

/// The direction of the axis with a letter.
fn direction_of(letter: char) -> UnitVector3<f64> {
    match letter {
        'A' => Vector3::x_axis(),
        'B' => Vector3::y_axis(),
        _ => Vector3::z_axis(),
    }
}

impl SentRotary {
    /// Fills absent members from the axis `found` in an MTConnect document. Adds a violation for each member
    /// that is still absent.
    fn complete(&mut self, found: Option<&mtconnect::Rotary>, at: &Pointer, violations: &mut Violations) {
        self.direction = self.direction.or(found.and_then(|own| own.direction).map(Coordinates));
        self.point_mm = self.point_mm.or(found.and_then(|own| own.point_mm).map(Coordinates));
        self.travel_deg = self.travel_deg.or(found.and_then(|own| own.travel_deg));
        self.wrapped |= self.travel_deg.is_none() && found.is_some_and(|own| own.is_continuous);
        for (is_absent, name) in
            [(self.direction.is_none(), "direction"), (self.point_mm.is_none(), "point_mm")]
        {
            if is_absent {
                let detail = format!("the MTConnect document does not state this: send `{name}`");
                violations.add(&at.field(name), FieldCode::MissingField, detail);
            }
        }
    }

    fn convert(self, letter: char, at: &Pointer, violations: &mut Violations) -> Option<RotaryAxis> {
        let Self { direction, point_mm, travel_deg, wrapped, mirrored } = self;
        let direction = match direction {
            None => Some(direction_of(letter)),
            Some(own) => axis::unit(own, &at.field("direction"), violations),
        };
        if let Some(point) = &point_mm {
            point.check(&at.field("point_mm"), violations);
        }
        for (k, end) in travel_deg.into_iter().flatten().enumerate() {
            violations.number(&at.field("travel_deg").index(k), end, TRAVEL_DEG, "degrees");
        }
        Some(RotaryAxis {
            name: letter,
            direction: direction?,
            point_mm: point_mm.map_or_else(Point3::origin, Point3::from),
            travel: travel_deg.map(|ends| ends.map(f64::to_radians)),
            is_wrapped: wrapped,
            is_mirrored: mirrored,
        })
    }
}

/// The machines that a request may name.
#[derive(Debug, Serialize, ToSchema)]
pub struct Machines {
    /// All machines: generic examples of the usual kinds, of no maker.
    machines: Vec<ListedMachine>,
}

/// A machine that a request may name.
#[derive(Debug, Serialize, ToSchema)]
pub struct ListedMachine {
    /// Name of the machine: the value of `machine.name`.
    name: String,
    /// What the rotary axes carry.
    kind: Kind,
    /// The letters of the rotary axes.
    axes: String,
    /// The rotary axes, in the order of `axes`.
    rotary: Vec<ListedRotary>,
    /// Travel of the linear axes.
    travel_mm: LinearTravel,
    /// Distance from the tip of the tool to the rotary centre of the head, in mm; 0 without a head.
    pivot_mm: f64,
}

/// A rotary axis of a listed machine.
#[derive(Debug, Serialize, ToSchema)]
pub struct ListedRotary {
    /// The direction about which positive angles turn right-handed what the axis carries: three plain numbers
    /// without a unit.
    #[schema(value_type = AxisDirection)]
    direction: Coordinates<3>,
    /// Lowest and highest angle, in degrees. Absent for an axis without ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<AngleRange>)]
    travel_deg: Option<[f64; 2]>,
    /// Whether the axis turns without end.
    wrapped: bool,
}

impl Machines {
    /// All machines.
    pub fn all() -> Self {
        Self { machines: named::named().iter().map(ListedMachine::from).collect() }
    }
}

impl From<&Machine> for ListedMachine {
    fn from(machine: &Machine) -> Self {
        let [x, y, z] = machine.travel_mm();
        let rotary = machine.rotary();
        Self {
            name: machine.name().to_owned(),
            kind: machine.kind(),
            axes: rotary.iter().map(|axis| axis.name).collect(),
            rotary: rotary.iter().map(ListedRotary::from).collect(),
            travel_mm: LinearTravel { x, y, z },
            pivot_mm: machine.pivot_mm(),
        }
    }
}

impl From<&RotaryAxis> for ListedRotary {
    fn from(axis: &RotaryAxis) -> Self {
        // Travels of the list are whole degrees.
        let degrees = |end: f64| end.to_degrees().round();
        Self {
            direction: Coordinates(axis.direction.into_inner().into()),
            travel_deg: axis.travel.map(|ends| ends.map(degrees)),
            wrapped: axis.is_wrapped,
        }
    }
}
