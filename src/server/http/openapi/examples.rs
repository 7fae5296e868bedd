//! Examples in the contract: bodies of requests, and the answers of the service to some of these bodies.

use serde_json::{Value, json};

use crate::http::request::representation::{GCODE, JSON};

/// The texts of files in a folder of `openapi/`, each with its name. The folder `surfaces-mill` belongs to
/// `/v1/surfaces/mill`, and `five-axis-smooth` to `/v1/five-axis/smooth`.
macro_rules! texts {
    ($root:literal, $extension:literal, { $($folder:literal: [$($name:literal),+ $(,)?]),+ $(,)? }) => {
        &[$($((
            $folder,
            $name,
            include_str!(concat!("../../../../openapi/", $root, "/", $folder, "/", $name, ".", $extension)),
        )),+),+]
    };
}

type Texts = &'static [(&'static str, &'static str, &'static str)];

/// Bodies of requests that the service answers without a problem.
const REQUESTS: Texts = texts!("examples", "json", {
    "arcs-fit": ["contour", "helix", "probed-circle", "section", "sine"],
    "curves-interpolate": ["band-of-x", "in-band", "nurbs", "parabolas", "profile", "sine", "spline"],
    "five-axis-smooth": ["blade", "corner", "program", "rotation", "table", "wave"],
    "parts-inspect": ["bowl", "plate"],
    "pockets-plan": [
        "arcs", "boss", "circle", "comb", "corner-island", "dome", "drawing", "dumbbell", "fillets-above-radius", "fillets-below-radius",
        "hundred-islands", "island", "islands-on-walls", "l-shape", "narrow-gaps", "noisy-outline", "open-slot",
        "rectangle", "regions", "rest", "three-bumps",
    ],
    "programs-read": ["drilling", "loop", "pocket"],
    "programs-write": ["contour", "holes", "inch-fanuc", "leaning", "one-line", "parabolas", "three-operations"],
    "programs-verify": ["clamp", "faults", "pocket"],
    "surfaces-drop": ["bowl", "bull-nose"],
    "surfaces-mill": ["bezier-patches", "cylinder", "die", "freeform", "job-order", "measured", "one-pass", "wire-union"],
    "surfaces-model": ["cylinder", "ferguson", "normal-sweep", "parallel-sweep", "ruled", "sloping-plane"],
});

/// Answers to bodies of the same names.
const ANSWERS: Texts = texts!("answers", "json", {
    "arcs-fit": ["contour"],
    "curves-interpolate": ["nurbs"],
    "five-axis-smooth": ["corner", "table"],
    "pockets-plan": ["circle"],
    "programs-write": ["one-line"],
    "surfaces-drop": ["bull-nose"],
    "surfaces-mill": ["one-pass"],
    "surfaces-model": ["sloping-plane"],
});

/// Programs for bodies of the same names.
const PROGRAMS: Texts = texts!("answers", "ngc", {
    "arcs-fit": ["contour"],
    "curves-interpolate": ["nurbs"],
    "pockets-plan": ["circle"],
    "programs-write": ["one-line"],
    "surfaces-mill": ["one-pass"],
});

/// Answers to requests without a body: the path and the answer.
const SERVICE: [(&str, &str); 3] = [
    ("/v1/dialects", include_str!("../../../../openapi/answers/service/dialects.json")),
    ("/v1/machines", include_str!("../../../../openapi/answers/service/machines.json")),
    ("/v1/limits", include_str!("../../../../openapi/answers/service/limits.json")),
];

const PROBLEM: &str = include_str!("../../../../openapi/answers/service/problem.json");

/// Adds all examples to the contract.
pub fn add(document: &mut Value) {
    let parsed = |text| serde_json::from_str::<Value>(text).unwrap_or_default();
    for (folder, name, text) in REQUESTS {
        let body = &mut document["paths"][path(folder)]["post"]["requestBody"];
        body["content"][JSON]["examples"][name] = json!({ "value": parsed(text) });
    }
    for (folder, name, text) in ANSWERS {
        let answer = &mut document["paths"][path(folder)]["post"]["responses"]["200"];
        answer["content"][JSON]["examples"][name] = json!({ "value": parsed(text) });
    }
    for (folder, name, text) in PROGRAMS {
        let answer = &mut document["paths"][path(folder)]["post"]["responses"]["200"];
        answer["content"][GCODE[0]]["examples"][name] = json!({ "value": text });
    }
    for (path, text) in SERVICE {
        document["paths"][path]["get"]["responses"]["200"]["content"][JSON]["example"] = parsed(text);
    }
    document["components"]["schemas"]["Problem"]["examples"] = json!([parsed(PROBLEM)]);
}

/// The body of an example by its folder and its name.
pub fn example(folder: &str, name: &str) -> Option<&'static str> {
    let found = REQUESTS.iter().find(|(own, called, _)| *own == folder && *called == name);
    found.map(|(_, _, text)| *text)
}

/// The folder of the examples of a path.
pub fn folder(path: &str) -> String {
    path.trim_start_matches("/v1/").replace('/', "-")
}

fn path(folder: &str) -> String {
    let (noun, verb) = folder.rsplit_once('-').unwrap_or((folder, ""));
    format!("/v1/{noun}/{verb}")
}
