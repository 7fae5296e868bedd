// Reads the names of members: their words and their units, such as `plunge_feed_mm_per_min`.

/** Units as names write them. @type {Record<string, string>} */
const UNITS = {
  mm: "mm", mm2: "mm²", mm3: "mm³", um: "µm", inch: "inch", deg: "°", s: "s", ms: "ms", min: "min", rpm: "1/min",
  hz: "Hz", kw: "kW", w: "W", percent: "%", bytes: "bytes",
};
/** Units as the service writes them in texts. @type {Record<string, string>} */
const WRITTEN = {
  mm: "mm", s: "s", degrees: "°", milliseconds: "ms", "mm/min": "mm/min", "mm/s": "mm/s", "1/min": "1/min",
  "mm/s2": "mm/s²", "mm/s3": "mm/s³", "degrees by s": "°/s", "degrees by s2": "°/s²", "degrees by s3": "°/s³",
};
/** What a unit is divided by. @type {Record<string, string>} */
const PARTS = { min: "min", s: "s", s2: "s²", s3: "s³", tooth: "tooth", rev: "rev", mm: "mm" };

const ENDING =
  /(?:^|_)(mm[23]?|um|inch|deg|m?s|min|rpm|hz|k?w|percent|bytes)(?:_per_(min|s[23]?|tooth|rev|mm))?$|_per_(mm|min|s)$/;

/** Words of names that are abbreviations, written in capitals. */
const CAPITALS = /\b(nc|cl|rpm|id)\b/g;

/** Units of members of reports whose names tell none. @type {Record<string, string>} */
const QUANTITIES = {
  speed: "mm/s", acceleration: "mm/s²", jerk: "mm/s³", at: "mm", centroid: "mm", end: "mm", bounds: "mm",
};
/** Members that hold coordinates. */
const PLACES = /^(?:bounds|centroid|end)$|(?:^|_)(?:at|z_mm)$/;
/** Figures that have the unit of the member around them. */
const FIGURES = new Set(["bound", "found", "least", "most", "rms", "max", "min"]);

/**
 * A readable name, without the unit that the name ends with.
 * @param {string} name  such as `plunge_feed_mm_per_min`
 * @returns {string}  such as `Plunge feed`
 */
export function labelOf(name) {
  const short = name.startsWith("n_") ? name : name.replace(ENDING, "");
  const bare = short === "" || short === "max" || short === "min" ? name : short;
  const words = bare.replace(/^n_/, "number_of_").replaceAll("_", " ")
    .replace(CAPITALS, (word) => word.toUpperCase());
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/**
 * The unit that a name ends with. Numbers of things (`n_bytes`) have none.
 * @param {string} name
 * @returns {string}  empty where the name tells none
 */
export function unitInName(name) {
  const [ending, unit, part, inverse] = ENDING.exec(name) ?? [];
  if (!ending?.startsWith("_") || name.startsWith("n_")) return "";
  return inverse ? `1/${PARTS[inverse]}` : `${UNITS[unit ?? ""]}${part ? `/${PARTS[part]}` : ""}`;
}

/**
 * The unit that a text of the service tells.
 * @param {string} words  such as `degrees by s`
 * @returns {string}  such as `°/s`; empty for an unknown one
 */
export const unitInWords = (words) => WRITTEN[words] ?? "";

/**
 * The unit of a member of a report.
 * @param {string} name
 * @param {string} outer  unit of the member around it
 * @returns {string}  empty where there is none
 */
export function unitInReport(name, outer) {
  const own = unitInName(name) || QUANTITIES[name] || (name.endsWith("_at") ? "mm" : "");
  return own || (FIGURES.has(name) ? outer : "");
}

/** Whether a member of a report holds places, not lengths. @param {string} name */
export const isPlace = (name) => PLACES.test(name);

/**
 * The unit of a rotary axis in place of the unit of a linear axis.
 * @param {string} unit  such as `mm/s`
 * @returns {string}  such as `°/s`
 */
export const turning = (unit) => unit.replace(/^mm(?=\/|$)/, "°");
