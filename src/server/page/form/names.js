// Makes units, defaults and column names from what the contract says of a member.

import { unitInName, unitInWords } from "../names.js";

/** @typedef {import("../contract.js").Schema} Schema */

const UNIT = /\bin (mm(?:\/(?:min|s[23]?))?|degrees(?: by s[23]?)?|milliseconds|1\/min|s)(?![\w/])/;
const OR_DEGREES = /, or in (degrees(?: by s\d?)?)(?!\w)/;

/**
 * @param {string} label  of a list
 * @returns {string}  the label of one of its entries
 */
export function singular(label) {
  if (/is$/.test(label)) return label;
  return label.replace(/axes$/, "axis").replace(/(ss|ch|sh|x)es$/, "$1").replace(/([^si])s$/, "$1");
}

/** The noun that a description begins with, such as "The sections of the holder" or "Two rotary axes". */
const NOUN = /^(?:the |two )?((?:[a-z]+ )?[a-z]+s)(?:[,.:;]| (?:of|with|before|after|in|from)\b)/i;

/**
 * The name of an entry of a list whose own label is no plural.
 * @param {string[]} texts  descriptions of the list, from the outside inwards
 * @returns {string}  such as `Section`; empty where no description begins with the entries
 */
export function entryOf(texts) {
  const nouns = texts.map((text) => NOUN.exec(text)?.[1]?.toLowerCase() ?? "");
  const noun = singular(nouns.find((many) => many !== "" && singular(many) !== many) ?? "");
  return noun.charAt(0).toUpperCase() + noun.slice(1);
}

/**
 * The unit of a member: from its name, else from what is said of it.
 * @param {string} name
 * @param {string[]} texts  descriptions, from the outside inwards
 * @returns {string}  empty where none is told
 */
export function unitOf(name, texts) {
  const own = unitInName(name);
  if (own) return own;
  for (const text of texts) {
    if (/without a unit/.test(text)) return "";
    const told = unitInWords(UNIT.exec(text)?.[1] ?? "");
    const other = unitInWords(OR_DEGREES.exec(text)?.[1] ?? "");
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
