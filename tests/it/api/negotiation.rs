//! Media types, queries, request ids, unknown paths, and the endpoints that describe the service.

use axum::body::Body;
use axum::http::Request;

use super::support::{MILL, ONE_PASS, app, get, post, send};

#[tokio::test]
async fn an_accept_header_without_a_match_is_406_with_the_offers() {
    let app = app(&["--workers", "1"]);
    let answer = post(&app, MILL, ONE_PASS, &[("accept", "image/png, application/xml;q=0.3")]).await;
    assert_eq!((answer.status.as_u16(), answer.code().as_str()), (406, "not_acceptable"));
    let problem = answer.problem();
    assert_eq!(problem["offers"][0], "application/json");
    assert_eq!(problem["offers"][1], "text/x-gcode");
    let last: Vec<_> = problem["offers"].as_array().expect("offers").iter().skip(5).collect();
    assert_eq!(last, ["image/svg+xml", "text/html", "model/gltf-binary", "text/event-stream"]);
    assert_eq!(answer.header("vary"), "Accept, Accept-Encoding");
}

#[tokio::test]
async fn unknown_query_parameters_and_values_are_400() {
    let app = app(&["--workers", "1"]);
    for query in ["format=pdf", "toolpath=maybe", "tolpath=false"] {
        let answer = post(&app, &format!("{MILL}?{query}"), ONE_PASS, &[]).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (400, "invalid_query"), "{query}");
    }
}

#[tokio::test]
async fn content_types_other_than_json_and_curls_default_are_415() {
    let app = app(&["--workers", "1"]);
    let status = async |content_type: Option<&str>| {
        let builder = Request::post(MILL);
        let builder = content_type.into_iter().fold(builder, |b, value| b.header("content-type", value));
        send(&app, builder.body(Body::from("{}")).expect("a request")).await
    };
    for content_type in [
        None,
        Some("application/json"),
        Some("Application/JSON; charset=utf-8"),
        Some("application/vnd.part+json"),
        Some("application/x-www-form-urlencoded"),
    ] {
        assert_eq!(status(content_type).await.status, 422, "{content_type:?}");
    }
    for content_type in ["text/plain", "application/xml", "application/jsonp", "multipart/mixed", ""] {
        let answer = status(Some(content_type)).await;
        assert_eq!(answer.code(), "unsupported_media_type", "{content_type}");
        assert_eq!(answer.status, 415);
    }
}

#[tokio::test]
async fn unknown_paths_and_wrong_methods_are_answered_with_problems() {
    let app = app(&["--workers", "1"]);
    let missing = get(&app, "/v1/surfaces/mil").await;
    assert_eq!((missing.status.as_u16(), missing.code().as_str()), (404, "not_found"));
    let wrong = get(&app, MILL).await;
    assert_eq!((wrong.status.as_u16(), wrong.code().as_str()), (405, "method_not_allowed"));
    assert_eq!(wrong.header("allow"), "POST");
    let wrong = post(&app, "/livez", "", &[]).await;
    assert_eq!((wrong.status.as_u16(), wrong.header("allow")), (405, "GET,HEAD"));
}

#[tokio::test]
async fn a_legal_request_id_is_echoed_and_another_is_made_otherwise() {
    let app = app(&["--workers", "1"]);
    let echoed = post(&app, MILL, "{}", &[("x-request-id", "job-7")]).await;
    assert_eq!(echoed.problem()["request_id"], "job-7");
    let request = Request::get("/livez").header("x-request-id", "probe-1");
    let alive = send(&app, request.body(Body::empty()).expect("a request")).await;
    assert_eq!((alive.status.as_u16(), alive.header("x-request-id")), (200, "probe-1"));
    let made = post(&app, MILL, "{}", &[("x-request-id", "a b\"c")]).await;
    assert_eq!(made.header("x-request-id").len(), 36);
    assert_ne!(get(&app, "/livez").await.header("x-request-id"), made.header("x-request-id"));
}

#[tokio::test]
async fn limits_dialects_contract_and_readiness_can_be_read() {
    let app = app(&["--workers", "3", "--queue", "5"]);
    let limits = get(&app, "/v1/limits").await;
    assert_eq!(limits.header("content-type"), "application/json");
    let limits = limits.json();
    assert_eq!((&limits["queue"], &limits["workers"]), (&5.into(), &3.into()));
    assert_eq!(limits["body_bytes"], 16 * 1024 * 1024);
    assert_eq!(get(&app, "/v1/dialects").await.json()["dialects"][0]["name"], "linuxcnc");
    assert_eq!(get(&app, "/openapi.json").await.json()["openapi"], "3.1.0");
    assert_eq!(get(&app, "/readyz").await.status, 200);
    app.drain(std::time::Instant::now() + std::time::Duration::from_secs(1));
    let answer = get(&app, "/readyz").await;
    assert_eq!(answer.status, 503);
    assert!(answer.header("retry-after").parse::<u32>().is_ok());
    assert_eq!(get(&app, "/livez").await.status, 200);
}
