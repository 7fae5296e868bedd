//! Reads the axes of a machine from an MTConnect probe document.
//!
//! # Method
//! The components `Linear` and `Rotary` with the names X, Y, Z and A, B, C count; other components, such as
//! spindles, do not. Of a rotary axis, `Configuration/Motion` states the direction (`Axis`), a point
//! (`Origin` or `Transformation/Translation`), whether it turns without end (`CONTINUOUS`), and which axis
//! carries it (`parentIdRef`). Travel comes from a `Specification` of the position, or from the
//! `Constraints` of a position.
//!
//! # Reference
//! MTConnect Standard, Part 2, Device Information Model, version 2.

use roxmltree::{Document, Node, ParsingOptions};

/// Most nodes of a document. A machine has some thousand.
const MOST_NODES: u32 = 200_000;

/// A rotary axis as far as the document states it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotary {
    pub letter: char,
    pub direction: Option<[f64; 3]>,
    pub point_mm: Option<[f64; 3]>,
    pub travel_deg: Option<[f64; 2]>,
    pub is_continuous: bool,
    /// The id of the element `Motion` of this axis.
    id: Option<String>,
    /// The id of the element `Motion` of the axis that carries this axis.
    parent: Option<String>,
}

/// The axes of a document.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Probed {
    /// In the order of the document.
    pub rotary: Vec<Rotary>,
    /// Of X, Y and Z.
    pub travel_mm: [Option<[f64; 2]>; 3],
}

impl Probed {
    /// The letters of the two rotary axes, the carrying one first; `None` if the document does not say which
    /// axis carries the other one.
    pub fn order(&self) -> Option<[char; 2]> {
        let [a, b] = &self.rotary[..] else { return None };
        let carries = |below: &Rotary, above: &Rotary| above.parent.is_some() && above.parent == below.id;
        match (carries(a, b), carries(b, a)) {
            (true, false) => Some([a.letter, b.letter]),
            (false, true) => Some([b.letter, a.letter]),
            _ => None,
        }
    }
}

/// Reads a document.
///
/// # Errors
/// A sentence that says why it is no probe document, or that it is one of several devices.
pub fn read(text: &str) -> Result<Probed, String> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document =
        Document::parse_with_options(text, options).map_err(|error| format!("this is not XML: {error}"))?;
    let devices = document.descendants().filter(|node| node.tag_name().name() == "Device").count();
    if devices != 1 {
        return Err(format!("the document describes {devices} devices; send the probe of one device"));
    }
    let mut probed = Probed::default();
    for node in document.descendants() {
        let Some(letter) = letter(&node) else { continue };
        let travel = travel(&node);
        match (node.tag_name().name(), "XYZ".find(letter)) {
            ("Linear", Some(k)) => probed.travel_mm[k] = probed.travel_mm[k].or(travel),
            ("Rotary", None) => probed.rotary.push(rotary(&node, letter, travel)),
            _ => {}
        }
    }
    Ok(probed)
}

/// The letter of an axis: its name, or its native name.
fn letter(node: &Node) -> Option<char> {
    let of = |name: &str| {
        let mut characters = name.chars();
        let first = characters.next().filter(|letter| "XYZABC".contains(*letter))?;
        characters.next().is_none().then_some(first)
    };
    ["name", "nativeName"].iter().find_map(|attribute| node.attribute(*attribute).and_then(of))
}

fn rotary(node: &Node, letter: char, travel_deg: Option<[f64; 2]>) -> Rotary {
    let motion = child(node, "Configuration").and_then(|own| child(&own, "Motion"));
    let attribute = |name: &str| motion.and_then(|own| own.attribute(name)).map(str::to_owned);
    let translation =
        || motion.and_then(|own| child(&own, "Transformation")).and_then(|own| child(&own, "Translation"));
    let origin = motion.and_then(|own| child(&own, "Origin")).or_else(translation);
    Rotary {
        letter,
        direction: motion.and_then(|own| child(&own, "Axis")).and_then(|own| numbers(&own)),
        point_mm: origin.and_then(|own| numbers(&own)),
        travel_deg,
        is_continuous: travel_deg.is_none() && attribute("type").as_deref() == Some("CONTINUOUS"),
        id: attribute("id"),
        parent: attribute("parentIdRef"),
    }
}

/// The ends of travel: of a specification of the position, or of the constraints of a position.
fn travel(node: &Node) -> Option<[f64; 2]> {
    let specifications = child(node, "Configuration").and_then(|own| child(&own, "Specifications"));
    let specified = specifications.into_iter().flat_map(|own| own.children()).filter(|own| {
        own.tag_name().name() == "Specification"
            && matches!(own.attribute("type"), Some("POSITION" | "ANGLE" | "LINEAR" | "ROTARY"))
    });
    let items = child(node, "DataItems").into_iter().flat_map(|own| own.children());
    let constrained = items
        .filter(|own| matches!(own.attribute("type"), Some("POSITION" | "ANGLE")))
        .filter_map(|own| child(&own, "Constraints"));
    specified.chain(constrained).find_map(|own| Some([number(&own, "Minimum")?, number(&own, "Maximum")?]))
}

fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|own| own.tag_name().name() == name)
}

fn number(node: &Node, name: &str) -> Option<f64> {
    child(node, name)?.text().and_then(finite)
}

/// Three numbers, separated by spaces.
fn numbers(node: &Node) -> Option<[f64; 3]> {
    let all: Option<Vec<f64>> = node.text()?.split_whitespace().map(finite).collect();
    all?.try_into().ok()
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_that_is_deep_or_large_or_has_entities_is_refused() {
        let deep = format!("{}{}", "<a>".repeat(300_000), "</a>".repeat(300_000));
        assert!(read(&deep).is_err());
        assert!(read("<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>").unwrap_err().contains("not XML"));
        assert!(read("<a/>").unwrap_err().contains("0 devices"));
    }
}
