//! What the text of a program does not say, as the query of a request.

use utoipa::IntoParams;

use super::{Compensation, WithoutPoint, control_of};
use crate::http::decode::query::{FromQuery, Parameters};
use crate::http::dto::check::Range;
use crate::http::dto::dialect::DialectName;
use toolpathd_core::toolpath::program::Units;

/// What the text of a program does not say: the query of a body that is NC text. With a body of JSON a
/// member of the body counts before the parameter of the same name.
#[derive(Debug, Clone, Default, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct ReadQuery {
    /// Name of the control's dialect, as listed by `/v1/dialects`. `deckel` is not
    /// read. Default: `linuxcnc`.
    #[param(value_type = Option<DialectName>)]
    pub(super) dialect: Option<String>,
    /// Unit of lengths before the first G20 or G21. Default: `mm`, and the answer warns.
    #[param(inline)]
    pub(super) units: Option<Units>,
    /// What a length without a decimal point means. Default: `increments` for `fanuc`, `haas` and `mazak`,
    /// `units` for the others.
    #[param(inline)]
    pub(super) without_point: Option<WithoutPoint>,
    /// Where the tip of the tool stands before the first block: three numbers in mm, separated by commas.
    /// Default: not known.
    #[param(value_type = Option<String>)]
    pub(super) start: Option<[f64; 3]>,
    /// Whether blocks behind a slash are left out. Default: they run.
    pub(super) block_delete: Option<bool>,
    /// What G41 and G42 mean. Default: `refuse`.
    #[param(inline)]
    pub(super) compensation: Option<Compensation>,
    /// Radius of the cutter for `compensation=compute`, in mm.
    #[param(minimum = 0.001, maximum = 1_000_000)]
    pub(super) cutter_radius_mm: Option<f64>,
    /// Speed of rapids, in mm/min. Default: 10000.
    #[param(minimum = 0.001, maximum = 1_000_000)]
    pub(super) rapid_feed_mm_per_min: Option<f64>,
    /// Whether the JSON answer holds the modal state behind each block that has run, of the first 200000
    /// blocks. Default: `false`.
    pub(super) trace: Option<bool>,
}

impl FromQuery for ReadQuery {
    const NAMES: &'static [&'static str] = &[
        "dialect",
        "units",
        "without_point",
        "start",
        "block_delete",
        "compensation",
        "cutter_radius_mm",
        "rapid_feed_mm_per_min",
        "trace",
    ];

    fn read(sent: &Parameters) -> Result<Self, String> {
        let start = sent.text("start")?.map(place).transpose()?;
        let dialect = sent.text("dialect")?.map(str::to_owned);
        if let Some(name) = &dialect {
            control_of(Some(name))
                .map_err(|(_, detail)| format!("the query parameter `dialect`: {detail}"))?;
        }
        let rapid = sent.number("rapid_feed_mm_per_min")?;
        if let Some(rapid) = rapid.filter(|rapid| !Range::POSITIVE.holds(*rapid)) {
            return Err(format!("`rapid_feed_mm_per_min` is {rapid}; send 0.001 to 1000000 mm/min"));
        }
        let radius = sent.number("cutter_radius_mm")?;
        if let Some(radius) = radius.filter(|radius| !Range::POSITIVE.holds(*radius)) {
            return Err(format!("`cutter_radius_mm` is {radius}; send 0.001 to 1000000 mm"));
        }
        Ok(Self {
            dialect,
            units: sent.name("units")?,
            without_point: sent.name("without_point")?,
            start,
            block_delete: sent.flag("block_delete")?,
            compensation: sent.name("compensation")?,
            cutter_radius_mm: radius,
            rapid_feed_mm_per_min: rapid,
            trace: sent.flag("trace")?,
        })
    }
}

/// Three coordinates of a query.
fn place(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let place = numbers.ok().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    place
        .filter(|place| place.iter().all(|x| Range::COORDINATE.holds(*x)))
        .ok_or_else(|| "the query parameter `start` must be three numbers in mm, such as `0,0,50`".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_a_query_is_three_numbers() {
        assert_eq!(place("1, -2,3.5"), Ok([1.0, -2.0, 3.5]));
        assert!(
            ["", "1,2", "1,2,3,4", "1,2,x", "1,2,1e9", "1,2,NaN"].iter().all(|text| place(text).is_err())
        );
    }
}
