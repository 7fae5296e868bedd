//! Texts of ISO 10303-21.

use crate::fault::{Place, Unreadable};
use crate::step::string::decode;
use crate::step::tests::writer::read_text;
use crate::step::text::{Cursor, Value};

fn values(text: &str) -> Result<Vec<Value>, String> {
    let text = format!("A({text})");
    match Cursor::new(text.as_bytes(), 0).parts() {
        Ok(mut parts) => Ok(parts.remove(0).values),
        Err(fault) => Err(fault.detail),
    }
}

#[test]
fn values_of_every_type_are_read() {
    let found =
        values("1,-2.5E+1,.5,$,'it''s',.T.,$,*,#12,\"0FF\",LENGTH_MEASURE(3.),(1,(2))  /* so */ ").unwrap();
    let expected = [
        Value::Integer(1),
        Value::Real(-25.0),
        Value::Real(0.5),
        Value::Unset,
        Value::Text("it's".into()),
        Value::Enumeration("T".into()),
        Value::Unset,
        Value::Derived,
        Value::Reference(12),
        Value::Binary,
        Value::Typed("LENGTH_MEASURE".into(), vec![Value::Real(3.0)]),
        Value::List(vec![Value::Integer(1), Value::List(vec![Value::Integer(2)])]),
    ];
    assert_eq!(found, expected);
}

#[test]
fn an_instance_of_several_parts_has_the_values_of_each() {
    let text = b"( A(1) B() C('x') )";
    let parts = Cursor::new(text, 0).parts().unwrap();
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["A", "B", "C"]);
    assert_eq!(parts[2].values, [Value::Text("x".into())]);
}

#[test]
fn escapes_of_texts_stand_for_letters() {
    assert_eq!(decode(br"Wei\X2\00DF\X0\ wei\S\_"), "Weiß weiß");
    assert_eq!(decode(br"\X\E9t\X\E9 \\ \X4\0001F600\X0\"), "été \\ 😀");
    // What is no escape stays.
    assert_eq!(decode(br"C:\parts\X2\ZZ"), r"C:\parts\X2\ZZ");
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    for text in ["1.E999", "-1.E999", "1.2.3", "+-1", "1E"] {
        assert_eq!(values(text).unwrap_err(), "a number is not readable or not finite", "{text}");
    }
    assert!(values("NAN").is_err());
}

#[test]
fn deep_lists_are_refused() {
    let text = format!("{}{}", "(".repeat(100_000), ")".repeat(100_000));
    assert!(values(&text).unwrap_err().contains("nested"));
}

#[test]
fn a_text_may_hold_what_ends_a_statement() {
    let text = "ISO-10303-21;\nHEADER;FILE_SCHEMA(('A;''B'));ENDSEC;DATA;\n#1=A('; /* ''');/* #2=B(); */\n\
                ENDSEC;END-ISO-10303-21;";
    assert_eq!(read_text(text).unwrap().schema, "A;'B");
}

#[test]
fn what_is_no_step_file_is_refused_by_its_line() {
    let place = |text: &str| match read_text(text) {
        Err(Unreadable::Broken { place, .. }) => place,
        other => panic!("{other:?}"),
    };
    assert_eq!(place("solid cube\n"), Place::Line(1));
    assert_eq!(place("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n"), Place::Line(5));
    assert_eq!(place("ISO-10303-21;\nDATA;\n#1=A(\n"), Place::Entity(1));
    assert_eq!(place("ISO-10303-21;\nDATA;\nnonsense;\n"), Place::Line(3));
    assert_eq!(place("ISO-10303-21;\nDATA;\n#1=A();\n#1=B();\nENDSEC;\nEND-ISO-10303-21;"), Place::Entity(1));
    assert_eq!(place("ISO-10303-21;\nDATA;\n#99999999999=A();\n"), Place::Line(3));
}
