// Tells what an opened file is, and makes the request that its text stands for.
import { isObject } from "./form/value.js";
import { parseTable } from "./paste.js";

/** @typedef {import("./contract.js").Contract} Contract */
/** @typedef {import("./contract.js").Operation} Operation */
/** @typedef {"json" | "table" | "nc" | "cl" | "unknown"} Kind  a request, rows of numbers, a program, a CL file */
/** @typedef {{kind: Kind, text: string, value: unknown}} Opened  with the value of JSON */

/** As many characters tell whether a text is a table. */
const SAMPLE = 200_000;
/** Members of requests that say the same in different ways: the opened text takes the place of the others. */
const SOURCES = ["nc", "cl", "path", "toolpath"];

/** A line of a program: a number of the line, then a word such as `G1`, or a block of Heidenhain controls. */
const NC = /^[\s/]*(?:(?:N\s*)?\d+\s+)?(?:[GMTOFSXYZ]\s?[-+]?\.?\d|BEGIN PGM\b|L\s+[XYZ][-+\d])/im;
const CL = /^\s*(?:GOTO|PARTNO|MULTAX|LOADTL|FEDRAT)\b/m;

/**
 * @param {string} text
 * @returns {Opened}
 */
export function opened(text) {
  const value = jsonOf(text);
  if (isTable(value)) return { kind: "table", text: value.map((row) => row.join("\t")).join("\n"), value };
  if (isObject(value)) return { kind: "json", text, value };
  return { kind: kindOf(text), text, value: undefined };
}

/** @param {string} text @returns {Kind} */
function kindOf(text) {
  const { rows, skipped } = parseTable(text.slice(0, SAMPLE));
  if (rows.length > skipped.length) return "table";
  if (CL.test(text)) return "cl";
  return NC.test(text) ? "nc" : "unknown";
}

/** @param {string} text @returns {unknown}  undefined where the text is no JSON */
function jsonOf(text) {
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}

/** @param {unknown} value @returns {value is number[][]} */
function isTable(value) {
  const isRow = (/** @type {unknown} */ row) => Array.isArray(row) && row.every((cell) => typeof cell === "number");
  return Array.isArray(value) && value.length > 0 && value.every(isRow);
}

/**
 * The request with a program or a CL file: of the chosen operation, where that takes one.
 * @param {Contract} contract
 * @param {Operation} chosen
 * @param {unknown} body  of the chosen operation
 * @param {"nc" | "cl"} member
 * @param {string} text
 * @returns {{operation: Operation, body: unknown} | null}
 */
export function withText({ operations, resolve }, chosen, body, member, text) {
  const takes = (/** @type {Operation} */ { schema }) => member in (resolve(schema).properties ?? {});
  if (takes(chosen)) {
    const others = Object.entries(body ?? {}).filter(([name]) => !SOURCES.includes(name));
    return { operation: chosen, body: { ...Object.fromEntries(others), [member]: text } };
  }
  // An operation that needs nothing else can run at once.
  const needsOnly = (/** @type {Operation} */ { schema }) => String(resolve(schema).required) === member;
  const operation = operations.find(needsOnly) ?? operations.find(takes);
  return operation ? { operation, body: { [member]: text } } : null;
}
