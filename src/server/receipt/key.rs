//! Keys of receipts, from files as OpenSSL writes them.

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use ed25519_dalek::pkcs8::{DecodePrivateKey, DecodePublicKey};
use ed25519_dalek::{Signature, Signer, VerifyingKey};

/// What a signature is of, before the digest: a key that signs other texts too signs no receipt by that.
const LABEL: &str = "toolpathd receipt 1\n";

/// A key that signs receipts.
#[derive(Clone)]
pub struct SigningKey(Arc<ed25519_dalek::SigningKey>);

/// A key that shows who has signed.
#[derive(Clone, PartialEq, Eq)]
pub struct PublicKey(VerifyingKey);

impl SigningKey {
    /// The signature of a digest, in base64.
    pub fn sign(&self, digest: &str) -> String {
        BASE64_STANDARD.encode(self.0.sign(text(digest).as_bytes()).to_bytes())
    }

    pub fn public(&self) -> PublicKey {
        PublicKey(self.0.verifying_key())
    }
}

/// Reads a private key: the path of a PEM file (PKCS #8), as `openssl genpkey -algorithm ed25519` writes it.
impl FromStr for SigningKey {
    type Err = String;

    fn from_str(path: &str) -> Result<Self, String> {
        let text = pem(path)?;
        let key = ed25519_dalek::SigningKey::from_pkcs8_pem(&text).map_err(|error| {
            format!("{path} holds no private key of Ed25519 in PEM: {error}; make one by `openssl genpkey -algorithm ed25519`")
        })?;
        Ok(Self(Arc::new(key)))
    }
}

impl PublicKey {
    /// The key of 32 bytes in base64; `None` for any other text.
    pub fn of_base64(text: &str) -> Option<Self> {
        let bytes: [u8; 32] = BASE64_STANDARD.decode(text).ok()?.try_into().ok()?;
        VerifyingKey::from_bytes(&bytes).ok().map(Self)
    }

    /// Whether `signature`, in base64, is a signature of the digest by this key.
    pub fn has_signed(&self, digest: &str, signature: &str) -> bool {
        let bytes = BASE64_STANDARD.decode(signature).ok();
        let signature = bytes.and_then(|bytes| Signature::from_slice(&bytes).ok());
        signature.is_some_and(|own| self.0.verify_strict(text(digest).as_bytes(), &own).is_ok())
    }
}

/// Reads a public key: the path of a PEM file, as `openssl pkey -pubout` writes it.
impl FromStr for PublicKey {
    type Err = String;

    fn from_str(path: &str) -> Result<Self, String> {
        let key = VerifyingKey::from_public_key_pem(&pem(path)?);
        key.map(Self).map_err(|error| format!("{path} holds no public key of Ed25519 in PEM: {error}"))
    }
}

/// The key of 32 bytes in base64.
impl fmt::Display for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&BASE64_STANDARD.encode(self.0.as_bytes()))
    }
}

impl fmt::Debug for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PublicKey({self})")
    }
}

/// Tells the public key alone.
impl fmt::Debug for SigningKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SigningKey({})", self.public())
    }
}

fn text(digest: &str) -> String {
    format!("{LABEL}{digest}")
}

fn pem(path: &str) -> Result<String, String> {
    std::fs::read_to_string(Path::new(path)).map_err(|error| format!("{path}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signature_holds_for_one_digest_and_one_key() {
        let key = |byte| SigningKey(Arc::new(ed25519_dalek::SigningKey::from_bytes(&[byte; 32])));
        let (own, other) = (key(1), key(2));
        let signature = own.sign("ab12");
        assert!(own.public().has_signed("ab12", &signature));
        assert!(!own.public().has_signed("ab13", &signature));
        assert!(!other.public().has_signed("ab12", &signature));
        assert!(!own.public().has_signed("ab12", "AAAA"));
        assert_eq!(PublicKey::of_base64(&own.public().to_string()), Some(own.public()));
        assert_eq!(PublicKey::of_base64("AAAA"), None);
        assert!(!format!("{own:?}").contains(&BASE64_STANDARD.encode([1; 32])));
    }
}
