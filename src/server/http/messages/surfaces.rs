//! Data that give no surface. These faults show only when the whole surface is made; all other faults are
//! found when the request is checked.

use super::{member, violation};
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::surface::ferguson::{FergusonError, Grid};
use toolpathd_core::geometry::surface::joints::NotSmooth;
use toolpathd_core::geometry::surface::net_grid::NetGridError;
use toolpathd_core::geometry::surface::normal_sweep::NormalSweepError;
use toolpathd_core::geometry::surface::nurbs::NurbsError;
use toolpathd_core::geometry::surface::parallel_sweep::ParallelSweepError;
use toolpathd_core::geometry::surface::point_grid::{Edge, GridError};
use toolpathd_core::geometry::surface::ruled::RuledError;
use toolpathd_core::geometry::surface::source::SourceError;

impl From<SourceError> for ApiError {
    fn from(error: SourceError) -> Self {
        let fact = error.to_string();
        let (at, code) = match error {
            SourceError::PointGrid(error) => of_grid(error),
            SourceError::Ferguson(error) => of_ferguson(error),
            SourceError::NetGrid(error) => of_nets(error),
            SourceError::Nurbs(error) => of_nurbs(error),
            SourceError::ParallelSweep(error) => of_parallel_sweep(error),
            SourceError::NormalSweep(error) => return of_normal_sweep(error, fact),
            SourceError::Ruled(error) => return of_ruled(error, fact),
        };
        violation(&at, code, fact)
    }
}

impl From<NotSmooth> for ApiError {
    fn from(error: NotSmooth) -> Self {
        let fact = error.to_string();
        match error {
            NotSmooth::Stopped(stopped) => stopped.into(),
            NotSmooth::Edge { at, .. } => Self::new(Code::NotSmooth, fact).at(at.into()),
            NotSmooth::Gap { at, gap_mm: _, patches: [_, [i, j]] } => {
                let patch = surface().field("patches").index(i).index(j);
                Self::new(Code::NotSmooth, fact).at(at.into()).blaming(&patch, FieldCode::PatchesApart)
            }
        }
    }
}

fn surface() -> Pointer {
    member("/surface")
}

fn of_grid(error: GridError) -> (Pointer, FieldCode) {
    let points = surface().field("points");
    let at = |edge: Edge| {
        surface().field("end_tangents").field(match edge {
            Edge::U0 => "u0",
            Edge::U1 => "u1",
            Edge::V0 => "v0",
            Edge::V1 => "v1",
        })
    };
    match error {
        GridError::TooFewRows { .. } => (points, FieldCode::TooFewPoints),
        GridError::TooFewPoints { row, .. } => (points.index(row), FieldCode::TooFewPoints),
        GridError::Ragged { row, .. } => (points.index(row), FieldCode::RaggedGrid),
        GridError::NotFinite { i, j } => (points.index(i).index(j), FieldCode::TooLarge),
        GridError::NotClosed => (surface().field("ends"), FieldCode::Conflict),
        GridError::EndTangents { edge, .. } => (at(edge), FieldCode::WrongLength),
        GridError::EndTangentNotFinite { edge } => (at(edge), FieldCode::TooLarge),
    }
}

fn of_ferguson(error: FergusonError) -> (Pointer, FieldCode) {
    let at = |grid: Grid| {
        surface().field(match grid {
            Grid::Points => "points",
            Grid::TangentsU => "tangents_u",
            Grid::TangentsV => "tangents_v",
            Grid::Twists => "twists",
        })
    };
    match error {
        FergusonError::Rows { grid, .. } => (at(grid), FieldCode::WrongLength),
        FergusonError::Columns { grid, row, .. } => (at(grid).index(row), FieldCode::WrongLength),
        FergusonError::NotFinite { grid, row, column } => {
            (at(grid).index(row).index(column), FieldCode::TooLarge)
        }
    }
}

fn of_nets(error: NetGridError) -> (Pointer, FieldCode) {
    let patches = surface().field("patches");
    match error {
        NetGridError::Empty => (patches, FieldCode::TooFewPoints),
        NetGridError::Ragged { row, .. } => (patches.index(row), FieldCode::RaggedGrid),
        NetGridError::NotFinite { i, j } => (patches.index(i).index(j), FieldCode::TooLarge),
    }
}

fn of_nurbs(error: NurbsError) -> (Pointer, FieldCode) {
    let of = |names: [&str; 2], along: usize| surface().field(names[along]);
    let knots = |along: usize| of(["knots_u", "knots_v"], along);
    let points = surface().field("control_points");
    let weights = surface().field("weights");
    match error {
        NurbsError::Degree { along, .. } => (of(["degree_u", "degree_v"], along), FieldCode::OutOfRange),
        NurbsError::TooFewPoints { .. } => (points, FieldCode::TooFewPoints),
        NurbsError::Ragged { row, .. } => (points.index(row), FieldCode::RaggedGrid),
        NurbsError::PointNotFinite { i, j } => (points.index(i).index(j), FieldCode::TooLarge),
        NurbsError::KnotCount { along, .. } => (knots(along), FieldCode::WrongLength),
        NurbsError::EmptyDomain { along } => (knots(along), FieldCode::OutOfRange),
        NurbsError::KnotsDecrease { along, index }
        | NurbsError::SpanTooShort { along, index }
        | NurbsError::KnotWithoutEffect { along, index, .. }
        | NurbsError::KnotMultiplicity { along, index, .. } => {
            (knots(along).index(index), FieldCode::OutOfRange)
        }
        NurbsError::PointWithoutEffect { i, j } => (points.index(i).index(j), FieldCode::OutOfRange),
        NurbsError::TooManyPatches { .. } => (points, FieldCode::LimitExceeded),
        NurbsError::WeightRows { .. } => (weights, FieldCode::WrongLength),
        NurbsError::WeightColumns { row, .. } => (weights.index(row), FieldCode::WrongLength),
        NurbsError::Weight { i, j, .. } | NurbsError::WeightRatio { i, j, .. } => {
            (weights.index(i).index(j), FieldCode::OutOfRange)
        }
    }
}

fn of_parallel_sweep(error: ParallelSweepError) -> (Pointer, FieldCode) {
    match error {
        ParallelSweepError::Empty => (surface(), FieldCode::TooFewPoints),
        ParallelSweepError::TooManyPatches { .. } => (surface(), FieldCode::LimitExceeded),
    }
}

fn of_normal_sweep(error: NormalSweepError, fact: String) -> ApiError {
    let basic = surface().field("basic");
    ApiError::invalid(vec![match error {
        NormalSweepError::Empty => FieldError::new(&surface(), FieldCode::TooFewPoints, fact),
        NormalSweepError::TooManyPatches => FieldError::new(&surface(), FieldCode::LimitExceeded, fact),
        NormalSweepError::Corner { place, .. }
        | NormalSweepError::Reversal { place, .. }
        | NormalSweepError::Fold { place, .. }
        | NormalSweepError::Mitre { place, .. }
        | NormalSweepError::Cusp { place }
        | NormalSweepError::Upright { place } => {
            FieldError::in_text(&basic, place, FieldCode::OutOfRange, fact)
        }
    }])
}

fn of_ruled(error: RuledError, fact: String) -> ApiError {
    ApiError::invalid(vec![match error {
        RuledError::Empty => FieldError::new(&surface(), FieldCode::TooFewPoints, fact),
        RuledError::TooManyPatches => FieldError::new(&surface(), FieldCode::LimitExceeded, fact),
        RuledError::Cusp { curve, place } => {
            let name = if curve == 0 { "first" } else { "second" };
            FieldError::in_text(&surface().field(name), place, FieldCode::OutOfRange, fact)
        }
    }])
}
