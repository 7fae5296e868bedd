// The figures of an answer as tables.

/** @import { Answer } from "./run.js" */

import { el, rich } from "./dom.js";
import { digits } from "./figures.js";
import { labelOf, turning, unitInReport } from "./names.js";
import { TEXTS } from "./texts.js";

/** Most rows of a table, and most depth of tables within tables. */
const MOST_ROWS = 200;
const MOST_DEPTH = 6;
/** Most levels whose times of patterns are shown. */
const MOST_LEVELS = 12;
/** Percent of the width that the longest bar takes. */
const LONGEST_BAR = 30;
/** Names of choices, such as `zigzag_stock_offset`. */
const CODE = /^[a-z]+(?:_[a-z]+)+$/;

/** @typedef {Record<string, unknown>} Figures */

/**
 * Shows an answer in a panel.
 * @param {HTMLElement} host
 * @param {Answer} answer
 * @param {HTMLElement} charts  the diagrams of the answer
 */
export function showReport(host, answer, charts) {
  const { warnings: warned, meta, report, measures } = answer;
  host.replaceChildren(
    ...(warned.length > 0 ? [section(TEXTS.warnings, warnings(answer))] : []),
    ...(meta === undefined ? [] : [section(TEXTS.figures, table(meta, "", 0))]),
    ...candidates(report),
    section(TEXTS.report, table(report, "", 0)),
    charts,
    ...(measures === undefined ? [] : [section(TEXTS.measures, table(measures, "", 0))]),
  );
}

/** @param {string} title @param {...Node} content */
const section = (title, ...content) => el("section", {}, el("h3", {}, title), ...content);

/** @param {Answer} answer */
function warnings(answer) {
  return el("ul", { class: "warnings" }, ...answer.warnings.map(({ code, detail }) =>
    el("li", {}, el("strong", {}, `${labelOf(code)}: `), ...rich(detail))));
}

/** The rows of an object. @param {Figures} figures @param {string} unit of the object @param {number} depth */
function table(figures, unit, depth) {
  const lines = Object.entries(figures).flatMap(([name, value]) => {
    const content = shown(value, unitOf(figures, name, unit), depth);
    if (typeof content === "string") return [el("tr", {}, el("th", { scope: "row" }, labelOf(name)), el("td", {}, content))];
    // A table has the whole width, below its name.
    return [el("tr", {}, el("th", { scope: "row", colspan: 2 }, labelOf(name))), el("tr", {}, el("td", { colspan: 2 }, content))];
  });
  return el("table", { class: "figures" }, el("tbody", {}, ...lines));
}

/** The unit of a member of an object. @param {Figures} figures @param {string} name @param {string} outer unit of the object */
function unitOf(figures, name, outer) {
  const unit = unitInReport(name, outer);
  return ["A", "B", "C"].includes(String(figures["axis"])) ? turning(unit) : unit;
}

/** @param {unknown} value @param {string} unit @param {number} depth @returns {Node | string} */
function shown(value, unit, depth) {
  if (value === null || value === undefined) return TEXTS.none;
  if (typeof value === "boolean") return value ? TEXTS.yes : TEXTS.no;
  if (typeof value === "number") return withUnit(digits(value), unit);
  if (typeof value === "string") return CODE.test(value) ? value.replaceAll("_", " ") : value;
  if (Array.isArray(value)) return list(value, unit, depth);
  return depth < MOST_DEPTH ? folded(table(/** @type {Figures} */ (value), unit, depth + 1), depth) : JSON.stringify(value);
}

/** @param {string} text @param {string} unit */
const withUnit = (text, unit) => (unit.startsWith("°") ? text + unit : `${text} ${unit}`.trim());

/** @param {unknown[]} values @param {string} unit @param {number} depth @returns {Node | string} */
function list(values, unit, depth) {
  if (values.length === 0) return TEXTS.none;
  if (values.every((value) => typeof value === "number") && values.length <= 6) {
    return withUnit(values.map((value) => digits(value)).join(", "), unit);
  }
  if (values.every((value) => typeof value === "object" && value !== null && !Array.isArray(value))) {
    return folded(rows(/** @type {Figures[]} */ (values), unit, depth), depth, values.length);
  }
  const items = values.slice(0, MOST_ROWS).map((value) => el("li", {}, shown(value, unit, depth + 1)));
  if (values.length > MOST_ROWS) items.push(el("li", {}, TEXTS.more(values.length - MOST_ROWS)));
  return folded(el("ol", {}, ...items), depth, values.length);
}

/** Objects with the same members as rows. @param {Figures[]} values @param {string} outer @param {number} depth */
function rows(values, outer, depth) {
  const columns = [...new Set(values.flatMap((value) => Object.keys(value)))].map((name) => {
    const units = new Set(values.map((value) => unitOf(value, name, outer)));
    // Where the rows differ, each number has its own unit.
    return { name, unit: units.size === 1 ? [...units][0] ?? "" : null };
  });
  const head = columns.map(({ name, unit }) => el("th", { scope: "col" }, labelOf(name) + (unit ? `, ${unit}` : "")));
  const lines = values.slice(0, MOST_ROWS).map((value) => el("tr", {}, ...columns.map(({ name, unit }) =>
    cell(value[name], unit ?? unitOf(value, name, outer), unit === null, depth))));
  if (values.length > MOST_ROWS) lines.push(el("tr", {}, el("td", {}, TEXTS.more(values.length - MOST_ROWS))));
  return el("table", { class: "rows" }, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...lines));
}

/** @param {unknown} value @param {string} unit @param {boolean} isUnitTold with each number @param {number} depth */
function cell(value, unit, isUnitTold, depth) {
  if (value === undefined) return el("td");
  if (typeof value !== "number") return el("td", {}, shown(value, unit, depth + 1));
  return el("td", { class: "number" }, isUnitTold ? withUnit(digits(value), unit) : digits(value));
}

/**
 * A part that is opened on demand, unless it stands at the top.
 * @param {HTMLElement} part @param {number} depth @param {number} [count] of what is in a list
 */
function folded(part, depth, count) {
  const wide = el("div", { class: "wide" }, part);
  if (depth < 1 && (count === undefined || count <= 12)) return wide;
  return el("details", {}, el("summary", {}, count === undefined ? TEXTS.figures : String(count)), wide);
}

/**
 * The times of the patterns on a level.
 * @typedef {{ pattern: string, time_s?: number, valid: boolean, invalid_because?: string }} Candidate
 * @typedef {{ z_mm: number, chosen: string, candidates: Candidate[] }} Level
 */

/** The times of patterns on each level as bars, where a report has them. @param {Figures} report */
function candidates(report) {
  const levels = /** @type {Level[]} */ (Array.isArray(report["levels"]) ? report["levels"] : [])
    .filter((level) => Array.isArray(level.candidates) && level.candidates.length > 0).slice(0, MOST_LEVELS);
  if (levels.length === 0) return [];
  const longest = Math.max(...levels.flatMap((level) => level.candidates.map((one) => one.time_s ?? 0)), 1e-9);
  return [section(TEXTS.patternTimes, ...levels.map((level) => el("table", { class: "bars" },
    el("caption", {}, `Z ${digits(level.z_mm)} mm`),
    el("tbody", {}, ...level.candidates.map((one) => bar(one, one.pattern === level.chosen, longest))))))];
}

/** @param {Candidate} candidate @param {boolean} isChosen @param {number} longest time of all, s */
function bar({ pattern, time_s, valid, invalid_because = "" }, isChosen, longest) {
  const drawn = el("span", { class: valid ? "bar-part" : "bar-part invalid" });
  drawn.style.width = `${(LONGEST_BAR * (time_s ?? 0)) / longest}%`;
  const told = valid ? (isChosen ? TEXTS.chosen : "") : invalid_because;
  const time = el("span", { class: "number" }, time_s === undefined ? "" : `${digits(time_s)} s`);
  return el("tr", {}, el("th", { scope: "row" }, labelOf(pattern)), el("td", {}, drawn, " ", time, ` ${told}`));
}
