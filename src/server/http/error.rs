//! Errors as the caller sees them: problem documents (RFC 9457). Only this module turns failures into status
//! codes.

mod field;
mod moved;
mod sent_part;

use std::fmt;
use std::num::NonZero;
use std::time::Duration;

use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use super::pointer::Pointer;
pub use field::{FieldCode, FieldError};
pub use sent_part::SentPart;
use toolpathd_core::wire::Place;

pub const PROBLEM_JSON: &str = "application/problem+json";

/// Most entries of `errors` in one answer. `detail` tells the number of all violations.
pub const MAX_ERRORS: usize = 100;

/// Most characters of a detail. A detail may quote a text of the caller, which may have any length.
pub const MAX_DETAIL_CHARACTERS: usize = 500;

/// Most seconds after which a refused caller is told to try again.
const LONGEST_RETRY_S: f64 = 60.0;

/// What went wrong. The list of codes is closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ProblemCode)]
pub enum Code {
    BadRequest,
    InvalidQuery,
    /// A page of another origin must not send programs to controls.
    OriginRefused,
    /// The service is not known under the host name of the request.
    HostRefused,
    MalformedJson,
    NotFound,
    MethodNotAllowed,
    NotAcceptable,
    RequestTimeout,
    PayloadTooLarge,
    UriTooLong,
    UnsupportedMediaType,
    UnsupportedCoding,
    HeadersTooLarge,
    InvalidRequest,
    Unsupported,
    LimitExceeded,
    Overhang,
    OffsetFolds,
    NotSmooth,
    HeightBelowTop,
    FeedRequired,
    ToleranceBelowDecimals,
    ToleranceNotReached,
    /// Passes along parallel planes leave more than the scallop height asked for.
    ScallopNotReached,
    SectionLost,
    NothingToCut,
    ToolTooLarge,
    NoEntry,
    /// The machine cannot tilt the tool to an axis.
    AxisUnreachable,
    /// An axis of the machine would leave its travel.
    OutOfTravel,
    /// The tool axis rests on the pole of the machine while it turns.
    AxisOnPole,
    NoValidPattern,
    /// No block of the text moves the machine, so the text is not an NC program.
    NoMotion,
    BandInfeasible,
    /// The line to the control cannot carry the program.
    NotSendable,
    TargetBusy,
    TargetUnreachable,
    /// The program was not sent to its end. `sent` tells how far it was.
    SendingStopped,
    InternalError,
    Overloaded,
    DeadlinePassed,
}

impl Code {
    pub fn status(self) -> StatusCode {
        match self {
            Code::BadRequest | Code::InvalidQuery | Code::MalformedJson => StatusCode::BAD_REQUEST,
            Code::OriginRefused => StatusCode::FORBIDDEN,
            Code::HostRefused => StatusCode::MISDIRECTED_REQUEST,
            Code::NotFound => StatusCode::NOT_FOUND,
            Code::MethodNotAllowed => StatusCode::METHOD_NOT_ALLOWED,
            Code::NotAcceptable => StatusCode::NOT_ACCEPTABLE,
            Code::RequestTimeout => StatusCode::REQUEST_TIMEOUT,
            Code::PayloadTooLarge => StatusCode::PAYLOAD_TOO_LARGE,
            Code::UriTooLong => StatusCode::URI_TOO_LONG,
            Code::UnsupportedMediaType | Code::UnsupportedCoding => StatusCode::UNSUPPORTED_MEDIA_TYPE,
            Code::HeadersTooLarge => StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
            Code::InvalidRequest
            | Code::Unsupported
            | Code::LimitExceeded
            | Code::Overhang
            | Code::OffsetFolds
            | Code::NotSmooth
            | Code::HeightBelowTop
            | Code::FeedRequired
            | Code::ToleranceBelowDecimals
            | Code::ToleranceNotReached
            | Code::ScallopNotReached
            | Code::SectionLost
            | Code::NothingToCut
            | Code::ToolTooLarge
            | Code::NoEntry
            | Code::AxisUnreachable
            | Code::OutOfTravel
            | Code::AxisOnPole
            | Code::NoValidPattern
            | Code::NoMotion
            | Code::BandInfeasible
            | Code::NotSendable => StatusCode::UNPROCESSABLE_ENTITY,
            Code::TargetBusy => StatusCode::CONFLICT,
            Code::TargetUnreachable | Code::SendingStopped => StatusCode::BAD_GATEWAY,
            Code::InternalError => StatusCode::INTERNAL_SERVER_ERROR,
            Code::Overloaded => StatusCode::SERVICE_UNAVAILABLE,
            Code::DeadlinePassed => StatusCode::GATEWAY_TIMEOUT,
        }
    }

    fn title(self) -> &'static str {
        match self {
            Code::BadRequest => "The request is not understood",
            Code::InvalidQuery => "A query parameter is not legal",
            Code::OriginRefused => "Pages of this origin may not do this",
            Code::HostRefused => "The service is not known under this host name",
            Code::MalformedJson => "The body is not JSON",
            Code::NotFound => "There is nothing at this path",
            Code::MethodNotAllowed => "The path does not have this method",
            Code::NotAcceptable => "None of the accepted media types is on offer",
            Code::RequestTimeout => "The body stopped arriving",
            Code::PayloadTooLarge => "The body is too large",
            Code::UriTooLong => "The path and query are too long",
            Code::UnsupportedMediaType => "The body's media type is not read here",
            Code::UnsupportedCoding => "The body's content coding is not read here",
            Code::HeadersTooLarge => "The headers are too large, or too many",
            Code::InvalidRequest => "The body is not a legal request",
            Code::Unsupported => "This version cannot do what is asked",
            Code::LimitExceeded => "The job is larger than this server allows",
            Code::Overhang => "The surface does not face up everywhere",
            Code::OffsetFolds => "The surface is curved more tightly than the cutter",
            Code::NotSmooth => "The surface has an edge or a gap",
            Code::HeightBelowTop => "A height is below the top of the part",
            Code::FeedRequired => "A program needs feeds",
            Code::ToleranceBelowDecimals => "The tolerance is finer than the written decimals",
            Code::ToleranceNotReached => "The tolerance was not reached",
            Code::ScallopNotReached => "The scallop height was not reached",
            Code::SectionLost => "A section of the surface could not be followed",
            Code::NothingToCut => "There is nothing to cut",
            Code::ToolTooLarge => "The tool fits nowhere",
            Code::NoEntry => "The cutter cannot come down into the material",
            Code::AxisUnreachable => "The machine cannot tilt the tool as far as the path does",
            Code::OutOfTravel => "An axis of the machine reaches the end of its travel",
            Code::AxisOnPole => "The tool axis meets the pole of the machine",
            Code::NoValidPattern => "No pattern clears the pocket",
            Code::NoMotion => "The program moves nothing",
            Code::BandInfeasible => "The band leaves no room for an element",
            Code::NotSendable => "The line to the control cannot carry the program",
            Code::TargetBusy => "A program is being sent to the control",
            Code::TargetUnreachable => "The line to the control cannot be opened",
            Code::SendingStopped => "The program was not sent to its end",
            Code::InternalError => "The server failed",
            Code::Overloaded => "The server is full",
            Code::DeadlinePassed => "The computation took too long",
        }
    }

    /// The code for a bare status from the framework.
    fn of_status(status: StatusCode) -> Code {
        match status {
            StatusCode::NOT_FOUND => Code::NotFound,
            StatusCode::METHOD_NOT_ALLOWED => Code::MethodNotAllowed,
            StatusCode::NOT_ACCEPTABLE => Code::NotAcceptable,
            StatusCode::REQUEST_TIMEOUT => Code::RequestTimeout,
            StatusCode::PAYLOAD_TOO_LARGE => Code::PayloadTooLarge,
            StatusCode::URI_TOO_LONG => Code::UriTooLong,
            StatusCode::UNSUPPORTED_MEDIA_TYPE => Code::UnsupportedMediaType,
            StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE => Code::HeadersTooLarge,
            StatusCode::UNPROCESSABLE_ENTITY => Code::InvalidRequest,
            StatusCode::SERVICE_UNAVAILABLE => Code::Overloaded,
            StatusCode::GATEWAY_TIMEOUT => Code::DeadlinePassed,
            status if status.is_client_error() => Code::BadRequest,
            _ => Code::InternalError,
        }
    }
}

/// Writes the code as a problem holds it, such as `invalid_request`.
impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// A failure, by RFC 9457: the body of every answer with a status of 400 and above.
#[derive(Debug, Serialize, ToSchema)]
pub struct Problem {
    /// Always `about:blank`. `code` tells problems apart.
    #[serde(rename = "type")]
    kind: &'static str,
    /// The kind of problem, for people. The title depends on `code` alone.
    title: &'static str,
    /// Status of the answer: an HTTP status number.
    #[schema(minimum = 400, maximum = 599)]
    status: u16,
    /// This problem, for people: what is wrong, where, and what to do.
    detail: String,
    /// The kind of problem, for software. With `invalid_request`, the list `errors` has one entry for each
    /// violation. With `unsupported` the request is legal, but this version cannot do what is asked.
    code: Code,
    /// Id of the request, as in the header `x-request-id`.
    request_id: String,
    /// The violations, at most 100; `detail` states the number of all violations. An empty list where no
    /// place of the body is to blame.
    errors: Vec<FieldError>,
    /// The place on the part, in mm. Present with `overhang`, `offset_folds`, `section_lost`,
    /// `band_infeasible`, `tolerance_not_reached`, `scallop_not_reached`, `tool_too_large` and `no_entry`,
    /// with `invalid_request` where outlines cross, and with `not_smooth` unless `boundary: past` is to
    /// blame.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Place>)]
    place: Option<[f64; 3]>,
    /// The media types that the endpoint can answer. Present with `not_acceptable`.
    #[serde(skip_serializing_if = "Option::is_none")]
    offers: Option<Vec<&'static str>>,
    /// What was sent of the program. Present with `sending_stopped`.
    #[serde(skip_serializing_if = "Option::is_none")]
    sent: Option<Box<SentPart>>,
}

/// A failure on its way to the caller. It becomes a [`Problem`] where the request's id is known.
#[derive(Debug, Clone, PartialEq)]
pub struct ApiError {
    code: Code,
    /// The status of the answer: that of `code`, or the framework's own status.
    status: StatusCode,
    detail: String,
    errors: Vec<FieldError>,
    place: Option<[f64; 3]>,
    offers: Option<Vec<&'static str>>,
    sent: Option<Box<SentPart>>,
    /// Seconds after which the caller should try again, where they are known.
    retry_after_s: Option<NonZero<u16>>,
}

impl ApiError {
    pub fn new(code: Code, detail: impl Into<String>) -> Self {
        let detail = shortened(detail.into());
        Self {
            code,
            status: code.status(),
            detail,
            errors: Vec::new(),
            place: None,
            offers: None,
            sent: None,
            retry_after_s: None,
        }
    }

    /// The error of a body that violates rules. The code is `unsupported` or `feed_required` when all
    /// violations have that code, else `invalid_request`.
    pub fn invalid(errors: Vec<FieldError>) -> Self {
        Self::invalid_among(errors.len(), errors)
    }

    /// As [`Self::invalid`], for `errors` that are the first of `total` violations.
    pub fn invalid_among(total: usize, errors: Vec<FieldError>) -> Self {
        let are_all = |code| errors.iter().all(|error| error.code == code);
        let code = match () {
            () if are_all(FieldCode::Unsupported) => Code::Unsupported,
            () if are_all(FieldCode::FeedRequired) => Code::FeedRequired,
            () => Code::InvalidRequest,
        };
        let detail = match errors.as_slice() {
            [only] => format!("{}: {}", only.pointer, only.detail),
            several => format!("{total} violations; the first at {}", first_pointer(several)),
        };
        Self { errors, ..Self::new(code, detail) }
    }

    /// The error for a bare `status` from the framework. The title of the code serves as the detail.
    pub fn from_status(status: StatusCode) -> Self {
        let code = Code::of_status(status);
        Self { status, ..Self::new(code, code.title()) }
    }

    /// The same error with another detail.
    pub fn saying(self, detail: String) -> Self {
        Self { detail: shortened(detail), ..self }
    }

    /// The same error, with a violation at `at` that has the error's own detail.
    pub fn blaming(mut self, at: &Pointer, code: FieldCode) -> Self {
        self.errors.push(FieldError::new(at, code, self.detail.clone()));
        self
    }

    /// The same error, with its place on the part, in mm.
    pub fn at(mut self, place: [f64; 3]) -> Self {
        self.place = Some(place);
        self
    }

    /// The same error, with the media types that the endpoint can answer.
    pub fn offering(mut self, offers: impl IntoIterator<Item = &'static str>) -> Self {
        self.offers = Some(offers.into_iter().collect());
        self
    }

    /// The same error, with what was sent of a program.
    pub fn after(mut self, sent: SentPart) -> Self {
        self.sent = Some(Box::new(sent));
        self
    }

    /// The same error, with the time after which the caller should try again, in whole seconds.
    pub fn retrying(mut self, after: Duration) -> Self {
        let seconds = after.as_secs_f64().ceil().clamp(1.0, LONGEST_RETRY_S);
        self.retry_after_s = NonZero::new(seconds as u16);
        self
    }

    /// Seconds after which the caller should try again, at least one.
    pub fn retry_after_s(&self) -> u16 {
        self.retry_after_s.map_or(1, NonZero::get)
    }

    pub fn code(&self) -> Code {
        self.code
    }

    pub fn status(&self) -> StatusCode {
        self.status
    }

    pub fn detail(&self) -> &str {
        &self.detail
    }

    pub fn errors(&self) -> &[FieldError] {
        &self.errors
    }

    /// The problem that answers the request with this id.
    pub fn problem(self, request_id: &str) -> Problem {
        Problem {
            kind: "about:blank",
            title: self.code.title(),
            status: self.status.as_u16(),
            detail: self.detail,
            code: self.code,
            request_id: request_id.to_owned(),
            errors: self.errors,
            place: self.place,
            offers: self.offers,
            sent: self.sent,
        }
    }
}

fn shortened(text: String) -> String {
    match text.char_indices().nth(MAX_DETAIL_CHARACTERS) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

fn first_pointer(errors: &[FieldError]) -> &str {
    errors.first().map_or("#", |error| &error.pointer)
}

/// Puts the error into the extensions of the response. `envelope::wrap` knows the request's id and writes
/// the body.
impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = self.status.into_response();
        response.extensions_mut().insert(self);
        response
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_whose_only_faults_are_unsupported_gets_the_code_unsupported() {
        let unsupported =
            FieldError::new(&Pointer::root().field("engine"), FieldCode::Unsupported, "not yet");
        let wrong =
            FieldError::new(&Pointer::root().field("tool"), FieldCode::OutOfRange, "-1 is below 0.001");
        assert_eq!(ApiError::invalid(vec![unsupported.clone()]).code(), Code::Unsupported);
        let both = ApiError::invalid(vec![unsupported, wrong]);
        assert_eq!(both.code(), Code::InvalidRequest);
        assert_eq!(both.detail, "2 violations; the first at #/engine");
    }

    #[test]
    fn a_long_detail_is_shortened() {
        let error = ApiError::new(Code::MalformedJson, "\u{e9}".repeat(10_000));
        assert_eq!(error.detail.chars().count(), MAX_DETAIL_CHARACTERS + 3);
    }
}
