//! The elements of an XML text, one after the other.

use std::borrow::Cow;

use quick_xml::Reader;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};

use crate::fault::{Place, Unreadable};

/// The elements of an XML text.
pub struct Tags<'a> {
    reader: Reader<&'a [u8]>,
    /// The name of the part of the archive, for errors.
    part: &'a str,
}

/// The beginning of an element.
pub struct Start<'a> {
    tag: BytesStart<'a>,
}

impl<'a> Tags<'a> {
    pub fn new(text: &'a str, part: &'a str) -> Self {
        let mut reader = Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Self { reader, part }
    }

    /// The first element of the text.
    ///
    /// # Errors
    /// When the text has no element, or is no XML.
    pub fn root(&mut self) -> Result<Start<'a>, Unreadable> {
        self.next()?.ok_or_else(|| self.fault("it has no element"))
    }

    /// Gives each element within the last one to `each`, which must read up to its end.
    ///
    /// # Errors
    /// When the text ends, or is no XML; the errors of `each`.
    pub fn children(
        &mut self,
        mut each: impl FnMut(&mut Self, Start<'a>) -> Result<(), Unreadable>,
    ) -> Result<(), Unreadable> {
        while let Some(start) = self.next()? {
            each(self, start)?;
        }
        Ok(())
    }

    /// Passes over an element and all that it holds.
    ///
    /// # Errors
    /// When the text ends, or is no XML.
    pub fn skip(&mut self, start: &Start) -> Result<(), Unreadable> {
        match self.reader.read_to_end(start.tag.name()) {
            Ok(_) => Ok(()),
            Err(fault) => Err(self.broken(&fault)),
        }
    }

    /// The next element within the last one; `None` at the end of the last one.
    fn next(&mut self) -> Result<Option<Start<'a>>, Unreadable> {
        loop {
            match self.reader.read_event() {
                Ok(Event::Start(tag)) => return Ok(Some(Start { tag })),
                Ok(Event::End(_)) => return Ok(None),
                Ok(Event::Eof) => return Err(self.fault("the text ends before its last element does")),
                Ok(Event::DocType(_)) => return Err(self.fault("3MF allows no document type")),
                Ok(_) => {}
                Err(fault) => return Err(self.broken(&fault)),
            }
        }
    }

    /// The place behind the last element that was read.
    pub fn place(&self) -> Place {
        Place::Byte(self.reader.buffer_position())
    }

    /// A fault at the last element that was read.
    pub fn fault(&self, detail: &str) -> Unreadable {
        Unreadable::at(self.place(), format!("of {}: {detail}", self.part))
    }

    fn broken(&self, fault: &quick_xml::Error) -> Unreadable {
        let place = Place::Byte(self.reader.error_position());
        Unreadable::at(place, format!("of {}: {}", self.part, plain(fault)))
    }
}

impl Start<'_> {
    /// The prefix, which may be empty, and the name behind it.
    pub fn name(&self) -> (&str, &str) {
        split(self.tag.name().0)
    }

    /// The prefix and the name of each attribute, with its value.
    ///
    /// # Errors
    /// When an attribute is no XML.
    pub fn attributes(&self) -> impl Iterator<Item = Result<((&str, &str), Cow<'_, str>), String>> {
        let mut attributes = self.tag.attributes();
        // The check for equal names would be slow where an element has very many attributes.
        attributes.with_checks(false);
        std::iter::from_fn(move || attributes.next()).map(|attribute| {
            let attribute = attribute.map_err(|fault| plain(&fault))?;
            let value = attribute.normalized_value(XmlVersion::Implicit1_0);
            let value = value.map_err(|fault| plain(&fault))?;
            Ok((split(attribute.key.0), value))
        })
    }
}

fn split(name: &str) -> (&str, &str) {
    name.split_once(':').unwrap_or(("", name))
}

/// A fault with quotation marks in the place of grave accents.
fn plain(fault: &impl ToString) -> String {
    fault.to_string().replace('\u{60}', "\"")
}
