//! How large the parts of a request and its work may be.

/// The largest size of each part of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of a request body.
    pub body_bytes: usize,
    /// Points of one surface.
    pub surface_points: usize,
    /// Points of one curve.
    pub curve_points: usize,
    /// Elements of one interpolated curve.
    pub elements: usize,
    /// Places at which one request drops a cutter.
    pub drop_points: usize,
    /// Section planes of one milling job.
    pub sections: usize,
    /// Moves of one toolpath, sent or computed.
    pub moves: usize,
    /// CL points of one milling job; a twenty-fifth where the cutter is lowered onto the surface.
    pub cl_points: usize,
    /// Points of all wires of one model.
    pub wire_points: usize,
    /// Samples of one motion.
    pub samples: usize,
    /// Steps of the interpolation of one curve.
    pub curve_steps: u64,
    /// Comparisons of the cutter with earlier cuts, of one pattern of a pocket.
    pub cut_comparisons: u64,
}

impl Limits {
    /// The limits in the contract. A service with other settings answers its own limits at `/v1/limits`.
    pub const DEFAULT: Limits = Limits {
        body_bytes: 16 * 1024 * 1024,
        surface_points: 250_000,
        curve_points: 250_000,
        elements: 250_000,
        drop_points: 250_000,
        sections: 20_000,
        moves: 500_000,
        cl_points: 10_000_000,
        wire_points: 250_000,
        samples: 300_000,
        curve_steps: 2_000_000_000,
        cut_comparisons: 400_000_000,
    };
}
