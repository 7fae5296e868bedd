//! What every answer of a computation holds.

use serde::Serialize;
use utoipa::ToSchema;

use super::meta::{self, Meta};
use super::toolpath::{Measures, Toolpath, Warning};

/// The answer of a computation, with the report of its operation.
#[derive(Serialize, ToSchema)]
pub struct Answer<R: ToSchema> {
    pub engine_version: &'static str,
    /// Equals the header `x-request-id`; the only member that differs between runs.
    pub request_id: String,
    /// As it was sent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(schema_with = meta::schema)]
    pub meta: Option<Meta>,
    pub warnings: Vec<Warning>,
    pub report: R,
    /// Of the toolpath; with every answer that is about one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measures: Option<Measures>,
    /// The program, where the answer is about its text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nc: Option<String>,
    /// Absent with `?toolpath=false`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toolpath: Option<Toolpath>,
}

impl<R: ToSchema> Answer<R> {
    /// A report without a toolpath.
    pub fn of_report(engine_version: &'static str, request_id: &str, report: R) -> Self {
        Self {
            engine_version,
            request_id: request_id.to_owned(),
            meta: None,
            warnings: Vec::new(),
            report,
            measures: None,
            nc: None,
            toolpath: None,
        }
    }
}
