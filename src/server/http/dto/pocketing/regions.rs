//! Several regions in one request for pockets, and the order in which they are cut.

use crate::config::Limits;
use crate::http::dto::check::Violations;
use crate::http::dto::outline::{MOST_REGIONS, Region};
use crate::http::dto::schema::{array_of, reference, schema_of};
use crate::http::error::FieldCode;
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::segment::Segment;
use toolpathd_core::operations::pocketing::{LevelOrder, Outlines, Regions, Sequence};

schema_of!(RegionList of Region, "Pockets of the same floor.", {
    array_of(reference::<Region>(), 1, MOST_REGIONS)
});

/// The members of a request that are about several regions.
pub struct SentRegions {
    pub regions: Option<Vec<Region>>,
    pub order: Option<LevelOrder>,
    pub sequence: Option<Sequence>,
}

impl SentRegions {
    pub fn are_sent(&self) -> bool {
        self.regions.is_some()
    }

    /// Checks which members stand beside each other. The flags say whether `region`, `heights` and `surface`
    /// are sent.
    pub fn check(&self, [has_region, has_heights, has_surface]: [bool; 3], violations: &mut Violations) {
        let root = Pointer::root();
        if self.are_sent() {
            let flat =
                "`regions` have upright walls and a flat floor: send one `region` instead, or leave this out";
            let others = [
                ("region", has_region, "send `region` or `regions`, not both"),
                ("heights", has_heights, flat),
                ("surface", has_surface, flat),
            ];
            for (name, _, detail) in others.into_iter().filter(|(_, is_sent, _)| *is_sent) {
                violations.add(&root.field(name), FieldCode::Conflict, detail);
            }
            return;
        }
        let of_regions = [("order", self.order.is_some()), ("sequence", self.sequence.is_some())];
        for (name, _) in of_regions.into_iter().filter(|(_, is_sent)| *is_sent) {
            let detail = "this member belongs to `regions`; leave it out";
            violations.add(&root.field(name), FieldCode::Conflict, detail);
        }
    }

    /// The warnings of bulges of more than a half circle.
    pub fn remarks(&self) -> Vec<Warning> {
        let at = Pointer::root().field("regions");
        let regions = self.regions.iter().flatten().enumerate();
        regions.filter_map(|(k, region)| region.remark(&at.index(k))).collect()
    }

    /// The regions in the core's terms. Adds their open edges to `open`, and violations to `violations`.
    pub fn convert(
        self,
        limits: &Limits,
        open: &mut Vec<Segment>,
        violations: &mut Violations,
    ) -> Option<Regions> {
        let Self { regions, order, sequence } = self;
        let regions = regions?;
        let at = Pointer::root().field("regions");
        if regions.is_empty() {
            violations.add(&at, FieldCode::WrongLength, "the list is empty; send at least one region");
        }
        if regions.len() > MOST_REGIONS {
            let detail = format!("there are {} regions; send at most {MOST_REGIONS}", regions.len());
            violations.add(&at, FieldCode::LimitExceeded, detail);
            return None;
        }
        let total: usize = regions.iter().map(Region::n_vertices).sum();
        if !violations.count_of_points(&at, total, 0, limits.curve_points) {
            return None;
        }
        let convert = |(k, region): (usize, Region)| {
            let (outlines, own) = region.convert_with_open(&at.index(k), limits, violations);
            open.extend(own);
            outlines
        };
        let all: Vec<Outlines> = regions.into_iter().enumerate().map(convert).collect();
        let (order, sequence) = (order.unwrap_or_default(), sequence.unwrap_or_default());
        Some(Regions { all, order, sequence })
    }
}
