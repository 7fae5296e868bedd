use super::*;
use crate::geometry::curve::{Curve, Line};
use crate::geometry::surface::BicubicPatch;
use crate::machining::cutter::Cutter;

/// A cutter that reaches everything.
struct Everywhere;

impl Reach for Everywhere {
    fn is_reached(&self, _: &Point3<f64>, _: &Vector3<f64>, _: f64, _: &Budget) -> Result<bool, Stopped> {
        Ok(true)
    }
}

pub(super) const WANTED: Wanted = Wanted {
    gap_share: 0.06,
    gap_mm: 1e-5,
    target_mm: None,
    grain_mm: 1.0,
    smallest_mm: 1e-4,
    part_limit: 1_000_000,
};

/// The plane z = slope y over 40 mm by 30 mm.
fn plane(slope: f64) -> BezierSurface {
    BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let y = 10.0 * b as f64;
                Vector3::new(40.0 / 3.0 * a as f64, y, slope * y)
            })
        }),
    })
}

/// Passes along x, `apart` mm apart, of a cutter that touches the plane z = slope y.
fn passes(cutter: &Cutter, slope: f64, apart: f64) -> Vec<Vec<Curve>> {
    let lower = cutter.tangent_point(nalgebra::Vector2::new(0.0, slope));
    let n = (30.0 / apart).round() as usize;
    (0..=n)
        .map(|k| {
            let y = 30.0 * k as f64 / n as f64;
            let at = |x: f64| Point3::new(x, y - lower.place.y, slope * y - lower.height);
            vec![Curve::Line(Line { start: at(0.0), end: at(40.0) })]
        })
        .collect()
}

fn left_by(surface: &BezierSurface, cutter: &Cutter, passes: &[Vec<Curve>]) -> Left {
    let swept = Swept::new(cutter, 0.0, passes.iter().map(Vec::as_slice), 0.0, 1e-4);
    left(surface, &[swept], &Everywhere, WANTED, &Budget::unlimited()).unwrap()
}

#[test]
fn a_ball_leaves_the_cusps_of_its_passes_on_a_plane() {
    for (radius, apart, slope) in [(3.0, 1.0, 0.0), (3.0, 2.0, 0.5), (5.0, 0.3, 1.5)] {
        let cutter = Cutter::ball(radius);
        let left = left_by(&plane(slope), &cutter, &passes(&cutter, slope, apart));
        let half = 0.5 * apart * f64::hypot(1.0, slope);
        let cusp = f64::hypot(radius, half) - radius;
        let ratio = left.reached.bound_mm / cusp;
        assert!((1.0..1.07).contains(&ratio), "{left:?} {cusp}");
        assert_eq!(left.rest, Leftover::NONE);
    }
}

/// A small sequence of numbers from 0 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A hill of 12 mm by 12 mm.
fn hill() -> BezierSurface {
    let z = |a: usize, b: usize| if (1..3).contains(&a) && (1..3).contains(&b) { 4.0 } else { 0.0 };
    BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| Vector3::new(4.0 * a as f64, 4.0 * b as f64, z(a, b)))
        }),
    })
}

/// Passes over the hill along x, in lines between points of contact.
fn passes_over_hill(cutter: &Cutter, apart: f64) -> Vec<Vec<Curve>> {
    let hill = hill();
    let contacts =
        crate::machining::drop_cutter::Contacts::new(&hill, *cutter, &Budget::unlimited()).unwrap();
    let n = (12.0 / apart).round() as usize;
    let tip = |x: f64, y: f64| {
        let at = nalgebra::Vector2::new(x, y);
        contacts.drop(at, None, &Budget::unlimited()).unwrap().unwrap().tip
    };
    (0..=n)
        .map(|k| {
            let y = 12.0 * k as f64 / n as f64;
            let tips: Vec<Point3<f64>> = (0..=40).map(|i| tip(0.3 * f64::from(i), y)).collect();
            tips.windows(2).map(|pair| Curve::Line(Line { start: pair[0], end: pair[1] })).collect()
        })
        .collect()
}

fn moved(pass: &[Curve], by: Vector3<f64>) -> Vec<Curve> {
    pass.iter().map(|curve| Curve::Line(Line { start: curve.start() + by, end: curve.end() + by })).collect()
}

/// The largest distance of points of the hill from the cutter at the corners and middles of the passes.
fn sampled(cutter: &Cutter, passes: &[Vec<Curve>]) -> f64 {
    let tips: Vec<Point3<f64>> = passes
        .iter()
        .flatten()
        .flat_map(|curve| (0..4).map(|k| curve.point_at(f64::from(k) / 3.0)))
        .collect();
    let (hill, mut most) = (hill(), 0.0f64);
    for k in 0..25 * 25 {
        let p = hill.patch(0, 0).jet(f64::from(k / 25) / 24.0, f64::from(k % 25) / 24.0).point;
        let least = tips.iter().map(|tip| distance_from(cutter, tip, &p)).fold(f64::INFINITY, f64::min);
        most = most.max(least);
    }
    most
}

/// Spoils passes over a hill in many ways, and returns how often the bound was below what samples find or did
/// not rise with it.
fn missed(cutter: &Cutter, cases: usize, seed: u64) -> usize {
    let good = passes_over_hill(cutter, 1.0);
    let whole = left_by(&hill(), cutter, &good).reached.bound_mm;
    let mut numbers = Numbers(seed);
    let mut missed = 0;
    for case in 0..cases {
        let mut passes = good.clone();
        let k = (numbers.next() * passes.len() as f64) as usize;
        match case % 4 {
            0 => drop(passes.remove(k)),
            1 => {
                let share = 0.3 + 0.6 * numbers.next();
                let length = passes[k].len();
                passes[k].truncate((share * length as f64) as usize);
            }
            2 => passes[k] = moved(&passes[k], Vector3::y() * (0.5 + numbers.next())),
            _ => passes[k] = moved(&passes[k], Vector3::z() * (0.05 + numbers.next())),
        }
        let stated = left_by(&hill(), cutter, &passes).reached.bound_mm;
        let found = sampled(cutter, &passes);
        // Samples of the path alone find more than is left, by the cusps between them.
        let cusps = if cutter.flat_radius() == 0.0 { 0.002 } else { 0.05 };
        let is_missed = stated < found - cusps || (found > whole + cusps && stated <= whole);
        missed += usize::from(is_missed);
    }
    missed
}

#[test]
fn no_spoilt_pass_is_missed() {
    assert_eq!(missed(&Cutter::ball(2.0), 48, 1), 0);
    assert_eq!(missed(&Cutter::bull_nose(2.0, 0.5), 12, 2), 0);
    assert_eq!(missed(&Cutter::bull_nose(2.0, 0.0), 12, 3), 0);
}

#[test]
fn cutters_that_share_a_surface_leave_what_all_of_them_leave() {
    let cutters = [Cutter::ball(2.0), Cutter::bull_nose(2.0, 0.5)];
    let budget = Budget::unlimited();
    let [one, other] = cutters.map(|cutter| passes_over_hill(&cutter, 0.5));
    let swept = |cutter: usize, passes: &[Vec<Curve>]| {
        Swept::new(&cutters[cutter], 0.0, passes.iter().map(Vec::as_slice), 0.0, 1e-4)
    };
    let left_of = |all: &[Swept]| left(&hill(), all, &Everywhere, WANTED, &budget).unwrap().reached.bound_mm;
    let half = one.len() / 2;
    let alone = left_of(&[swept(0, &one[..half])]);
    let shared = left_of(&[swept(0, &one[..=half]), swept(1, &other[half..])]);
    let whole = [left_of(&[swept(0, &one)]), left_of(&[swept(1, &other)])];
    assert!(alone > 1.0, "{alone}");
    assert!(shared <= 1.1 * whole[0].max(whole[1]), "{shared} {whole:?}");
    let sampled = sampled(&cutters[0], &one[..=half]).min(sampled(&cutters[1], &other[half..]));
    assert!(shared < sampled, "{shared} {sampled}");
}

#[test]
fn arcs_over_a_cylinder_leave_no_more_than_their_cusps() {
    use crate::geometry::curve::{Arc, Direction};
    use crate::geometry::plane::Plane;
    // A cubic that comes within 0.003 mm of an arch of radius 20 from -45 to 45 degrees.
    let (s, k) = (20.0 * 0.5f64.sqrt(), 0.552_285 * 20.0);
    let d = k * 0.5f64.sqrt();
    let [x, z] = [[-s, -s + d, s - d, s], [s, s + d, s + d, s]];
    let arch = BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
        net: std::array::from_fn(|a| std::array::from_fn(|b| Vector3::new(x[a], 4.0 * b as f64, z[a]))),
    });
    let (cutter, apart) = (Cutter::ball(3.0), 1.0);
    let passes: Vec<Vec<Curve>> = (0..=12)
        .map(|k| {
            let y = apart * f64::from(k);
            let center = Point3::new(0.0, y, -3.0);
            let arc = |from: f64, to: f64| {
                let point = |angle: f64| Point3::new(23.0 * angle.sin(), y, 23.0 * angle.cos() - 3.0);
                let ends = [from, to].map(point);
                Curve::Arc(
                    Arc::with_center_near(Plane::Zx, Direction::Ccw, ends[0], ends[1], center).unwrap(),
                )
            };
            let quarter = std::f64::consts::FRAC_PI_4;
            vec![arc(-quarter, -0.1), arc(-0.1, 0.3), arc(0.3, quarter)]
        })
        .collect();
    let left = left_by(&arch, &cutter, &passes);
    let cusp = f64::hypot(3.0, 0.5 * apart) - 3.0;
    let ratio = left.reached.bound_mm / cusp;
    assert!((0.95..1.2).contains(&ratio), "{left:?} {cusp}");
}
