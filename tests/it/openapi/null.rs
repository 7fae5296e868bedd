//! Where the contract allows `null`: for every optional member of a request, and in answers only where the
//! service sends `null`.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::{operations, parsed};

fn allows_null(schema: &Value) -> bool {
    schema["type"].as_array().is_some_and(|types| types.contains(&"null".into()))
        || schema["oneOf"].as_array().is_some_and(|items| items.iter().any(allows_null))
        || schema["type"] == "null"
}

/// The names of the schemas that a part of every operation reaches.
fn reached(document: &Value, part: &str) -> BTreeSet<String> {
    fn visit(value: &Value, document: &Value, names: &mut BTreeSet<String>) {
        match value {
            Value::Object(members) => {
                if let Some(Value::String(target)) = members.get("$ref")
                    && let Some(name) = target.strip_prefix("#/components/schemas/")
                    && names.insert(name.to_owned())
                {
                    visit(&document["components"]["schemas"][name], document, names);
                }
                members.values().for_each(|member| visit(member, document, names));
            }
            Value::Array(elements) => elements.iter().for_each(|element| visit(element, document, names)),
            _ => {}
        }
    }
    let mut names = BTreeSet::new();
    operations(document).iter().for_each(|(_, operation)| visit(&operation[part], document, &mut names));
    names
}

#[test]
fn no_optional_member_of_an_answer_may_be_null() {
    fn visit(schema: &Value, at: &str, wrong: &mut Vec<String>, n_members: &mut usize) {
        let required = schema["required"].as_array().cloned().unwrap_or_default();
        for (name, member) in schema["properties"].as_object().into_iter().flatten() {
            *n_members += 1;
            if allows_null(member) && !required.contains(&name.as_str().into()) {
                wrong.push(format!("{at}.{name}"));
            }
        }
        match schema {
            Value::Object(members) => {
                members
                    .iter()
                    .for_each(|(name, member)| visit(member, &format!("{at}.{name}"), wrong, n_members));
            }
            Value::Array(items) => items.iter().for_each(|item| visit(item, at, wrong, n_members)),
            _ => {}
        }
    }
    let document = parsed();
    let answered = reached(&document, "responses");
    assert!(answered.contains("Problem") && answered.contains("Toolpath"));
    let (mut wrong, mut n_members) = (Vec::new(), 0);
    for name in answered.iter().map(String::as_str).chain(["Progress"]) {
        visit(&document["components"]["schemas"][name], name, &mut wrong, &mut n_members);
    }
    assert!(wrong.is_empty(), "these may be null, and answers never hold them so: {wrong:#?}");
    assert!(n_members > 200, "only {n_members} members were found");
}

#[test]
fn a_schema_of_requests_differs_from_that_of_answers_by_null_alone() {
    /// A schema without `null`, and with the names of answers.
    fn bare(value: &Value) -> Value {
        match value {
            Value::String(text) => text.replace("/schemas/Given", "/schemas/").into(),
            Value::Array(items) => {
                items.iter().filter(|item| **item != "null" && item["type"] != "null").map(bare).collect()
            }
            Value::Object(members) => {
                let mut all = Map::new();
                for (name, member) in members {
                    match (name.as_str(), bare(member)) {
                        ("type", Value::Array(types)) if types.len() == 1 => {
                            all.insert(name.clone(), types[0].clone());
                        }
                        ("oneOf", Value::Array(options)) if options.len() == 1 => {
                            all.extend(options[0].as_object().expect("an object").clone());
                        }
                        (_, member) => {
                            all.insert(name.clone(), member);
                        }
                    }
                }
                all.into()
            }
            other => other.clone(),
        }
    }
    let document = parsed();
    let schemas = document["components"]["schemas"].as_object().expect("schemas");
    let (sent, answered) = (reached(&document, "requestBody"), reached(&document, "responses"));
    let mut n_apart = 0;
    for (name, schema) in schemas {
        let Some(of_answers) = name.strip_prefix("Given").and_then(|name| schemas.get(name)) else {
            continue;
        };
        n_apart += 1;
        assert_ne!(schema, of_answers, "{name} is superfluous");
        assert_eq!(bare(schema), bare(of_answers), "{name}");
        assert!(sent.contains(name) && !answered.contains(name), "{name} belongs to requests");
    }
    assert_eq!(n_apart, 7, "the number of schemas that requests have for themselves");
    for shared in sent.intersection(&answered) {
        assert_eq!(bare(&schemas[shared]), schemas[shared], "{shared} allows null in answers");
    }
}

#[test]
fn every_optional_member_of_a_request_may_be_null() {
    let document = parsed();
    let schemas = &document["components"]["schemas"];
    for name in ["MillRequest", "InterpolateRequest", "Wires", "Cutting", "PocketRequest", "GivenLineMove"] {
        let required = schemas[name]["required"].as_array().cloned().unwrap_or_default();
        let properties = schemas[name]["properties"].as_object().expect("an object");
        for (member, schema) in
            properties.iter().filter(|(member, _)| !required.contains(&Value::from(member.as_str())))
        {
            assert!(allows_null(schema), "{name}.{member} must not be null");
        }
    }
    assert!(allows_null(&schemas["GivenMetaTexts"]["additionalProperties"]));
}
