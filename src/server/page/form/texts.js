// The texts of the form that people see.

/**
 * @param {number} count
 * @param {string} one
 * @param {string} [many]
 * @returns {string}  such as `1 row`, `1,200 rows`
 */
function counted(count, one, many = `${one}s`) {
  return `${count.toLocaleString("en")} ${count === 1 ? one : many}`;
}

export const TEXTS = {
  // Numbers.
  noNumber: (/** @type {string} */ text) => `“${text}” is no number.`,
  noInteger: "This has to be a whole number.",
  outOfRange: (/** @type {string} */ range, /** @type {string} */ unit) =>
    `${`Allowed: ${range} ${unit}`.trim()}.`,
  atLeast: (/** @type {string} */ min) => `${min} or more`,
  atMost: (/** @type {string} */ max) => `at most ${max}`,
  fromTo: (/** @type {string} */ min, /** @type {string} */ max) => `${min} to ${max}`,
  range: (/** @type {string} */ range, /** @type {string} */ unit) => `${`Range: ${range} ${unit}`.trim()}.`,

  // Fields.
  required: "required",
  help: (/** @type {string} */ label) => `Help on ${label}`,
  helpSign: "?",
  choose: "choose …",
  standard: (/** @type {string} */ value) => `default: ${value}`,
  notSet: "not set",
  yes: "yes",
  no: "no",
  unknownChoice: (/** @type {string} */ value) => `“${value}” is not among the choices.`,
  tooLong: (/** @type {number} */ most) => `At most ${counted(most, "character")}.`,
  largeText: (/** @type {number} */ length, /** @type {number} */ shown) =>
    `${counted(length, "character")}; the first ${shown.toLocaleString("en")} are shown, not to be edited.`,
  replaceText: "Empty this text",
  asJson: "Shown as JSON, because it has another form than the contract describes.",
  noJson: (/** @type {number} */ line, /** @type {number} */ column, /** @type {string} */ what) =>
    `No JSON at line ${line}, column ${column}: ${what}. The form keeps the last legal value.`,
  expected: {
    value: "a value is expected",
    name: "a name in double quotes is expected",
    colon: "a colon is expected",
    next: "a comma or the end is expected",
    end: "nothing more is expected",
    text: "this text does not end, or holds a sign that has to be written as an escape",
  },

  // Objects, lists and maps.
  add: (/** @type {string} */ label) => `Add ${label}`,
  remove: (/** @type {string} */ label) => `Remove ${label}`,
  more: (/** @type {number} */ count) => `${count} more`,
  furtherMembers: (/** @type {string} */ names) => `Also set, to be edited in the JSON: ${names}.`,
  items: (/** @type {number} */ count) => counted(count, "entry", "entries"),
  item: (/** @type {string} */ label, /** @type {number} */ number) => `${label} ${number}`,
  addItem: "Add an entry",
  page: (/** @type {number} */ first, /** @type {number} */ last, /** @type {number} */ count) =>
    `${first}–${last} of ${count.toLocaleString("en")}`,
  previous: "Previous",
  next: "Next",
  mapName: "Name",
  mapValue: "Text",
  nameTwice: "This name is there already.",
  kind: "Kind",
  /** @type {Record<string, string>} */
  shapes: {
    number: "a number", integer: "a whole number", text: "a text", points: "a table", numbers: "numbers",
    list: "a list", object: "members", map: "names and texts", flag: "yes or no", json: "JSON",
  },

  // Tables.
  rows: (/** @type {number} */ count) => counted(count, "row"),
  row: (/** @type {number} */ number) => `row ${number}`,
  column: (/** @type {number} */ number) => `${number}`,
  cell: (/** @type {number} */ row, /** @type {string} */ column) => `Row ${row}, ${column}`,
  addRow: "Add row",
  removeRow: (/** @type {number} */ row) => `Remove row ${row}`,
  removeNoRow: "Remove row",
  paste: "Paste or load",
  pasteHere: "Paste rows of a spreadsheet here. They take the place of the table.",
  file: "Or choose a file of text or CSV",
  tableHelp: "Arrow keys move between cells. The Insert key, and Enter in the last row, add a row; "
    + "Ctrl+Delete removes one. Rows of a spreadsheet can be pasted, and a text or CSV file dropped here.",
  undo: "Undo",
  undone: "Undone.",
  nothingRead: "No numbers were found. The table is as before.",
  understood: (/** @type {number} */ rows, /** @type {string} */ width, /** @type {string} */ how) =>
    `${counted(rows, "row")} of ${width}, ${how}`,
  numbersOf: (/** @type {number} */ least, /** @type {number} */ most) =>
    least === most ? counted(most, "number") : `${least} to ${most} numbers`,
  /** @type {Record<string, string>} */
  separators: {
    "\t": "separated by tabs", ";": "separated by semicolons", ",": "separated by commas",
    " ": "separated by blanks", "": "one in a line",
  },
  /** @type {Record<string, string>} */
  decimals: { ",": "decimal comma", ".": "decimal point", "": "whole numbers" },
  headerRead: (/** @type {string} */ names) => `header: ${names}`,
  skipped: (/** @type {number} */ count, /** @type {string} */ which) =>
    `${counted(count, "line")} skipped: ${which}`,
  skippedLine: (/** @type {number} */ line, /** @type {string} */ text) => `line ${line} “${text}”`,
  ambiguous: "the comma could also be a decimal sign: use semicolons between numbers to be sure",
  gridRead: (/** @type {number} */ rows, /** @type {string} */ by) =>
    `${counted(rows, "row")} of points, split ${by}`,
  /** @type {Record<string, string>} */
  gridBy: { blank: "at blank lines", "0": "where x changes", "1": "where y changes", none: "nowhere" },
  tooWide: (/** @type {number} */ most) => `Some rows have more than ${counted(most, "number")}.`,
  fileTooLarge: (/** @type {string} */ name) => `${name} is too large for a table.`,

  // Errors and the JSON text.
  errors: (/** @type {number} */ count) =>
    (count === 1 ? "One field needs another value:" : `${count} fields need other values:`),
  wholeRequest: "the request",
  abridged: (/** @type {number} */ kilobytes) =>
    `Abridged: the whole JSON has more than ${kilobytes} kB. Editing it here may be slow.`,
  editAnyway: "Edit anyway",
  left: (/** @type {number} */ count) => `… ${count.toLocaleString("en")} more`,
};
