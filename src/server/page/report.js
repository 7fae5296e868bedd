// The figures of an answer as tables.

/** @import { Answer } from "./run.js" */

import { el, rich } from "./dom.js";
import { digits, placeText } from "./figures.js";
import { isPlace, labelOf, turning, unitInReport } from "./names.js";
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
/** What a number is. @typedef {{ unit: string, isPlace: boolean, isIndex: boolean }} Quantity */

/** @type {Quantity} */
const PLAIN = { unit: "", isPlace: false, isIndex: false };
/** Members that the service counts from 0, and people from 1. */
const INDICES = new Set(["pass", "move"]);

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
    ...(meta === undefined ? [] : [section(TEXTS.figures, table(meta, PLAIN, 0))]),
    ...candidates(report),
    section(TEXTS.report, table(report, PLAIN, 0)),
    charts,
    ...(measures === undefined ? [] : [section(TEXTS.measures, table(measures, PLAIN, 0))]),
  );
}

/** @param {string} title @param {...Node} content */
const section = (title, ...content) => el("section", {}, el("h3", {}, title), ...content);

/** @param {Answer} answer */
function warnings(answer) {
  return el("ul", { class: "warnings" }, ...answer.warnings.map(({ code, detail }) =>
    el("li", {}, el("strong", {}, `${labelOf(code)}: `), ...rich(detail))));
}

/** The rows of an object. @param {Figures} figures @param {Quantity} outer  of the object @param {number} depth */
function table(figures, outer, depth) {
  const lines = Object.entries(figures).flatMap(([name, value]) => {
    const content = shown(value, quantityOf(figures, name, outer), depth);
    if (typeof content === "string") return [el("tr", {}, el("th", { scope: "row" }, labelOf(name)), el("td", {}, content))];
    // A table has the whole width, below its name.
    return [el("tr", {}, el("th", { scope: "row", colspan: 2 }, labelOf(name))), el("tr", {}, el("td", { colspan: 2 }, content))];
  });
  return el("table", { class: "figures" }, el("tbody", {}, ...lines));
}

/**
 * What a member of an object is.
 * @param {Figures} figures @param {string} name @param {Quantity} outer  of the object
 * @returns {Quantity}
 */
function quantityOf(figures, name, outer) {
  const unit = unitInReport(name, outer.unit);
  const isTurning = ["A", "B", "C"].includes(String(figures["axis"]));
  return { unit: isTurning ? turning(unit) : unit, isPlace: outer.isPlace || isPlace(name), isIndex: INDICES.has(name) };
}

/** @param {unknown} value @param {Quantity} quantity @param {number} depth @returns {Node | string} */
function shown(value, quantity, depth) {
  if (value === null || value === undefined) return TEXTS.none;
  if (typeof value === "boolean") return value ? TEXTS.yes : TEXTS.no;
  if (typeof value === "number") return withUnit(figure(value, quantity), quantity.unit);
  if (typeof value === "string") return CODE.test(value) ? value.replaceAll("_", " ") : value;
  if (Array.isArray(value)) return list(value, quantity, depth);
  return depth < MOST_DEPTH ? folded(table(/** @type {Figures} */ (value), quantity, depth + 1), depth) : JSON.stringify(value);
}

/** @param {number} value @param {Quantity} quantity */
function figure(value, { isPlace, isIndex }) {
  if (isIndex) return digits(value + 1);
  return isPlace ? placeText(value) : digits(value);
}

/** @param {string} text @param {string} unit */
const withUnit = (text, unit) => (unit.startsWith("°") ? text + unit : `${text} ${unit}`.trim());

/** @param {unknown[]} values @param {Quantity} quantity @param {number} depth @returns {Node | string} */
function list(values, quantity, depth) {
  if (values.length === 0) return TEXTS.none;
  if (values.every((value) => typeof value === "number") && values.length <= 6) {
    return withUnit(values.map((value) => figure(value, quantity)).join(", "), quantity.unit);
  }
  if (values.every((value) => typeof value === "object" && value !== null && !Array.isArray(value))) {
    return folded(rows(/** @type {Figures[]} */ (values), quantity, depth), depth, values.length);
  }
  const items = values.slice(0, MOST_ROWS).map((value) => el("li", {}, shown(value, quantity, depth + 1)));
  if (values.length > MOST_ROWS) items.push(el("li", {}, TEXTS.more(values.length - MOST_ROWS)));
  return folded(el("ol", {}, ...items), depth, values.length);
}

/** Objects with the same members as rows. @param {Figures[]} values @param {Quantity} outer @param {number} depth */
function rows(values, outer, depth) {
  const columns = [...new Set(values.flatMap((value) => Object.keys(value)))].map((name) => {
    const units = new Set(values.map((value) => quantityOf(value, name, outer).unit));
    // Where the rows differ, each number has its own unit.
    return { name, unit: units.size === 1 ? [...units][0] ?? "" : null };
  });
  const head = columns.map(({ name, unit }) => el("th", { scope: "col" }, labelOf(name) + (unit ? `, ${unit}` : "")));
  const lines = values.slice(0, MOST_ROWS).map((value) => el("tr", {}, ...columns.map(({ name, unit }) =>
    cell(value[name], quantityOf(value, name, outer), unit === null, depth))));
  if (values.length > MOST_ROWS) lines.push(el("tr", {}, el("td", {}, TEXTS.more(values.length - MOST_ROWS))));
  return el("table", { class: "rows" }, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...lines));
}

/** @param {unknown} value @param {Quantity} quantity @param {boolean} isUnitTold with each number @param {number} depth */
function cell(value, quantity, isUnitTold, depth) {
  if (value === undefined) return el("td");
  if (typeof value !== "number") return el("td", {}, shown(value, quantity, depth + 1));
  const text = figure(value, quantity);
  return el("td", { class: "number" }, isUnitTold ? withUnit(text, quantity.unit) : text);
}

/**
 * A part that is opened on demand, unless it stands at the top.
 * @param {HTMLElement} part @param {number} depth @param {number} [count] of what is in a list
 */
function folded(part, depth, count) {
  const wide = el("div", { class: "wide" }, part);
  if (depth < 1 && (count === undefined || count <= 12)) return wide;
  return el("details", {}, el("summary", {}, count === undefined ? TEXTS.figures : TEXTS.entries(count)), wide);
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
    el("caption", {}, `Z ${placeText(level.z_mm)} mm`),
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
