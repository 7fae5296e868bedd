//! The body as the decoder needs it, while it is written.

use std::fmt::Write;

use serde_json::Value;

/// JSON that is written from its beginning to its end, or not at all.
pub struct Written(Option<String>);

impl Written {
    /// Keeps what is written.
    pub fn kept() -> Self {
        Self(Some(String::new()))
    }

    /// Forgets what is written.
    pub fn forgotten() -> Self {
        Self(None)
    }

    pub fn is_kept(&self) -> bool {
        self.0.is_some()
    }

    /// The text; empty where it was forgotten.
    pub fn text(self) -> String {
        self.0.unwrap_or_default()
    }

    pub fn push(&mut self, text: &str) {
        if let Some(written) = &mut self.0 {
            written.push_str(text);
        }
    }

    pub fn value(&mut self, value: &Value) {
        if let Some(written) = &mut self.0 {
            // Writing to a text does not fail.
            let _ = write!(written, "{value}");
        }
    }

    /// Writes the name of a member.
    pub fn name(&mut self, name: &str) {
        if self.0.is_some() {
            self.value(&name.into());
            self.push(":");
        }
    }

    /// Writes a comma unless nothing is written behind the mark `first`.
    pub fn separate(&mut self, first: usize) {
        if self.mark() > first {
            self.push(",");
        }
    }

    /// The length of the text, to come back to.
    pub fn mark(&self) -> usize {
        self.0.as_ref().map_or(0, String::len)
    }

    pub fn back_to(&mut self, mark: usize) {
        if let Some(written) = &mut self.0 {
            written.truncate(mark);
        }
    }
}
