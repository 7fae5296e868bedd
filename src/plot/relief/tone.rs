//! Light and shade on a surface, as translucent white and black areas over the colours of the bands.

use nalgebra::Vector3;

use super::{Corner, split};

/// Unit vector towards the light: from the upper left of the plan, 45 degrees up.
const LIGHT: [f64; 3] = [-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2];

/// A veil over all places with less light than `limit` (shade), or with more (lit).
#[derive(Debug, Clone, Copy)]
pub struct Tone {
    pub name: &'static str,
    limit: f64,
    fill: &'static str,
}

/// The tones. The shades lie on top of each other, so a darker place has more of them.
pub const TONES: [Tone; 5] = [
    Tone { name: "shade", limit: -0.1, fill: "#1d3030" },
    Tone { name: "shade", limit: -0.25, fill: "#1d3030" },
    Tone { name: "shade", limit: -0.45, fill: "#1d3030" },
    Tone { name: "shade", limit: -0.7, fill: "#1d3030" },
    Tone { name: "lit", limit: 0.12, fill: "#fff" },
];

impl Tone {
    /// The part of a convex piece under this veil.
    pub fn part_of(&self, piece: &[Corner]) -> Vec<Corner> {
        let is_shade = self.limit < 0.0;
        let is_in = |corner: &Corner| (corner.light < self.limit) == is_shade;
        if piece.iter().all(is_in) {
            return piece.to_vec();
        }
        if !piece.iter().any(is_in) {
            return Vec::new();
        }
        let [below, above] = split(piece, self.limit, |corner| corner.light);
        if is_shade { below } else { above }
    }
}

/// The light on a place with this unit normal, minus the light on a level place; 0 without a normal.
pub fn light(normal: &Vector3<f64>) -> f64 {
    if *normal == Vector3::zeros() { 0.0 } else { normal.dot(&Vector3::from(LIGHT)) - LIGHT[2] }
}

pub fn style() -> String {
    let [shade, .., lit] = TONES;
    [(shade, ".055"), (lit, ".28")]
        .map(|(tone, opacity)| {
            format!(".plot .{}{{fill:{};fill-opacity:{opacity};stroke:none}}", tone.name, tone.fill)
        })
        .concat()
}
