//! Checks a receipt of a verification: whether it was altered, whether it is of these files, and whether all
//! that it states is proved again.

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::config::{Checking, Limits};
use crate::http::{DIGESTED, RECEIPT_SCHEMA, receipt_of};
use crate::receipt::{PublicKey, Unrepeated, digest, digest_of, leave_out_null};
use toolpathd_core::budget::Budget;

/// Members of a request that are premises of its receipt.
const PREMISES: [&str; 6] =
    ["tolerance_mm", "control_tolerance_mm", "clearance_mm", "allowed_excess_mm", "cell_mm", "rapids"];

/// The same of what a program does not say.
const PREMISES_OF_TEXT: [&str; 7] =
    ["dialect", "units", "without_point", "start", "offsets", "block_delete", "compensation"];

/// A mark of the order of bytes at the start of a text in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The most differences that are named.
const MOST_NAMED: usize = 10;

/// What a receipt is checked against.
struct Files<'a> {
    program: &'a [u8],
    part: &'a Map<String, Value>,
}

/// Checks a receipt. Answers what holds, in words.
///
/// # Errors
/// Every reason why the receipt does not hold or its verdict is not `pass`, in words.
pub fn check(checking: &Checking, limits: &Limits) -> Result<String, String> {
    let Checking { receipt, program, part, key } = checking;
    let answer = object(receipt)?;
    let receipt = match answer.get("receipt") {
        Some(Value::Object(receipt)) => receipt,
        _ => &answer,
    };
    let files = Files { program: &read(program)?, part: &object(part)? };
    judged(receipt, &files, key.as_ref(), limits).map_err(|reasons| reasons.join("\n"))?;
    let verdict = receipt.get("verdict").and_then(Value::as_str).unwrap_or_default();
    let tolerance = receipt.get("premises").and_then(|own| own.get("tolerance_mm")).cloned();
    let tolerance = tolerance.unwrap_or_default();
    let signed = match (signature(receipt), key) {
        (Some(_), Some(_)) => "signed by the key that was asked for".to_owned(),
        (Some((key, _)), None) => format!("signed by {key}, which was compared with no key"),
        (None, _) => "not signed".to_owned(),
    };
    let text = format!("the receipt holds: verdict {verdict} within {tolerance} mm; {signed}");
    if verdict == "pass" { Ok(text) } else { Err(text) }
}

/// Every reason why a receipt does not hold.
fn judged(
    receipt: &Map<String, Value>,
    files: &Files<'_>,
    key: Option<&PublicKey>,
    limits: &Limits,
) -> Result<(), Vec<String>> {
    if receipt.get("schema").and_then(Value::as_str) != Some(RECEIPT_SCHEMA) {
        return Err(vec![format!("this is no receipt: `schema` is not `{RECEIPT_SCHEMA}`")]);
    }
    let mut reasons = Vec::new();
    reasons.extend(altered(receipt, key));
    reasons.extend(stale(receipt, files));
    reasons.extend(contradictions(receipt, files));
    if !reasons.is_empty() {
        return Err(reasons);
    }
    let request = request(receipt, files).map_err(|reason| vec![reason])?;
    let anew = receipt_of(request.to_string().as_bytes(), limits, &Budget::unlimited());
    let anew =
        anew.map_err(|error| vec![format!("the program is not verified again: {}", error.detail())])?;
    let mut anew = serde_json::to_value(anew).map_err(|error| vec![error.to_string()])?;
    leave_out_null(&mut anew);
    let mut stated = Value::Object(receipt.clone());
    leave_out_null(&mut stated);
    differences("", &stated, &anew, &mut reasons);
    if reasons.is_empty() { Ok(()) } else { Err(reasons) }
}

/// The public key and the value of the signature.
fn signature(receipt: &Map<String, Value>) -> Option<(&str, &str)> {
    let signature = receipt.get("signature").filter(|own| !own.is_null())?;
    let text = |name: &str| signature.get(name).and_then(Value::as_str).unwrap_or_default();
    Some((text("public_key"), text("value")))
}

/// Why digest or signature do not fit the receipt.
fn altered(receipt: &Map<String, Value>, key: Option<&PublicKey>) -> Vec<String> {
    let mut content = receipt.clone();
    content.retain(|name, _| name != "digest" && name != "signature");
    let stated = receipt.get("digest").and_then(Value::as_str).unwrap_or_default();
    let mut reasons = Vec::new();
    if digest_of(&content).ok().as_deref() != Some(stated) {
        reasons.push("the receipt was altered: its digest does not fit its content".to_owned());
    }
    let algorithm = receipt.get("signature").and_then(|own| own.get("algorithm"));
    let n_members = receipt.get("signature").and_then(Value::as_object).map_or(0, Map::len);
    match signature(receipt) {
        None if key.is_some() => reasons.push("the receipt is not signed".to_owned()),
        None => {}
        Some((own, value)) => {
            let signed_by = PublicKey::of_base64(own);
            let is_signed = signed_by.as_ref().is_some_and(|key| key.has_signed(stated, value));
            if !is_signed || n_members != 3 || algorithm.and_then(Value::as_str) != Some("ed25519") {
                reasons.push("the signature does not fit the receipt".to_owned());
            } else if key.is_some() && signed_by.as_ref() != key {
                reasons.push(format!("another key has signed the receipt: {own}"));
            }
        }
    }
    reasons
}

/// Which of the files are others than those that were verified.
fn stale(receipt: &Map<String, Value>, files: &Files<'_>) -> Vec<String> {
    let digests = receipt.get("digests").cloned().unwrap_or_default();
    let mut reasons = Vec::new();
    let mut compare = |name: &str, own: Option<String>| {
        if own.as_deref() != digests.get(name).and_then(Value::as_str) {
            reasons.push(format!("the receipt is stale: {name} is not what was verified"));
        }
    };
    let is_text = program_premises(receipt).is_some();
    let toolpath =
        || serde_json::from_slice::<Value>(files.program).ok().and_then(|own| digest_of(&own).ok());
    compare("program", if is_text { Some(digest(files.program)) } else { toolpath() });
    for (name, members) in DIGESTED {
        compare(name, digest_of(&members_of(files.part, members)).ok());
    }
    reasons
}

/// Premises that the request of PART names in another way.
fn contradictions(receipt: &Map<String, Value>, files: &Files<'_>) -> Vec<String> {
    let premises = receipt.get("premises").and_then(Value::as_object);
    let stated = |name: &str| {
        let of_text = program_premises(receipt).and_then(|own| own.get(name));
        premises.and_then(|own| own.get(name)).or(of_text).cloned().unwrap_or_default()
    };
    let names = PREMISES.iter().chain(&PREMISES_OF_TEXT);
    let asked = names.filter_map(|name| Some((*name, files.part.get(*name).filter(|own| !own.is_null())?)));
    let other = asked.filter(|(name, value)| !is_same(value, &stated(name)));
    let told = other.map(|(name, value)| {
        format!("the request has another {name} than the receipt: {value} and {}", stated(name))
    });
    told.collect()
}

/// Whether two values are the same, in letters of any case and with either name of a work offset.
fn is_same(one: &Value, other: &Value) -> bool {
    let text = |value: &Value| {
        let value = serde_json::from_str::<Value>(&value.to_string().to_uppercase().replace("G154", "G54.1"));
        value.ok().and_then(|value| digest_of(&value).ok())
    };
    one == other || text(one).is_some_and(|one| Some(one) == text(other))
}

/// How the text was read; `None` where a toolpath was verified.
fn program_premises(receipt: &Map<String, Value>) -> Option<&Map<String, Value>> {
    receipt.get("premises")?.get("program")?.as_object()
}

/// The request that verifies the same program on the same premises.
fn request(receipt: &Map<String, Value>, files: &Files<'_>) -> Result<Value, String> {
    let mut request = Map::new();
    for (_, names) in DIGESTED {
        request.extend(members_of(files.part, names));
    }
    let premises = receipt.get("premises").and_then(Value::as_object);
    let premises = premises.ok_or("the receipt has no premises")?;
    request.extend(members_of(premises, &PREMISES));
    match program_premises(receipt) {
        Some(of_text) => {
            request.extend(members_of(of_text, &PREMISES_OF_TEXT));
            let text = std::str::from_utf8(files.program).map_err(|_| "the program is no text in UTF-8")?;
            request.insert("nc".to_owned(), json!(text));
        }
        None => {
            let toolpath = serde_json::from_slice(files.program).map_err(|error| error.to_string())?;
            request.insert("toolpath".to_owned(), toolpath);
        }
    }
    Ok(Value::Object(request))
}

/// The named members of an object.
fn members_of(body: &Map<String, Value>, names: &[&str]) -> Map<String, Value> {
    let sent = names.iter().filter_map(|name| Some(((*name).to_owned(), body.get(*name)?.clone())));
    sent.collect()
}

/// Adds where `stated` differs from `anew`, but for what is no statement on the program.
fn differences(at: &str, stated: &Value, anew: &Value, reasons: &mut Vec<String>) {
    if stated == anew || ["/digest", "/signature", "/engine_version"].contains(&at) {
        return;
    }
    if reasons.len() == MOST_NAMED {
        reasons.push("further differences are not named".to_owned());
    }
    if reasons.len() > MOST_NAMED {
        return;
    }
    match (stated, anew) {
        (Value::Object(one), Value::Object(other)) => {
            let mut names: Vec<&String> = one.keys().chain(other.keys()).collect();
            names.sort();
            names.dedup();
            for name in names {
                let of = |own: &Map<String, Value>| own.get(name).cloned().unwrap_or_default();
                differences(&format!("{at}/{name}"), &of(one), &of(other), reasons);
            }
        }
        (Value::Array(one), Value::Array(other)) if one.len() == other.len() => {
            for (k, (one, other)) in one.iter().zip(other).enumerate() {
                differences(&format!("{at}/{k}"), one, other, reasons);
            }
        }
        (Value::Number(one), Value::Number(other)) if one.as_f64() == other.as_f64() => {}
        _ => reasons.push(format!("{at}: the receipt states {stated}; proved is {anew}")),
    }
}

fn object(path: &Path) -> Result<Map<String, Value>, String> {
    let text = read(path)?;
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&text);
    match serde_json::from_slice(text) {
        Ok(Unrepeated(Value::Object(members))) => Ok(members),
        Ok(_) => Err(format!("{}: this is no object in JSON", path.display())),
        Err(error) => Err(format!("{}: this is no object in JSON: {error}", path.display())),
    }
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const POCKET: &str = include_str!("../../openapi/examples/programs-verify/pocket.json");
    const CLAMP: &str = include_str!("../../openapi/examples/programs-verify/clamp.json");

    fn map(text: &str) -> Map<String, Value> {
        serde_json::from_str(text).unwrap()
    }

    /// The receipt of a body, and its program.
    fn receipt(body: &str) -> (Map<String, Value>, Vec<u8>) {
        let receipt = receipt_of(body.as_bytes(), &Limits::DEFAULT, &Budget::unlimited()).unwrap();
        let sent = map(body);
        let program = match sent.get("nc").and_then(Value::as_str) {
            Some(text) => text.as_bytes().to_vec(),
            None => sent["toolpath"].to_string().into_bytes(),
        };
        (map(&serde_json::to_string(&receipt).unwrap()), program)
    }

    fn reasons(receipt: &Map<String, Value>, program: &[u8], body: &str) -> Vec<String> {
        let files = Files { program, part: &map(body) };
        judged(receipt, &files, None, &Limits::DEFAULT).err().unwrap_or_default()
    }

    /// The receipt with a digest that fits.
    fn forged(mut receipt: Map<String, Value>) -> Map<String, Value> {
        receipt.remove("digest");
        let digest = digest_of(&receipt).unwrap();
        receipt.insert("digest".to_owned(), json!(digest));
        receipt
    }

    /// The pointers to all texts, numbers and truth values.
    fn leaves(at: &str, value: &Value, found: &mut Vec<String>) {
        match value {
            Value::Object(members) => {
                members.iter().for_each(|(name, own)| leaves(&format!("{at}/{name}"), own, found));
            }
            Value::Array(elements) => {
                elements.iter().enumerate().for_each(|(k, own)| leaves(&format!("{at}/{k}"), own, found));
            }
            _ => found.push(at.to_owned()),
        }
    }

    #[test]
    fn no_statement_of_a_receipt_can_be_altered() {
        for body in [POCKET, CLAMP] {
            let (receipt, program) = receipt(body);
            assert_eq!(reasons(&receipt, &program, body), [""; 0]);
            let mut pointers = Vec::new();
            leaves("", &Value::Object(receipt.clone()), &mut pointers);
            assert!(pointers.len() > 30);
            for pointer in pointers {
                let mut value = Value::Object(receipt.clone());
                let leaf = value.pointer_mut(&pointer).unwrap();
                *leaf = match &*leaf {
                    Value::Number(number) => json!(number.as_f64().unwrap() * (1.0 + 1e-12) + 1e-12),
                    Value::Bool(own) => json!(!own),
                    _ => json!("linuxcnc"),
                };
                let Value::Object(altered) = value else { unreachable!() };
                let told = reasons(&altered, &program, body);
                let is_told = |reason: &String| reason.contains("altered") || reason.contains("no receipt");
                assert!(told.iter().any(is_told), "{pointer}: {told:?}");
                // On another premise the same may be proved.
                let is_premise = pointer.starts_with("/premises/");
                let is_free = ["/digest", "/engine_version"].contains(&pointer.as_str());
                let holds = reasons(&forged(altered), &program, body).is_empty();
                assert!(holds == is_free || is_premise, "{pointer}");
            }
        }
    }

    #[test]
    fn a_stale_receipt_tells_what_has_changed() {
        let (receipt, program) = receipt(POCKET);
        let text = String::from_utf8(program.clone()).unwrap();
        let deeper = text.replace("Z-3. F200.", "Z-3.1 F200.");
        let stale = |what: &str| [format!("the receipt is stale: {what} is not what was verified")];
        assert_eq!(reasons(&receipt, deeper.as_bytes(), POCKET), stale("program"));
        let changed = |name: &str, value: Value| {
            let mut body = map(POCKET);
            body.insert(name.to_owned(), value);
            Value::Object(body).to_string()
        };
        let tool = json!({ "shape": "flat", "diameter_mm": 8.001, "number": 3, "flute_length_mm": 20 });
        assert_eq!(reasons(&receipt, &program, &changed("tool", tool)), stale("tools"));
        assert_eq!(reasons(&receipt, &program, &changed("floor_z_mm", json!(-2.999))), stale("part"));
        let other = |name: &str, value: Value| {
            let told = reasons(&receipt, &program, &changed(name, value));
            assert!(told.iter().any(|reason| reason.contains(&format!("another {name}"))), "{told:?}");
        };
        other("tolerance_mm", json!(1));
        other("rapids", json!("straight"));
        other("dialect", json!("linuxcnc"));
        assert_eq!(reasons(&receipt, &program, &changed("tolerance_mm", json!(0.01))), [""; 0]);
        // The same number in another text is the same part; so is a member that is null.
        assert_eq!(
            reasons(&receipt, &program, &POCKET.replace("\"floor_z_mm\": -3,", "\"floor_z_mm\": -3.0,")),
            [""; 0]
        );
        assert_eq!(reasons(&receipt, &program, &changed("travel", Value::Null)), [""; 0]);
    }
}
