//! The request to plan a pocket, and its conversion to a job.

mod cleared;
mod entry;
mod finish;
mod regions;
mod relief;

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::cutting::Cutting;
use super::machine_abilities::MachineAbilities;
use super::meta::{Meta, MetaTexts};
use super::outline::Region;
use super::program::Program;
use super::schema::{array_of, reference, schema_of};
use super::setup::{self, JobWithSetup, SentSetup};
use super::surface::Surface;
use super::tool::Tool;
use super::verification::Solid;
use crate::config::Limits;
use crate::http::decode::files::FileReading;
use crate::http::decode::{IntoJob, object};
use crate::http::error::{ApiError, FieldCode};
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
pub use cleared::Cleared;
use entry::PocketEntry;
use finish::{PocketFinishing, PocketLead, SentFinish};
use regions::{RegionList, SentRegions};
use relief::{Heights, IslandsBy, SentRelief};
use toolpathd_core::operations::pocketing::{
    self as core, ChooseBy, LevelOrder, Milling, Only, Pattern, Sequence,
};

/// A pocket to be cleared.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PocketRequest {
    /// The wall of the pocket and its islands. Required without `regions`, `heights` and `surface`. With one
    /// of the last two, everything outside the region stays. Default: the rectangle of `heights`, or the
    /// outline of `surface`.
    region: Option<Region>,
    /// Several pockets of the same floor, in place of `region`, `heights` and `surface`. Regions that
    /// overlap, or touch along a stretch, are cut as one pocket; those that only meet in a point stay apart.
    /// An island stays in its own region: another region that reaches across the island's edge cuts it, and
    /// the answer warns.
    #[schema(value_type = Option<RegionList>)]
    regions: Option<Vec<Region>>,
    /// In which order the levels of `regions` are cut. Default: `depth_first`.
    order: Option<LevelOrder>,
    /// In which sequence `regions` are cut. Default: `least_travel`.
    sequence: Option<Sequence>,
    /// Measured heights of the part. On each level, places that are higher than the level's floor stay.
    #[serde(default, deserialize_with = "object::optional")]
    heights: Option<Heights>,
    /// The surface of the part, without overhangs. On each level, places that are higher than the level's
    /// floor stay.
    surface: Option<Surface>,
    /// How islands are found in `heights` or `surface`.
    #[serde(default)]
    #[schema(default = "slicing")]
    islands_by: IslandsBy,
    /// Spacing of the grid on which `islands_by: labelling` samples a surface, in mm. Default: a tenth of the
    /// cutter's diameter.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    cell_mm: Option<f64>,
    /// Where material stands: a solid, whose top is the default of `top_z_mm`. What of the pocket is outside
    /// the stock is air. An edge that is open counts as closed where stock stands in front of it. Default:
    /// all of the pocket is material, and nothing stands in front of open edges.
    stock: Option<Solid>,
    /// What earlier tools have emptied. Only the material that is left is cut.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<ClearedList>)]
    cleared: Option<Vec<Cleared>>,
    /// Height of the stock's top, in mm. Default: 0; with `heights` or `surface` their highest point.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    top_z_mm: Option<f64>,
    /// Height of the pocket's floor, in mm; below `top_z_mm`.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    floor_z_mm: f64,
    /// Largest depth of a level, in mm. There are as few levels as this allows; a thousandth of a mm more is
    /// allowed too. They are equally deep, unless `roughing_allowance_mm` makes some less deep. The last
    /// level ends on the floor.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    stepdown_max_mm: f64,
    /// What stays on walls and islands for finishing, in mm.
    #[schema(minimum = 0, maximum = 1_000_000, default = 0)]
    allowance_mm: Option<f64>,
    /// What stays on the floor for finishing, in mm.
    #[schema(minimum = 0, maximum = 1_000_000, default = 0)]
    floor_allowance_mm: Option<f64>,
    /// How walls and floor are finished by the same tool after roughing. Default: what is left stays.
    #[serde(default, deserialize_with = "object::optional")]
    finish: Option<PocketFinishing>,
    /// `roughing`: `finish` is left out. `finishing`: only `finish` is done; the pocket is taken to be
    /// roughed to the allowances by a tool that is no larger. Default: both.
    only: Option<Only>,
    /// How passes along walls and islands begin and end. Default: the defaults of all members.
    #[serde(default, deserialize_with = "object::optional")]
    lead: Option<PocketLead>,
    /// How far entries, lifts, links and rapids keep away from walls and islands, in mm, beside the cutter's
    /// radius and the allowance. Where there is no room for it, they keep away as far as the room allows, and
    /// the answer warns. Default: a fiftieth of the cutter's diameter, and at least 0.2 mm.
    #[schema(minimum = 0, maximum = 1_000_000)]
    clearance_side_mm: Option<f64>,
    /// Thickest material that a level may leave on slopes of `heights` or `surface`, in mm, at a right angle
    /// to the slope. Levels are then as deep as this limit and `stepdown_max_mm` allow. A level ends on a
    /// horizontal plane of the part if more than this limit would stay on the plane. Default: no limit.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    roughing_allowance_mm: Option<f64>,
    /// The cutter: `flat`.
    #[serde(deserialize_with = "object::required")]
    tool: Tool,
    /// Largest distance of neighbouring passes, in mm; at most the cutter's diameter.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    stepover_mm: f64,
    /// The patterns among which each level chooses. Default: all.
    #[schema(value_type = Option<Patterns>)]
    patterns: Option<Vec<Pattern>>,
    /// The figure that the chosen pattern has least.
    #[serde(default)]
    #[schema(default = "time")]
    choose_by: ChooseBy,
    /// How the cutter comes down into the material. Default: the defaults of all members.
    #[serde(default, deserialize_with = "object::optional")]
    entry: Option<PocketEntry>,
    /// The side on which the material is. `climb`: on the right of the cutter, seen along the feed.
    /// `conventional`: on the left. Rows to and fro have it on both sides in turn.
    #[serde(default)]
    #[schema(default = "climb")]
    direction: Milling,
    /// What the machine can do. Default: nothing is assumed.
    #[serde(default, deserialize_with = "object::required")]
    machine: MachineAbilities,
    /// Feeds, spindle, coolant and heights.
    #[serde(deserialize_with = "object::required")]
    cutting: Cutting,
    /// How the NC program is written. Default: for LinuxCNC in mm.
    #[serde(default, deserialize_with = "object::required")]
    program: Program,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer,
    /// the header of the program and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

schema_of!(Patterns of Pattern, "Patterns, each once.", { array_of(reference::<Pattern>(), 1, 7) });

schema_of!(ClearedList of Cleared, "Emptied places.", {
    array_of(reference::<Cleared>(), 0, MOST_CLEARED)
});

/// The most emptied places.
const MOST_CLEARED: usize = 1000;

impl IntoJob for PocketRequest {
    type Job = JobWithSetup<core::Job>;

    fn read_files(&mut self, reading: &mut FileReading) {
        let root = Pointer::root();
        if let Some(surface) = &mut self.surface {
            surface.read_file(&root.field("surface"), reading);
        }
        if let Some(region) = &mut self.region {
            region.read_file(&root.field("region"), reading);
        }
        if let Some(regions) = &mut self.regions {
            Region::read_files(regions, &root.field("regions"), reading);
        }
    }

    fn put_right(&mut self, limits: &Limits) -> Vec<Warning> {
        self.surface.as_mut().map(|surface| surface.put_right(limits)).unwrap_or_default()
    }

    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError> {
        let Self {
            region,
            regions,
            order,
            sequence,
            heights,
            surface,
            islands_by,
            cell_mm,
            stock,
            cleared,
            top_z_mm,
            floor_z_mm,
            stepdown_max_mm,
            allowance_mm,
            floor_allowance_mm,
            finish,
            only,
            lead,
            clearance_side_mm,
            roughing_allowance_mm,
            tool,
            stepover_mm,
            patterns,
            choose_by,
            entry,
            direction,
            machine,
            cutting,
            program,
            meta,
        } = self;
        let root = Pointer::root();
        let finish = SentFinish { allowance_mm, floor_allowance_mm, finish, only, lead, clearance_side_mm };
        let mut violations = Violations::default();
        let regions = SentRegions { regions, order, sequence };
        let others = [region.is_some(), heights.is_some(), surface.is_some()];
        regions.check(others, &mut violations);
        let sent = SentRelief {
            surface,
            heights,
            islands_by,
            cell_mm,
            roughing_allowance_mm,
            has_region: region.is_some() || regions.are_sent(),
        };
        let (relief, islands_by) = sent.convert(tool.diameter_mm(), limits, &mut violations);
        let mut remarks: Vec<Warning> =
            region.iter().filter_map(|region| region.remark(&root.field("region"))).collect();
        remarks.extend(regions.remarks());
        let at_cleared = root.field("cleared");
        let of_cleared = cleared.iter().flatten().enumerate();
        remarks.extend(of_cleared.filter_map(|(k, cleared)| cleared.remark(&at_cleared.index(k))));
        let at_region = root.field("region");
        let area = region.map(|region| region.convert_with_open(&at_region, limits, &mut violations));
        let (area, mut open) = area.map_or((None, Vec::new()), |(area, open)| (Some(area), open));
        let regions = regions.convert(limits, &mut open, &mut violations);
        if relief.is_some() && !open.is_empty() {
            let detail =
                "open edges go with upright walls alone: leave `open` out, or `heights` and `surface`";
            violations.add(&at_region.field("open"), FieldCode::Conflict, detail);
        }
        if area.is_none() && regions.is_none() && stock.is_some() {
            let detail = "send the `region` that is cut out of the stock";
            violations.add(&root.field("stock"), FieldCode::Conflict, detail);
        }
        let (stock, top_z_mm) = stock_of(stock, top_z_mm, limits, &mut violations);
        let cleared = emptied(cleared.unwrap_or_default(), limits, &mut violations);
        let checked_tool = tool.convert(&root.field("tool"), &mut violations);
        if !tool.is_flat() {
            let detail = "a pocket has a flat floor: send a tool of `shape: flat`";
            violations.add(&root.field("tool").field("shape"), FieldCode::Unsupported, detail);
        }
        violations.optional(&root.field("top_z_mm"), top_z_mm, Range::COORDINATE, "mm");
        violations.number(&root.field("floor_z_mm"), floor_z_mm, Range::COORDINATE, "mm");
        // The default top of a relief is not known before the relief is computed.
        let top = top_z_mm.or(relief.is_none().then_some(0.0));
        if let Some(top) = top.filter(|top| floor_z_mm >= *top) {
            let detail = format!("the floor at {floor_z_mm} mm is not below the top at {top} mm");
            violations.add(&root.field("floor_z_mm"), FieldCode::OutOfRange, detail);
        }
        let finish = finish.convert(tool.diameter_mm(), top.map(|top| top - floor_z_mm), &mut violations);
        violations.number(&root.field("stepdown_max_mm"), stepdown_max_mm, Range::POSITIVE, "mm");
        let stepovers = Range { max: tool.diameter_mm(), ..Range::POSITIVE };
        violations.number(&root.field("stepover_mm"), stepover_mm, stepovers, "mm");
        let patterns =
            patterns.map(|patterns| checked_patterns(&root.field("patterns"), patterns, &mut violations));
        let entry = PocketEntry::convert(entry, &root.field("entry"), tool.diameter_mm(), &mut violations);
        if entry.at.is_some() && finish.only == Some(Only::Finishing) && finish.finish.floor.is_none() {
            let detail = "only walls are finished, and the cutter comes down beside them: leave `at` out";
            violations.add(&root.field("entry").field("at"), FieldCode::Conflict, detail);
        }
        let sent =
            SentSetup { tool: Some(checked_tool), body: tool.body(), cutting: Some(cutting), program, meta };
        let (mut setup, cutting, meta) = sent.convert(&mut violations);
        setup.remarks.extend(remarks);
        let max_rpm = machine.max_rpm(&root.field("machine"), &mut violations);
        if let Some(cutting) = &cutting {
            setup::check_machine_speed(cutting, max_rpm, &mut violations);
        }
        let Some(cutting) = cutting else { return Err(violations.into_error()) };
        violations.result()?;
        let job = core::Job {
            area,
            open,
            stock,
            regions,
            relief,
            islands_by,
            cleared,
            top_z_mm,
            floor_z_mm,
            stepdown_max_mm,
            allowance_mm: finish.allowance_mm,
            floor_allowance_mm: finish.floor_allowance_mm,
            finish: finish.finish,
            only: finish.only,
            lead: finish.lead,
            clearance_side_mm: finish.clearance_side_mm,
            roughing_allowance_mm,
            tool: checked_tool,
            stepover_mm,
            patterns: patterns.unwrap_or_else(|| Pattern::ALL.to_vec()),
            choose_by,
            entry,
            milling: direction,
            cutting,
            resolution: setup.program.resolution,
            curves: setup.dialect.curves,
            move_limit: limits.moves,
            comparison_limit: limits.cut_comparisons,
        };
        Ok(JobWithSetup { job, setup, meta })
    }
}

/// The stock, and the height of its top.
fn stock_of(
    stock: Option<Solid>,
    top_z_mm: Option<f64>,
    limits: &Limits,
    violations: &mut Violations,
) -> (Option<core::Standing>, Option<f64>) {
    let Some(stock) = stock else { return (None, top_z_mm) };
    let before = violations.total();
    let stock = stock.stock(&Pointer::root().field("stock"), limits, violations);
    if violations.total() > before {
        return (None, top_z_mm);
    }
    let (outlines, bottom_z_mm, top_mm) = stock.outlines();
    if let Some(sent) = top_z_mm.filter(|sent| *sent != top_mm) {
        let detail = format!("the stock ends at {top_mm} mm, and not at {sent} mm: leave `top_z_mm` out");
        violations.add(&Pointer::root().field("top_z_mm"), FieldCode::Conflict, detail);
    }
    (Some(core::Standing { outlines, bottom_z_mm }), Some(top_mm))
}

fn emptied(cleared: Vec<Cleared>, limits: &Limits, violations: &mut Violations) -> Vec<core::Emptied> {
    let at = Pointer::root().field("cleared");
    if cleared.len() > MOST_CLEARED {
        let detail = format!("there are {} emptied places; send at most {MOST_CLEARED}", cleared.len());
        violations.add(&at, FieldCode::LimitExceeded, detail);
        return Vec::new();
    }
    let convert = |(k, cleared): (usize, Cleared)| cleared.convert(&at.index(k), limits, violations);
    cleared.into_iter().enumerate().flat_map(convert).collect()
}

fn checked_patterns(at: &Pointer, patterns: Vec<Pattern>, violations: &mut Violations) -> Vec<Pattern> {
    if patterns.is_empty() {
        violations.add(at, FieldCode::WrongLength, "the list is empty; send at least one pattern");
    }
    for (k, pattern) in patterns.iter().enumerate() {
        if patterns[..k].contains(pattern) {
            violations.add(&at.index(k), FieldCode::Conflict, "the pattern stands twice; send it once");
        }
    }
    patterns
}
