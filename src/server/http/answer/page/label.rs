//! Turns the names of fields into words with a unit: `cutting_length_mm` becomes "cutting length" in mm.

use toolpathd_plot::text::{clean, escape};

/// Ends of names that are units. The first end that fits counts, so an end stands before any shorter end that
/// it contains.
const UNITS: [(&str, &str); 15] = [
    ("_mm_per_min", "mm/min"),
    ("_mm_per_s2", "mm/s\u{b2}"),
    ("_mm_per_s3", "mm/s\u{b3}"),
    ("_mm_per_s", "mm/s"),
    ("_deg_per_s", "\u{b0}/s"),
    ("_per_mm", "1/mm"),
    ("_mm2", "mm\u{b2}"),
    ("_mm3", "mm\u{b3}"),
    ("_mm", "mm"),
    ("_deg", "\u{b0}"),
    ("_rpm", "rpm"),
    ("_percent", "%"),
    ("_bytes", "bytes"),
    ("_ms", "ms"),
    ("_s", "s"),
];

/// Words that are written in capitals.
const CAPITALS: [&str; 5] = ["cc", "cl", "id", "nc", "url"];

/// Names whose words alone do not say of what they speak.
const OWN_WORDS: [(&str, &str); 4] = [
    ("deviation_max_mm", "max deviation from what was sent"),
    ("deviation_max_deg", "max deviation of the tool axis from what was sent"),
    ("toolpath_deviation_max_mm", "max deviation of the moves from what was sent"),
    ("toolpath_deviation_max_deg", "max deviation of the axis of the moves from what was sent"),
];

/// The name of a field as people read it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// The words of the name, escaped for HTML.
    pub words: String,
    pub unit: Option<&'static str>,
    /// Whether the value is an upper bound, so that it is rounded upward only.
    pub is_bound: bool,
}

impl Label {
    pub fn of(name: &str) -> Self {
        let (stem, unit) = UNITS
            .iter()
            .find_map(|(end, unit)| name.strip_suffix(end).map(|stem| (stem, Some(*unit))))
            .unwrap_or((name, None));
        // The field `bounds` is a box in mm, and its name has no unit.
        let unit = if name == "bounds" { Some("mm") } else { unit };
        let stem = stem.strip_prefix("n_").unwrap_or(stem);
        let is_bound = stem.ends_with("_max");
        let stem = match stem.strip_suffix("_max") {
            Some(what) => format!("max_{what}"),
            None => stem.to_owned(),
        };
        let own = OWN_WORDS.iter().find(|(own, _)| *own == name).map(|(_, words)| (*words).to_owned());
        let words = own.unwrap_or_else(|| stem.split('_').map(word).collect::<Vec<String>>().join(" "));
        Self { words: escape(&clean(&words)), unit, is_bound }
    }
}

fn word(word: &str) -> String {
    if CAPITALS.contains(&word) { word.to_uppercase() } else { word.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words_and_units() {
        for (name, words, unit) in [
            ("cutting_length_mm", "cutting length", Some("mm")),
            ("n_cl_points", "CL points", None),
            ("feed_mm_per_min", "feed", Some("mm/min")),
            ("uncut_area_mm2", "uncut area", Some("mm\u{b2}")),
            ("curvature_max_concave_per_mm", "curvature max concave", Some("1/mm")),
            ("total_time_s", "total time", Some("s")),
            ("n_passes", "passes", None),
            ("gouge_max_mm", "max gouge", Some("mm")),
            ("deviation_max_mm", "max deviation from what was sent", Some("mm")),
            ("bounds", "bounds", Some("mm")),
            ("a<b", "a&lt;b", None),
        ] {
            let label = Label::of(name);
            assert_eq!((label.words.as_str(), label.unit), (words, unit), "{name}");
        }
        assert!(Label::of("gouge_max_mm").is_bound && !Label::of("z_mm").is_bound);
    }
}
