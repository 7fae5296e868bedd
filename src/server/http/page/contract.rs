//! The contract as the page needs it: the requests with their schemas. Schemas of answers, and the bodies
//! of examples, are several times as long; the page asks for an example when it shows it.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

use crate::http::openapi::example_folder;
use crate::http::request::representation::JSON;

const SCHEMAS: &str = "#/components/schemas/";

/// The part of a contract that is about requests with bodies of JSON.
pub fn reduced(contract: &Value) -> Value {
    let paths: Map<String, Value> = contract["paths"]
        .as_object()
        .into_iter()
        .flatten()
        .filter_map(|(path, item)| Some((path.clone(), json!({ "post": operation(path, &item["post"])? }))))
        .collect();
    let paths = Value::Object(paths);
    let all = &contract["components"]["schemas"];
    let mut needed = BTreeSet::new();
    need(&paths, all, &mut needed);
    let schemas: Map<String, Value> =
        needed.into_iter().map(|name| (name.to_owned(), all[name].clone())).collect();
    json!({ "openapi": contract["openapi"], "paths": paths, "components": { "schemas": schemas } })
}

/// An operation that takes JSON; none for any other.
fn operation(path: &str, post: &Value) -> Option<Value> {
    let content = post["requestBody"]["content"].as_object()?;
    let schema = content.get(JSON)?.get("schema")?;
    let names = content[JSON]["examples"].as_object().into_iter().flat_map(Map::keys);
    let folder = example_folder(path);
    let examples: Map<String, Value> = names
        .map(|name| (name.clone(), json!({ "externalValue": format!("page/examples/{folder}/{name}") })))
        .collect();
    let others = content.keys().filter(|kind| *kind != JSON).map(|kind| (kind.clone(), json!({})));
    let mut body: Map<String, Value> = others.collect();
    body.insert(JSON.to_owned(), json!({ "schema": schema, "examples": examples }));
    let forms = post["responses"]["200"]["content"].as_object().into_iter().flat_map(Map::keys);
    let forms: Map<String, Value> = forms.map(|kind| (kind.clone(), json!({}))).collect();
    let in_query = |parameter: &&Value| parameter["in"] == "query";
    let parameters: Vec<&Value> =
        post["parameters"].as_array().into_iter().flatten().filter(in_query).collect();
    Some(json!({
        "operationId": post["operationId"],
        "summary": post["summary"],
        "description": post["description"],
        "parameters": parameters,
        "requestBody": { "content": body },
        "responses": { "200": { "content": forms } },
    }))
}

/// Adds the names of all schemas to which a value refers, and to which these refer.
fn need<'a>(value: &'a Value, all: &'a Value, needed: &mut BTreeSet<&'a str>) {
    match value {
        Value::Object(members) => {
            let name =
                members.get("$ref").and_then(Value::as_str).and_then(|place| place.strip_prefix(SCHEMAS));
            if let Some(name) = name
                && needed.insert(name)
            {
                need(&all[name], all, needed);
            }
            members.values().for_each(|member| need(member, all, needed));
        }
        Value::Array(elements) => elements.iter().for_each(|element| need(element, all, needed)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_is_referred_to_is_there_and_nothing_of_answers() {
        let contract = crate::http::openapi::document();
        let reduced = reduced(&contract);
        let text = reduced.to_string();
        for reference in text.split(SCHEMAS).skip(1) {
            let name = reference.split('"').next().unwrap();
            assert!(reduced["components"]["schemas"].get(name).is_some(), "{name}");
        }
        let plan = &reduced["paths"]["/v1/pockets/plan"]["post"];
        let island = &plan["requestBody"]["content"][JSON]["examples"]["island"];
        assert_eq!(island["externalValue"], "page/examples/pockets-plan/island");
        assert!(reduced["components"]["schemas"].get("PocketReport").is_none());
        assert!(
            reduced["paths"].get("/v1/dialects").is_none()
                && reduced["paths"].get("/v1/dnc/{target}").is_none()
        );
        assert!(5 * text.len() < contract.to_string().len() * 3, "{} bytes", text.len());
    }
}
