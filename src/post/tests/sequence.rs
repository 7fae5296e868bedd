//! Several operations in one program.

use nalgebra::Point2;

use super::corrupted::survivors;
use super::cycles::hole;
use super::*;
use crate::dialects::deckel::DECKEL;
use crate::dialects::grbl::GRBL;
use crate::dialects::heidenhain::HEIDENHAIN;
use crate::dialects::okuma::OKUMA;
use crate::dialects::siemens::SIEMENS;
use toolpathd_core::toolpath::cycle::CycleKind;

/// What an operation differs in.
#[derive(Clone, Copy)]
struct Kind {
    tool: u32,
    radius_mm: f64,
    rpm: Option<f64>,
    coolant: Coolant,
    work_offset: Option<u8>,
    clearance_mm: f64,
}

const FACE: Kind = Kind {
    tool: 3,
    radius_mm: 25.0,
    rpm: Some(1500.0),
    coolant: Coolant::Flood,
    work_offset: Some(54),
    clearance_mm: 20.0,
};

/// Six tools in nine operations, two work offsets, a dwell in each, all canned cycles, and operations that go
/// on with the tool of the one before.
fn nine() -> Vec<Kind> {
    vec![
        FACE,
        Kind { tool: 5, radius_mm: 5.0, rpm: Some(8000.0), ..FACE },
        // The same tool, faster, without coolant, over a higher clearance plane.
        Kind {
            tool: 5,
            radius_mm: 5.0,
            rpm: Some(9000.0),
            coolant: Coolant::Off,
            clearance_mm: 60.0,
            ..FACE
        },
        // The same tool at the second offset.
        Kind { tool: 5, radius_mm: 5.0, rpm: Some(9000.0), work_offset: Some(55), ..FACE },
        Kind { tool: 6, radius_mm: 4.0, work_offset: Some(55), ..FACE },
        Kind { tool: 7, radius_mm: 3.0, rpm: None, coolant: Coolant::Off, work_offset: Some(55), ..FACE },
        // Another tool and another offset.
        Kind { tool: 8, radius_mm: 2.0, ..FACE },
        // The same tool, with the spindle stopped.
        Kind { tool: 8, radius_mm: 2.0, rpm: None, ..FACE },
        Kind { tool: 9, radius_mm: 1.0, clearance_mm: 30.0, ..FACE },
    ]
}

/// A part of a path that depends on the number of the operation.
fn path(k: usize) -> Toolpath {
    let [x, y] = [10.0 * k as f64, -3.0 * k as f64];
    let mut path = Toolpath::builder(Point3::new(x, y, 12.0 + k as f64));
    path.rapid(Point3::new(x, y, 5.0)).unwrap();
    if let Some(&kind) = CycleKind::ALL.get(k.wrapping_sub(1)) {
        path.cycle(hole(kind), vec![Point2::new(x + 3.0, y + 4.0), Point2::new(x + 5.0, y + 6.0)]).unwrap();
        path.rapid(Point3::new(x, y, 5.0)).unwrap();
    }
    path.line(Point3::new(x, y, -1.0), feed(200.0), Role::Plunge).unwrap();
    path.dwell(0.5).unwrap();
    path.line(Point3::new(x + 8.0, y, -1.0), feed(700.0 + k as f64), Role::Cut).unwrap();
    let about = (Plane::Xy, Direction::Ccw);
    let center = Point3::new(x + 4.0, y, -1.0);
    path.arc(Point3::new(x, y, -1.0), center, about, feed(650.0), Role::Cut).unwrap();
    if k > 0 && k.is_multiple_of(2) {
        // It leaves another plane in force.
        let (end, center) = (Point3::new(x - 4.0, y, -1.0), Point3::new(x - 2.0, y, -1.0));
        path.arc(end, center, (Plane::Zx, Direction::Ccw), feed(600.0), Role::Cut).unwrap();
    }
    let at = path.at();
    path.rapid(Point3::new(at.x, at.y, 5.0)).unwrap();
    path.finish().unwrap()
}

/// All that the operations borrow.
struct Owned {
    dialect: &'static Dialect,
    paths: Vec<Toolpath>,
    tools: Vec<Tool>,
    programs: Vec<Program>,
    cuttings: Vec<Cutting>,
}

impl Owned {
    fn new(dialect: &'static Dialect, safe_home: SafeHome, kinds: &[Kind]) -> Self {
        let abilities = &dialect.abilities;
        let program = |kind: &Kind| Program {
            work_offset: kind.work_offset.filter(|own| abilities.work_offsets.contains(own)),
            safe_home,
            ..Program::plain(MM)
        };
        let cutting = |kind: &Kind| Cutting { spindle_rpm: kind.rpm, coolant: kind.coolant, ..cutting() };
        let raised = |kind: &Kind| Cutting { clearance_z_mm: kind.clearance_mm, ..cutting(kind) };
        let tool = |kind: &Kind| Tool {
            shape: Shape::Flat,
            radius_mm: kind.radius_mm,
            number: Some(kind.tool),
            length_offset: None,
        };
        Self {
            dialect,
            paths: (0..kinds.len()).map(path).collect(),
            tools: kinds.iter().map(tool).collect(),
            programs: kinds.iter().map(program).collect(),
            cuttings: kinds.iter().map(raised).collect(),
        }
    }

    fn operations(&self) -> Vec<Operation<'_>> {
        let operation = |k: usize| Operation {
            name: Some(["Face", "Pocket; rough"][k % 2]),
            toolpath: &self.paths[k],
            job: ProgramJob {
                tool: Some(&self.tools[k]),
                ..ProgramJob::plain(&self.programs[k], &self.cuttings[k], self.dialect)
            },
        };
        (0..self.paths.len()).map(operation).collect()
    }

    fn text(&self) -> Result<String, WriteError> {
        write_all(&self.operations(), &Budget::unlimited()).map(|program| program.text)
    }
}

/// The highest way up that a dialect has.
fn home(dialect: &Dialect) -> SafeHome {
    *dialect.abilities.safe_homes.last().unwrap()
}

/// All dialects but GRBL, whose programs have one tool, and Deckel, whose programs have one operation.
fn changes_tools(dialect: &Dialect) -> bool {
    let has_one = [GRBL.name, DECKEL.name].contains(&dialect.name);
    assert_eq!(dialect.changes_tools(), !has_one, "{}", dialect.name);
    !has_one
}

#[test]
fn six_tools_and_two_offsets_are_written_and_read_back_in_every_dialect_that_changes_tools() {
    for dialect in DIALECTS.iter().filter(|dialect| changes_tools(dialect)) {
        let mut kinds = nine();
        if home(dialect) == SafeHome::None {
            // The tool of one operation cannot go on at another offset.
            kinds.remove(3);
        }
        let owned = Owned::new(dialect, home(dialect), &kinds);
        let text = owned.text().unwrap_or_else(|error| panic!("{} {error}", dialect.name));
        let code = |line: &&str| {
            !line.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start().starts_with(['(', ';'])
        };
        let code: String = text.lines().filter(code).map(|line| format!("{line} ")).collect();
        let calls: Vec<u32> = if dialect.name == HEIDENHAIN.name {
            let numbers = code.split("TOOL CALL ").skip(1).filter_map(|call| call.split(' ').next());
            numbers.filter_map(|number| number.parse().ok()).collect()
        } else {
            let words = code.split(' ').filter_map(|word| word.strip_prefix('T'));
            words.filter_map(|number| number.parse().ok()).collect()
        };
        assert_eq!(calls, [3, 5, 6, 7, 8, 9], "{}\n{text}", dialect.name);
        assert!(text.contains("2 OF "), "{text}");
    }
}

/// Every word of the programs in LinuxCNC, Fanuc, Siemens and Heidenhain, corrupted. In all operations the
/// spindle turns and coolant flows, at different speeds, so that every word counts.
#[test]
fn each_corrupted_word_of_several_operations_is_found() {
    let five = Kind { tool: 5, radius_mm: 5.0, rpm: Some(8000.0), ..FACE };
    let kinds = [
        FACE,
        five,
        Kind { rpm: Some(9000.0), clearance_mm: 60.0, ..five },
        Kind { rpm: Some(9000.0), work_offset: Some(55), ..five },
        Kind { tool: 6, radius_mm: 4.0, rpm: Some(7000.0), work_offset: Some(55), ..FACE },
        Kind { tool: 8, radius_mm: 2.0, rpm: Some(6000.0), ..FACE },
    ];
    for (dialect, safe_home) in [
        (&LINUXCNC, SafeHome::G53),
        (&LINUXCNC, SafeHome::G28),
        (&FANUC, SafeHome::G28),
        (&SIEMENS, SafeHome::G53),
        (&HEIDENHAIN, SafeHome::G53),
    ] {
        let owned = Owned::new(dialect, safe_home, &kinds);
        let mut tried = 0;
        let mut found = survivors(&owned.operations(), &mut tried);
        // Behind the way home (G91 G28) and the tool change, G90 is stated again.
        found.retain(|own| safe_home != SafeHome::G28 || !own.starts_with("G90 "));
        assert!(found.is_empty(), "{} {} of {tried}: {found:#?}", dialect.name, found.len());
        assert!(tried > 800, "{tried}");
    }
}

#[test]
fn an_operation_with_the_tool_of_the_one_before_crosses_over_both_clearance_planes() {
    let low = Kind { work_offset: None, clearance_mm: 20.0, ..FACE };
    let high = Kind { clearance_mm: 60.0, ..low };
    for (kinds, ways) in [
        ([low, high], "Z20.000\n(OPERATION: 2 OF 2 - POCKET ROUGH)"),
        ([high, low], "Z60.000\n(OPERATION: 2 OF 2 - POCKET ROUGH)"),
    ] {
        let text = Owned::new(&LINUXCNC, SafeHome::None, &kinds).text().unwrap();
        assert!(text.contains(ways), "{text}");
        let (_, second) = text.split_once("(OPERATION: 2").unwrap();
        let moves: Vec<&str> = second.lines().skip(1).filter(|line| !line.starts_with('(')).take(3).collect();
        let up = if kinds[1].clearance_mm > 20.0 { vec!["Z60.000"] } else { Vec::new() };
        let expected: Vec<&str> = up.into_iter().chain(["X10.000 Y-3.000", "Z13.000"]).take(3).collect();
        assert!(moves.starts_with(&expected), "{moves:?}\n{text}");
        assert_eq!(text.matches(" M6").count(), 1);
    }
}

/// The check compares the smoothing at every cut.
#[test]
fn the_smoothing_holds_in_every_operation() {
    for (dialect, asked, _) in super::smoothing::cases() {
        let mut owned = Owned::new(dialect, home(dialect), &nine());
        owned.programs.iter_mut().for_each(|program| program.smoothing = Some(asked));
        assert!(owned.text().is_ok(), "{} {:?}", dialect.name, owned.text());
    }
}

#[test]
fn what_cannot_be_joined_is_refused() {
    let other = Kind { tool: 5, radius_mm: 4.0, ..FACE };
    let elsewhere = Kind { work_offset: Some(55), ..FACE };
    let refusal = |dialect: &'static Dialect, kinds: &[Kind]| {
        let without_coolant: Vec<Kind> =
            kinds.iter().map(|kind| Kind { coolant: Coolant::Off, ..*kind }).collect();
        Owned::new(dialect, SafeHome::None, &without_coolant).text().unwrap_err()
    };
    let no_home = |has_homes: bool| Unjoinable::NoSafeHome { has_homes }.into();
    assert_eq!(refusal(&LINUXCNC, &[FACE, elsewhere]), no_home(true));
    assert_eq!(refusal(&LINUXCNC, &[FACE, other]), no_home(true));
    assert_eq!(refusal(&OKUMA, &[FACE, elsewhere]), no_home(false));
    assert_eq!(refusal(&GRBL, &[FACE, other]), Unjoinable::ToolChange { dialect: "grbl" }.into());
    assert_eq!(
        refusal(&LINUXCNC, &[FACE, Kind { tool: 3, radius_mm: 4.0, ..FACE }]),
        Unjoinable::TwoTools { number: 3 }.into()
    );
    assert_eq!(refusal(&LINUXCNC, &[]), Unjoinable::Nothing.into());
    let mut owned = Owned::new(&LINUXCNC, SafeHome::G53, &[FACE, other]);
    owned.programs[1].number = 7;
    assert_eq!(owned.text(), Err(Unjoinable::Programs.into()));
    let mut owned = Owned::new(&LINUXCNC, SafeHome::G53, &[FACE, other]);
    owned.programs.iter_mut().for_each(|program| program.custom.tool_change = vec!["M6".into()]);
    assert_eq!(owned.text(), Err(Unjoinable::OwnToolChange.into()));
    let mut owned = Owned::new(&LINUXCNC, SafeHome::G53, &[FACE, other, FACE]);
    owned.tools[2].length_offset = Some(9);
    assert_eq!(owned.text(), Err(Unjoinable::LengthOffsets { number: 3 }.into()));
    let too_fast = Kind { rpm: Some(1e7), ..other };
    let error = Owned::new(&FANUC, SafeHome::G28, &[FACE, too_fast]).text().unwrap_err();
    let speed = Box::new(WriteError::SpindleSpeed { rpm: 1e7 });
    assert_eq!(error, WriteError::InOperation { index: 1, error: speed });
    // One tool on a control without tool changes is enough.
    assert!(Owned::new(&GRBL, SafeHome::None, &[FACE, FACE]).text().is_ok());
}
