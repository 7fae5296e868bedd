//! What a caller reads of the failures and the warnings of the core and of programs: the fact, and the advice
//! in terms of the request's members. Each file holds the sentences of one operation or subject.

mod arc_fitting;
mod computing;
mod cutting;
mod doubts;
mod files;
mod five_axis;
mod interpolation;
mod milling;
mod models;
mod pocketing;
mod points;
mod reading;
mod surfaces;
mod tools;
mod verification;
mod warning;
mod writing;

use nalgebra::Point2;

use super::error::{ApiError, Code, FieldCode, FieldError};
use super::pointer::Pointer;
pub use computing::too_slow;
pub use files::{left_out, no_grid};
pub use five_axis::{path_text, positions_of_control, words_left_alone, words_left_alone_in};
pub use points::point_fault;
pub use reading::not_read;
pub use tools::too_short;
pub use verification::tool_not_told;
pub use warning::{Warning, WarningCode};
pub use writing::{missing, refused, second_work_offset, smoothed_twice};

/// The member of the body at `path`, such as `/program/decimals`.
fn member(path: &str) -> Pointer {
    Pointer::root().join(path)
}

/// The failure of a request with one violation. Its detail begins with the pointer `at`.
fn violation(at: &Pointer, code: FieldCode, detail: String) -> ApiError {
    ApiError::invalid(vec![FieldError::new(at, code, detail)])
}

/// The failure of a job that is larger than the server allows. The member at `path` decides how large it is.
fn too_large(path: &str, detail: String) -> ApiError {
    ApiError::new(Code::LimitExceeded, detail).blaming(&member(path), FieldCode::LimitExceeded)
}

/// A place of the plane as a place on the part.
fn in_plane(at: Point2<f64>) -> [f64; 3] {
    [at.x, at.y, 0.0]
}
