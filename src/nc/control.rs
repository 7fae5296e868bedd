//! How controls differ in what they make of the same words.
//!
//! The facts come from manuals, sources and interpreters of the controls. A fact that no source settles is a
//! field of its own, so that the reader can say what it has assumed.

/// A family of controls with the same grammar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    LinuxCnc,
    Grbl,
    Mach,
    /// Fanuc and those that follow it.
    Fanuc,
    Siemens,
    /// Heidenhain's conversational programs.
    Klartext,
}

/// What a length without a decimal point means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WithoutPoint {
    /// The same as with a point.
    Units,
    /// Least increments: 0.001 mm or 0.0001 inch.
    Increments,
}

/// What the time of a G4 counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DwellTime {
    Seconds,
    /// P counts whole milliseconds; X counts seconds.
    Milliseconds,
    /// P counts seconds with a point, and milliseconds without.
    ByPoint,
}

/// What I, J and K of an arc count from until G90.1 or G91.1 says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Centers {
    /// From the start of the arc.
    Start,
    /// From the start or from zero, by a setting of the control.
    Unsure,
}

/// How far the two radii of an arc may differ. The arc is refused above `most_mm`, and where the difference
/// exceeds both `mm` and the part `relative` of the radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadiusRule {
    pub mm: f64,
    /// As `mm`, in a program in inches.
    pub mm_in_inches: f64,
    pub relative: f64,
    pub most_mm: f64,
}

/// Variables, expressions and jumps that a control reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    None,
    /// Custom macro B.
    Fanuc,
    /// O words.
    LinuxCnc,
}

/// What a control makes of its words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    pub name: &'static str,
    pub family: Family,
    pub without_point: WithoutPoint,
    /// Whether another setting of the control would read numbers without a point in another way.
    pub points_matter: bool,
    pub dwell: DwellTime,
    /// Whether controls of this dialect disagree on a P of G4 without a point.
    pub dwell_is_unsure: bool,
    /// The letters that state the time of G4.
    pub dwell_letters: &'static [u8],
    pub centers: Centers,
    pub radius: RadiusRule,
    pub language: Language,
    /// Whether a factor of G51 without a point counts thousandths.
    pub scales_by_thousandths: bool,
    /// How far above the last peck G83 and G73 stop their rapid, mm.
    pub peck_clearance_mm: f64,
    /// Whether a program needs M2, M30 or percent signs.
    pub needs_end: bool,
    /// Whether the control refuses words that no code of the block uses, and codes that it does not know.
    pub is_strict: bool,
    /// Whether G0 is in force at the start of a program.
    pub starts_rapid: bool,
    /// Whether a rapid along several axes is a straight line whatever the settings of the control. Else each
    /// axis may run at its own speed until it has arrived.
    pub runs_straight: bool,
}

/// Mismatch that LinuxCNC accepts: 0.0011 inch, or 0.1 % of the radius up to a hundred times as much.
const LINUXCNC_RADIUS: RadiusRule =
    RadiusRule { mm: 0.027_94, mm_in_inches: 0.027_94, relative: 1e-3, most_mm: 2.794 };

/// GRBL, `gcode.c`: error 33 above 0.5 mm, and above both 0.005 mm and 0.1 %.
const GRBL_RADIUS: RadiusRule = RadiusRule { mm: 0.005, mm_in_inches: 0.005, relative: 1e-3, most_mm: 0.5 };

/// Fanuc has a parameter (3410). Rounding to three decimals moves the radii apart by up to 0.0022 mm, or by
/// 0.056 mm in a program in inches. A smaller limit would refuse such programs.
const FANUC_RADIUS: RadiusRule = RadiusRule { mm: 0.02, mm_in_inches: 0.06, relative: 1e-3, most_mm: 0.5 };

/// Alarm 14040: machine data 21000 (0.01 mm) and 21010 (0.1 %), of which the larger counts.
const SIEMENS_RADIUS: RadiusRule = RadiusRule { mm: 0.01, mm_in_inches: 0.01, relative: 1e-3, most_mm: 1.0 };
/// TNC 320, *User's Manual*, 340 55x-03, p. 155: the machine parameter circleDeviation.
const KLARTEXT_RADIUS: RadiusRule =
    RadiusRule { mm: 0.016, mm_in_inches: 0.016, relative: 0.0, most_mm: 0.016 };

const FANUC: Control = Control {
    name: "fanuc",
    family: Family::Fanuc,
    without_point: WithoutPoint::Increments,
    points_matter: true,
    dwell: DwellTime::Milliseconds,
    dwell_is_unsure: false,
    dwell_letters: b"PXU",
    centers: Centers::Start,
    radius: FANUC_RADIUS,
    language: Language::Fanuc,
    scales_by_thousandths: true,
    peck_clearance_mm: 1.0,
    needs_end: false,
    is_strict: false,
    starts_rapid: false,
    // Parameter 1401.
    runs_straight: false,
};

const LINUXCNC: Control = Control {
    name: "linuxcnc",
    family: Family::LinuxCnc,
    without_point: WithoutPoint::Units,
    points_matter: false,
    dwell: DwellTime::Seconds,
    dwell_letters: b"P",
    radius: LINUXCNC_RADIUS,
    language: Language::LinuxCnc,
    // `interp_cycles.cc`: 0.010 inch.
    peck_clearance_mm: 0.254,
    needs_end: true,
    is_strict: true,
    runs_straight: true,
    ..FANUC
};

const SIEMENS: Control = Control {
    name: "siemens",
    family: Family::Siemens,
    without_point: WithoutPoint::Units,
    points_matter: false,
    dwell: DwellTime::Seconds,
    dwell_letters: b"F",
    radius: SIEMENS_RADIUS,
    language: Language::None,
    // Without interpolation (RTLIOF) each axis runs at its own speed.
    runs_straight: false,
    ..FANUC
};

/// All controls whose programs are read, by the names of dialects.
pub const CONTROLS: [Control; 10] = [
    LINUXCNC,
    FANUC,
    Control {
        name: "haas",
        dwell: DwellTime::ByPoint,
        dwell_letters: b"P",
        scales_by_thousandths: false,
        ..FANUC
    },
    Control { name: "mazak", ..FANUC },
    Control {
        name: "okuma",
        without_point: WithoutPoint::Units,
        dwell: DwellTime::Seconds,
        dwell_letters: b"FP",
        language: Language::None,
        ..FANUC
    },
    Control {
        name: "iso",
        without_point: WithoutPoint::Units,
        dwell: DwellTime::Seconds,
        dwell_is_unsure: true,
        dwell_letters: b"PX",
        language: Language::None,
        ..FANUC
    },
    Control {
        name: "mach4",
        family: Family::Mach,
        dwell_is_unsure: true,
        centers: Centers::Unsure,
        radius: FANUC_RADIUS,
        language: Language::Fanuc,
        needs_end: false,
        is_strict: false,
        ..LINUXCNC
    },
    Control {
        name: "grbl",
        family: Family::Grbl,
        radius: GRBL_RADIUS,
        language: Language::None,
        needs_end: false,
        starts_rapid: true,
        ..LINUXCNC
    },
    SIEMENS,
    Control {
        name: "heidenhain",
        family: Family::Klartext,
        without_point: WithoutPoint::Units,
        points_matter: false,
        dwell: DwellTime::Seconds,
        radius: KLARTEXT_RADIUS,
        // Q parameters, which `klartext` reads itself.
        language: Language::None,
        // END PGM.
        needs_end: true,
        ..FANUC
    },
];

impl Control {
    /// The control of the dialect called `name`.
    pub fn named(name: &str) -> Option<&'static Control> {
        CONTROLS.iter().find(|control| control.name == name)
    }

    pub fn is(&self, family: Family) -> bool {
        self.family == family
    }
}

impl RadiusRule {
    /// How far the radii of an arc of this radius may differ, mm.
    pub fn allowed_mm(&self, radius_mm: f64, in_inches: bool) -> f64 {
        let plain = if in_inches { self.mm_in_inches } else { self.mm };
        plain.max(self.relative * radius_mm).min(self.most_mm.max(plain))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_arc_may_be_off_by_a_part_of_its_radius() {
        let grbl = Control::named("grbl").unwrap();
        let allowed = [1.0, 100.0, 1e6].map(|radius| grbl.radius.allowed_mm(radius, false));
        assert_eq!(allowed, [0.005, 0.1, 0.5]);
        let siemens = Control::named("siemens").unwrap();
        let allowed = [1.0, 100.0, 1e6].map(|radius| siemens.radius.allowed_mm(radius, false));
        assert_eq!(allowed, [0.01, 0.1, 1.0]);
        let klartext = Control::named("heidenhain").unwrap();
        assert_eq!([1.0, 1e6].map(|radius| klartext.radius.allowed_mm(radius, true)), [0.016; 2]);
        assert!(Control::named("deckel").is_none());
    }
}
