//! The committed contract equals the contract that the code serves, and its examples obey it.

mod answers;
mod null;
pub mod schema;

use serde_json::Value;
use toolpathd_server::http::contract;

const COMMITTED: &str = include_str!("../../openapi/openapi.json");

fn parsed() -> Value {
    serde_json::from_str(&contract()).expect("the contract is JSON")
}

#[test]
fn the_committed_contract_equals_the_served_contract() {
    assert!(
        COMMITTED.trim_end() == contract(),
        "openapi/openapi.json is not what the code serves; run `cargo run -- openapi > openapi/openapi.json`"
    );
}

#[test]
fn every_reference_in_the_contract_has_a_target() {
    fn visit(value: &Value, document: &Value) {
        match value {
            Value::Object(members) => {
                if let Some(Value::String(target)) = members.get("$ref") {
                    let found = document.pointer(target.trim_start_matches('#'));
                    assert!(found.is_some(), "{target} is not in the contract");
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
fn operation_ids_are_unique_and_every_error_is_a_problem() {
    let document = parsed();
    let mut names = std::collections::HashSet::new();
    for (path, item) in document["paths"].as_object().expect("paths") {
        for (method, operation) in item.as_object().expect("operations") {
            let name = operation["operationId"].as_str().expect("a name");
            assert!(names.insert(name.to_owned()), "the operation id {name} is used twice");
            for (status, response) in operation["responses"].as_object().expect("responses") {
                let is_problem = response["content"].get("application/problem+json").is_some();
                assert_eq!(
                    is_problem,
                    status.as_str() >= "400",
                    "{method} {path} {status}: only errors are problems"
                );
            }
        }
    }
    assert_eq!(document["openapi"], "3.1.0");
    assert_eq!(names.len(), 21);
}

#[test]
fn the_schemas_of_points_state_their_lengths() {
    let schemas = &parsed()["components"]["schemas"];
    assert_eq!((&schemas["Point"]["minItems"], &schemas["Point"]["maxItems"]), (&3.into(), &3.into()));
    assert_eq!(schemas["PointGrid"]["properties"]["points"]["$ref"], "#/components/schemas/PointRows");
    let points = &schemas["PointRows"];
    assert_eq!((&points["minItems"], &points["items"]["minItems"]), (&2.into(), &2.into()));
    assert_eq!(schemas["MillRequest"]["additionalProperties"], false);
}

#[test]
fn no_schema_requires_two_types_at_once() {
    fn visit(value: &Value) {
        if let Some(all) = value.get("allOf").and_then(Value::as_array) {
            let types: Vec<_> = all.iter().filter_map(|part| part.get("type")).collect();
            assert!(
                types.windows(2).all(|pair| pair[0] == pair[1]),
                "the parts of allOf have different types: {value}"
            );
        }
        match value {
            Value::Object(members) => members.values().for_each(visit),
            Value::Array(elements) => elements.iter().for_each(visit),
            _ => {}
        }
    }
    visit(&parsed());
}

/// Calls `look` with the path and the schema of every property of every object schema.
fn each_property(value: &Value, path: &str, look: &mut impl FnMut(&str, &Value)) {
    match value {
        Value::Object(members) => {
            if let Some(properties) = members.get("properties").and_then(Value::as_object) {
                properties.iter().for_each(|(name, property)| look(&format!("{path}.{name}"), property));
            }
            let schemas = members.iter().filter(|(name, _)| !name.starts_with("example"));
            schemas.for_each(|(name, member)| each_property(member, &format!("{path}.{name}"), look));
        }
        Value::Array(items) => items.iter().for_each(|item| each_property(item, path, look)),
        _ => {}
    }
}

fn operations(document: &Value) -> Vec<(String, Value)> {
    let items = document["paths"].as_object().expect("paths").iter();
    let operations = items.flat_map(|(path, item)| {
        let methods = item.as_object().expect("operations").iter();
        methods.map(move |(method, operation)| (format!("{method} {path}"), operation.clone()))
    });
    operations.collect()
}

#[test]
fn every_property_parameter_and_operation_has_a_description() {
    let document = parsed();
    let mut silent = Vec::new();
    let mut n_properties = 0;
    each_property(&document, "", &mut |path, property| {
        n_properties += 1;
        if property["description"].as_str().is_none_or(|text| text.trim().len() < 8) {
            silent.push(path.to_owned());
        }
    });
    for (name, operation) in operations(&document) {
        for member in ["summary", "description"] {
            if operation[member].as_str().is_none_or(str::is_empty) {
                silent.push(format!("{name} {member}"));
            }
        }
        for parameter in operation["parameters"].as_array().into_iter().flatten() {
            if parameter["description"].as_str().is_none_or(str::is_empty) {
                silent.push(format!("{name} {}", parameter["name"]));
            }
        }
    }
    assert!(silent.is_empty(), "without a description: {silent:#?}");
    assert!(n_properties > 200, "only {n_properties} properties were found");
    assert!(document["servers"].as_array().is_some_and(|servers| !servers.is_empty()), "no server is listed");
    assert!(document["info"].get("license").is_none(), "the contract names a licence, but none is chosen");
}

/// Words that name a unit in a description, and words for numbers that have no unit.
const UNITS: [&str; 22] = [
    "mm2",
    "mm3",
    "mm",
    "mm/s",
    "mm/s3",
    "mm/min",
    "mm/s2",
    "1/mm",
    "1/min",
    "degrees",
    "s",
    "milliseconds",
    "bytes",
    "characters",
    "number",
    "numbers",
    "count",
    "counts",
    "ratio",
    "byte",
    "points",
    "steps",
];

/// Whether a schema allows a number, or an array of numbers. It may also allow `null`.
fn is_numeric(document: &Value, schema: &Value) -> bool {
    if let Some(target) = schema["$ref"].as_str() {
        return is_numeric(document, document.pointer(target.trim_start_matches('#')).expect("a schema"));
    }
    let is_of = |name: &str| {
        schema["type"] == name || schema["type"].as_array().is_some_and(|types| types.contains(&name.into()))
    };
    is_of("number")
        || is_of("integer")
        || is_of("array") && is_numeric(document, &schema["items"])
        || schema["oneOf"].as_array().into_iter().flatten().any(|option| is_numeric(document, option))
}

#[test]
fn the_description_of_every_number_names_its_unit_or_that_it_has_none() {
    let document = parsed();
    let mut bare = Vec::new();
    let mut n_numbers = 0;
    let mut look = |path: &str, property: &Value| {
        if !is_numeric(&document, property) {
            return;
        }
        n_numbers += 1;
        let text = property["description"].as_str().unwrap_or_default().to_lowercase();
        let mut words = text.split(|c: char| c.is_whitespace() || ",.;:()`".contains(c));
        if !words.any(|word| UNITS.contains(&word)) {
            bare.push(path.to_owned());
        }
    };
    each_property(&document, "", &mut look);
    for (name, operation) in operations(&document) {
        for parameter in operation["parameters"].as_array().into_iter().flatten() {
            let mut described = parameter["schema"].clone();
            described["description"] = parameter["description"].clone();
            look(&format!("{name} {}", parameter["name"]), &described);
        }
    }
    assert!(bare.is_empty(), "without a unit: {bare:#?}");
    assert!(n_numbers > 100, "only {n_numbers} numbers were found");
}

#[test]
fn unions_of_objects_with_a_kind_have_a_discriminator() {
    let document = parsed();
    let schemas = document["components"]["schemas"].as_object().expect("schemas");
    let mut n_unions = 0;
    for (name, union) in schemas {
        let Some(options) = union["oneOf"].as_array() else { continue };
        let kind_of = |option: &Value| {
            let target = option["$ref"].as_str()?.to_owned();
            let schema = document.pointer(target.trim_start_matches('#'))?;
            let kind = schema.pointer("/properties/kind/enum/0")?.as_str()?.to_owned();
            let is_required =
                schema["required"].as_array().is_some_and(|names| names.contains(&"kind".into()));
            is_required.then_some((kind, target))
        };
        let kinds: Vec<_> = options.iter().filter_map(kind_of).collect();
        if kinds.is_empty() {
            continue;
        }
        // One option may have no kind at all: generators tell it apart by its other members.
        let has_no_kind = |option: &&Value| {
            let target = option["$ref"].as_str().unwrap_or_default().trim_start_matches('#');
            document.pointer(target).is_some_and(|schema| schema["properties"]["kind"].is_null())
        };
        if options.iter().filter(has_no_kind).count() == 1 {
            assert_eq!(kinds.len() + 1, options.len(), "{name} has two options without a kind");
            continue;
        }
        n_unions += 1;
        assert_eq!(kinds.len(), options.len(), "{name} has an option without a kind");
        assert_eq!(union["discriminator"]["propertyName"], "kind", "{name} lacks its discriminator");
        let mapping = union["discriminator"]["mapping"].as_object().expect("a mapping");
        assert_eq!(mapping.len(), kinds.len(), "{name} maps other kinds than it has");
        for (kind, target) in kinds {
            assert_eq!(mapping[&kind], target, "{name} maps the kind {kind} to another schema");
        }
    }
    assert_eq!(n_unions, 9, "the number of unions with a kind");
}

/// Generators of clients take a member with a default for one that is always there.
#[test]
fn defaults_stand_in_descriptions_and_no_member_with_one_is_required() {
    fn visit(value: &Value, n_defaults: &mut usize) {
        if let Some(properties) = value["properties"].as_object() {
            let required = value["required"].as_array().cloned().unwrap_or_default();
            for (name, property) in properties {
                assert!(property.get("default").is_none(), "{name} has a default beside its description");
                if property["description"].as_str().is_some_and(|text| text.contains("Default: `")) {
                    *n_defaults += 1;
                    assert!(
                        !required.contains(&name.as_str().into()),
                        "{name} has a default and is required"
                    );
                }
            }
        }
        match value {
            Value::Object(members) => members.values().for_each(|member| visit(member, n_defaults)),
            Value::Array(elements) => elements.iter().for_each(|element| visit(element, n_defaults)),
            _ => {}
        }
    }
    let mut n_defaults = 0;
    visit(&parsed()["components"], &mut n_defaults);
    assert!(n_defaults > 20, "only {n_defaults} defaults were found");
}

#[test]
fn examples_of_requests_answers_and_problems_obey_their_schemas() {
    let document = parsed();
    let mut n_examples = 0;
    for (name, operation) in operations(&document) {
        let bodies = [&operation["requestBody"], &operation["responses"]["200"]];
        for body in bodies.map(|body| &body["content"]["application/json"]) {
            let named = body["examples"].as_object().into_iter().flat_map(|examples| examples.values());
            let values = named.map(|example| &example["value"]).chain(body.get("example"));
            for value in values {
                n_examples += 1;
                let faults = schema::faults(&document, &body["schema"], value, "#");
                assert!(faults.is_empty(), "an example of {name} breaks its schema: {faults:#?}");
            }
        }
    }
    assert!(n_examples >= 28 + 8, "only {n_examples} examples were found");
    let problem = &document["components"]["schemas"]["Problem"];
    let faults = schema::faults(&document, problem, &problem["examples"][0], "#");
    assert!(faults.is_empty(), "the example of a problem breaks its schema: {faults:#?}");
}

#[test]
fn the_schema_check_finds_a_body_that_breaks_its_schema() {
    let document = parsed();
    let mill = &document["components"]["schemas"]["MillRequest"];
    let body = &document["paths"]["/v1/surfaces/mill"]["post"]["requestBody"]["content"]["application/json"];
    let legal = &body["examples"]["one-pass"]["value"];
    for (pointer, value) in [
        ("/tolerance_mm", "fine".into()),
        ("/tolerance_mm", (-1).into()),
        ("/surface/kind", "sphere".into()),
        ("/surface/points/0/0", serde_json::json!([1, 2])),
        ("/tool/shape", "round".into()),
    ] {
        let mut broken = legal.clone();
        *broken.pointer_mut(pointer).expect("a member") = value;
        assert!(!schema::faults(&document, mill, &broken, "#").is_empty(), "no fault was found at {pointer}");
    }
}
