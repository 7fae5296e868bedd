//! JSON pointers into the caller's body, written as URI fragments (RFC 6901, section 6).

use std::fmt::{self, Write};

/// A pointer such as `#/surface/points/2/3/1`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pointer(String);

impl Pointer {
    /// The whole body.
    pub fn root() -> Self {
        Self("#".into())
    }

    /// The pointer to the member `name` of the object at this pointer.
    pub fn field(&self, name: &str) -> Self {
        let mut text = self.0.clone();
        text.push('/');
        for byte in name.bytes() {
            match byte {
                b'~' => text.push_str("~0"),
                b'/' => text.push_str("~1"),
                // RFC 3986 allows these characters in a fragment.
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' => text.push(char::from(byte)),
                _ if b"-._!$&'()*+,;=:@?".contains(&byte) => text.push(char::from(byte)),
                _ => {
                    let _ = write!(text, "%{byte:02X}");
                }
            }
        }
        Self(text)
    }

    /// The pointer to the element `index` of the array at this pointer.
    pub fn index(&self, index: usize) -> Self {
        Self(format!("{}/{index}", self.0))
    }

    /// The pointer `below`, which starts at the value of this pointer, as a pointer from the root of the
    /// body.
    pub fn join(&self, below: &str) -> Self {
        Self(format!("{}{}", self.0, below.trim_start_matches('#')))
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Pointer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_escaped_for_json_pointers_and_for_uri_fragments() {
        let at = Pointer::root().field("a/b~c").index(3).field("d e\u{e9}\"");
        assert_eq!(at.as_str(), "#/a~1b~0c/3/d%20e%C3%A9%22");
        assert_eq!(Pointer::root().field("a").join("#/b/0").as_str(), "#/a/b/0");
    }
}
