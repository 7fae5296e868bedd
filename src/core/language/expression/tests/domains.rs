//! Tests of the domains where expressions are defined, and of the bounds of their values.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use super::parsed;
use crate::budget::{Budget, Stopped};
use crate::geometry::interval::Interval;
use crate::language::expression::{Offence, Undefined};

fn examined(text: &str, domain: [f64; 2]) -> Result<Interval, Undefined> {
    parsed(text).examine(domain, &Budget::unlimited())
}

#[test]
fn legal_expressions_pass_with_tight_bounds() {
    let table: &[(&str, [f64; 2], [f64; 2])] = &[
        ("sqrt(x)", [0.0, 4.0], [0.0, 2.0]),
        ("sqrt(1 - x^2)", [-1.0, 1.0], [0.0, 1.0]),
        ("5*sqrt(1 - (x/10)^2)", [-10.0, 10.0], [0.0, 5.0]),
        ("sqrt(0.3 - x)", [0.0, 0.3], [0.0, 0.3f64.sqrt()]),
        ("sqrt(0.3 - 0.1 - x)", [0.0, 0.2], [0.0, 0.2f64.sqrt()]),
        ("sqrt(x^2 - 2*x + 1)", [0.0, 3.0], [0.0, 2.0]),
        ("sqrt(x^2 + x^4)", [-1.0, 1.0], [0.0, 2f64.sqrt()]),
        ("sqrt(x - sin(x))", [0.0, 1.0], [0.0, (1.0 - 1f64.sin()).sqrt()]),
        ("sqrt(1 - sin(x))", [0.0, 3.0], [0.0, 1.0]),
        ("acos(x)", [-1.0, 1.0], [0.0, PI]),
        ("asin(2*x/(1 + x^2))", [0.0, 3.0], [0.0, FRAC_PI_2]),
        ("acos(cos(x))", [0.0, 6.0], [0.0, PI]),
        ("x^0.5", [0.0, 1.0], [0.0, 1.0]),
        ("x^2.5", [0.0, 1.0], [0.0, 1.0]),
        ("x^-0.5", [0.25, 1.0], [1.0, 2.0]),
        ("x^x", [0.5, 2.0], [0.5f64.sqrt(), 4.0]),
        ("x^(x + 1)", [0.0, 1.0], [0.0, 1.0]),
        ("x^x^x^x", [0.1, 2.0], [0.1f64.powf(0.1f64.powf(0.1f64.powf(0.1))), 65536.0]),
        ("cbrt(x)", [-8.0, 8.0], [-2.0, 2.0]),
        ("abs(x)", [-1.0, 2.0], [0.0, 2.0]),
        ("tan(x)", [-1.5, 1.5], [-(1.5f64.tan()), 1.5f64.tan()]),
        ("tan(x)", [2.0, 4.0], [2f64.tan(), 4f64.tan()]),
        ("1/x", [0.1, 1.0], [1.0, 10.0]),
        ("1/(x^2 - 2*x + 1.0001)", [0.0, 2.0], [1.0 / 1.0001, 1e4]),
        ("ln(x)", [1e-20, 1.0], [1e-20f64.ln(), 0.0]),
        ("ln(x^2 - 2*x + 1.000001)", [0.0, 2.0], [1e-6f64.ln(), 1.000001f64.ln()]),
        ("exp(x)*exp(-x)", [0.0, 20.0], [1.0, 1.0]),
        ("x - x", [-1e6, 1e6], [0.0, 0.0]),
        ("x^3 - 3*x", [-2.0, 2.0], [-2.0, 2.0]),
        ("sin(1000*x)", [0.0, 1.0], [-1.0, 1.0]),
        ("sin(1e9*x)", [0.0, 1.0], [-1.0, 1.0]),
        ("7", [0.0, 1.0], [7.0, 7.0]),
        ("hypot(x, x)", [-1.0, 1.0], [0.0, 2f64.sqrt()]),
        ("min(x, 1 - x)", [0.0, 1.0], [0.0, 0.5]),
        ("1e6*x", [-1.0, 1.0], [-1e6, 1e6]),
    ];
    for &(text, domain, [least, most]) in table {
        let bounds = examined(text, domain).unwrap_or_else(|error| panic!("{text}: {error}"));
        let slack = 1.1e-4 * least.abs().max(most.abs()) + 2e-9;
        let near = |bound: f64, value: f64| (bound - value).abs() <= slack;
        assert!(near(bounds.lo(), least) && near(bounds.hi(), most), "{text}: {bounds:?}");
        assert!(bounds.lo() <= least + 1e-12 && bounds.hi() >= most * (1.0 - 1e-12), "{text}: {bounds:?}");
    }
}

/// Text, domain, offence, byte of the operation, and the range of x where the offence may be found.
type Case = (&'static str, [f64; 2], Offence, usize, [f64; 2]);

#[test]
fn illegal_expressions_are_refused_with_the_place_of_the_offence() {
    use Offence::*;
    let table: &[Case] = &[
        ("1/x", [-1.0, 1.0], DivisionByZero, 1, [0.0, 0.0]),
        ("1/x", [-1.0, 2.0], DivisionByZero, 1, [0.0, 0.0]),
        ("1/x", [0.0, 2.0], DivisionByZero, 1, [0.0, 0.0]),
        ("2 + 1/(x-0.1234567)", [-1.0, 1.0], DivisionByZero, 5, [0.1234567, 0.1234567]),
        ("1/(x^2 - 2)", [0.0, 3.0], DivisionByZero, 1, [SQRT_2 - 1e-9, SQRT_2 + 1e-9]),
        ("1/(x^2 - 2*x + 1)", [0.0, 3.0], DivisionByZero, 1, [0.99, 1.01]),
        ("x/x", [-1.0, 2.0], DivisionByZero, 1, [0.0, 0.0]),
        ("sin(x)/x", [-1.0, 1.0], DivisionByZero, 6, [0.0, 0.0]),
        ("0*ln(x)", [-1.0, 1.0], Logarithm, 2, [-1.0, -1.0]),
        ("1/0", [0.0, 1.0], DivisionByZero, 1, [0.0, 0.0]),
        ("1/sqrt(x)", [0.0, 1.0], DivisionByZero, 1, [0.0, 0.0]),
        ("1/sqrt(x^2 - 0.2*x + 0.01)", [0.0, 1.0], DivisionByZero, 1, [0.0999, 0.1001]),
        ("x^(1/0)", [0.0, 1.0], DivisionByZero, 4, [0.0, 0.0]),
        ("x^(1/(1/0))", [0.0, 1.0], DivisionByZero, 7, [0.0, 0.0]),
        ("log(-1)", [0.0, 1.0], Logarithm, 0, [0.0, 0.0]),
        ("3 + log(x)", [-0.5, 1.0], Logarithm, 4, [-0.5, -0.5]),
        ("ln(x)", [0.0, 1.0], Logarithm, 0, [0.0, 0.0]),
        ("log10(1 - x)", [0.0, 1.0], Logarithm, 0, [1.0, 1.0]),
        ("log2(abs(x - 0.3))", [0.0, 1.0], Logarithm, 0, [0.3, 0.3]),
        ("ln(exp(-x))", [0.0, 1000.0], Logarithm, 0, [700.0, 1000.0]),
        ("sqrt(x)", [-0.1, 1.0], SquareRoot, 0, [-0.1, 0.0]),
        ("sqrt(x)", [-1e-17, 1.0], SquareRoot, 0, [-1e-17, 0.0]),
        ("sqrt(x - 1e-13)", [0.0, 1.0], SquareRoot, 0, [0.0, 1e-13]),
        ("sqrt((x - 0.123)^2 - 1e-20)", [0.0, 1.0], SquareRoot, 0, [0.1229, 0.1231]),
        ("sqrt(1.0001 - x^2)", [-2.0, 2.0], SquareRoot, 0, [-2.0, -1.0]),
        ("asin(x)", [0.0, 1.1], Inverse("asin"), 0, [1.0, 1.1]),
        ("acos(-x)", [0.0, 1.1], Inverse("acos"), 0, [1.0, 1.1]),
        ("x^0.5", [-1.0, 1.0], PowerOfNegative, 1, [-1.0, 0.0]),
        ("x^(1/3)", [-1.0, 1.0], PowerOfNegative, 1, [-1.0, 0.0]),
        ("x^x", [-2.0, 2.0], PowerOfNegative, 1, [-2.0, 0.0]),
        ("x^x", [0.0, 1.0], PowerOfZero, 1, [0.0, 0.0]),
        ("x^-2", [-1.0, 1.0], PowerOfZero, 1, [0.0, 0.0]),
        ("x^-0.5", [0.0, 1.0], PowerOfZero, 1, [0.0, 0.0]),
        ("0^x", [-1.0, 1.0], PowerOfZero, 1, [-1.0, 0.0]),
        ("tan(x)", [0.0, 2.0], Pole, 0, [FRAC_PI_2 - 1e-9, FRAC_PI_2 + 1e-9]),
        ("tan(10*x)", [-2.0, 2.0], Pole, 0, [-2.0, 2.0]),
        ("1e308*x*x", [-10.0, 10.0], Overflow, 5, [-10.0, -1.0]),
        ("exp(x)", [0.0, 1000.0], Overflow, 0, [709.0, 1000.0]),
        ("exp(-exp(x))", [0.0, 1000.0], Overflow, 5, [709.0, 1000.0]),
        ("10^400", [0.0, 1.0], Overflow, 2, [0.0, 0.0]),
    ];
    for &(text, domain, offence, at, [from, to]) in table {
        let found = match examined(text, domain) {
            Err(Undefined::At { offence, x, at } | Undefined::Near { offence, x, at }) => (offence, at, x),
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!((found.0, found.1), (offence, at), "{text}");
        assert!((from..=to).contains(&found.2), "{text}: {}", found.2);
    }
}

#[test]
fn messages_name_operation_and_place() {
    let message = |text, domain| examined(text, domain).unwrap_err().to_string();
    assert_eq!(
        message("3 + log(x)", [-0.5, 1.0]),
        "log of a number that is not positive at x = -0.5 (byte 4)"
    );
    assert_eq!(message("1/x", [-1.0, 2.0]), "division by zero near x = 0 (byte 1)");
    assert_eq!(message("1/(x-0.1234567)", [-1.0, 1.0]), "division by zero near x = 0.1234567 (byte 1)");
}

#[test]
fn a_proof_that_fails_ends_when_the_cells_run_out() {
    let touching = parsed("ln(1.00000000001 + 2*sin(1e5*x)*cos(1e5*x))");
    let outcome = touching.examine([0.0, 100.0], &Budget::unlimited());
    assert!(
        matches!(outcome, Err(Undefined::NotRuledOut { offence: Offence::Logarithm, .. })),
        "{outcome:?}"
    );
}

#[test]
fn a_domain_is_two_rising_numbers() {
    for domain in [[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY], [-1.7e308, 1.7e308]] {
        assert_eq!(examined("x", domain), Err(Undefined::NoDomain));
    }
}

#[test]
fn a_spent_budget_ends_the_search() {
    let budget = Budget::unlimited();
    budget.cancel();
    assert_eq!(parsed("x").examine([0.0, 1.0], &budget), Err(Undefined::Stopped(Stopped::Cancelled)));
}
