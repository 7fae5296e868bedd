//! The digests and the signature of receipts.
//!
//! A digest is SHA-256 in hexadecimal digits. JSON is digested in its canonical form (RFC 8785), in which
//! members have one order and a number has one text, so that a receipt may be parsed and written again. A
//! member that is `null` counts as absent.
//!
//! A signature is Ed25519 (RFC 8032) of the text `toolpathd receipt 1`, a line feed, and the digest of the
//! receipt.

mod key;
mod unrepeated;

use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

pub use key::{PublicKey, SigningKey};
pub use unrepeated::Unrepeated;

/// The digest of bytes.
pub fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The digest of a value in canonical JSON.
///
/// # Errors
/// When the value cannot be written as JSON.
pub fn digest_of(value: &impl Serialize) -> Result<String, serde_json::Error> {
    digest_of_tree(serde_json::to_value(value)?)
}

/// As [`digest_of`], without a copy of the value.
///
/// # Errors
/// When the value cannot be written as JSON.
pub fn digest_of_tree(mut value: Value) -> Result<String, serde_json::Error> {
    leave_out_null(&mut value);
    Ok(digest(&serde_json_canonicalizer::to_vec(&value)?))
}

/// Leaves out the members that are `null`, at any depth.
pub fn leave_out_null(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|_, member| !member.is_null());
            members.values_mut().for_each(leave_out_null);
        }
        Value::Array(elements) => elements.iter_mut().for_each(leave_out_null),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_digest_depends_on_values_and_not_on_their_text() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(digest(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        let written: Value = serde_json::from_str(r#"{"b": [1.0, 1e-7, null], "a": null, "c": {}}"#).unwrap();
        assert_eq!(digest_of(&written).unwrap(), digest(br#"{"b":[1,1e-7,null],"c":{}}"#));
        assert_eq!(
            digest_of(&written).unwrap(),
            digest_of(&json!({ "c": {}, "b": [1, 1e-7, null] })).unwrap()
        );
        assert_ne!(
            digest_of(&written).unwrap(),
            digest_of(&json!({ "c": {}, "b": [1, 2e-7, null] })).unwrap()
        );
    }
}
