//! Milling: the examples in every representation.

use super::support::{MILL, app, post};

const EXAMPLES: [(&str, &str); 3] = [
    ("die", include_str!("../../../openapi/examples/surfaces-mill/die.json")),
    ("freeform", include_str!("../../../openapi/examples/surfaces-mill/freeform.json")),
    ("one-pass", include_str!("../../../openapi/examples/surfaces-mill/one-pass.json")),
];

#[tokio::test]
async fn every_example_is_a_legal_request() {
    let app = app(&["--workers", "1"]);
    for (name, body) in EXAMPLES {
        let answer = post(&app, MILL, body, &[]).await;
        assert_ne!(answer.status, 400, "{name}");
        if answer.status == 422 {
            assert_eq!(answer.violations(), [], "{name}: {}", answer.problem());
        }
    }
}

#[tokio::test]
async fn every_example_answers_in_json_as_the_contract_names_it() {
    let app = app(&["--workers", "1"]);
    for (name, body) in EXAMPLES {
        let answer = post(&app, MILL, body, &[("x-request-id", "one")]).await;
        assert_eq!(answer.status, 200, "{name}");
        assert_eq!(answer.header("content-type"), "application/json");
        assert_eq!(answer.header("vary"), "Accept, Accept-Encoding");
        let json = answer.json();
        assert_eq!(json["request_id"], "one");
        assert_eq!(json["engine_version"], env!("CARGO_PKG_VERSION"));
        assert!(json["report"]["n_passes"].as_u64().is_some_and(|passes| passes > 0), "{name}");
        assert!(json["toolpath"]["passes"][0]["moves"][0]["kind"].is_string(), "{name}");
        let again = post(&app, MILL, body, &[("x-request-id", "one")]).await;
        assert_eq!(again.body, answer.body, "{name}");
        let bare = post(&app, &format!("{MILL}?toolpath=false"), body, &[]).await.json();
        assert!(bare.get("toolpath").is_none() && bare["measures"] == json["measures"], "{name}");
    }
}

#[tokio::test]
async fn every_example_answers_in_nc_text_under_the_name_it_was_asked_by() {
    let app = app(&["--workers", "1"]);
    for (name, body) in EXAMPLES {
        let by_query = post(&app, &format!("{MILL}?format=gcode"), body, &[]).await;
        assert_eq!(by_query.status, 200, "{name}");
        assert_eq!(by_query.header("content-type"), "text/x-gcode; charset=us-ascii");
        assert!(by_query.header("content-disposition").starts_with("attachment; filename=\""));
        for media_type in ["text/x-gcode", "text/x.gcode", "application/x-gcode", "text/plain"] {
            let answer = post(&app, MILL, body, &[("accept", media_type)]).await;
            assert_eq!(answer.header("content-type"), format!("{media_type}; charset=us-ascii"));
            assert_eq!(answer.body, by_query.body, "{name}");
        }
    }
}

#[tokio::test]
async fn every_example_answers_in_pictures_by_query_and_by_header() {
    let app = app(&["--workers", "1"]);
    for (name, body) in EXAMPLES {
        for (format, media_type, start) in
            [("svg", "image/svg+xml", "<svg"), ("html", "text/html", "<!DOCTYPE")]
        {
            let by_query =
                post(&app, &format!("{MILL}?format={format}"), body, &[("x-request-id", "one")]).await;
            assert_eq!(by_query.header("content-type"), format!("{media_type}; charset=utf-8"), "{name}");
            assert!(by_query.body.starts_with(start.as_bytes()), "{name} {format}");
            let headers = [("accept", media_type), ("x-request-id", "one")];
            assert_eq!(post(&app, MILL, body, &headers).await.body, by_query.body, "{name} {format}");
        }
    }
}
