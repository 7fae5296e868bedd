//! Prints the figures of a STEP file as JSON, with places on its faces: what `compare.py` compares with
//! Open CASCADE.

use std::fmt::Write;
use std::time::Instant;

use toolpathd_core::budget::Budget;
use toolpathd_part::step::{Face, Model, read};

fn main() {
    for path in std::env::args().skip(1).filter(|argument| !argument.starts_with("--")) {
        let bytes = std::fs::read(&path).expect("the file is readable");
        let begun = Instant::now();
        let answer = read(&bytes, &Budget::unlimited());
        let seconds = begun.elapsed().as_secs_f64();
        match answer {
            Ok(model) => println!("{}", report(&path, &model, seconds)),
            Err(error) => {
                println!("{{\"path\":{path:?},\"error\":{:?},\"seconds\":{seconds}}}", error.to_string())
            }
        }
    }
}

fn report(path: &str, model: &Model, seconds: f64) -> String {
    let faces: Vec<String> = model.faces.iter().map(face).collect();
    let holes: Vec<String> = model
        .holes
        .iter()
        .map(|hole| {
            format!(
                "{{\"diameter\":{},\"depth\":{},\"through\":{},\"faces\":{:?}}}",
                hole.diameter_mm, hole.depth_mm, hole.is_through, hole.faces
            )
        })
        .collect();
    let left_out: Vec<String> = model
        .left_out
        .iter()
        .map(|one| format!("[{:?},{:?},{},{:?}]", one.kind, one.reason, one.count, one.first.to_string()))
        .collect();
    format!(
        "{{\"path\":{path:?},\"seconds\":{seconds},\"mm_per_unit\":{},\"bodies\":{},\"faces\":[{}],\"holes\":[{}],\"levels\":{},\"left_out\":[{}]}}",
        model.mm_per_unit,
        model.bodies.len(),
        faces.join(","),
        holes.join(","),
        model.levels.len(),
        left_out.join(",")
    )
}

fn face(face: &Face) -> String {
    let [low, high] = face.bounds_mm;
    let mut text = format!(
        "{{\"entity\":{},\"kind\":{:?},\"area\":{:e},\"untrimmed\":{},\"box\":[{:e},{:e},{:e},{:e},{:e},{:e}],\"deviation\":{:e},\"points\":[",
        face.entity,
        face.surface.kind(),
        face.area_mm2,
        face.is_untrimmed,
        low.x,
        low.y,
        low.z,
        high.x,
        high.y,
        high.z,
        face.edge_deviation_mm
    );
    // Points of the B-spline at uneven places: they must lie on the surface of the file.
    if let Ok(surface) = face.nurbs.surface() {
        let spans = toolpathd_core::geometry::surface::Surface::spans(&surface);
        for k in 0..6 {
            let place = |n: usize, share: f64| n as f64 * ((f64::from(k) + share) * 0.618_033_988).fract();
            let (u, v) = (place(spans[0], 0.3), place(spans[1], 0.71));
            let point = toolpathd_core::geometry::surface::Surface::jet(&surface, u, v).point;
            let comma = if k == 0 { "" } else { "," };
            let _ = write!(text, "{comma}[{:e},{:e},{:e}]", point.x, point.y, point.z);
        }
    }
    text.push_str("],\"inside\":[");
    for (k, [u, v]) in inside(face).into_iter().enumerate() {
        let (point, normal) = (face.surface.point([u, v]), face.normal([u, v]).unwrap_or_default());
        let comma = if k == 0 { "" } else { "," };
        let _ = write!(
            text,
            "{comma}[{:e},{:e},{:e},{:e},{:e},{:e}]",
            point.x, point.y, point.z, normal.x, normal.y, normal.z
        );
    }
    text.push_str("]}");
    text
}

/// Some parameters within the trim, away from its bounds.
fn inside(face: &Face) -> Vec<[f64; 2]> {
    let place = |k: usize, share: f64| face.domain[k][0] + (face.domain[k][1] - face.domain[k][0]) * share;
    let is_inside = |u: f64, v: f64| {
        let [u, v] = [place(0, u), place(1, v)];
        let sides = face.trim.iter().flat_map(|polygon| polygon.iter().zip(polygon.iter().cycle().skip(1)));
        let crossed = sides.filter(|(a, b)| {
            (a[1] > v) != (b[1] > v) && u < a[0] + (b[0] - a[0]) * (v - a[1]) / (b[1] - a[1])
        });
        crossed.count() % 2 == 1
    };
    let is_far_inside = |u: f64, v: f64| {
        [-0.02, 0.0, 0.02].iter().all(|du| [-0.02, 0.0, 0.02].iter().all(|dv| is_inside(u + du, v + dv)))
    };
    let places =
        (0..200).map(|k| [0.618_033_988, 0.754_877_666].map(|step| (f64::from(k) * step + 0.1).fract()));
    places.filter(|[u, v]| is_far_inside(*u, *v)).take(3).map(|[u, v]| [place(0, u), place(1, v)]).collect()
}
