//! Loops of pieces in the plane of the parameters of a surface.

use super::piece::BoundPiece;

/// A closed loop of pieces, with how often it goes round along u and v.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    pub pieces: Vec<BoundPiece>,
    pub turns: [i32; 2],
}

impl Chain {
    /// All places, from sample to sample.
    pub fn polygon(&self) -> Vec<[f64; 2]> {
        let mut places: Vec<[f64; 2]> = self.pieces.iter().flat_map(BoundPiece::places).collect();
        places.dedup();
        places
    }

    /// The area within the polygon, in parameters; negative if it goes clockwise.
    pub fn polygon_area(&self) -> f64 {
        let places = self.polygon();
        let pairs = places.iter().zip(places.iter().cycle().skip(1));
        pairs.map(|(a, b)| (a[0] * b[1] - b[0] * a[1]) / 2.0).sum()
    }

    pub fn start(&self) -> [f64; 2] {
        self.pieces[0].start()
    }

    pub fn end(&self) -> [f64; 2] {
        self.pieces[self.pieces.len() - 1].end()
    }

    pub fn reverse(&mut self) {
        self.pieces.reverse();
        self.pieces.iter_mut().for_each(BoundPiece::reverse);
        self.turns = self.turns.map(|n| -n);
    }

    pub fn shift(&mut self, by: [f64; 2]) {
        self.pieces.iter_mut().for_each(|piece| piece.shift(by));
    }

    /// Appends straight lines through the places, from the end on.
    pub fn go(&mut self, places: &[[f64; 2]]) {
        for place in places {
            let end = self.end();
            if end != *place {
                self.pieces.push(BoundPiece::Straight([end, *place]));
            }
        }
    }

    /// The least and the largest value of a parameter.
    pub fn range(&self, along: usize) -> [f64; 2] {
        let values = self.pieces.iter().flat_map(BoundPiece::places).map(|place| place[along]);
        values.fold([f64::MAX, f64::MIN], |[low, high], value| [low.min(value), high.max(value)])
    }

    pub fn box_of(&self) -> [[f64; 2]; 2] {
        [self.range(0), self.range(1)]
    }
}
