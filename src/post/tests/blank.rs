//! The raw part in Klartext: two corners before everything else.

use super::*;
use crate::dialects::heidenhain::HEIDENHAIN;
use toolpathd_core::toolpath::program::Blank;

fn drilled() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(1.0, 2.0, 20.0));
    path.rapid(Point3::new(1.0, 2.0, 1.0)).unwrap();
    path.line(Point3::new(1.0, 2.0, -1.0), feed(400.0), Role::Plunge).unwrap();
    path.finish().unwrap()
}

fn program_of(low: [f64; 3], high: [f64; 3]) -> Program {
    let blank = Blank { low: low.into(), high: high.into() };
    Program { blank: Some(blank), ..Program::plain(MM) }
}

#[test]
fn the_corners_of_the_raw_part_lie_on_the_grid_around_it() {
    let (program, cutting) = (program_of([0.0, -0.0001, -5.0004], [20.0, 30.0001, 0.5]), cutting());
    let job = ProgramJob::plain(&program, &cutting, &HEIDENHAIN);
    let text = write(&drilled(), &job, &Budget::unlimited()).unwrap().text;
    let lines: Vec<&str> = text.lines().filter(|line| line.contains("BLK FORM")).collect();
    assert!(lines[0].ends_with(" BLK FORM 0.1 Z X+0.000 Y-0.001 Z-5.001"), "{text}");
    assert!(lines[1].ends_with(" BLK FORM 0.2 X+20.000 Y+30.001 Z+0.500"), "{text}");
    let at = |word: &str| text.find(word).unwrap();
    assert!(at("BLK FORM 0.2") < at("TOOL CALL"), "{text}");
}

#[test]
fn a_changed_corner_fails_the_check() {
    let (program, cutting) = (program_of([0.0, 0.0, -5.0], [20.0, 30.0, 0.5]), cutting());
    let job = ProgramJob::plain(&program, &cutting, &HEIDENHAIN);
    let text = write(&drilled(), &job, &Budget::unlimited()).unwrap().text;
    let check = |text: &str| check_text(text, &drilled(), &job);
    assert!(check(&text).is_ok());
    for (from, to) in
        [("Z-5.000", "Z-5.001"), ("X+20.000", "X+21.000"), ("Z+0.500", "Z-5.000"), ("0.2 X", "0.3 X")]
    {
        let spoiled = text.replacen(from, to, 1);
        assert_ne!(spoiled, text, "{from}");
        assert!(check(&spoiled).is_err(), "{from} {to}");
    }
}

#[test]
fn a_box_without_a_volume_and_other_controls_have_no_raw_part() {
    let cutting = cutting();
    for (dialect, high) in [(&HEIDENHAIN, [20.0, 0.0, 1.0]), (&LINUXCNC, [20.0, 30.0, 1.0])] {
        let program = program_of([0.0, 0.0, -5.0], high);
        let job = ProgramJob::plain(&program, &cutting, dialect);
        let text = write(&drilled(), &job, &Budget::unlimited()).unwrap().text;
        assert!(!text.contains("BLK FORM"), "{text}");
    }
}

#[test]
fn no_datum_is_activated_unless_a_work_offset_asks_for_it() {
    let cutting = cutting();
    let text = |work_offset| {
        let program = Program { work_offset, ..Program::plain(MM) };
        let job = ProgramJob::plain(&program, &cutting, &HEIDENHAIN);
        write(&drilled(), &job, &Budget::unlimited()).unwrap().text
    };
    assert!(!text(None).contains("CYCL DEF 247"), "{}", text(None));
    for (offset, row) in (54..=59).zip(1..) {
        let lines = format!("CYCL DEF 247 DATUM SETTING ~\n  Q339=+{row} ; DATUM NUMBER\n");
        assert!(text(Some(offset)).contains(&lines), "{}", text(Some(offset)));
    }
}
