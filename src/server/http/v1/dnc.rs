//! `/v1/dnc`: the controls to which programs can be sent, and the sending.

use std::sync::Arc;

use axum::extract::{FromRequestParts, Path, Request, State};
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};

use crate::http::answer::encoded::Encoded;
use crate::http::answer::events::{self, Begun};
use crate::http::app::App;
use crate::http::byte_limit::HeldBytes;
use crate::http::compute::Size;
use crate::http::decode::query::NoQuery;
use crate::http::dto::dnc::{DncTargets, SentProgram};
use crate::http::error::{ApiError, Code};
use crate::http::request::body::program_body;
use crate::http::request::negotiation::{Offers, Wanted};
use crate::http::request::representation::Representation;
use crate::http::request::retry::IDEMPOTENCY_KEY;
use toolpathd_core::budget::Budget;

/// List the controls to which programs can be sent.
///
/// The configuration of the server names the controls. A server without controls answers an empty list.
#[utoipa::path(get, path = "/v1/dnc", operation_id = "listControls", tag = "dnc",
    responses((status = 200, description = "All controls.", body = DncTargets)))]
pub async fn list_controls(State(app): State<Arc<App>>) -> Result<Encoded, ApiError> {
    Encoded::json(&app.controls.list())
}

/// Send an NC program to a control.
///
/// The answer comes when the whole program was sent, or the sending has ended in another way. A caller that
/// accepts `text/event-stream` gets a stream of events: `progress` with the stage `sending`, `waiting`
/// while the control holds up the sender, or `paused` while GRBL says that it waits for its operator, where
/// `done` and `total` count characters; then `result` or `problem`.
///
/// A control takes one program at a time; a second one is refused with status 409. If the caller goes away,
/// the sending stops at the end of a block and sends the end mark `%`; GRBL gets a feed hold, and a reset
/// once the machine is at rest. No deadline holds for a sending; a control that takes nothing for its
/// `patience_s` ends it. GRBL is asked for its status: while it moves, dwells or waits for its operator, the
/// sending waits.
#[utoipa::path(post, path = "/v1/dnc/{target}", operation_id = "sendProgram", tag = "dnc",
    params(("target" = String, Path, description = "Name of the control, as listed by `/v1/dnc`.")),
    request_body(content((String = "text/x-gcode")),
        description = "The NC program. `text/plain` is read, too."),
    responses((status = 200, description = "The whole program was sent.",
        content((SentProgram = "application/json"), (String = "text/event-stream")))))]
pub async fn send_program(
    State(app): State<Arc<App>>,
    Path(target): Path<String>,
    request: Request,
) -> Result<Response, ApiError> {
    check_origin(request.headers(), &app.cors_origins)?;
    if request.headers().contains_key(IDEMPOTENCY_KEY) {
        let detail = "a program that is sent twice runs twice: send no `idempotency-key`, and look at the machine before you send again";
        return Err(ApiError::new(Code::BadRequest, detail));
    }
    let control = app.controls.find(&target)?;
    let (mut parts, body) = request.into_parts();
    let form = Wanted::<Sendings>::from_request_parts(&mut parts, &()).await?.form;
    let request = Request::from_parts(parts, body);
    let held = HeldBytes::of(&request)?;
    let program = program_body(request, app.body_limits).await?;
    let found = control.clone();
    let make = move |_: &Budget| found.sender(&program.decoded()?.bytes);
    let sender = app.compute.run(app.compute.admit()?, Size::Small, None, make).await??;
    let taken = control.take()?;
    if form.representation == Representation::Events {
        let start = |listener| taken.send(sender, held, Some(listener));
        return events::stream(form.request_id, Begun::told(), start).await;
    }
    Ok(taken.send(sender, held, None).await?.into_response())
}

/// Refuses a page of another origin that `--cors-origin` does not list. A browser sends plain text to any
/// address without asking first, so any page that somebody opens could start a machine.
fn check_origin(headers: &HeaderMap, allowed: &[HeaderValue]) -> Result<(), ApiError> {
    let Some(origin) = headers.get(header::ORIGIN) else { return Ok(()) };
    let text = origin.to_str().unwrap_or_default();
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
    let is_own = text.split_once("://").is_some_and(|(_, authority)| Some(authority) == host);
    if is_own || allowed.contains(origin) {
        return Ok(());
    }
    let detail = format!("pages of `{text}` may not send programs; list the origin in `--cors-origin`");
    Err(ApiError::new(Code::OriginRefused, detail))
}

/// The forms of the answer to a program that is sent.
enum Sendings {}

impl Offers for Sendings {
    type Query = NoQuery;

    const OFFERS: &'static [Representation] = &[Representation::Json, Representation::Events];
    const PARAMETERS: &'static [&'static str] = &["format"];
}
