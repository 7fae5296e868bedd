//! The committed contract is the one the code serves, and its examples obey it.

use serde_json::Value;
use toolpathd::http::contract;

const COMMITTED: &str = include_str!("../../openapi/openapi.json");

fn parsed() -> Value {
    serde_json::from_str(&contract()).expect("the contract is JSON")
}

#[test]
fn the_committed_contract_is_current() {
    assert!(
        COMMITTED.trim_end() == contract(),
        "openapi/openapi.json is not what the code serves; run `cargo run -- openapi > openapi/openapi.json`"
    );
}

#[test]
fn every_reference_leads_somewhere() {
    fn visit(value: &Value, document: &Value) {
        match value {
            Value::Object(members) => {
                if let Some(Value::String(target)) = members.get("$ref") {
                    let found = document.pointer(target.trim_start_matches('#'));
                    assert!(found.is_some(), "{target} leads nowhere");
                }
                members.values().for_each(|member| visit(member, document));
            }
            Value::Array(elements) => elements.iter().for_each(|element| visit(element, document)),
            _ => {}
        }
    }
    let document = parsed();
    visit(&document, &document);
}

#[test]
fn operations_have_names_of_their_own_and_answer_problems() {
    let document = parsed();
    let mut names = std::collections::HashSet::new();
    for (path, item) in document["paths"].as_object().expect("paths") {
        for (method, operation) in item.as_object().expect("operations") {
            let name = operation["operationId"].as_str().expect("a name");
            assert!(names.insert(name.to_owned()), "{name} is used twice");
            for (status, response) in operation["responses"].as_object().expect("responses") {
                let is_problem = response["content"].get("application/problem+json").is_some();
                assert_eq!(is_problem, status.as_str() >= "400", "{method} {path} {status}");
            }
        }
    }
    assert_eq!(document["openapi"], "3.1.0");
    assert_eq!(names.len(), 13);
}

#[test]
fn the_schemas_of_points_hold_their_limits() {
    let schemas = &parsed()["components"]["schemas"];
    assert_eq!((&schemas["Point"]["minItems"], &schemas["Point"]["maxItems"]), (&3.into(), &3.into()));
    let points = &schemas["PointGrid"]["properties"]["points"];
    assert_eq!((&points["minItems"], &points["items"]["minItems"]), (&2.into(), &2.into()));
    assert_eq!(schemas["MillRequest"]["additionalProperties"], false);
}

#[test]
fn no_schema_asks_for_two_types_at_once() {
    fn visit(value: &Value) {
        if let Some(all) = value.get("allOf").and_then(Value::as_array) {
            let types: Vec<_> = all.iter().filter_map(|part| part.get("type")).collect();
            assert!(types.windows(2).all(|pair| pair[0] == pair[1]), "{value}");
        }
        match value {
            Value::Object(members) => members.values().for_each(visit),
            Value::Array(elements) => elements.iter().for_each(visit),
            _ => {}
        }
    }
    visit(&parsed());
}
