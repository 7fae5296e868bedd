//! Helices in Klartext: CP with the angle IPA and the rise IZ, in as few blocks as on a control that is
//! told the ends.

use super::*;
use crate::dialects::heidenhain::HEIDENHAIN;

/// Down along a helix of whole turns, a quarter turn, and a circle.
fn bored() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(10.0, 0.0, 12.0));
    path.rapid(Point3::new(10.0, 0.0, 1.0)).unwrap();
    let about = (Plane::Xy, Direction::Ccw);
    for z in [0.0, -1.0] {
        path.arc(Point3::new(10.0, 0.0, z), Point3::new(0.0, 0.0, z + 1.0), about, feed(400.0), Role::Ramp)
            .unwrap();
    }
    path.arc(Point3::new(0.0, 10.0, -1.25), Point3::new(0.0, 0.0, -1.0), about, feed(400.0), Role::Ramp)
        .unwrap();
    let about = (Plane::Xy, Direction::Cw);
    path.arc(Point3::new(0.0, 10.0, -1.25), Point3::new(0.0, 0.0, -1.25), about, feed(800.0), Role::Cut)
        .unwrap();
    path.finish().unwrap()
}

fn job<'a>(program: &'a Program, cutting: &'a Cutting, dialect: &'a Dialect) -> ProgramJob<'a> {
    ProgramJob::plain(program, cutting, dialect)
}

#[test]
fn a_helix_states_its_angle_and_its_rise() {
    let (program, cutting) = (Program::plain(MM), cutting());
    let text = write(&bored(), &job(&program, &cutting, &HEIDENHAIN), &Budget::unlimited()).unwrap().text;
    let cuts: Vec<&str> = text
        .lines()
        .map(|line| line.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start())
        .skip_while(|line| !line.starts_with("CC"))
        .take(6)
        .collect();
    assert_eq!(
        cuts,
        [
            "CC X+0.000 Y+0.000",
            "CP IPA+360.0000 IZ-1.000 DR+ R0 F400",
            "CP IPA+360.0000 IZ-1.000 DR+ R0",
            "CP IPA+90.0000 IZ-0.250 DR+ R0",
            "L X+0.000 Y+10.000 Z-1.250 R0 F800",
            "C X+0.000 Y+10.000 DR- R0",
        ],
        "{text}"
    );
}

#[test]
fn a_changed_helix_fails_the_check() {
    let (program, cutting) = (Program::plain(MM), cutting());
    let job = job(&program, &cutting, &HEIDENHAIN);
    let text = write(&bored(), &job, &Budget::unlimited()).unwrap().text;
    for (from, to) in [
        ("IPA+90.0000", "IPA+90.0001"),
        ("IPA+90.0000", "IPA+89.0000"),
        ("IPA+90.0000 IZ-0.250 DR+", "IPA-90.0000 IZ-0.250 DR-"),
        ("IZ-0.250", "IZ-0.251"),
        ("IZ-0.250", "IZ+0.250"),
        ("IZ-0.250 ", ""),
        ("IPA+360.0000 IZ-1.000 DR+ R0 F400", "IPA+360.0000 IZ-1.000 DR+ R0 F401"),
        ("IPA+360.0000", "IPA+359.9999"),
        ("IPA+360.0000", "IPA+720.0000"),
        ("CC X+0.000", "CC X+0.001"),
        ("DR+", "DR-"),
    ] {
        let spoiled = text.replacen(from, to, 1);
        assert_ne!(spoiled, text, "{from}");
        let read = check_text(&spoiled, &bored(), &job);
        assert!(read.is_err(), "{from} {to}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Chains of helices with centres and ends anywhere take about as many blocks as with their ends written,
    /// and the tool stays within the bound wherever the helices lead.
    #[test]
    fn chains_of_helices_stay_near_their_toolpath(
        turns in prop::collection::vec((1.0..80.0f64, 0.0..TAU, 0.05..TAU, 0.01..2.0f64, any::<bool>()), 1..20),
    ) {
        let mut path = Toolpath::builder(Point3::new(1.0, 2.0, 50.0));
        for (radius, angle, sweep, rise, is_ccw) in turns {
            let direction = if is_ccw { Direction::Ccw } else { Direction::Cw };
            let one = Hop::Arc { plane: Plane::Xy, direction, radius, angle, sweep, rise: -rise, rate: 500.0 };
            let _ = hop(&mut path, &one);
        }
        let path = path.finish().unwrap();
        let (program, cutting) = (Program::plain(MM), cutting());
        let klartext = write(&path, &job(&program, &cutting, &HEIDENHAIN), &Budget::unlimited()).unwrap();
        let words = write(&path, &job(&program, &cutting, &LINUXCNC), &Budget::unlimited()).unwrap();
        prop_assert!(klartext.max_displacement_mm <= 1.5 * MM.step_mm(), "{} mm", klartext.max_displacement_mm);
        // A line back to the grid behind each helix, at most, and halves where the angle needs room.
        prop_assert!(klartext.blocks <= 4 * words.blocks, "{} {}", klartext.blocks, words.blocks);
        let mut ends = path.moves().filter_map(|step| match step {
            toolpathd_core::toolpath::Move::Feed { along, .. } => Some(along.end()),
            _ => None,
        });
        let mut next = ends.next();
        for placed in Reader::new(&klartext.text, &HEIDENHAIN, 0.0015) {
            let Step::Feed { along, .. } = placed.unwrap().step else { continue };
            if next.is_some_and(|end| (along.end() - end).norm() <= klartext.max_displacement_mm + 1e-9) {
                next = ends.next();
            }
        }
        prop_assert_eq!(next, None);
    }
}
