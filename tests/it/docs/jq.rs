//! Runs jq commands without jq.

use std::collections::HashMap;

use jaq_core::load::{Arena, File, Loader};
use jaq_core::{Compiler, Ctx, Vars, data, defs, funs, unwrap_valr};
use jaq_json::{Val, read};

/// `jq FILTER FILE > FILE`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Jq {
    pub filter: String,
    /// The file that is read.
    pub read: String,
    pub saved_as: String,
}

impl Jq {
    /// The command of these arguments. An option is an error.
    pub fn of(arguments: &[String]) -> Result<Self, String> {
        match arguments {
            [filter, read, to, saved_as] if to == ">" && !filter.starts_with('-') => {
                Ok(Self { filter: filter.clone(), read: read.clone(), saved_as: saved_as.clone() })
            }
            _ => Err("only jq with a filter, a file and `>` is supported".into()),
        }
    }

    /// What the command writes. The file is one that an earlier command of the document wrote.
    ///
    /// # Errors
    /// The file is missing or no JSON, or the filter fails.
    pub fn run(&self, files: &HashMap<String, Vec<u8>>) -> Result<Vec<u8>, String> {
        let file = files.get(&self.read).ok_or(format!("nothing wrote {}", self.read))?;
        let input = read::parse_single(file).map_err(|fault| format!("{}: {fault}", self.read))?;
        let arena = Arena::default();
        let code = File { code: self.filter.as_str(), path: () };
        let modules = Loader::new(defs()).load(&arena, code).map_err(|fault| format!("{fault:?}"))?;
        let filter = Compiler::default().with_funs(funs()).compile(modules);
        let filter = filter.map_err(|fault| format!("{fault:?}"))?;
        let context = Ctx::<data::JustLut<Val>>::new(&filter.lut, Vars::new([]));
        let mut written = String::new();
        for value in filter.id.run((context, input)).map(unwrap_valr) {
            let value = value.map_err(|fault| format!("{}: {fault:?}", self.filter))?;
            written += &format!("{value}\n");
        }
        Ok(written.into_bytes())
    }
}

#[test]
fn a_filter_makes_a_job_of_an_answer() {
    let filter = "[.holes[] | select(.depth > 2) | .at as [$x, $y] | {at: [$x + .r, $y], r: (.r / 2)}]";
    let jq = Jq { filter: filter.into(), read: "in".into(), saved_as: "out".into() };
    let text = "{\"holes\": [{\"at\": [1.5, 2], \"r\": 3, \"depth\": 4}, {\"depth\": 1}]}";
    let files = HashMap::from([("in".to_owned(), text.as_bytes().to_vec())]);
    let written = jq.run(&files).expect("values");
    assert_eq!(String::from_utf8_lossy(&written), "[{\"at\":[4.5,2],\"r\":1.5}]\n");
    let broken = Jq { filter: "[.holes".into(), ..jq };
    assert!(broken.run(&files).is_err());
}
