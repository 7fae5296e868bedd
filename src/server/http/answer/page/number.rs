//! Numbers rounded for people.

use serde_json::Number;

use super::label::Label;

/// Significant digits of a number below 1.
const DIGITS: i32 = 4;
/// Decimals of a number of 1 or more.
const DECIMALS: i32 = 3;

/// `number` rounded for people; a bound is rounded upward. A time in seconds is followed by h:mm:ss.
pub fn show(number: &Number, label: &Label) -> String {
    let Some(value) = number.as_f64().filter(|_| number.is_f64()) else { return number.to_string() };
    let text = round(value, label.is_bound);
    if label.unit == Some("s") { format!("{text} s ({})", clock(value)) } else { text }
}

/// `number` rounded for a column: with four digits that matter, lengths with three decimals at least; a bound
/// is rounded upward.
pub fn short(number: &Number, label: &Label) -> String {
    let Some(value) = number.as_f64().filter(|_| number.is_f64()) else { return number.to_string() };
    let least = if label.unit == Some("mm") { DECIMALS } else { 0 };
    let decimals = (DIGITS - 1 - magnitude(value)).max(least);
    round_to(value, decimals, label.is_bound)
}

fn magnitude(value: f64) -> i32 {
    if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 }
}

fn round(value: f64, upward: bool) -> String {
    let magnitude = magnitude(value);
    let decimals = if magnitude < 0 { DIGITS - 1 - magnitude } else { DECIMALS };
    round_to(value, decimals, upward)
}

fn round_to(value: f64, decimals: i32, upward: bool) -> String {
    if !(-9..=15).contains(&magnitude(value)) {
        return format!("{value:.3e}");
    }
    let unit = 10f64.powi(decimals);
    let rounded = if upward { (value * unit).ceil() } else { (value * unit).round() } / unit;
    // Adding zero turns a negative zero into zero. `{}` writes the shortest text that reads as the number, so
    // no zeros stand at its end.
    format!("{}", rounded + 0.0)
}

fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn columns_have_four_digits_and_bounds_are_rounded_up() {
        for (name, value, expected) in [
            ("z_mm", json!(-3_551.317_158), "-3551.317"),
            ("area_mm2", json!(3_551.317_158), "3551"),
            ("t_s", json!(70.521), "70.52"),
            ("t_max_s", json!(70.521), "70.53"),
            ("x_mm", json!(0.009_470_222), "0.00947"),
            ("t_s", json!(7), "7"),
        ] {
            assert_eq!(short(value.as_number().unwrap(), &Label::of(name)), expected, "{name} {value}");
        }
    }

    #[test]
    fn a_number_keeps_the_digits_that_matter_and_a_bound_is_rounded_up() {
        for (name, value, expected) in [
            ("x_mm", json!(3_551.317_158), "3551.317"),
            ("x_mm", json!(0.009_470_622), "0.009471"),
            ("x_max_mm", json!(0.009_470_222), "0.009471"),
            ("x_mm", json!(0.009_470_222), "0.00947"),
            ("x_mm", json!(-0.000_04), "-0.00004"),
            ("x_mm", json!(-0.0), "0"),
            ("x_mm", json!(2.0), "2"),
            ("x_mm", json!(1e-30), "1.000e-30"),
            ("n_x", json!(49_504), "49504"),
            ("t_s", json!(59.96), "59.96 s (0:01:00)"),
            ("t_s", json!(7_325.25), "7325.25 s (2:02:05)"),
        ] {
            assert_eq!(show(value.as_number().unwrap(), &Label::of(name)), expected, "{name} {value}");
        }
    }
}
