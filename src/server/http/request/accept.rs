//! Proactive negotiation by `Accept` and `Accept-Encoding` (RFC 9110, sections 12.5.1 and 12.5.3).

use axum::http::{HeaderMap, HeaderName, header};

/// A media range or a content coding with its weight in thousandths.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Accepted {
    range: String,
    weight: u16,
}

/// Whether the caller accepts gzip, with a weight at least that of uncompressed bytes.
pub fn takes_gzip(headers: &HeaderMap) -> bool {
    let accepted: Vec<Accepted> = elements(headers, header::ACCEPT_ENCODING).collect();
    let weight = |names: &[&str]| {
        let named = accepted.iter().find(|accepted| names.contains(&accepted.range.as_str()));
        named.map(|accepted| accepted.weight)
    };
    let gzip = weight(&["gzip", "x-gzip"]).or(weight(&["*"])).unwrap_or(0);
    // `identity` is acceptable even where the caller does not name it, so without a weight it is no
    // preference.
    gzip > 0 && gzip >= weight(&["identity"]).unwrap_or(0)
}

/// The offer with the largest weight. Among equal weights the offer that the caller asked for most
/// specifically wins, then the earliest. Without `Accept` the first offer wins. `None` when the caller
/// accepts no offer.
pub fn best(headers: &HeaderMap, offers: &[&'static str]) -> Option<&'static str> {
    let ranges = elements(headers, header::ACCEPT).filter(|accepted| accepted.range.contains('/'));
    let accepted: Vec<Accepted> = ranges.collect();
    if accepted.is_empty() {
        // An `Accept` that cannot be read counts as none.
        return offers.first().copied();
    }
    let mut chosen: Option<(&'static str, (u16, u8))> = None;
    for offer in offers {
        let score = weigh(&accepted, offer);
        if score.0 > 0 && chosen.is_none_or(|(_, best)| score > best) {
            chosen = Some((offer, score));
        }
    }
    chosen.map(|(offer, _)| offer)
}

/// Weight and specificity of the most specific range that holds the offer; zeros where no range holds it.
fn weigh(accepted: &[Accepted], offer: &str) -> (u16, u8) {
    let (main, _) = offer.split_once('/').unwrap_or((offer, ""));
    let specificity = |range: &str| match range.split_once('/') {
        _ if range == offer => Some(2),
        Some((main_range, "*")) if main_range == main => Some(1),
        Some(("*", "*")) => Some(0),
        _ => None,
    };
    accepted
        .iter()
        .filter_map(|Accepted { range, weight }| specificity(range).map(|s| (s, *weight)))
        .max_by_key(|&(specificity, _)| specificity)
        .map_or((0, 0), |(specificity, weight)| (weight, specificity))
}

/// The elements of a header, from all of its lines that are text.
fn elements(headers: &HeaderMap, name: HeaderName) -> impl Iterator<Item = Accepted> {
    headers.get_all(name).into_iter().filter_map(|line| line.to_str().ok()).flat_map(parse)
}

fn parse(line: &str) -> impl Iterator<Item = Accepted> {
    line.split(',').filter_map(|element| {
        let mut parts = element.split(';').map(str::trim);
        let range = parts.next()?.to_ascii_lowercase();
        let weight = parts
            .filter_map(|parameter| parameter.split_once('='))
            .find(|(name, _)| name.trim().eq_ignore_ascii_case("q"))
            .map_or(Some(1000), |(_, value)| thousandths(value.trim()));
        weight.map(|weight| Accepted { range, weight })
    })
}

/// A qvalue: 0 or 1 with at most three decimals, at most 1.
fn thousandths(text: &str) -> Option<u16> {
    let (whole, decimals) = text.split_once('.').unwrap_or((text, ""));
    let is_number = decimals.len() <= 3 && decimals.bytes().all(|byte| byte.is_ascii_digit());
    let fraction: u16 = if is_number { format!("{decimals:0<3}").parse().ok()? } else { return None };
    match (whole, fraction) {
        ("0", _) => Some(fraction),
        ("1", 0) => Some(1000),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OFFERS: [&str; 3] = ["application/json", "text/x-gcode", "text/plain"];

    fn chosen(lines: &[&str]) -> Option<&'static str> {
        let mut headers = HeaderMap::new();
        for line in lines {
            headers.append(header::ACCEPT, line.parse().expect("a header"));
        }
        best(&headers, &OFFERS)
    }

    #[test]
    fn the_heaviest_wins_then_the_most_specific_then_the_first() {
        for (lines, expected) in [
            (&[][..], Some("application/json")),
            (&["*/*"], Some("application/json")),
            (&[""], Some("application/json")),
            (&["text/x-gcode"], Some("text/x-gcode")),
            (&["TEXT/X-GCODE"], Some("text/x-gcode")),
            (&["text/*"], Some("text/x-gcode")),
            (&["text/plain, text/*"], Some("text/plain")),
            (&["text/plain;q=0.5, text/x-gcode;q=0.7"], Some("text/x-gcode")),
            (&["text/plain;q=0.5", "text/x-gcode;q=0.4"], Some("text/plain")),
            (&["text/x-gcode, */*;q=0.1"], Some("text/x-gcode")),
            (&["application/json;q=0, */*"], Some("text/x-gcode")),
            (&["text/plain, */*"], Some("text/plain")),
            (&["*/*, application/json;q=0.2"], Some("text/x-gcode")),
            (&["application/json; charset=utf-8; q=1.000"], Some("application/json")),
            (&["text/html, image/*"], None),
            (&["*/*;q=0"], None),
            (&["application/json;q=0"], None),
            (&["text/x-gcode;q=2, text/plain;q=0.001"], Some("text/plain")),
        ] {
            assert_eq!(chosen(lines), expected, "{lines:?}");
        }
    }

    #[test]
    fn gzip_is_used_where_its_weight_is_at_least_that_of_identity() {
        for (lines, expected) in [
            (&[][..], false),
            (&["gzip"], true),
            (&["GZip, deflate, br"], true),
            (&["x-gzip"], true),
            (&["br", "gzip;q=0.001"], true),
            (&["*"], true),
            (&["*;q=0.5, gzip;q=0"], false),
            (&["gzip;q=0"], false),
            (&["br"], false),
            (&[""], false),
            (&["identity, gzip;q=0.5"], false),
            (&["identity;q=0.5, gzip;q=0.5"], true),
            (&["identity;q=0, *"], true),
            (&["gzip;q=nonsense"], false),
        ] {
            let mut headers = HeaderMap::new();
            for line in lines {
                headers.append(header::ACCEPT_ENCODING, line.parse().expect("a header"));
            }
            assert_eq!(takes_gzip(&headers), expected, "{lines:?}");
        }
    }
}
