//! The fewest elements for sin x over [0, 6.5]. Brute force verifies each element.

use serde_json::{Value, json};

use super::answer;
use super::evaluator::{Curve, domain, moves};

async fn sine(method: &str, mm: f64, joints: &str, measure: &str) -> Value {
    answer(&json!({
        "curve": { "kind": "graph", "expression": "sin(x)", "domain": [0, 6.5] },
        "method": method, "subdivision": "least", "joints": joints,
        "band": { "below_mm": mm, "above_mm": mm, "measure": measure },
    }))
    .await
}

/// The number of elements. Fails if an element is outside the band, a stated deviation is wrong, or the chain
/// has a gap.
fn verified(answer: &Value, mm: f64, measure: &str) -> usize {
    let curve = Curve { point: &|x| [x, x.sin()], domain: [0.0, 6.5] };
    let elements = answer["report"]["elements"].as_array().expect("elements");
    let paths = moves(answer);
    assert_eq!(paths.len(), elements.len());
    let mut end = [0.0, 0.0];
    let mut at = 0.0;
    for (path, element) in paths.iter().zip(elements) {
        assert!((path[0][0] - end[0]).abs() + (path[0][1] - end[1]).abs() < 1e-12, "a gap before {element}");
        end = path[path.len() - 1];
        let range = domain(element);
        assert_eq!(range[0], at);
        at = range[1];
        let found =
            if measure == "vertical" { curve.vertical_deviation(path) } else { curve.deviation(path, range) };
        let stated = element["deviation_mm"].as_f64().expect("a deviation");
        assert!(
            found <= mm + 2e-9 && found <= stated + 1e-12,
            "{found} found, {stated} stated, {mm} allowed"
        );
        assert!(stated <= 2.0 * found + 1e-6, "{stated} stated, only {found} found");
    }
    assert_eq!(at, 6.5);
    assert!((end[0] - 6.5).abs() + (end[1] - 6.5f64.sin()).abs() < 1e-12);
    let least = answer["report"]["n_elements_lower_bound"].as_u64().expect("a bound");
    assert!(least <= elements.len() as u64);
    elements.len()
}

#[tokio::test]
async fn nearly_every_line_with_joints_on_the_curve_is_as_long_as_the_band_allows() {
    for (mm, most) in [(0.1, 5), (0.01, 17), (0.001, 54)] {
        let answer = sine("linear", mm, "on_curve", "vertical").await;
        assert!(verified(&answer, mm, "vertical") <= most, "more than {most} elements within {mm}");
        // A line is as long as it can be if a line that ends a millionth farther on leaves the band. Near an
        // inflection a line may end earlier, so that the next line reaches farther. The last line ends with
        // the curve.
        let elements = answer["report"]["elements"].as_array().expect("elements");
        let is_longest = |element: &&Value| {
            let [a, b] = domain(element);
            let b = b + 1e-6;
            let chord = |x: f64| a.sin() + (b.sin() - a.sin()) * (x - a) / (b - a);
            let within = (0..=20_000)
                .map(|k| a + (b - a) * f64::from(k) / 20_000.0)
                .all(|x| (x.sin() - chord(x)).abs() <= mm);
            !within
        };
        let longest = elements[..elements.len() - 1].iter().filter(is_longest).count();
        assert!(
            longest + 1 + 2 >= elements.len(),
            "within {mm}, only {longest} of {} lines are as long as the band allows",
            elements.len()
        );
    }
}

#[tokio::test]
async fn parabolas_with_joints_on_the_curve_are_no_more_than_listed() {
    for (mm, most, most_normal) in [(0.1, 2, 2), (0.01, 6, 5), (0.001, 11, 11)] {
        let answer = sine("parabolic", mm, "on_curve", "vertical").await;
        assert!(verified(&answer, mm, "vertical") <= most, "more than {most} elements within {mm}");
        let answer = sine("parabolic", mm, "on_curve", "normal").await;
        assert!(
            verified(&answer, mm, "normal") <= most_normal,
            "more than {most_normal} elements within {mm}"
        );
    }
}

#[tokio::test]
async fn arcs_with_joints_on_the_curve_are_at_most_three_quarters_of_the_lines() {
    for (mm, most) in [(0.1, 3), (0.01, 6), (0.001, 13)] {
        let answer = sine("arc", mm, "on_curve", "normal").await;
        assert!(verified(&answer, mm, "normal") <= most, "more than {most} elements within {mm}");
    }
}

/// Within 0.01 mm there are 13 lines. Fewer are impossible: no path of fewer lines stays within the band.
#[tokio::test]
async fn lines_with_joints_in_the_band_reach_their_lower_bound() {
    for (mm, exactly) in [(0.1, 5), (0.01, 13), (0.001, 39)] {
        let answer = sine("linear", mm, "in_band", "vertical").await;
        assert_eq!(verified(&answer, mm, "vertical"), exactly);
        assert_eq!(answer["report"]["n_elements_lower_bound"], exactly);
        let normal = sine("linear", mm, "in_band", "normal").await;
        assert!(verified(&normal, mm, "normal") <= exactly);
    }
}
