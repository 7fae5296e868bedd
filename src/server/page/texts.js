// All texts of the page, to be translated in this one file: of the page, of its form, and of its picture.

import { grouped } from "./figures.js";

/**
 * @param {number} count
 * @param {string} one
 * @param {string} [many]
 * @returns {string}  such as `1 row`, `1 200 rows`
 */
function counted(count, one, many = `${one}s`) {
  return `${grouped(count)} ${count === 1 ? one : many}`;
}

/** Texts of the form, and of what is around it. */
const SHARED = {
  yes: "yes", no: "no", next: "Next",
  fileTooLarge: (/** @type {string} */ name, /** @type {number} */ most) =>
    `${name} is too large for this page. Choose a file of at most ${most / 1e6} MB, or send its content with curl.`,
};

/** Texts around form and picture. */
export const TEXTS = {
  ...SHARED,
  operation: "Operation",
  example: "Example",
  ownRequest: "your own request",
  noOwnRequest: "your own request (none yet)",
  run: "Run",
  cancel: "Cancel",
  request: "Request",
  form: "Form",
  json: "JSON",
  jsonLabel: "The request as JSON",
  copyLink: "Copy link",
  copyCurl: "Copy as curl",
  copied: "Copied.",
  copiedCurl: "Copied for bash, zsh and other POSIX shells. cmd.exe and PowerShell need other quotes around the request.",
  copiedWithFile: (/** @type {string} */ name) =>
    `Copied for any shell. The request is saved as ${name}: run the command in the folder that holds this file.`,
  notCopied: "The browser did not allow copying. Take the link from the address bar, or the request from the tab JSON.",
  open: "Open file",
  picture: "Picture",
  answer: "Answer",
  program: "Program",
  report: "Report",
  take: "Download",
  time: "Time in the program",
  speed: "Speed",
  play: "Play",
  pause: "Pause",
  hint: "Choose an operation and press Run: the path of the tool is drawn here. "
    + "Files can be dropped here too: an NC program, a CL file, a table of points, or a request in JSON.",
  find: "Find",
  goToLine: "Go to line",
  downloadNc: "NC program",
  downloads: { json: "JSON", svg: "SVG", glb: "3D model (glb)", stl: "Triangles (STL)", html: "Work sheet to print" },
  saved: (/** @type {string} */ name) => `Saved as ${name}.`,
  loading: "Loading the form …",
  noContract: "The form could not be loaded. Check that the service runs, and reload the page",
  ready: "Ready. Change the request or press Run.",
  running: "Running …",
  stage: (/** @type {string} */ stage) => `Running: ${stage} …`,
  progress: "Progress of the computation",
  lines: "Lines of the program. The arrow keys choose a line.",
  lineTold: (/** @type {number} */ line, /** @type {string} */ text) => `Line ${line}: ${text}`,
  cancelled: "Cancelled.",
  refused: (/** @type {number} */ count) => 
    `Refused: ${counted(count, "field")} to correct, marked in the form.`,
  failed: (/** @type {string} */ detail) => `Failed: ${detail}`,
  noService: "The service does not answer. Check that it runs, and press Run again.",
  brokenOff: "The answer broke off. Press Run again.",
  done: (/** @type {string} */ seconds, /** @type {number} */ warnings) =>
    `Done in ${seconds} s` + (warnings === 0 ? "." : `, with ${counted(warnings, "warning")}: see the report.`),
  old: "This answer belongs to an earlier request. Press Run.",
  brokenJson: "The text in the tab JSON is no JSON. Correct it there, then press Run.",
  replaceJson: "The tab JSON holds a text that is no JSON. Replace this text by the request of the form?",
  noExample: (/** @type {string} */ name, /** @type {string} */ detail) =>
    `The example ${name} could not be loaded, so the request is empty: ${detail}`,
  noModel: "This answer has nothing to draw. Its figures stand in the report.",
  noPicture: (/** @type {string} */ detail) => `The picture cannot be drawn: ${detail}`,
  contextLost: "The browser has taken the graphics processor away from this page. The picture comes back when the browser "
    + "returns it; if it does not, reload the page.",
  noProgram: "This answer has no program. Its figures stand in the report.",
  noWebGL: "This browser cannot draw in three dimensions (it lacks WebGL 2). "
    + "A flat drawing is shown where the operation has one.",
  sheet: "Drawing of the answer",
  notFound: "Not found in the program.",
  notRead: (/** @type {string} */ name, /** @type {string} */ detail) =>
    `${name} could not be read: ${detail} Open a file, not a folder.`,
  notUnderstood: (/** @type {string} */ name) =>
    `${name} was not understood. Open a request in JSON, an NC program, a CL file, or a table of points (CSV or text).`,
  openedRequest: (/** @type {string} */ name, /** @type {string} */ title) =>
    `${name} is opened as a request for “${title}”. Press Run.`,
  openedProgram: (/** @type {string} */ name, /** @type {string} */ title) =>
    `${name} is opened for “${title}”. Press Run.`,
  openedTable: (/** @type {string} */ name, /** @type {string} */ label, /** @type {string} */ columns,
    /** @type {string} */ note) => `${name} fills “${label}”${columns && ` (${columns})`}: ${note}`,
  noTable: (/** @type {string} */ name, /** @type {string} */ titles) =>
    `${name} holds rows of numbers, but no table of this request takes them. Choose an operation such as ${titles}, `
    + "and open the file again.",
  linkTooLong: "The request is too long for a link. Copy it as curl, or copy the text of the tab JSON.",
  badLink: "The link holds no request that this service knows.",
  warnings: "Warnings",
  measures: "Measures",
  figures: "Figures",
  more: (/** @type {number} */ count) => `${count} more`,
  none: "none",
  entries: (/** @type {number} */ count) => counted(count, "entry", "entries"),
  views: { iso: "Isometric", top: "Top", front: "Front", right: "Right", back: "Back", left: "Left", bottom: "Bottom" },
  view: "View",
  ownView: "Own view",
  fit: "Show all",
  perspective: "Perspective",
  material: "Material",
  colorBy: "Colour by",
  colors: { kind: "kind of move", feed: "feed", deviation: "deviation", level: "level", pass: "pass" },
  assumedStock: "the request states no stock, so its size is assumed",
  obstacles: {
    part: "the answer has no part",
    stock: "the answer has no stock; where the request can state a stock, state it and run again",
    tool: "the request has no tool",
  },
  show: { part: "Part", stock: "Stock", tool: "Tool" },
  speeds: /** @type {[string, number][]} */ ([
    ["0.1 ×", 0.1], ["true time", 1], ["10 ×", 10], ["100 ×", 100], ["1000 ×", 1000],
  ]),
  hit: (/** @type {string} */ kind, /** @type {string} */ place, /** @type {string} */ feed, /** @type {number} */ block) =>
    `${VIEW_TEXTS.kinds[kind] ?? kind} at ${place}${feed}${block > 0 ? `, line ${block}` : ""}`,
  charts: {
    title: "Over the time of the program",
    motionTitle: "Over the time of the motion",
    motion: "The motion has ramps, and leaves out the ways in and out, so its times are not those of the program.",
    feed: { name: "Feed", unit: "mm/min" },
    height: { name: "Z of the tip", unit: "mm" },
    before: "before",
    after: "after",
    beforeAndAfter: (/** @type {string} */ before, /** @type {string} */ after) => `before ${before}, after ${after}`,
    label: (/** @type {string} */ title, /** @type {string} */ low, /** @type {string} */ high) =>
      `${title}, from ${low} to ${high}, over time`,
  },
  patternTimes: "Times of the patterns",
  chosen: "chosen",
};

/** Texts of the form. */
export const FORM_TEXTS = {
  ...SHARED,
  // Numbers.
  noNumber: (/** @type {string} */ text) => `“${text}” is no number. Type one such as 12.5.`,
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
  unknownChoice: (/** @type {string} */ value) => `“${value}” is not among the choices.`,
  tooLong: (/** @type {number} */ most) => `This text is too long: at most ${counted(most, "character")}.`,
  largeText: (/** @type {number} */ length, /** @type {number} */ shown) =>
    `${counted(length, "character")}: too many to edit here. The first ${grouped(shown)} are shown.`,
  replaceText: "Empty this text",
  asJson: "Shown as JSON, because the value does not fit the fields of the form.",
  noJson: (/** @type {number} */ line, /** @type {number} */ column, /** @type {string} */ what) =>
    `This is no JSON: line ${line}, column ${column}: ${what}. The form keeps the last request that could be read.`,
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
  moveUp: (/** @type {string} */ label) => `Move ${label} up`,
  moveDown: (/** @type {string} */ label) => `Move ${label} down`,
  duplicate: (/** @type {string} */ label) => `Duplicate ${label}`,
  withKeys: (/** @type {string} */ name, /** @type {string} */ keys) => `${name} (${keys})`,
  more: (/** @type {number} */ count) => counted(count, "more field"),
  furtherMembers: (/** @type {string} */ names) => `Also in the request, to be edited in the tab JSON: ${names}.`,
  items: (/** @type {number} */ count) => counted(count, "entry", "entries"),
  item: (/** @type {string} */ label, /** @type {number} */ number) => `${label} ${number}`,
  entry: "Entry",
  point: "Point",
  gridRow: "Row",
  addItem: (/** @type {string} */ label) => `Add ${label.toLowerCase()}`,
  page: (/** @type {number} */ first, /** @type {number} */ last, /** @type {number} */ count) =>
    `${first}–${last} of ${grouped(count)}`,
  previous: "Previous",
  mapName: "Name",
  mapValue: "Text",
  nameTwice: "Another entry has this name already. Choose another name.",
  kind: "Kind",
  untagged: "in the request",
  /** @type {Record<string, string>} */
  shapes: {
    number: "a number", integer: "a whole number", text: "a text", points: "a table of points", numbers: "numbers",
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
  paste: "Paste rows, or load a file",
  pasteHere: "Paste rows of a spreadsheet here. They take the place of the table.",
  file: "Or choose a file of text or CSV",
  tableHelp: "Arrow keys move between cells. The Insert key, and Enter in the last row, add a row; "
    + "Ctrl+Delete removes one. Rows of a spreadsheet can be pasted, and a text or CSV file dropped here.",
  undo: "Undo",
  undone: "Undone.",
  nothingRead: "No rows of numbers were found, so the table is as before. Each line needs numbers only.",
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
    `${counted(rows, "row")} of points, ${by}`,
  /** @type {Record<string, string>} */
  gridBy: {
    blank: "split at blank lines", "0": "split where x changes", "1": "split where y changes",
    none: "not split: put a blank line between rows",
  },
  tooWide: (/** @type {number} */ most) => `Some rows have more than ${counted(most, "number")}. Remove the others.`,

  // Errors and the JSON text.
  errors: (/** @type {number} */ count) =>
    (count === 1 ? "One field needs another value:" : `${count} fields need other values:`),
  wholeRequest: "the request",
  abridged: (/** @type {number} */ kilobytes) =>
    `Shortened: the whole JSON has more than ${kilobytes} kB, and editing it here may be slow.`,
  editAnyway: "Edit anyway",
  left: (/** @type {number} */ count) => `… ${grouped(count)} more`,
};

/** Texts of the picture. */
export const VIEW_TEXTS = {
  kinds: /** @type {Record<string, string>} */ ({
    rapid: "Rapid", cut: "Cut", plunge: "Plunge", ramp: "Ramp", lead_in: "Lead-in", link: "Link",
    lead_out: "Lead-out", dwell: "Dwell", turn: "Turn of a rotary axis",
  }),
  feed: "Feed", feedUnit: "mm/min", noFeed: "Rapid or no feed told",
  deviation: "Deviation, at most", deviationUnit: "mm", noDeviation: "Deviation not known",
  level: "Level", noLevel: "Without level",
  pass: "Pass", noPass: "Without pass",
  left: "Left on the part", leftUnit: "mm", gouged: "Cut into the part",
  material: {
    noStock: "The material is not shown: the stock is unknown.",
    noTool: "The material is not shown: the tool is unknown.",
    fiveAxes: "The material is not shown: the tool leans, and the view cuts with an upright tool only.",
  },
  axes: /** @type {const} */ (["X", "Y", "Z"]),
  scale: (/** @type {string} */ grid, /** @type {string[]} */ size) =>
    `Grid ${grid} mm; size ${size.join(" × ")} mm`,
  keys: "Arrows turn, Shift and arrows move, + and - zoom, 1 to 7 are views, F shows all.",
  nothing: "3D view: nothing to show.",
  shown: (/** @type {string[]} */ parts) => `3D view: ${parts.join("; ")}.`,
  path: (/** @type {number} */ n, /** @type {string[]} */ kinds) =>
    `path of ${grouped(n)} stretches (${kinds.join(", ").toLowerCase()})`,
  part: "part",
  stock: (/** @type {string[]} */ size) => `stock ${size.join(" × ")} mm`,
  removal: "material as it is cut",
  cutting: (/** @type {number} */ percent) => `Cutting the material: ${percent} %`,
  tool: (/** @type {string} */ shape, /** @type {string} */ d) => `${shape.replace("_", " ")} cutter ${d} mm`,
  toolAt: (/** @type {string[]} */ place, /** @type {string} */ time) =>
    `tip at X ${place[0]} Y ${place[1]} Z ${place[2]} mm after ${time} s`,
  seen: { perspective: "in perspective", orthographic: "without perspective" },
};
