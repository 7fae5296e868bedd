//! The items along a section curve, and the lines, arcs and cubics made of them.

use nalgebra::{Point, SVector};

use super::corner::{self, Rounding};
use super::grammar::{Kind, Row, Written};
use super::{Fault, NEAREST_MM, SectionCurveError};
use crate::geometry::plane_curve::piecewise::{Bezier, Piecewise, PiecewiseError};
use crate::geometry::profile::{Piece, Profile, Shape};
use crate::geometry::spline::{EndCondition, derivatives};

/// Tangent lengths may exceed the length of a line by this part of it. A remainder of a line shorter than
/// this part is left out. Both are the rounding of arcs that meet.
const FIT: f64 = 1e-14;

/// An item in D dimensions, mm.
#[derive(Debug, Clone, PartialEq)]
pub enum Item<const D: usize> {
    /// `l`, and `r` with the radius 0.
    Point(Point<f64, D>),
    /// `r`: the radius is above zero.
    Corner { point: Point<f64, D>, radius_mm: f64 },
    /// `b`: two points or more.
    Smooth(Vec<Point<f64, D>>),
}

/// A line, an arc or a cubic of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainPiece<const D: usize> {
    pub shape: Shape<D>,
    /// The item that the piece belongs to, or leads to.
    pub item: usize,
    /// The parameters at the ends of the piece. Along lines and arcs, the parameter of the curve grows by
    /// their length. Along a `b`, it grows by the sum of the chords between the points of the `b`, and each
    /// chord gets an equal part of this sum.
    pub ends: [f64; 2],
}

/// A section curve in D dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain<const D: usize> {
    items: Vec<Item<D>>,
    /// The place of each item in the text.
    places: Vec<usize>,
    pieces: Vec<ChainPiece<D>>,
}

impl<const D: usize> Chain<D> {
    /// The items in order, at least one.
    pub fn items(&self) -> &[Item<D>] {
        &self.items
    }

    /// The place of each item: the number of bytes before it in the text.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// The pieces from the start to the end of the curve, without gaps. Parameters start at 0.
    pub fn pieces(&self) -> &[ChainPiece<D>] {
        &self.pieces
    }

    /// The curve as a profile, from which surfaces are swept. The place of a piece is the byte where its item
    /// starts.
    pub fn profile(&self) -> Profile<D> {
        let place = |piece: &ChainPiece<D>| self.places.get(piece.item).copied().unwrap_or_default();
        Profile::new(self.pieces.iter().map(|s| Piece { shape: s.shape, place: place(s) }))
    }

    pub(super) fn new(written: &[Written]) -> Result<Self, SectionCurveError> {
        for end in written.first().into_iter().chain(written.last()) {
            if end.kind == Kind::Corner {
                return Err(fault(end.at, Fault::CornerAtEnd));
            }
        }
        let items = written.iter().map(item).collect::<Result<Vec<Item<D>>, _>>()?;
        let places: Vec<usize> = written.iter().map(|item| item.at).collect();
        if let [Item::Point(_)] = items[..] {
            return Err(fault(places[0], Fault::OnePoint));
        }
        for (k, pair) in items.windows(2).enumerate() {
            if coincide(pair[0].exit(), pair[1].entry()) {
                return Err(fault(places[k + 1], Fault::Coincident));
            }
        }
        let roundings = roundings(&items, &places)?;
        let pieces = pieces(&items, &roundings);
        let flat = pieces.iter().find(|s| s.ends[1] <= s.ends[0]);
        if let Some(piece) = flat {
            // The curve is so long that its parameter cannot distinguish these points.
            return Err(fault(places[piece.item], Fault::Coincident));
        }
        Ok(Self { items, places, pieces })
    }
}

impl Chain<2> {
    /// The curve, with a Bezier curve for each piece.
    ///
    /// # Errors
    /// When the parameters do not rise, or a coordinate is too large: only on curves of absurd length.
    pub fn curve(&self) -> Result<Piecewise, SectionCurveError> {
        let place = |k: usize| self.pieces.get(k).map_or(0, |piece| self.places[piece.item]);
        let mut pieces = Vec::with_capacity(self.pieces.len());
        for (k, piece) in self.pieces.iter().enumerate() {
            let bezier = match &piece.shape {
                Shape::Line(points) => Bezier::polynomial(points),
                Shape::Arc { points, weight } => Bezier::rational(points, &[1.0, *weight, 1.0]),
                Shape::Cubic(points) => Bezier::polynomial(points),
            };
            pieces.push((bezier.map_err(|error| fault(place(k), Fault::Piece(error)))?, piece.ends[1]));
        }
        Piecewise::new(0.0, pieces).map_err(|error| {
            let piece = match error {
                PiecewiseError::Parameter { index } => index.saturating_sub(1),
                PiecewiseError::Gap { index, gap_mm: _ } => index,
                PiecewiseError::Empty | PiecewiseError::TooManyPieces => 0,
            };
            fault(place(piece), Fault::Chain(error))
        })
    }
}

impl<const D: usize> Item<D> {
    /// The point to which the line before the item leads.
    pub fn entry(&self) -> &Point<f64, D> {
        match self {
            Self::Point(point) | Self::Corner { point, radius_mm: _ } => point,
            Self::Smooth(points) => &points[0],
        }
    }

    /// The point from which the line after the item starts.
    pub fn exit(&self) -> &Point<f64, D> {
        match self {
            Self::Point(point) | Self::Corner { point, radius_mm: _ } => point,
            Self::Smooth(points) => &points[points.len() - 1],
        }
    }
}

fn item<const D: usize>(written: &Written) -> Result<Item<D>, SectionCurveError> {
    match (written.kind, &written.rows[..]) {
        (Kind::Corner, [row]) => {
            let point = point(row, 1)?;
            let radius_mm = row.numbers[D];
            if radius_mm < 0.0 {
                return Err(fault(written.at, Fault::NegativeRadius { radius_mm }));
            }
            Ok(if radius_mm > 0.0 { Item::Corner { point, radius_mm } } else { Item::Point(point) })
        }
        (Kind::Smooth, rows) => {
            let points = rows.iter().map(|row| point(row, 0)).collect::<Result<Vec<_>, _>>()?;
            if points.len() < 2 {
                return Err(fault(written.at, Fault::OneSmoothPoint));
            }
            for (k, pair) in points.windows(2).enumerate() {
                if coincide(&pair[0], &pair[1]) {
                    return Err(fault(rows[k + 1].at, Fault::Coincident));
                }
            }
            Ok(Item::Smooth(points))
        }
        (_, rows) => match rows.first() {
            Some(row) => Ok(Item::Point(point(row, 0)?)),
            None => Err(fault(written.at, Fault::NumberCount { found: 0 })),
        },
    }
}

/// The point of a row that has `further` numbers after the coordinates.
fn point<const D: usize>(row: &Row, further: usize) -> Result<Point<f64, D>, SectionCurveError> {
    match row.count.checked_sub(further) {
        Some(found) if found == D => Ok(Point::from(SVector::from_fn(|c, _| row.numbers[c]))),
        Some(found @ (2 | 3)) => Err(fault(row.at, Fault::Dimension { expected: D, found })),
        _ => Err(fault(row.at, Fault::NumberCount { found: row.count })),
    }
}

/// The rounding of each item that is a corner with a turn; `None` for other items. An error if one does not
/// fit between its neighbours.
fn roundings<const D: usize>(
    items: &[Item<D>],
    places: &[usize],
) -> Result<Vec<Option<Rounding<D>>>, SectionCurveError> {
    let mut roundings: Vec<Option<Rounding<D>>> = Vec::with_capacity(items.len());
    for (k, item) in items.iter().enumerate() {
        roundings.push(match item {
            Item::Corner { point, radius_mm } if k > 0 && k + 1 < items.len() => {
                let corner = [*items[k - 1].exit(), *point, *items[k + 1].entry()];
                corner::rounding(corner, *radius_mm).map_err(|error| fault(places[k], error))?
            }
            _ => None,
        });
    }
    let tangent = |k: usize| roundings[k].as_ref().map_or(0.0, |rounding| rounding.tangent);
    for k in 1..items.len() {
        let (length_mm, taken_mm) = (leg(items, k), tangent(k - 1) + tangent(k));
        if taken_mm > length_mm * (1.0 + FIT) {
            // Blame the earlier corner if it does not fit alone or is the only one; otherwise the later one.
            let blamed = if tangent(k) == 0.0 || tangent(k - 1) > length_mm { k - 1 } else { k };
            let radius_mm = match &items[blamed] {
                Item::Corner { radius_mm, .. } => *radius_mm,
                _ => 0.0,
            };
            return Err(fault(places[blamed], Fault::CornerDoesNotFit { radius_mm, taken_mm, length_mm }));
        }
    }
    Ok(roundings)
}

/// The length of the straight line from the item before `k` to item `k`, without roundings; mm.
fn leg<const D: usize>(items: &[Item<D>], k: usize) -> f64 {
    (items[k].entry() - items[k - 1].exit()).norm()
}

fn pieces<const D: usize>(items: &[Item<D>], roundings: &[Option<Rounding<D>>]) -> Vec<ChainPiece<D>> {
    let mut pen = Pen { pieces: Vec::new(), at: *items[0].entry(), parameter: 0.0 };
    let tangent = |k: usize| roundings[k].as_ref().map_or(0.0, |rounding| rounding.tangent);
    for (k, item) in items.iter().enumerate() {
        if k > 0 {
            let length = leg(items, k);
            let left = length - tangent(k - 1) - tangent(k);
            let to = match &roundings[k] {
                Some(rounding) => rounding.arcs[0].0[0],
                None => *item.entry(),
            };
            if left > FIT * length {
                pen.draw(Shape::Line([pen.at, to]), k, left);
            } else if roundings[k].is_none() {
                pen.land(to);
            }
        }
        for (points, weight) in roundings[k].iter().flat_map(|rounding| &rounding.arcs) {
            let length = roundings[k].as_ref().map_or(0.0, |rounding| rounding.length);
            pen.draw(Shape::Arc { points: [pen.at, points[1], points[2]], weight: *weight }, k, length);
        }
        if let Item::Smooth(points) = item {
            let values: Vec<SVector<f64, D>> = points.iter().map(|p| p.coords).collect();
            let slopes = derivatives(&values, EndCondition::Natural);
            let length: f64 = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
            let span = length / (points.len() - 1) as f64;
            for (i, pair) in points.windows(2).enumerate() {
                let (from, to) = (pair[0], pair[1]);
                let cubic = [from, from + slopes[i] / 3.0, to - slopes[i + 1] / 3.0, to];
                pen.draw(Shape::Cubic(cubic), k, span);
            }
        }
    }
    pen.pieces
}

/// Draws pieces one after the other.
struct Pen<const D: usize> {
    pieces: Vec<ChainPiece<D>>,
    at: Point<f64, D>,
    parameter: f64,
}

impl<const D: usize> Pen<D> {
    /// Appends a piece that starts at the place of the pen.
    fn draw(&mut self, shape: Shape<D>, item: usize, length: f64) {
        let end = self.parameter + length;
        self.pieces.push(ChainPiece { shape, item, ends: [self.parameter, end] });
        self.at = shape.end();
        self.parameter = end;
    }

    /// Moves the end of the last piece to `to`, which differs from it by rounding only.
    fn land(&mut self, to: Point<f64, D>) {
        self.at = to;
        if let Some(piece) = self.pieces.last_mut() {
            match &mut piece.shape {
                Shape::Line([.., end]) | Shape::Arc { points: [.., end], .. } | Shape::Cubic([.., end]) => {
                    *end = to;
                }
            }
        }
    }
}

fn coincide<const D: usize>(a: &Point<f64, D>, b: &Point<f64, D>) -> bool {
    (a - b).norm() <= NEAREST_MM
}

fn fault(at: usize, fault: Fault) -> SectionCurveError {
    SectionCurveError { at, fault }
}
