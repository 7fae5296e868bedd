//! Bodies that are not JSON, and the pointers of violations.

mod agreement;

use super::*;

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
    job::<Outer>(body, &Limits::DEFAULT).map(|sent| sent.job)
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
