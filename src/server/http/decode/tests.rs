//! Bodies that are not JSON, and the pointers of violations.

mod agreement;

use serde::Deserialize;

use super::*;
use crate::http::error::{Code, MAX_ERRORS};
use toolpathd_core::budget::Stopped;

#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct Outer {
    #[serde(default)]
    #[schema(value_type = Vec<crate::http::dto::point::PlanePoint>)]
    _list: Vec<[f64; 2]>,
    #[serde(default)]
    _inner: Option<Inner>,
}

#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct Inner {
    _width: f64,
    #[serde(default)]
    _side: Option<Side>,
}

#[derive(Debug, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum Side {
    Left,
}

impl IntoJob for Outer {
    type Job = ();

    fn into_job(self, _: &Limits) -> Result<(), ApiError> {
        Ok(())
    }
}

fn decoded(body: &[u8]) -> Result<(), ApiError> {
    job::<Outer>(body, &Limits::DEFAULT, &Budget::unlimited()).map(|sent| sent.job)
}

fn code_of(body: &str) -> Code {
    decoded(body.as_bytes()).expect_err(body).code()
}

#[test]
fn a_body_that_is_not_json_is_malformed_whatever_else_is_wrong() {
    let deep = "[".repeat(100_000);
    for body in [
        "",
        "  \n",
        "{",
        "{\"_list\": [[1, 2]",
        "nothing",
        "{\"_list\": [[NaN, 1]]}",
        "{\"_list\": [[Infinity, 1]]}",
        "{\"_list\": [[1e999, 1]]}",
        "{\"unknown\": 1e999}",
        "{\"unknown\": 1, \"_list\": [",
        "{} {}",
        "{\"_list\": [], \"_list\": []}",
        "{\"x\": {\"a\": 1, \"a\": 2}}",
        &deep,
    ] {
        assert_eq!(code_of(body), Code::MalformedJson, "{}", &body[..body.len().min(40)]);
    }
    assert_eq!(decoded(b"{\"_list\": \"\xff\"}").expect_err("utf-8").code(), Code::MalformedJson);
}

#[test]
fn a_pointer_leads_to_the_member_at_fault() {
    for (body, pointer, code) in [
        (r#"{"_lisst": 1}"#, "#/_lisst", FieldCode::UnknownField),
        (r#"{"_list": [[1, 2], [3, "x"]]}"#, "#/_list/1/1", FieldCode::WrongType),
        (r#"{"_list": [[1, 2], [3]]}"#, "#/_list/1", FieldCode::WrongLength),
        (r#"{"_list": [[1, 2, 3]]}"#, "#/_list/0", FieldCode::WrongLength),
        (r#"{"_list": 3}"#, "#/_list", FieldCode::WrongType),
        (r#"{"_inner": {}}"#, "#/_inner/_width", FieldCode::MissingField),
        (r#"{"_inner": {"_width": 1, "a/b": 1}}"#, "#/_inner/a~1b", FieldCode::UnknownField),
        (r#"{"_inner": {"_width": null}}"#, "#/_inner/_width", FieldCode::MissingField),
        (r#"{"_inner": {"_width": 1, "_side": "up"}}"#, "#/_inner/_side", FieldCode::UnknownValue),
        (r#"{"_inner": {"_width": 1, "_side": 4}}"#, "#/_inner/_side", FieldCode::WrongType),
        ("[]", "#", FieldCode::WrongType),
        ("5", "#", FieldCode::WrongType),
    ] {
        let error = decoded(body.as_bytes()).expect_err(body);
        let [only] = error.errors() else { panic!("{body}: {error:?}") };
        assert_eq!((only.pointer.as_str(), only.code), (pointer, code), "{body}: {}", only.detail);
    }
}

#[test]
fn a_stopped_budget_ends_the_reading_of_a_long_body() {
    let budget = Budget::unlimited();
    budget.stop(Stopped::ShortOfMemory);
    let points = "[1, 2], ".repeat(10_000);
    for body in [format!("{{\"_list\": [{points}[1, 2]]}}"), format!("{{\"x\": [{points}[1, 2]]}}")] {
        let ended = job::<Outer>(body.as_bytes(), &Limits::DEFAULT, &budget).map(|sent| sent.job);
        assert_eq!(ended, Err(Stopped::ShortOfMemory.into()));
    }
}

#[test]
fn millions_of_violations_are_counted_and_the_first_hundred_listed() {
    let body = format!("{{\"_list\": [{}[1, 2]], \"_inner\": {{\"_width\": 1}}}}", "0,".repeat(100_000));
    let error = decoded(body.as_bytes()).expect_err("wrong elements");
    assert_eq!(error.errors().len(), MAX_ERRORS);
    assert_eq!(error.detail(), "100000 violations; the first at #/_list/0");
    assert_eq!(error.errors()[99].pointer, "#/_list/99");
}

#[test]
fn an_object_of_many_unknown_members_is_read_to_its_end() {
    let members: Vec<String> = (0..5_000).map(|k| format!("\"m{k}\": 0")).collect();
    let error = decoded(format!("{{{}}}", members.join(",")).as_bytes()).expect_err("unknown members");
    assert_eq!((error.code(), error.errors().len()), (Code::InvalidRequest, MAX_ERRORS));
    let repeated = format!("{{{}, \"m700\": 1}}", members[..1_000].join(","));
    assert_eq!(code_of(&repeated), Code::MalformedJson);
}
