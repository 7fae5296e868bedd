// The figures of an answer as tables.

/** @import { Answer } from "./run.js" */

import { digits, unitOf, wordsOf } from "./figures.js";
import { TEXTS } from "./texts.js";

/** Most rows of a table, and most depth of tables within tables. */
const MOST_ROWS = 200;
const MOST_DEPTH = 6;

/**
 * Shows an answer in a panel.
 * @param {HTMLElement} host
 * @param {Answer} answer
 */
export function showReport(host, answer) {
  const parts = [];
  if (answer.warnings.length > 0) parts.push(warnings(answer));
  if (answer.meta !== undefined) parts.push(section(TEXTS.figures, answer.meta));
  parts.push(...candidates(answer.report));
  parts.push(section(TEXTS.report, answer.report));
  if (answer.measures !== undefined) parts.push(section(TEXTS.measures, answer.measures));
  host.replaceChildren(...parts);
}

/** @param {string} name @param {string} text @param {string} [kind] */
function element(name, text, kind) {
  const made = document.createElement(name);
  made.textContent = text;
  if (kind !== undefined) made.className = kind;
  return made;
}

/** @param {Answer} answer */
function warnings(answer) {
  const part = document.createElement("section");
  const list = document.createElement("ul");
  list.className = "warnings";
  for (const { code, detail } of answer.warnings) {
    const item = element("li", detail);
    item.prepend(element("strong", `${wordsOf(code)}: `));
    list.append(item);
  }
  part.append(element("h3", TEXTS.warnings), list);
  return part;
}

/** @param {string} title @param {object} figures */
function section(title, figures) {
  const part = document.createElement("section");
  part.append(element("h3", title), table(figures, 0));
  return part;
}

/** The rows of an object. @param {object} figures @param {number} depth @returns {HTMLElement} */
function table(figures, depth) {
  const body = document.createElement("table");
  body.className = "figures";
  for (const [name, value] of Object.entries(figures)) {
    const row = body.insertRow();
    const head = element("th", wordsOf(name));
    head.setAttribute("scope", "row");
    const cell = row.insertCell();
    cell.append(shown(name, value, depth));
    row.prepend(head);
  }
  return body;
}

/** @param {string} name @param {unknown} value @param {number} depth @returns {Node | string} */
function shown(name, value, depth) {
  if (value === null || value === undefined) return TEXTS.none;
  if (typeof value === "boolean") return value ? TEXTS.yes : TEXTS.no;
  if (typeof value === "number") return `${digits(value)} ${unitOf(name)}`.trim();
  if (typeof value === "string") return value;
  if (Array.isArray(value)) return list(name, value, depth);
  return depth < MOST_DEPTH ? folded(table(value, depth + 1), depth) : JSON.stringify(value);
}

/** @param {string} name @param {unknown[]} values @param {number} depth @returns {Node | string} */
function list(name, values, depth) {
  if (values.length === 0) return TEXTS.none;
  if (values.every((value) => typeof value === "number") && values.length <= 6) {
    return `${values.map((value) => digits(Number(value))).join(", ")} ${unitOf(name)}`.trim();
  }
  if (values.every((value) => typeof value === "object" && value !== null && !Array.isArray(value))) {
    return folded(rows(/** @type {Record<string, unknown>[]} */ (values), depth), depth, values.length);
  }
  const items = document.createElement("ol");
  for (const value of values.slice(0, MOST_ROWS)) {
    const item = document.createElement("li");
    item.append(shown(name, value, depth + 1));
    items.append(item);
  }
  if (values.length > MOST_ROWS) items.append(element("li", TEXTS.more(values.length - MOST_ROWS)));
  return folded(items, depth, values.length);
}

/** Objects with the same members as rows. @param {Record<string, unknown>[]} values @param {number} depth */
function rows(values, depth) {
  const names = [...new Set(values.flatMap((value) => Object.keys(value)))];
  const body = document.createElement("table");
  body.className = "rows";
  const head = body.createTHead().insertRow();
  for (const name of names) {
    const unit = unitOf(name);
    head.append(element("th", wordsOf(name) + (unit === "" ? "" : `, ${unit}`)));
  }
  const lines = body.createTBody();
  for (const value of values.slice(0, MOST_ROWS)) {
    const line = lines.insertRow();
    for (const name of names) {
      const cell = line.insertCell();
      const own = value[name];
      if (typeof own === "number") {
        cell.className = "number";
        cell.textContent = digits(own);
      } else if (own !== undefined) {
        cell.append(shown(name, own, depth + 1));
      }
    }
  }
  if (values.length > MOST_ROWS) lines.insertRow().insertCell().textContent = TEXTS.more(values.length - MOST_ROWS);
  return body;
}

/** A part that is opened on demand, unless it stands at the top. @param {HTMLElement} part @param {number} depth @param {number} [count] */
function folded(part, depth, count) {
  const wide = document.createElement("div");
  wide.className = "wide";
  wide.append(part);
  if (depth < 1 && (count === undefined || count <= 12)) return wide;
  const details = document.createElement("details");
  details.append(element("summary", count === undefined ? TEXTS.figures : String(count)), wide);
  return details;
}

/** The times of patterns on each level as bars, where a report has them. @param {Record<string, unknown>} report */
function candidates(report) {
  const levels = report["levels"];
  if (!Array.isArray(levels)) return [];
  const shownLevels = levels.filter((level) => Array.isArray(level.candidates) && level.candidates.length > 0).slice(0, 12);
  if (shownLevels.length === 0) return [];
  const longest = Math.max(...shownLevels.flatMap((level) =>
    level.candidates.map((/** @type {{ time_s?: number }} */ one) => one.time_s ?? 0)), 1e-9);
  const part = document.createElement("section");
  part.append(element("h3", TEXTS.patternTimes));
  for (const level of shownLevels) {
    const body = document.createElement("table");
    body.className = "bars";
    body.createCaption().textContent = `Z ${digits(level.z_mm)} mm`;
    for (const one of level.candidates) {
      const row = body.insertRow();
      const head = element("th", wordsOf(one.pattern));
      head.setAttribute("scope", "row");
      row.append(head);
      const cell = row.insertCell();
      const bar = element("span", "", one.valid ? "bar-part" : "bar-part invalid");
      bar.style.width = `${(70 * (one.time_s ?? 0)) / longest}%`;
      const told = one.valid ? (one.pattern === level.chosen ? TEXTS.chosen : "") : (one.invalid_because ?? "");
      cell.append(bar, ` ${one.time_s === undefined ? "" : `${digits(one.time_s)} s`} ${told}`);
    }
    part.append(body);
  }
  return [part];
}
