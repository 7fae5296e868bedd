//! What the program of an answer takes over from the text of a path. What the request states itself counts
//! before the text.

use crate::http::dto::check::Violations;
use crate::http::dto::setup::Setup;
use crate::http::error::FieldCode;
use crate::http::messages::{self, Warning};
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::cutting::{Coolant, CuttingRequest};
use toolpathd_core::toolpath::pose::Waypoint;
use toolpathd_post::Missing;
use toolpathd_post::path_text::{LeftWord, PathText, Said};

/// The part of a text that the setup does not hold.
#[derive(Debug, Default)]
pub struct Carried {
    pub spindle_rpm: Option<f64>,
    pub coolant: Option<Coolant>,
    /// Notes for the header of the program.
    pub comments: Vec<String>,
    pub left_alone: Option<Warning>,
}

impl Carried {
    /// The path, and what else the text says. Completes `setup`, and adds violations to `violations`.
    pub fn new(
        text: PathText,
        member: &str,
        setup: &mut Setup,
        cutting: Option<&CuttingRequest>,
        violations: &mut Violations,
    ) -> (Vec<Waypoint>, Self) {
        let PathText { path, tool, spindle_rpm, coolant, work_offset, name, comments, mut left_alone } = text;
        let mut differs = |word: &str, line: usize| {
            left_alone.push(LeftWord { word: word.to_owned(), count: 1, line });
        };
        if let Some(Said { value, line }) = tool {
            match setup.tool.as_mut().map(|tool| &mut tool.number) {
                None => setup.called = Some(value),
                Some(number @ None) => *number = Some(value),
                Some(Some(number)) if *number == value => {}
                Some(Some(_)) => differs("the tool number", line),
            }
        }
        if let (Some(Said { value, line }), Some(own)) =
            (spindle_rpm, cutting.and_then(|own| own.spindle_rpm))
            && own != value
        {
            differs("the spindle speed", line);
        }
        let own = cutting.map(|own| own.coolant).filter(|own| *own != Coolant::Off);
        if let (Some(Said { value, line }), Some(own)) = (coolant, own)
            && own != value
        {
            differs("the coolant", line);
        }
        let missing = |setup: &Setup, coolant: Option<Coolant>| {
            let coolant = coolant.unwrap_or_default();
            toolpathd_post::missing(setup.dialect, &setup.program, coolant, setup.tool.as_ref())
        };
        // What the request itself asks for in vain has been told already.
        let told = missing(setup, own);
        setup.program.work_offset = setup.program.work_offset.or(work_offset);
        setup.program.name = setup.program.name.take().or(name);
        let coolant = own.or(coolant.map(|said| said.value));
        let at = Pointer::root().field(member);
        for missing in missing(setup, coolant).iter().filter(|missing| !told.contains(missing)) {
            violations.add(&at, FieldCode::Unsupported, messages::missing(missing).1);
        }
        let most = setup.dialect.abilities.max_tool;
        if let Some(number) = setup.called.filter(|number| *number > most) {
            let missing = Missing::ToolNumber { dialect: setup.dialect.name, number, most };
            violations.add(&at, FieldCode::Unsupported, messages::missing(&missing).1);
        }
        let carried = Self {
            spindle_rpm: spindle_rpm.map(|said| said.value),
            coolant,
            comments,
            left_alone: messages::words_left_alone(member, &left_alone),
        };
        (path, carried)
    }
}
