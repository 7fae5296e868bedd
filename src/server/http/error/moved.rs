//! Failures with other places than those at which they were found.

use super::ApiError;

impl ApiError {
    /// The same error, with other pointers: `sent` gives for a pointer another one, and the name of the file
    /// from which the value at fault was read.
    pub fn moved<'a>(mut self, sent: impl Fn(&str) -> Option<(String, Option<&'a str>)>) -> Self {
        for error in &mut self.errors {
            let Some((pointer, file)) = sent(&error.pointer) else { continue };
            self.detail = self.detail.replace(&error.pointer, &pointer);
            error.pointer = pointer;
            if let Some(name) = file {
                error.detail = format!("`{name}`: {}", error.detail);
            }
        }
        self
    }
}
