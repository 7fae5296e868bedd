//! Light and shade on a surface, as veils of black and white over the colours of heights.

use nalgebra::Vector3;

use super::{Corner, split};

/// Towards the light: from the upper left of the plan, halfway up. Of unit length.
const LIGHT: [f64; 3] = [-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2];

/// A veil, over all places darker or lighter than a limit.
#[derive(Debug, Clone, Copy)]
pub struct Tone {
    pub name: &'static str,
    limit: f64,
    fill: &'static str,
}

/// Shades lie over each other.
pub const TONES: [Tone; 5] = [
    Tone { name: "shade", limit: -0.1, fill: "#1d3030" },
    Tone { name: "shade", limit: -0.25, fill: "#1d3030" },
    Tone { name: "shade", limit: -0.45, fill: "#1d3030" },
    Tone { name: "shade", limit: -0.7, fill: "#1d3030" },
    Tone { name: "lit", limit: 0.12, fill: "#fff" },
];

impl Tone {
    /// The part of a convex piece under the veil.
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

/// How much more light falls on a place with this normal than on a level one; 0 without a normal.
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
