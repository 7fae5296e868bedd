use super::*;
use super::bisection::bisect; use super::least::fewest;
use crate::budget::Budget;
use crate::geometry::deviation::{Band, Measure};
use crate::geometry::plane_curve::{Enclosure, PlaneCurve};
use crate::geometry::interval::Interval;
use nalgebra::Vector2;

struct Wave { domain: [f64; 2] }
impl PlaneCurve for Wave {
    fn domain(&self) -> [f64; 2] { self.domain }
    fn breaks(&self) -> &[f64] { &[] }
    fn is_graph(&self) -> bool { true }
    fn point(&self, t: f64) -> Point2<f64> { Point2::new(t, t.sin()) }
    fn derivative(&self, t: f64) -> Vector2<f64> { Vector2::new(1.0, t.cos()) }
    fn enclose(&self, from: f64, to: f64) -> Enclosure {
        let (mid, half) = (0.5 * (from + to), 0.5 * (to - from));
        let slack = |x: f64| Interval::around(x, half * 1.000_001 + 1e-15);
        Enclosure { point: [Interval::between(from, to), slack(mid.sin())], first: [Interval::point(1.0), slack(mid.cos())], second: [Interval::ZERO, slack(-mid.sin())] }
    }
}

#[test]
fn counts() {
    let wave = Wave { domain: [0.0, 6.5] };
    for measure in [Measure::Vertical, Measure::Normal] {
        for method in [Method::Linear, Method::Parabolic, Method::Arc, Method::Mixed] {
            for mm in [0.1, 0.01, 0.001, 1e-4] {
                let band = Band { below_mm: mm, above_mm: mm, measure };
                let fitter = Fitter { curve: &wave, method, band, element_limit: 100_000 };
                let mut bisected = Vec::new();
                bisect(&fitter, [0.0, 6.5], &mut bisected, &Budget::unlimited()).unwrap();
                let mut least = Vec::new();
                let now = std::time::Instant::now();
                let result = fewest(&fitter, [0.0, 6.5], &mut least, &Budget::unlimited());
                println!("{measure:?} {method:?} {mm}: bisection {} least {} {result:?} {:?}", bisected.len(), least.len(), now.elapsed() / least.len() as u32);
                let now = std::time::Instant::now(); let lb = super::lower_bound::lower_bound(&fitter, [0.0, 6.5], &Budget::unlimited()); println!("   lower {lb:?} {:?}", now.elapsed()); let f = least[least.len()-1].range; let g = least[least.len()-2].range; println!("   last {}", (f[1]-f[0])/(g[1]-g[0]));
            }
        }
    }
    // Tables
    for method in [Method::Linear, Method::Parabolic, Method::Mixed] {
        for n in 1..=8 {
            let band = Band { below_mm: 0.1, above_mm: 0.1, measure: Measure::Normal };
            let fitter = Fitter { curve: &wave, method, band, element_limit: 100_000 };
            let mut per = vec![];
            for k in 0..n {
                let mut out = vec![];
                bisect(&fitter, [6.5 * k as f64 / n as f64, 6.5 * (k + 1) as f64 / n as f64], &mut out, &Budget::unlimited()).unwrap();
                per.push((out.len(), out.iter().map(|f| match f.element { crate::geometry::element::Element::Line{..} => 1, _ => 2}).collect::<Vec<_>>()));
            }
            println!("{method:?} {n}: {per:?}");
        }
    }
}

#[test]
fn in_band() {
    use super::corridor::*;
    let wave = Wave { domain: [0.0, 6.5] };
    for measure in [Measure::Vertical, Measure::Normal] {
        for mm in [0.1, 0.01, 0.001, 1e-4] {
            let band = Band { below_mm: mm, above_mm: mm, measure };
            let fitter = Fitter { curve: &wave, method: Method::Linear, band, element_limit: 100_000 };
            let mut least = Vec::new();
            fewest(&fitter, [0.0, 6.5], &mut least, &Budget::unlimited()).unwrap();
            let now = std::time::Instant::now();
            let corridor = Corridor::new(&wave, least.iter().map(|f| f.range), band, &Budget::unlimited()).unwrap();
            let inside = corridor.fewest(&wave, Edges::Inside, &Budget::unlimited()).unwrap();
            let outside = corridor.fewest(&wave, Edges::Outside, &Budget::unlimited()).unwrap();
            println!("{measure:?} {mm}: on curve {} in band {:?} lower {:?} {:?}", least.len(), inside.as_ref().map(|j| j.len() - 1), outside.map(|j| j.len() - 1), now.elapsed());
            let joints = inside.unwrap();
            for pair in joints.windows(2) {
                let line = crate::geometry::element::Element::Line { start: pair[0].at, end: pair[1].at };
                let v = crate::geometry::deviation::judge(&wave, &line, [pair[0].t, pair[1].t], crate::geometry::deviation::Ends::Beside, &band);
                if !matches!(v, crate::geometry::deviation::Verdict::Within(_)) || pair[0].offset_mm.abs() > mm { println!("   {v:?} {pair:?}"); }
            }
        }
    }
}
