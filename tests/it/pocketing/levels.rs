//! What program and page tell of the levels of a pocket.

use serde_json::{Value, json};

use super::cases::box_at;
use super::service::{Cut, Region, app, planned, with};
use crate::api::support::post;

const CUT: Cut = Cut { diameter_mm: 10.0, stepover_mm: 4.0, floor_mm: -9.0, stepdown_mm: 3.0 };

const PATTERNS: [&str; 3] = ["island_stock_offset", "zigzag_stock_offset", "continuous_offset"];

fn request() -> Value {
    let region = Region::new(box_at(0.0, 0.0, 60.0, 40.0), vec![box_at(25.0, 15.0, 8.0, 8.0)]);
    with(&CUT.request(&PATTERNS), "region", region.json())
}

fn levels(answer: &Value) -> &[Value] {
    answer["report"]["levels"].as_array().expect("levels")
}

/// The remarks of a label, each with the least Z that is written up to the next remark between blocks.
fn remarks(nc: &str, label: &str) -> Vec<(String, f64)> {
    let mut found: Vec<(String, f64)> = Vec::new();
    let mut is_own = false;
    for line in nc.lines() {
        if let Some(text) = line.strip_prefix(&format!("({label}: ")) {
            found.push((text.trim_end_matches(')').to_owned(), f64::INFINITY));
            is_own = true;
        } else if line.starts_with("(LEVEL: ") || line.starts_with("(FINISH: ") {
            is_own = false;
        } else if let Some((_, z)) = line.split_once('Z').filter(|_| is_own && !line.starts_with('(')) {
            let z: f64 = z.split(' ').next().expect("a word").parse().expect("a number");
            let least = &mut found.last_mut().expect("a remark").1;
            *least = least.min(z);
        }
    }
    found
}

#[tokio::test]
async fn the_program_names_every_level_before_its_first_cut() {
    let finish = json!({ "walls": { "stepdown_mm": 4.5 }, "floor": {} });
    let allowances = with(&with(&request(), "allowance_mm", json!(0.3)), "floor_allowance_mm", json!(0.3));
    let answer = planned(&app(), &with(&allowances, "finish", finish)).await;
    let nc = answer["nc"].as_str().expect("a program");
    let levels = levels(&answer);
    let told = remarks(nc, "LEVEL");
    assert_eq!((told.len(), levels.len()), (4, 4));
    for (k, ((text, least), level)) in told.iter().zip(levels).enumerate() {
        let pattern = level["chosen"].as_str().expect("a pattern").replace('_', " ").to_uppercase();
        let z = level["z_mm"].as_f64().expect("a height");
        assert_eq!(*text, format!("{} OF 4 - {pattern} - Z {z:.3}", k + 1));
        assert!((least - z).abs() < 1e-9, "{text}: {least}");
    }
    let told = remarks(nc, "FINISH");
    assert_eq!(told.len(), 2);
    for ((text, least), z) in told.iter().zip([-4.5, -9.0]) {
        assert_eq!(*text, format!("WALLS AND ISLANDS - Z {z:.3}"));
        assert!((least - z).abs() < 1e-9, "{text}: {least}");
    }
}

#[tokio::test]
async fn the_program_names_the_regions_of_each_level() {
    let square = |x: f64| Region::new(box_at(x, 0.0, 30.0, 30.0), vec![]).json();
    // The second and the third have a wall in common.
    let regions = json!([square(0.0), square(60.0), square(90.0)]);
    let request = with(&CUT.request(&PATTERNS), "regions", regions);
    let answer = planned(&app(), &with(&request, "sequence", json!("as_given"))).await;
    let told = remarks(answer["nc"].as_str().expect("a program"), "LEVEL");
    let expected = (0..6).map(|k| if k < 3 { " - REGION 0 - Z -" } else { " - REGION 1 AND 1 MORE - Z -" });
    assert_eq!(told.len(), 6);
    for ((k, (text, _)), of_regions) in told.iter().enumerate().zip(expected) {
        assert!(text.starts_with(&format!("{} OF 6 - ", k + 1)) && text.contains(of_regions), "{text}");
    }
}

#[tokio::test]
async fn the_page_shows_the_times_of_all_patterns_on_every_level_and_their_sum() {
    let app = app();
    let answer = planned(&app, &request()).await;
    let page = post(&app, "/v1/pockets/plan?format=html", request().to_string(), &[]).await;
    assert_eq!(page.status, 200);
    let page = page.text();
    let charts: Vec<&str> = page.split("<g class=\"chart\">").skip(1).collect();
    assert_eq!(charts.len(), 4);
    assert!(charts[0].contains(">All 3 levels with one pattern each<") && charts[0].contains(">as chosen<"));
    for (k, (chart, level)) in charts[1..].iter().zip(levels(&answer)).enumerate() {
        let z = level["z_mm"].as_f64().expect("a height");
        assert!(chart.contains(&format!(">Level {} of 3, floor at Z {z:.3} mm<", k + 1)));
        for candidate in level["candidates"].as_array().expect("candidates") {
            let name = candidate["pattern"].as_str().expect("a name").replace('_', " ");
            let is_chosen = candidate["pattern"] == level["chosen"];
            let class = if is_chosen { "head" } else { "name" };
            let told = chart.lines().any(|line| {
                line.contains(&format!("class=\"{class}\"")) && line.contains(&format!(">{name}<"))
            });
            assert!(told, "{name} on level {}: {chart}", k + 1);
            let seconds = candidate["time_s"].as_f64().expect("a time");
            assert!(seconds >= 100.0 || chart.contains(&format!(">{seconds:.1} s")), "{seconds} s: {chart}");
        }
        assert_eq!(chart.matches("class=\"mark\"").count() - usize::from(k == 2), 1);
    }
}
