//! Tests of answers in their forms.

use axum::body::to_bytes;
use axum::http::header;
use nalgebra::Point3;
use serde_json::{Value, json};

use super::*;
use crate::http::ENGINE_VERSION;
use crate::http::decode::files::Places;
use crate::http::messages::WarningCode;
use crate::http::request::request_id::RequestId;
use toolpathd_core::toolpath::Role;
use toolpathd_core::toolpath::cutting::CuttingRequest;
use toolpathd_core::toolpath::program::{Program, Resolution, Units};
use toolpathd_core::toolpath::tool::Tool;

#[derive(Serialize, ToSchema)]
struct Report {
    n_passes: usize,
}

fn cut() -> Cut {
    let rate = FeedRate::from_mm_per_min(500.0).expect("a feed");
    let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 2.0));
    builder.rapid(Point3::new(10.0, 0.0, 2.0)).expect("a rapid");
    builder.line(Point3::new(10.0, 0.0, 0.0), rate, Role::Plunge).expect("a line");
    Cut {
        toolpath: builder.finish().expect("a toolpath"),
        cutting: Some(CuttingRequest::at_feed(rate).at_heights(20.0, 2.0)),
        setup: Setup {
            tool: Some(Tool::ball(3.0)),
            ..Setup::of_program(
                toolpathd_post::DIALECTS[0],
                Program {
                    name: Some("die".to_owned()),
                    ..Program::plain(Resolution { units: Units::Mm, decimals: 3 })
                },
            )
        },
        comments: vec!["PROVED".to_owned()],
        nc: None,
    }
}

fn written_cut() -> Cut {
    let nc = NcText { text: "M2\n".to_owned(), move_lines: Vec::new() };
    Cut { nc: Some(nc), ..cut() }
}

fn outcome<P>(product: P) -> Outcome<Report, P> {
    let warning = Warning::new(WarningCode::StripLeft, "far".to_owned());
    Outcome {
        meta: Some([("part_id".to_owned(), "7 <b>".to_owned())].into()),
        warnings: vec![warning],
        report: Report { n_passes: 1 },
        product,
        drawing: Box::new(|| Drawing::of_surface(vec![vec![Point3::origin(), Point3::new(4.0, 0.0, 0.0)]])),
    }
}

/// Content type and text of the answer.
async fn shown<P: Product>(
    outcome: Outcome<Report, P>,
    representation: Representation,
    with_toolpath: Option<bool>,
) -> Result<(String, String), ApiError> {
    let request_id = RequestId::of(&Default::default());
    let media_type = representation.media_types()[0];
    let form = Form {
        representation,
        media_type,
        with_toolpath,
        with_nc: false,
        with_glb: false,
        with_points: false,
        view: Default::default(),
        with_gzip: false,
        request_id,
    };
    let response = represent(outcome, &Places::default(), &form, &Budget::unlimited())?.into_response();
    let content_type = response.headers()[header::CONTENT_TYPE].to_str().expect("text").to_owned();
    let body = to_bytes(response.into_body(), usize::MAX).await.expect("a body");
    Ok((content_type, String::from_utf8(body.into()).expect("UTF-8")))
}

async fn json_of<P: Product>(outcome: Outcome<Report, P>, with_toolpath: Option<bool>) -> Value {
    let (_, text) = shown(outcome, Representation::Json, with_toolpath).await.expect("an answer");
    serde_json::from_str(&text).expect("JSON")
}

#[tokio::test]
async fn the_answer_has_the_members_of_the_contract() {
    let answer = json_of(outcome(cut()), None).await;
    assert_eq!(answer["engine_version"], ENGINE_VERSION);
    assert_eq!(answer["meta"], json!({ "part_id": "7 <b>" }));
    // First the warning of the operation, then the warnings that every toolpath gets.
    assert_eq!(answer["warnings"][0]["code"], "strip_left");
    assert_eq!(answer["warnings"][1]["code"], "no_spindle_speed");
    assert_eq!(answer["report"]["n_passes"], 1);
    assert_eq!(answer["measures"]["rapid_length_mm"], 10.0);
    assert_eq!(answer["measures"]["moves"]["line"], 1);
    assert_eq!(answer["measures"]["bounds"]["max"], json!([10.0, 0.0, 2.0]));
    assert_eq!(answer["toolpath"]["passes"][0]["moves"][1]["role"], "plunge");
    assert_eq!(answer.get("nc"), None);
}

#[tokio::test]
async fn absent_and_unwanted_members_are_left_out() {
    let surface = json_of(outcome(OnSurface(Box::new(|| None))), None).await;
    let members: Vec<_> = surface.as_object().expect("an object").keys().cloned().collect();
    assert_eq!(members, ["engine_version", "meta", "report", "warnings"]);
    assert_eq!(json_of(outcome(cut()), Some(false)).await.get("toolpath"), None);
    let written = json_of(outcome(written_cut()), None).await;
    assert_eq!((written.get("toolpath"), &written["nc"]), (None, &json!("M2\n")));
    assert!(json_of(outcome(written_cut()), Some(true)).await["toolpath"].is_object());
}

#[tokio::test]
async fn a_program_is_written_once_and_says_what_the_caller_and_the_operation_say() {
    let (content_type, text) = shown(outcome(cut()), Representation::Gcode, None).await.expect("NC text");
    assert_eq!(content_type, "text/x-gcode; charset=us-ascii");
    assert!(text.contains("PART_ID 7") && text.contains("PROVED"), "{text}");
    let written = shown(outcome(written_cut()), Representation::Gcode, None).await;
    assert_eq!(written.expect("NC text").1, "M2\n");
    let error = shown(outcome(OnSurface(Box::new(|| None))), Representation::Gcode, None)
        .await
        .expect_err("no toolpath");
    assert_eq!(error.code(), Code::InternalError);
}

#[tokio::test]
async fn a_picture_has_the_part_id_as_its_title() {
    let picture = shown(outcome(cut()), Representation::Svg, None).await;
    let (content_type, text) = picture.expect("a picture");
    assert_eq!(content_type, "image/svg+xml; charset=utf-8");
    assert!(text.contains("7 &lt;b&gt;") && text.contains("PROVED"), "{text}");
    assert!(text.contains("ball, diameter 6 mm"), "{text}");
    let page = shown(outcome(OnSurface(Box::new(|| None))), Representation::Html, None).await;
    let (content_type, text) = page.expect("a page");
    assert_eq!(content_type, "text/html; charset=utf-8");
    assert!(text.contains("<title>7 &lt;b&gt;</title>") && text.contains("<svg"), "{text}");
    assert_eq!(sheet::title(&Outcome { meta: None, ..outcome(cut()) }), "die");
    assert_eq!(sheet::title(&Outcome { meta: None, ..outcome(OnSurface(Box::new(|| None))) }), "Surface");
}
