// Makes labels, units, defaults and column names from what the contract says of a member.

/** @typedef {import("../contract.js").Schema} Schema */

/** @type {Record<string, string>} */
const UNITS = {
  mm: "mm", um: "µm", inch: "inch", deg: "°", s: "s", ms: "ms", min: "min", rpm: "1/min", hz: "Hz",
  kw: "kW", w: "W", percent: "%", bytes: "bytes", degrees: "°", milliseconds: "ms",
  "mm/min": "mm/min", "mm/s": "mm/s", "1/min": "1/min", "mm/s2": "mm/s²", "mm/s3": "mm/s³",
  "degrees by s": "°/s", "degrees by s2": "°/s²", "degrees by s3": "°/s³",
};
/** @type {Record<string, string>} */
const PARTS = { min: "min", s: "s", s2: "s²", s3: "s³", tooth: "tooth", rev: "rev", mm: "mm" };

const SUFFIX = /(?:^|_)(mm|um|inch|deg|m?s|min|rpm|hz|k?w|percent|bytes)(?:_per_(min|s[23]?|tooth|rev|mm))?$/;
const UNIT = /\bin (mm(?:\/(?:min|s[23]?))?|degrees(?: by s[23]?)?|milliseconds|1\/min|s)(?![\w/])/;
const OR_DEGREES = /, or in (degrees(?: by s\d?)?)(?!\w)/;

/** Words of names that are abbreviations, written in capitals. */
const CAPITALS = /\b(nc|cl|rpm|id)\b/g;

/**
 * A readable name, without the unit that the name ends with.
 * @param {string} name  such as `plunge_feed_mm_per_min`
 * @returns {string}  such as `Plunge feed`
 */
export function labelOf(name) {
  const short = name.replace(SUFFIX, "");
  const bare = short === "" || short === "max" || short === "min" ? name : short;
  const words = bare.replace(/^n_/, "number_of_").replaceAll("_", " ")
    .replace(CAPITALS, (word) => word.toUpperCase());
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/**
 * @param {string} label  of a list
 * @returns {string}  the label of one of its entries
 */
export function singular(label) {
  return label.replace(/(ss|ch|sh|x)es$/, "$1").replace(/([^s])s$/, "$1");
}

/**
 * The unit of a member: from its name, else from what is said of it.
 * @param {string} name
 * @param {string[]} texts  descriptions, from the outside inwards
 * @returns {string}  empty where none is told
 */
export function unitOf(name, texts) {
  const [suffix, unit, part] = SUFFIX.exec(name) ?? [];
  if (suffix && suffix.startsWith("_") && unit) return `${UNITS[unit]}${part ? `/${PARTS[part]}` : ""}`;
  for (const text of texts) {
    if (/without a unit/.test(text)) return "";
    const told = UNITS[UNIT.exec(text)?.[1] ?? ""];
    const other = UNITS[OR_DEGREES.exec(text)?.[1] ?? ""];
    if (told) return other ? `${told} or ${other}` : told;
  }
  return "";
}

/**
 * The default of a member as a text.
 * @param {Schema} schema
 * @param {string} help
 * @returns {string}  empty where none is told
 */
export function fallbackOf(schema, help) {
  if (schema.default !== undefined && schema.default !== null) {
    return typeof schema.default === "object" ? JSON.stringify(schema.default) : String(schema.default);
  }
  const told = /\bDefault(?: in a request)?: (.+?)(?:[.;](?=\s|$)|$)/.exec(help)?.[1] ?? "";
  return told.replaceAll("`", "");
}

/**
 * What a description says of each choice, in the form "`name`: what it means."
 * @param {string} help
 * @param {string[]} names  the choices
 * @returns {Map<string, string>}
 */
export function choiceHelp(help, names) {
  /** @type {Map<string, string>} */
  const texts = new Map();
  const parts = help.split(/`([^`]+)`(?: \([^)]*\))?: /);
  for (let at = 1; at + 1 < parts.length; at += 2) {
    const name = parts[at] ?? "";
    if (names.includes(name)) texts.set(name, (parts[at + 1] ?? "").trim());
  }
  return texts;
}

/**
 * The names of the numbers of a row: from a description such as "`[x, y, z]`", or "lowest and highest".
 * @param {string[]} texts  descriptions, from the outside inwards
 * @param {number} width  the largest number of numbers
 * @returns {string[]}  empty where the numbers have no names
 */
export function columnsOf(texts, width) {
  for (const text of texts) {
    const tuples = [...text.matchAll(/\[([a-z]\w*(?:, [a-z]\w*)*)\]/g)]
      .map((found) => (found[1] ?? "").split(", "));
    const named = tuples.find((names) => names.length === width);
    if (named) return named;
    const pair = /^(?:the )?(\w+) and (?:the )?(\w+)\b/i.exec(text);
    if (width === 2 && pair?.[1] && pair[2]) return [pair[1].toLowerCase(), pair[2].toLowerCase()];
  }
  return [];
}
