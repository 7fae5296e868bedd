// Writes values as JSON that people can read, finds where a text is no JSON, and shortens large values.
import { FORM_TEXTS as TEXTS } from "../texts.js";

/** @typedef {{value: unknown} | {line: number, column: number, what: string}} Parsed */

/** A value whose JSON fits into as many characters stands in one line. */
const LINE = 88;
/** Of a list in an abridged value, as many entries are shown. */
const ENTRIES = 6;
/** Of a text in an abridged value, as many characters are shown. */
const CHARACTERS = 200;
/** Deeper parts are not indented. */
const NESTED = 100;
/** As deep may an abridged value be. */
const DEPTH = 12;

/**
 * Reads a JSON text.
 * @param {string} text
 * @returns {Parsed}  the value, or the place of the first error, lines and columns counted from 1
 */
export function parseJson(text) {
  try {
    return { value: JSON.parse(text) };
  } catch {
    const { at, what } = findError(text);
    const before = text.slice(0, at).split("\n");
    return { line: before.length, column: (before.at(-1) ?? "").length + 1, what: TEXTS.expected[what] };
  }
}

const BLANK = /[ \t\n\r]*/y;
const SCALAR = /-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?|true|false|null/y;
const STRING = /"(?:[^"\\\u0000-\u001f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*"/y;

/**
 * Finds the first error of a text that is no JSON.
 * @param {string} text
 * @returns {{at: number, what: keyof typeof TEXTS.expected}}
 */
function findError(text) {
  let at = 0;
  const skip = (/** @type {RegExp} */ pattern) => {
    pattern.lastIndex = at;
    const found = pattern.exec(text);
    if (found) at = pattern.lastIndex;
    return Boolean(found);
  };
  const sign = () => {
    skip(BLANK);
    return text.charAt(at);
  };
  /** @type {string[]} */
  const open = [];
  let isFirst = false;
  for (;;) {
    if (isFirst && sign() === (open.at(-1) === "{" ? "}" : "]")) {
      at += 1;
      open.pop();
    } else {
      if (open.at(-1) === "{") {
        if (sign() !== '"') return { at, what: "name" };
        if (!skip(STRING)) return { at, what: "text" };
        if (sign() !== ":") return { at, what: "colon" };
        at += 1;
      }
      const next = sign();
      if (next === "{" || next === "[") {
        open.push(next);
        at += 1;
        isFirst = true;
        continue;
      }
      if (next === '"') {
        if (!skip(STRING)) return { at, what: "text" };
      } else if (!skip(SCALAR)) return { at, what: "value" };
    }
    isFirst = false;
    while (open.length > 0 && sign() === (open.at(-1) === "{" ? "}" : "]")) {
      at += 1;
      open.pop();
    }
    const next = sign();
    if (open.length === 0) return { at, what: "end" };
    if (next !== ",") return { at, what: "next" };
    at += 1;
  }
}

/**
 * Whether the JSON of a value is longer than a limit. Looks at no more of the value than the limit needs.
 * @param {unknown} value
 * @param {number} limit  characters
 * @returns {boolean}
 */
export function isLonger(value, limit) {
  let left = limit;
  /** @type {Iterator<unknown>[]} */
  const open = [[value].values()];
  while (open.length > 0 && left >= 0) {
    const { value: next, done } = /** @type {Iterator<unknown>} */ (open.at(-1)).next();
    if (done) {
      open.pop();
    } else if (Array.isArray(next)) {
      left -= 2;
      open.push(next.values());
    } else if (typeof next === "object" && next !== null) {
      left -= Object.keys(next).join('":,').length + 4;
      open.push(Object.values(next).values());
    } else {
      left -= typeof next === "string" ? next.length + 3 : String(next).length + 1;
    }
  }
  return left < 0;
}

/**
 * Writes a value as JSON: short parts in one line, others indented.
 * @param {unknown} value
 * @param {string} [indent]
 * @returns {string}
 */
export function formatJson(value, indent = "") {
  if (!isLonger(value, LINE - indent.length)) return spaced(value);
  if (indent.length > 2 * NESTED) return JSON.stringify(value);
  const inner = `${indent}  `;
  if (Array.isArray(value)) return wrap("[", value.map((item) => formatJson(item, inner)), "]", indent);
  if (typeof value !== "object" || value === null) return JSON.stringify(value);
  const members = Object.entries(value).filter(([, item]) => item !== undefined)
    .map(([name, item]) => `${JSON.stringify(name)}: ${formatJson(item, inner)}`);
  return wrap("{", members, "}", indent);
}

/**
 * @param {unknown} value
 * @returns {string}  JSON in one line, with blanks after commas and colons
 */
function spaced(value) {
  if (Array.isArray(value)) return `[${value.map(spaced).join(", ")}]`;
  if (typeof value !== "object" || value === null) return JSON.stringify(value ?? null);
  const members = Object.entries(value).filter(([, item]) => item !== undefined)
    .map(([name, item]) => `${JSON.stringify(name)}: ${spaced(item)}`);
  return `{${members.join(", ")}}`;
}

/**
 * @param {string} open
 * @param {string[]} parts
 * @param {string} close
 * @param {string} indent
 * @returns {string}
 */
function wrap(open, parts, close, indent) {
  return `${open}\n${indent}  ${parts.join(`,\n${indent}  `)}\n${indent}${close}`;
}

/**
 * Writes the beginning of a large value. The text is no JSON.
 * @param {unknown} value
 * @returns {string}
 */
export function abridged(value) {
  return lines(value, "").slice(0, 400).join("\n");
}

/**
 * @param {unknown} value
 * @param {string} indent
 * @returns {string[]}
 */
function lines(value, indent) {
  if (typeof value === "string" && value.length > CHARACTERS) {
    return [`${JSON.stringify(value.slice(0, CHARACTERS))} ${TEXTS.left(value.length - CHARACTERS)}`];
  }
  if (!isLonger(value, LINE - indent.length)) return [spaced(value)];
  if (indent.length > 2 * DEPTH) return [brief(value)];
  const inner = `${indent}  `;
  const isList = Array.isArray(value);
  const entries = Object.entries(isList ? value.slice(0, ENTRIES) : value ?? {}).slice(0, 200);
  const left = (isList ? value.length : Object.keys(value ?? {}).length) - entries.length;
  const parts = entries.flatMap(([name, item]) => {
    const [first = "", ...others] = lines(item, inner);
    return [`${inner}${isList ? "" : `${JSON.stringify(name)}: `}${first}`, ...others];
  });
  if (left > 0) parts.push(`${inner}${TEXTS.left(left)}`);
  return [isList ? "[" : "{", ...parts, `${indent}${isList ? "]" : "}"}`];
}

/**
 * A short text for a value, such as the heading of a closed entry.
 * @param {unknown} value
 * @returns {string}
 */
export function brief(value) {
  // Brackets in brackets are read by nobody.
  const isNested = Array.isArray(value) && value.some(Array.isArray);
  if (!isNested && !isLonger(value, LINE)) return spaced(value);
  if (Array.isArray(value)) return TEXTS.items(value.length);
  if (typeof value === "string") return `${value.slice(0, LINE)} …`;
  return Object.entries(value ?? {}).filter(([, item]) => typeof item !== "object")
    .map(([name, item]) => `${name}: ${String(item).slice(0, 20)}`).join(", ").slice(0, LINE);
}
