// Reads rows of numbers from the text of a spreadsheet, a CSV file or a list of points.
// The separator and the decimal sign are decided over the whole text.
import { readNumber } from "./form/number.js";

/**
 * @typedef {object} Table
 * @property {number[][]} rows
 * @property {string} separator  a tab, `;`, `,`, a blank, or empty where each line has one number
 * @property {string} decimal  `,` or `.`; empty where all numbers are whole
 * @property {{line: number, text: string}[]} skipped  lines that are no rows of numbers, counted from 1
 * @property {string[] | null} header  the names in the first line
 * @property {boolean} isAmbiguous  whether commas could as well be decimal signs
 * @property {number[]} breaks  indices of rows before which lines are blank
 */
/** @typedef {{separator: string, decimal: string}} Style */
/** @typedef {{least?: number, most?: number}} Width  how many numbers a row is meant to have */
/**
 * @typedef {object} Score
 * @property {number} read  lines that are rows of numbers
 * @property {number} fitting  those of them that are as wide as wanted
 * @property {number} equal  those of them that have the commonest width
 * @property {number} numbers
 */
/** @typedef {{style: Style} & Score} Ranked */

/** So many lines, spread over the text, decide the style. More take longer and decide the same. */
const SAMPLE = 5000;
/** As many characters of a skipped line are told. */
const TOLD = 60;

/** Styles, the likelier first. Cells in quotes may hold the comma that separates them. */
const STYLES = /** @type {const} */ ([
  { separator: "\t", decimal: "." }, { separator: "\t", decimal: "," },
  { separator: ";", decimal: "." }, { separator: ";", decimal: "," },
  { separator: ", ", decimal: "," }, { separator: ",", decimal: "." },
  { separator: " ", decimal: "." }, { separator: " ", decimal: "," }, { separator: ",", decimal: "," },
]);

/**
 * Reads a table of numbers.
 * @param {string} text
 * @param {Width} [width]  decides where a comma can be both separator and decimal sign
 * @returns {Table}
 */
export function parseTable(text, width = {}) {
  const lines = text.replace(/^\uFEFF/, "").split(/\r\n|\r|\n/);
  const styles = STYLES.filter(({ separator }) => separator === " " || text.includes(separator))
    .filter(({ decimal }) => decimal === "." || text.includes(","));
  const ranked = ranking(lines, styles, width);
  return { ...bestTable(lines, ranked), isAmbiguous: isAmbiguous(ranked) };
}

/**
 * @param {string[]} lines
 * @param {Ranked[]} ranked
 * @returns {Table}  by the first style, or by the second where that reads more lines than the sample told
 */
function bestTable(lines, [first, second]) {
  const table = tableOf(lines, first?.style ?? STYLES[0]);
  if (table.skipped.length === 0 || lines.length <= SAMPLE || !second) return table;
  const other = tableOf(lines, second.style);
  return other.rows.length > table.rows.length ? other : table;
}

/**
 * @param {Ranked[]} ranked
 * @returns {boolean}  whether another meaning of the comma reads as many lines, as other numbers
 */
function isAmbiguous([first, ...others]) {
  if (!first || first.read === 0) return false;
  const isComma = (/** @type {Style} */ style) => style.separator === "," || style.decimal === ",";
  return isComma(first.style) && others.some(({ style, read, numbers }) => isComma(style)
    && style.decimal !== first.style.decimal && read === first.read && numbers !== first.numbers);
}

/**
 * @param {string[]} lines
 * @param {Style[]} styles
 * @param {Width} width
 * @returns {Ranked[]}  the styles, the best first
 */
function ranking(lines, styles, width) {
  const stride = Math.ceil(lines.length / SAMPLE);
  const sample = lines.filter((_, at) => at % stride === 0);
  return styles.map((style) => ({ style, ...scoreOf(sample, style, width) }))
    .sort((one, other) => other.read - one.read || other.fitting - one.fitting || other.equal - one.equal);
}

/**
 * @param {string[]} lines
 * @param {Style} style
 * @param {Width} width
 * @returns {Score}
 */
function scoreOf(lines, style, { least = 1, most = Infinity }) {
  /** @type {Map<number, number>} */
  const widths = new Map();
  for (const line of lines) {
    const row = rowOf(bareLine(line), style);
    if (row) widths.set(row.length, (widths.get(row.length) ?? 0) + 1);
  }
  let [read, fitting, equal, numbers] = [0, 0, 0, 0];
  for (const [width, count] of widths) {
    read += count;
    numbers += count * width;
    if (width >= least && width <= most) fitting += count;
    equal = Math.max(equal, count);
  }
  return { read, fitting, equal, numbers };
}

/**
 * @param {string[]} lines
 * @param {Style} style
 * @returns {Table}
 */
function tableOf(lines, style) {
  /** @type {Table} */
  const table = { rows: [], ...style, skipped: [], header: null, isAmbiguous: false, breaks: [] };
  let [isBlank, widest, hasDecimals] = [false, 0, false];
  lines.forEach((line, at) => {
    const bare = bareLine(line);
    if (bare === "") {
      isBlank ||= line.trim() === "" && table.rows.length > 0;
      return;
    }
    const row = rowOf(bare, style);
    if (!row) {
      const names = headerOf(bare, style);
      const isFirst = table.rows.length === 0 && table.skipped.length === 0 && !table.header;
      if (isFirst && names) table.header = names;
      else table.skipped.push({ line: at + 1, text: bare.slice(0, TOLD) });
      return;
    }
    if (isBlank) table.breaks.push(table.rows.length);
    isBlank = false;
    table.rows.push(row);
    widest = Math.max(widest, row.length);
    hasDecimals ||= row.some((number) => !Number.isInteger(number));
  });
  table.separator = widest < 2 ? "" : style.separator.charAt(0);
  table.decimal = hasDecimals ? style.decimal : "";
  return table;
}

/**
 * @param {string} line
 * @returns {string}  the line without its comment
 */
function bareLine(line) {
  const hash = line.indexOf("#");
  return (hash < 0 ? line : line.slice(0, hash)).trim();
}

/**
 * @param {string} bare  a line without its comment
 * @param {Style} style
 * @returns {number[] | null}  null where the line is no row of numbers
 */
function rowOf(bare, style) {
  if (bare === "") return null;
  /** @type {number[]} */
  const row = [];
  for (const cell of cellsOf(bare, style)) {
    const number = readNumber(cell, style.decimal);
    if (number === null || cell.endsWith(",")) return null;
    row.push(number);
  }
  return row.length > 0 ? row : null;
}

/**
 * @param {string} line  without blanks around it
 * @param {Style} style
 * @returns {string[]}  the cells, without quotes and without empty cells at the end
 */
function cellsOf(line, { separator }) {
  const cells = line.includes('"') ? quotedCells(line, separator.charAt(0)) : split(line, separator);
  while (cells.at(-1)?.trim() === "") cells.pop();
  return cells;
}

/**
 * @param {string} line
 * @param {string} separator
 * @returns {string[]}
 */
function split(line, separator) {
  if (separator === " ") return line.split(/\s+/);
  return separator === ", " ? line.split(/,\s+/) : line.split(separator);
}

/**
 * @param {string} line
 * @param {string} separator  one character
 * @returns {string[]}
 */
function quotedCells(line, separator) {
  const cells = [""];
  let isInside = false;
  for (const sign of line) {
    if (sign === '"') isInside = !isInside;
    else if (sign === separator && !isInside) cells.push("");
    else cells[cells.length - 1] += sign;
  }
  return cells;
}

/**
 * @param {string} line
 * @param {Style} style
 * @returns {string[] | null}  the names, where the line holds a name in each cell
 */
function headerOf(line, style) {
  const cells = cellsOf(line, style).map((cell) => cell.trim());
  return cells.every((cell) => /\p{L}/u.test(cell) && readNumber(cell) === null) ? cells : null;
}

/**
 * Splits points into the rows of a grid: at blank lines, else where x changes, else where y changes.
 * @param {Pick<Table, "rows" | "breaks">} table
 * @returns {{rows: number[][][], by: "blank" | "0" | "1" | "none"}}  `none`: all points are in one row
 */
export function gridOf({ rows, breaks }) {
  if (breaks.length > 0) return { rows: cut(rows, breaks), by: "blank" };
  for (const [axis, by] of /** @type {const} */ ([[0, "0"], [1, "1"]])) {
    const changes = rows.flatMap((row, at) => (at > 0 && row[axis] !== rows[at - 1]?.[axis] ? [at] : []));
    const grid = cut(rows, changes);
    const isEven = grid.every((row) => row.length === grid[0]?.length);
    if (isEven && grid.length > 1 && (grid[0]?.length ?? 0) > 1) return { rows: grid, by };
  }
  return { rows: rows.length > 0 ? [rows] : [], by: "none" };
}

/**
 * @param {number[][]} rows
 * @param {number[]} starts  indices, ascending
 * @returns {number[][][]}
 */
function cut(rows, starts) {
  return [0, ...starts].map((start, at) => rows.slice(start, starts[at] ?? rows.length));
}
