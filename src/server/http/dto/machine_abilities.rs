//! What a machine can do, in requests for operations with an upright tool.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use crate::http::pointer::Pointer;

/// What the machine can do. Nothing is assumed of a member that is absent.
#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MachineAbilities {
    /// The fastest speed of the spindle, in 1/min. A faster `cutting.spindle_rpm` is refused. Default:
    /// without limit.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    max_rpm: Option<f64>,
}

impl MachineAbilities {
    /// The fastest speed of the spindle, 1/min, if one was sent. Adds violations to `violations`.
    pub fn max_rpm(self, at: &Pointer, violations: &mut Violations) -> Option<f64> {
        let Self { max_rpm } = self;
        violations.optional(&at.field("max_rpm"), max_rpm, Range::POSITIVE, "1/min");
        max_rpm
    }
}
