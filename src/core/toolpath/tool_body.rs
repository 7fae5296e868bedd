//! What is told of a tool beside its cutting edge: how long its edges are, how far it sticks out of its
//! holder, the holder, and how fast it may turn. Nothing is assumed of what is not told.
//!
//! # Method
//! A tool that cuts beside a wall has the wall on its side all the way up to the top of the stock. So what is
//! wider than the cutter has to stay above this top. The clear length is the height over the tip up to which
//! nothing of the tool is wider than the cutter, and a cut may be as deep as that.

/// How much wider than the cutter a holder may be and still count as no wider, mm: diameters are decimals.
const SAME_WIDTH_MM: f64 = 1e-6;

/// How much deeper than a length a cut may be and still count as no deeper, mm: depths are differences of
/// heights, which are rounded.
const SAME_DEPTH_MM: f64 = 1e-6;

/// The least and the largest usual feed of a cutting edge, mm. Below, the edge rubs and does not cut; above,
/// no edge lasts.
const USUAL_FEED_PER_TOOTH_MM: [f64; 2] = [0.001, 1.0];

/// A cylinder or a cone about the tool axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolderSection {
    /// Its length along the axis, mm.
    pub length_mm: f64,
    /// Its diameters at the lower and at the upper end, mm.
    pub diameters_mm: [f64; 2],
}

/// What is told of a tool.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ToolBody {
    /// Length of the cutting edges from the tip upwards, mm.
    pub flute_length_mm: Option<f64>,
    /// How far the tool sticks out of its holder, mm.
    pub length_mm: Option<f64>,
    /// Number of cutting edges.
    pub n_flutes: Option<u32>,
    /// The fastest that the tool may turn, 1/min.
    pub max_rpm: Option<f64>,
    /// The sections of the holder, from its lower end upwards.
    pub holder: Vec<HolderSection>,
}

/// The part of a tool that must stay above the stock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Widest {
    /// Its height over the tip, mm.
    pub height_mm: f64,
    /// The section of the holder that becomes wider than the cutter there. `None` for what is above all that
    /// is told.
    pub section: Option<usize>,
}

/// How deep a job cuts, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Depths {
    /// From the top of the stock down to the lowest place of the tip.
    pub whole_mm: f64,
    /// The deepest material that is cut at once; none where that is not known.
    pub at_once_mm: Option<f64>,
}

/// A depth for which the tool is too short.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TooShort {
    #[error("{depth_mm:.3} mm are cut at once, and the cutting edges are {flutes_mm} mm long")]
    Flutes { depth_mm: f64, flutes_mm: f64 },
    #[error(
        "the tip goes {depth_mm:.3} mm below the top of the stock, and the tool is no wider than its cutter only up to {:.3} mm over the tip: the holder would go {:.3} mm below this top",
        widest.height_mm, depth_mm - widest.height_mm
    )]
    Holder { depth_mm: f64, widest: Widest },
}

/// What is legal in the use of a tool and yet often a mistake.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Doubt {
    #[error(
        "the tip goes {depth_mm:.3} mm below the top of the stock, and the cutting edges are {flutes_mm} mm long: the shank moves beside walls"
    )]
    ShankBesideWall { depth_mm: f64, flutes_mm: f64 },
    #[error(
        "each of the {n_flutes} cutting edges takes {feed_mm} mm in a turn; {} to {} mm are usual",
        USUAL_FEED_PER_TOOTH_MM[0], USUAL_FEED_PER_TOOTH_MM[1]
    )]
    FeedPerTooth { feed_mm: f64, n_flutes: u32 },
}

impl ToolBody {
    /// Whether a depth could be too much for what is told.
    pub fn limits_depth(&self) -> bool {
        self.flute_length_mm.is_some() || self.length_mm.is_some()
    }

    /// The lowest part that is wider than a cutter of `diameter_mm`. `None` where the length of the tool is
    /// not told.
    pub fn widest(&self, diameter_mm: f64) -> Option<Widest> {
        let most_mm = diameter_mm + SAME_WIDTH_MM;
        let mut height_mm = self.length_mm?;
        for (k, section) in self.holder.iter().enumerate() {
            let HolderSection { length_mm, diameters_mm: [below, above] } = *section;
            if below > most_mm {
                return Some(Widest { height_mm, section: Some(k) });
            }
            if above > most_mm {
                let share = (diameter_mm - below).max(0.0) / (above - below);
                return Some(Widest { height_mm: height_mm + share * length_mm, section: Some(k) });
            }
            height_mm += length_mm;
        }
        Some(Widest { height_mm, section: None })
    }

    /// All that is too short for a cutter of `diameter_mm` that cuts to these depths.
    pub fn too_short(&self, diameter_mm: f64, depths: &Depths) -> Vec<TooShort> {
        let depth_mm = depths.whole_mm;
        let holder = self
            .widest(diameter_mm)
            .filter(|widest| depth_mm > widest.height_mm + SAME_DEPTH_MM)
            .map(|widest| TooShort::Holder { depth_mm, widest });
        let flutes = self.flute_length_mm.zip(depths.at_once_mm);
        let flutes = flutes
            .filter(|(flutes_mm, depth_mm)| *depth_mm > flutes_mm + SAME_DEPTH_MM)
            .map(|(flutes_mm, depth_mm)| TooShort::Flutes { depth_mm, flutes_mm });
        flutes.into_iter().chain(holder).collect()
    }

    /// The doubt about a job whose depth is more than the length of the cutting edges.
    pub fn doubt_of_depth(&self, depths: &Depths) -> Option<Doubt> {
        let (flutes_mm, depth_mm) = (self.flute_length_mm?, depths.whole_mm);
        (depth_mm > flutes_mm + SAME_DEPTH_MM).then_some(Doubt::ShankBesideWall { depth_mm, flutes_mm })
    }

    /// The doubt about a feed in mm/min at a speed in 1/min. `None` where the number of cutting edges is not
    /// told.
    pub fn doubt_of_feed(&self, feed_mm_per_min: f64, rpm: f64) -> Option<Doubt> {
        let n_flutes = self.n_flutes?;
        let feed_mm = feed_mm_per_min / (rpm * f64::from(n_flutes));
        let [least, most] = USUAL_FEED_PER_TOOTH_MM;
        (!(least..=most).contains(&feed_mm)).then_some(Doubt::FeedPerTooth { feed_mm, n_flutes })
    }

    /// What a setter has to see to before the program runs, for the header of the program and the sheet.
    /// `None` where nothing is told.
    pub fn note(&self) -> Option<String> {
        let lengths = [("STICKS OUT", self.length_mm), ("FLUTES", self.flute_length_mm)]
            .map(|(name, length)| length.map(|mm| format!("{name} {mm} MM")));
        let edges = self.n_flutes.map(|n_flutes| format!("CUTTING EDGES {n_flutes}"));
        let speed = self.max_rpm.map(|rpm| format!("AT MOST {rpm} RPM"));
        let parts: Vec<String> = lengths.into_iter().chain([edges, speed]).flatten().collect();
        (!parts.is_empty()).then(|| format!("TOOL {}", parts.join(" - ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIAMETER_MM: f64 = 10.0;

    fn section(length_mm: f64, below: f64, above: f64) -> HolderSection {
        HolderSection { length_mm, diameters_mm: [below, above] }
    }

    fn body(holder: &[HolderSection]) -> ToolBody {
        ToolBody { length_mm: Some(40.0), holder: holder.to_vec(), ..ToolBody::default() }
    }

    fn whole(whole_mm: f64) -> Depths {
        Depths { whole_mm, at_once_mm: None }
    }

    #[test]
    fn a_tool_is_clear_up_to_where_its_holder_becomes_wider_than_the_cutter() {
        let of = |holder: &[HolderSection]| body(holder).widest(DIAMETER_MM).unwrap();
        assert_eq!(of(&[]), Widest { height_mm: 40.0, section: None });
        assert_eq!(of(&[section(30.0, 25.0, 25.0)]), Widest { height_mm: 40.0, section: Some(0) });
        // A cone from 8 to 12 mm is as wide as the cutter in its middle.
        let slender = [section(6.0, 10.0, 10.0), section(20.0, 8.0, 12.0), section(9.0, 50.0, 50.0)];
        assert_eq!(of(&slender), Widest { height_mm: 56.0, section: Some(1) });
        assert_eq!(of(&slender[..1]), Widest { height_mm: 46.0, section: None });
        // A cone that is wide below is wide from its lower end on.
        assert_eq!(of(&[section(20.0, 12.0, 8.0)]), Widest { height_mm: 40.0, section: Some(0) });
    }

    #[test]
    fn a_holder_is_refused_as_soon_as_it_goes_below_the_top_and_not_before() {
        let body = body(&[section(30.0, 25.0, 25.0)]);
        assert_eq!(body.too_short(DIAMETER_MM, &whole(40.0)), []);
        let widest = Widest { height_mm: 40.0, section: Some(0) };
        let expected = [TooShort::Holder { depth_mm: 40.01, widest }];
        assert_eq!(body.too_short(DIAMETER_MM, &whole(40.01)), expected);
        assert_eq!(body.too_short(25.0, &whole(40.01)), [], "a cutter as wide as its holder");
        assert_eq!(ToolBody::default().too_short(DIAMETER_MM, &whole(1e6)), [], "nothing is told");
    }

    #[test]
    fn flutes_limit_what_is_cut_at_once_and_doubt_the_whole_depth() {
        let body = ToolBody { flute_length_mm: Some(12.0), ..ToolBody::default() };
        let at_once = |at_once_mm| Depths { whole_mm: 20.0, at_once_mm: Some(at_once_mm) };
        assert_eq!(body.too_short(DIAMETER_MM, &at_once(12.0)), []);
        let expected = [TooShort::Flutes { depth_mm: 12.5, flutes_mm: 12.0 }];
        assert_eq!(body.too_short(DIAMETER_MM, &at_once(12.5)), expected);
        let doubt = Doubt::ShankBesideWall { depth_mm: 20.0, flutes_mm: 12.0 };
        assert_eq!(body.doubt_of_depth(&at_once(4.0)), Some(doubt));
        assert_eq!(body.doubt_of_depth(&whole(12.0)), None);
    }

    #[test]
    fn a_feed_per_tooth_is_doubted_outside_a_thousandth_to_one_millimetre() {
        let body = ToolBody { n_flutes: Some(4), ..ToolBody::default() };
        let is_doubted = |feed: f64| body.doubt_of_feed(feed, 1000.0).is_some();
        let of = [3.9, 4.0, 800.0, 4000.0, 4001.0].map(is_doubted);
        assert_eq!(of, [true, false, false, false, true]);
        assert_eq!(ToolBody::default().doubt_of_feed(1e6, 1.0), None);
    }

    #[test]
    fn only_what_is_told_is_noted() {
        assert_eq!(ToolBody::default().note(), None);
        let body = ToolBody { n_flutes: Some(3), length_mm: Some(32.5), ..ToolBody::default() };
        assert_eq!(body.note().unwrap(), "TOOL STICKS OUT 32.5 MM - CUTTING EDGES 3");
    }
}
