//! How a request came to the service.

/// The kind of connection over which a request came. The connection puts it into the extensions of the
/// request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// A connection within the limits.
    Regular,
    /// A connection beyond the limits. It is there for health checks and metrics only.
    BeyondLimit,
}
