//! The meaning of texts, and the faults and places of refused texts.

use super::parsed;
use crate::language::expression::{DEEPEST_NESTING, Expression, ExpressionError, Fault, LONGEST_TEXT};

fn refused(text: &str) -> ExpressionError {
    Expression::parse(text).expect_err(text)
}

#[test]
fn operators_bind_as_in_mathematics() {
    let table: &[(&str, f64)] = &[
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("8 - 3 - 2", 3.0),
        ("8/4/2", 1.0),
        ("8/4*2", 4.0),
        ("2*3 + 4*5", 26.0),
        ("2^3^2", 512.0),
        ("(2^3)^2", 64.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-1", 0.5),
        ("2^-2^2", 0.0625),
        ("2^-1*4", 2.0),
        ("2*-3", -6.0),
        ("2--3", 5.0),
        ("2 - + - 3", 5.0),
        ("--3", 3.0),
        ("-3*2", -6.0),
        ("-3 + 5", 2.0),
        ("-(1+2)^2", -9.0),
        ("+3", 3.0),
        ("1 - 2^2*3", -11.0),
        ("12/2^2", 3.0),
        ("x^2 + x", 6.0),
        ("-x^2", -4.0),
        ("x^-x", 0.25),
        ("x^x^x", 16.0),
    ];
    for &(text, value) in table {
        assert_eq!(parsed(text).value(2.0), value, "{text}");
    }
}

#[test]
fn numbers_and_names_are_read() {
    let table: &[(&str, f64)] = &[
        ("1", 1.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e-3", 1e-3),
        ("1E+3", 1e3),
        ("1.25e2", 125.0),
        ("0.1", 0.1),
        ("1e-400", 0.0),
        ("pi", std::f64::consts::PI),
        ("e", std::f64::consts::E),
        ("  x\t+\r\n1 ", 3.0),
        ("sin ( 0 )", 0.0),
        ("log(e)", 1.0),
        ("ln(e)", 1.0),
        ("log10(1000)", 1000f64.log10()),
        ("log2(8)", 3.0),
        ("sqrt(16)", 4.0),
        ("cbrt(-8)", -2.0),
        ("abs(-x)", 2.0),
        ("min(x, 1)", 1.0),
        ("max(x, 1)", 2.0),
        ("pow(x, 10)", 1024.0),
        ("hypot(3, 4)", 5.0),
        ("exp(0)", 1.0),
        ("tan(0) + asin(0) + atan(0) + sinh(0) + tanh(0)", 0.0),
        ("cos(0) + acos(1) + cosh(0)", 2.0),
        ("min(max(x, 5), (3 + 1))", 4.0),
    ];
    for &(text, value) in table {
        assert_eq!(parsed(text).value(2.0), value, "{text}");
    }
}

#[test]
fn an_exponent_without_x_counts_as_a_number() {
    assert_eq!(parsed("x^(6/2)").value(-2.0), -8.0);
    assert_eq!(parsed("x^-(1+1)").value(-2.0), 0.25);
    assert_eq!(parsed("x^sqrt(4)").value(-3.0), 9.0);
    assert_eq!(parsed("pow(x, 3)"), parsed("pow(x, 2 + 1)"));
    assert_eq!(parsed("x^0").value(0.0), 1.0);
    assert!(parsed("x^(1/3)").value(-8.0).is_nan());
}

#[test]
fn faults_are_reported_with_their_place() {
    use Fault::*;
    let wrong = |name, takes, given| WrongNumberOfArguments { name, takes, given };
    let table: Vec<(&str, usize, Fault)> = vec![
        ("", 0, Empty),
        (" \n ", 0, Empty),
        ("2x", 1, MissingOperator),
        ("2 (x)", 2, MissingOperator),
        ("x(2)", 1, MissingOperator),
        ("(x)(x)", 3, MissingOperator),
        ("x 2", 2, MissingOperator),
        ("1.2.3", 3, MissingOperator),
        ("2e", 1, MissingOperator),
        ("x +", 3, MissingOperand),
        ("x + ", 4, MissingOperand),
        ("*x", 0, MissingOperand),
        ("x ** 2", 3, MissingOperand),
        ("()", 1, MissingOperand),
        ("-", 1, MissingOperand),
        ("2^", 2, MissingOperand),
        ("min(x,)", 6, MissingOperand),
        ("min(,x)", 4, MissingOperand),
        (",", 0, MissingOperand),
        (")", 0, MissingOperand),
        ("(x", 0, UnclosedParenthesis),
        ("1 + (2*(x + 1)", 4, UnclosedParenthesis),
        ("sin(x", 3, UnclosedParenthesis),
        ("x)", 1, UnopenedParenthesis),
        ("x, 2", 1, UnexpectedCharacter(',')),
        ("(x, 2)", 2, UnexpectedCharacter(',')),
        ("x = 2", 2, UnexpectedCharacter('=')),
        ("x % 2", 2, UnexpectedCharacter('%')),
        ("1 + .", 4, UnexpectedCharacter('.')),
        ("2 \u{d7} x", 2, UnexpectedCharacter('\u{d7}')),
        ("\u{2212}x", 0, UnexpectedCharacter('\u{2212}')),
        ("x\0", 1, UnexpectedCharacter('\0')),
        ("\0", 0, UnexpectedCharacter('\0')),
        ("x + y", 4, UnknownName("y".into())),
        ("X", 0, UnknownName("X".into())),
        ("1 + sinn(x)", 4, UnknownName("sinn".into())),
        ("sin x", 4, MissingArguments("sin")),
        ("sin", 3, MissingArguments("sin")),
        ("1 + sin()", 4, wrong("sin", 1, 0)),
        ("sin(x, 1)", 0, wrong("sin", 1, 2)),
        ("min(x)", 0, wrong("min", 2, 1)),
        ("x + 1e999", 4, NumberTooLarge),
    ];
    for (text, at, fault) in table {
        assert_eq!(refused(text), ExpressionError { at, fault }, "{text:?}");
    }
}

#[test]
fn messages_are_clear() {
    assert_eq!(
        refused("2x").to_string(),
        "an operator is missing; a product is written with *, as in 2*x (byte 1)"
    );
    assert_eq!(refused("x\0").to_string(), "unexpected character '\\0' (byte 1)");
    assert_eq!(refused("min(1)").to_string(), "min takes 2 argument(s), not 1 (byte 0)");
}

/// The stack of this test is an eighth of the usual stack.
#[test]
fn hostile_texts_do_not_overflow_the_stack() {
    let texts = || {
        let long = "a".repeat(5_000);
        let deep = |n: usize| {
            ["(", "-", "sin(", "x^", "2*(", "1+2*-3^(", "min(x,"].map(move |part| part.repeat(n) + "x")
        };
        let mut texts = vec![long.clone(), format!("{long}(x)"), "x^".repeat(4_999), "1".repeat(9_999)];
        texts.extend(deep(1_000));
        texts.extend(deep(400));
        texts.extend(["+".repeat(9_999), ",".repeat(9_999), ")".repeat(9_999), "\0".repeat(9_999)]);
        texts.push("\u{e9}".repeat(4_000));
        texts
    };
    let check = move || {
        for text in texts() {
            refused(&text);
        }
        for text in ["(".repeat(10_000), "-".repeat(10_001), "x^".repeat(10_000), "x".repeat(1 << 20)] {
            assert!(matches!(refused(&text).fault, Fault::TooLong | Fault::TooDeep), "{text:.20}");
        }
    };
    // A quarter of the stack that threads have by default.
    std::thread::Builder::new().stack_size(1 << 19).spawn(check).unwrap().join().unwrap();
}

#[test]
fn texts_up_to_the_limits_are_accepted_and_beyond_are_refused() {
    let nested = |n: usize| "(".repeat(n) + "x" + &")".repeat(n);
    let check = move || {
        assert_eq!(parsed(&nested(DEEPEST_NESTING)).value(3.0), 3.0);
        assert_eq!(refused(&nested(DEEPEST_NESTING + 1)).fault, Fault::TooDeep);
        assert_eq!(refused(&("-".repeat(DEEPEST_NESTING + 1) + "x")).at, DEEPEST_NESTING);
        assert_eq!(parsed(&("x^".repeat(DEEPEST_NESTING) + "x")).value(1.0), 1.0);
        let busy = "1+2*-3^min(x,".repeat(DEEPEST_NESTING / 3);
        parsed(&(busy + "x" + &")".repeat(DEEPEST_NESTING / 3)));
    };
    std::thread::Builder::new().stack_size(1 << 19).spawn(check).unwrap().join().unwrap();
    // Operators that do not nest do not count as depth.
    let flat = "x+".repeat(LONGEST_TEXT / 2 - 1) + "x";
    assert_eq!(parsed(&flat).value(1.0), (LONGEST_TEXT / 2) as f64);
    assert_eq!(refused(&" ".repeat(LONGEST_TEXT + 1)).fault, Fault::TooLong);
    parsed(&("x-(x)*-x^2/".repeat(900) + "x"));
}
