// Reads numbers as people type them, with a comma or a point, and says what is wrong with a number.
import { FORM_TEXTS as TEXTS } from "../texts.js";

/** @typedef {{kind: string, min: number, max: number, unit: string}} Range */

/** @type {Record<string, RegExp>} */
const NUMBERS = {
  ".": /^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?$/,
  ",": /^[+-]?(?:\d+,?\d*|,\d+)(?:[eE][+-]?\d+)?$/,
};

/**
 * Reads a number.
 * @param {string} text
 * @param {string} [decimal]  the decimal sign, `,` or `.`; both are read without it
 * @returns {number | null}  null where the text is no number
 */
export function readNumber(text, decimal) {
  // The page writes thousands apart by such blanks; texts from elsewhere do too.
  const trimmed = text.trim().replace("\u2212", "-").replace(/(\d)[\u202f\u00a0](?=\d)/g, "$1");
  const sign = decimal ?? (trimmed.includes(",") ? "," : ".");
  if (!NUMBERS[sign]?.test(trimmed)) return null;
  const value = Number(trimmed.replace(",", "."));
  return Number.isFinite(value) ? value : null;
}

/**
 * What a typed text stands for in the request: a number, the text itself where it is no number, and undefined
 * where it is empty.
 * @param {string} text
 * @returns {number | string | undefined}
 */
export function typedValue(text) {
  if (text.trim() === "") return undefined;
  return readNumber(text) ?? text;
}

/**
 * @param {unknown} value
 * @returns {string}  the text of an input
 */
export function shownValue(value) {
  return value === undefined || value === null ? "" : String(value);
}

/**
 * What is wrong with a value.
 * @param {unknown} value
 * @param {Range} range
 * @returns {string}  empty where nothing is wrong
 */
export function numberProblem(value, range) {
  if (value === undefined || value === null || value === "") return "";
  if (typeof value !== "number") return TEXTS.noNumber(String(value));
  if (range.kind === "integer" && !Number.isInteger(value)) return TEXTS.noInteger;
  if (value < range.min || value > range.max) return TEXTS.outOfRange(rangeText(range), range.unit);
  return "";
}

/**
 * @param {Range} range
 * @returns {string}  such as `0.001 to 100`; empty without limits
 */
export function rangeText({ min, max }) {
  if (min === -Infinity && max === Infinity) return "";
  if (max === Infinity) return TEXTS.atLeast(String(min));
  if (min === -Infinity) return TEXTS.atMost(String(max));
  return TEXTS.fromTo(String(min), String(max));
}
