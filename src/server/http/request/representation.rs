//! The forms of answers, such as JSON, NC text and pictures, with their media types.

use axum::http::HeaderMap;

use super::accept;
use crate::http::error::{ApiError, Code};

pub const JSON: &str = "application/json";
const SVG: &str = "image/svg+xml";
const HTML: &str = "text/html";
pub const GLB: &str = "model/gltf-binary";
pub const STL: &str = "model/stl";
pub const EVENTS: &str = "text/event-stream";

/// The media types that stand for NC text, the preferred type first.
pub const GCODE: [&str; 4] = ["text/x-gcode", "text/x.gcode", "application/x-gcode", "text/plain"];

/// The form of an answer. The query parameter `format` takes these names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Representation {
    Json,
    /// NC text.
    Gcode,
    /// A picture.
    Svg,
    /// The picture with the figures of the answer.
    Html,
    /// Part, stock, cutter and path in three dimensions.
    Glb,
    /// Triangles of the part.
    Stl,
    /// Progress while the computation runs, and then the JSON answer. `format` has no name for events,
    /// because a browser cannot show them behind a link.
    Events,
}

impl Representation {
    pub const ALL: [Self; 7] =
        [Self::Json, Self::Gcode, Self::Svg, Self::Html, Self::Glb, Self::Stl, Self::Events];

    /// The form that `format` calls `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|form| form.name() == Some(name))
    }

    /// The value of `format`. `None` for events.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Json => Some("json"),
            Self::Gcode => Some("gcode"),
            Self::Svg => Some("svg"),
            Self::Html => Some("html"),
            Self::Glb => Some("glb"),
            Self::Stl => Some("stl"),
            Self::Events => None,
        }
    }

    /// The media types that stand for the form, the preferred type first.
    pub fn media_types(self) -> &'static [&'static str] {
        match self {
            Self::Json => &[JSON],
            Self::Gcode => &GCODE,
            Self::Svg => &[SVG],
            Self::Html => &[HTML],
            Self::Glb => &[GLB],
            Self::Stl => &[STL],
            Self::Events => &[EVENTS],
        }
    }
}

/// Chooses one of `offers` by `format`, else by `Accept` (RFC 9110, section 12.5.1), else the first offer.
/// Returns the form and the media type that the caller asked for.
///
/// # Errors
/// `not_acceptable` with the media types on offer.
pub fn choose(
    offers: &[Representation],
    headers: &HeaderMap,
    format: Option<Representation>,
) -> Result<(Representation, &'static str), ApiError> {
    let typed = offers.iter().flat_map(|offer| offer.media_types().iter().map(|name| (*offer, *name)));
    let typed: Vec<_> = typed.collect();
    let names: Vec<_> = typed.iter().map(|(_, name)| *name).collect();
    let chosen = match format {
        Some(format) => typed.iter().find(|(offer, _)| *offer == format),
        None => {
            let best = accept::best(headers, &names);
            typed.iter().find(|(_, name)| Some(*name) == best)
        }
    };
    chosen.copied().ok_or_else(|| {
        ApiError::new(Code::NotAcceptable, format!("accept one of {}", names.join(", "))).offering(names)
    })
}

#[cfg(test)]
mod tests {
    use axum::http::{HeaderValue, header};

    use super::*;

    #[test]
    fn the_query_overrides_the_header() {
        let offers = [Representation::Json, Representation::Gcode];
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT, HeaderValue::from_static("image/svg+xml"));
        let json = (Representation::Json, JSON);
        assert_eq!(choose(&offers, &headers, Some(Representation::Json)), Ok(json));
        for format in [None, Some(Representation::Svg)] {
            let error = choose(&offers, &headers, format).expect_err("not on offer");
            assert_eq!(error.code(), Code::NotAcceptable);
        }
        headers.insert(header::ACCEPT, HeaderValue::from_static("text/plain, */*;q=0.1"));
        assert_eq!(choose(&offers, &headers, None), Ok((Representation::Gcode, "text/plain")));
    }

    #[test]
    fn the_query_names_every_representation_but_events() {
        for (name, form) in [
            ("json", Some(Representation::Json)),
            ("gcode", Some(Representation::Gcode)),
            ("svg", Some(Representation::Svg)),
            ("html", Some(Representation::Html)),
            ("glb", Some(Representation::Glb)),
            ("stl", Some(Representation::Stl)),
            ("events", None),
        ] {
            assert_eq!(Representation::named(name), form);
        }
    }
}
