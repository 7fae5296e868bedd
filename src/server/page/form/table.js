// A table of numbers. Only the rows and columns that are seen are in the document.
import { parseTable } from "../paste.js";
import { el } from "../dom.js";
import { button, Frame, setInvalid } from "./dom.js";
import { numberProblem, rangeText, readNumber, typedValue } from "./number.js";
import { PasteBox, understood } from "./pastebox.js";
import { cellAt, columnCount, valueOf, withBlock, withCell, withoutRow, withRow } from "./rows.js";
import { keepTyped, numberInput } from "./scalars.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";

/** @typedef {import("./dom.js").Control} Control */
/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("./dom.js").Emit} Emit */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./value.js").Path} Path */
/** @typedef {import("./rows.js").Rows} Rows */

/** As many rows are in the document; the part that is seen is about a third of them. */
const ROWS = 36;
/** Rows in the document above the first row that is seen. */
const ABOVE = 12;
/** As many columns are in the document. */
const COLUMNS = 12;
/** Height of a row in pixels until one is measured. */
const HEIGHT = 32;

/**
 * Points, or a column of numbers.
 * @implements {Control}
 */
export class TableControl {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    this.field = field;
    this.emit = emit;
    this.range = field.kind === "numbers" ? field.item() : field;
    this.frame = new Frame(context, field, rangeText(this.range));
    /** @type {Rows} */
    this.rows = [];
    this.columns = 0;
    /** @type {Map<string, string>} errors of the service by `row` and `row/column` */
    this.faults = new Map();
    this.first = 0;
    this.left = 0;
    /** The cell that had the focus last. @type {{row: number, column: number} | null} */
    this.at = null;
    /** @type {{element: HTMLTableRowElement, head: HTMLElement, inputs: HTMLInputElement[]}[]} */
    this.shown = [];
    this.head = el("tr", {});
    this.above = el("td", {});
    this.below = el("td", {});
    this.body = el("tbody", {
      input: (/** @type {Event} */ event) => this.#typed(event),
      keydown: (/** @type {KeyboardEvent} */ event) => this.#pressed(event),
      paste: (/** @type {ClipboardEvent} */ event) => this.#pasted(event),
      focusin: (/** @type {Event} */ event) => this.#entered(event),
    });
    const table = el("table", { "aria-label": field.label }, el("thead", {}, this.head),
      el("tbody", { "aria-hidden": "true" }, el("tr", {}, this.above)), this.body,
      el("tbody", { "aria-hidden": "true" }, el("tr", {}, this.below)));
    this.table = table;
    this.scroller = el("div", { class: "form-table", tabindex: -1, scroll: () => this.#scrolled() }, table);
    this.width = field.kind === "numbers" ? { least: 1, most: 1, columns: [] } : field;
    this.box = new PasteBox(context, field.label, {
      width: this.width,
      read: (text) => this.#read(text, 0, 0),
      current: () => this.rows,
      apply: (rows) => this.#change(/** @type {Rows} */ (rows)),
    });
    this.element = this.frame.group(this.scroller, this.#bar(), this.box.element);
    this.box.takeDrops(this.element);
    this.update(value);
  }

  #bar() {
    this.count = el("span", { class: "form-note", role: "status" });
    this.remove = button("", () => this.#removeRow());
    this.previous = button(TEXTS.previous, () => this.#turn(-COLUMNS));
    this.next = button(TEXTS.next, () => this.#turn(COLUMNS));
    this.add = button(TEXTS.addRow, () => this.#addRow(this.rows.length));
    const help = el("p", { class: "form-note", id: `${this.frame.id}-keys` }, TEXTS.tableHelp);
    this.table.setAttribute("aria-describedby", help.id);
    this.box.details.append(help);
    return el("div", { class: "form-bar" }, this.add, this.remove, this.previous, this.next, this.count);
  }

  /** @param {unknown} value */
  update(value) {
    this.box.forget();
    this.rows = Array.isArray(value) ? value : [];
    if (!this.body.contains(document.activeElement)) this.at = null;
    this.#draw();
  }

  /** @param {Rows} rows */
  #change(rows) {
    this.rows = rows;
    this.clear();
    this.#draw();
    this.emit(rows);
  }

  #draw() {
    const columns = columnCount(this.field, this.rows);
    if (columns !== this.columns) {
      this.columns = columns;
      this.#drawHead();
    }
    const { most } = this.field;
    this.frame.setProblem(this.field.kind === "points" && columns > most ? TEXTS.tooWide(most) : "");
    this.table.setAttribute("aria-rowcount", String(this.rows.length + 1));
    const isWide = columns > COLUMNS;
    this.scroller.hidden = this.rows.length === 0;
    if (this.previous) this.previous.hidden = !isWide;
    if (this.next) this.next.hidden = !isWide;
    if (this.count) {
      const columnsText = TEXTS.page(this.left + 1, this.#endColumn(), columns);
      this.count.textContent = TEXTS.rows(this.rows.length) + (isWide ? `, ${columnsText}` : "");
    }
    this.#drawRows();
    this.#nameRemoval();
  }

  /** Says which row would be removed: that of the chosen cell. */
  #nameRemoval() {
    if (this.at && this.at.row >= this.rows.length) this.at = null;
    if (!this.remove) return;
    this.remove.textContent = this.at ? TEXTS.removeRow(this.at.row + 1) : TEXTS.removeNoRow;
    this.remove.disabled = this.at === null;
  }

  #drawHead() {
    this.left = Math.min(this.left, Math.max(0, this.columns - 1));
    const width = this.#endColumn() - this.left;
    const names = Array.from({ length: width }, (_, at) => this.#columnName(this.left + at));
    this.head.replaceChildren(...["#", ...names].map((name) => el("th", { scope: "col" }, name)));
    this.above.colSpan = width + 1;
    this.below.colSpan = width + 1;
    this.body.replaceChildren();
    this.shown = [];
  }

  /** @param {number} column @returns {string} */
  #columnName(column) {
    if (this.field.kind === "numbers") return `${this.field.label} ${this.range.unit}`.trim();
    const name = this.field.columns[column];
    const isLength = name === undefined || /^[xyz]$/.test(name);
    return `${name ?? TEXTS.column(column + 1)} ${isLength ? this.range.unit : ""}`.trim();
  }

  #drawRows() {
    const count = Math.min(ROWS, this.rows.length);
    this.first = Math.max(0, Math.min(this.first, this.rows.length - count));
    while (this.shown.length > count) this.shown.pop()?.element.remove();
    while (this.shown.length < count) this.#appendRow();
    this.shown.forEach((shown, at) => this.#fillRow(shown, this.first + at));
    const height = this.#height();
    this.above.style.height = `${this.first * height}px`;
    this.below.style.height = `${(this.rows.length - this.first - count) * height}px`;
  }

  #appendRow() {
    const head = el("th", { scope: "row" });
    const inputs = Array.from({ length: this.#endColumn() - this.left }, () => numberInput());
    const element = el("tr", {}, head, ...inputs.map((input) => el("td", {}, input)));
    this.body.append(element);
    this.shown.push({ element, head, inputs });
  }

  /** @param {(typeof this.shown)[number]} shown @param {number} row */
  #fillRow({ element, head, inputs }, row) {
    element.setAttribute("aria-rowindex", String(row + 2));
    head.textContent = String(row + 1);
    inputs.forEach((input, at) => {
      const column = this.left + at;
      keepTyped(input, cellAt(this.field, this.rows, row, column));
      const name = this.#columnName(column);
      input.setAttribute("aria-label", TEXTS.cell(row + 1, name));
      this.#check(input, row, column);
    });
  }

  /** @param {HTMLInputElement} input @param {number} row @param {number} column */
  #check(input, row, column) {
    const fault = this.faults.get(`${row}/${column}`) ?? this.faults.get(`${row}`) ?? "";
    const problem = fault || numberProblem(cellAt(this.field, this.rows, row, column), this.range);
    setInvalid(input, problem !== "");
    input.title = problem;
    if (fault) input.setAttribute("aria-describedby", this.frame.error.id);
    else input.removeAttribute("aria-describedby");
  }

  #height() {
    return this.shown[0]?.element.offsetHeight || HEIGHT;
  }

  #scrolled() {
    const { scrollTop, clientHeight } = this.scroller;
    const top = Math.floor(scrollTop / this.#height());
    const end = Math.min(this.rows.length, top + Math.ceil(clientHeight / this.#height()) + 1);
    if (top >= this.first && end <= this.first + this.shown.length) return;
    const hadFocus = this.body.contains(document.activeElement);
    this.first = top - ABOVE;
    this.#drawRows();
    if (!hadFocus || !this.at) return;
    const { row, column } = this.at;
    const input = this.shown[row - this.first]?.inputs[column - this.left];
    (input ?? this.scroller).focus({ preventScroll: true });
  }

  /** @param {number} step  in columns */
  #turn(step) {
    this.left = Math.max(0, Math.min(this.left + step, this.columns - 1));
    this.#drawHead();
    this.#draw();
  }

  /** @param {Event} event @returns {{input: HTMLInputElement, row: number, column: number} | null} */
  #place(event) {
    for (const [at, { inputs }] of this.shown.entries()) {
      const column = inputs.findIndex((input) => input === event.target);
      const input = inputs[column];
      if (input) return { input, row: this.first + at, column: this.left + column };
    }
    return null;
  }

  /** @param {Event} event */
  #typed(event) {
    const place = this.#place(event);
    if (!place) return;
    const { input, row, column } = place;
    this.rows = withCell(this.field, this.rows, row, column, typedValue(input.value));
    this.clear();
    this.#check(input, row, column);
    this.emit(this.rows);
  }

  /** @param {Event} event */
  #entered(event) {
    const place = this.#place(event);
    if (!place) return;
    this.at = place;
    this.#nameRemoval();
  }

  /** @param {KeyboardEvent} event */
  #pressed(event) {
    const place = this.#place(event);
    if (!place || event.altKey || event.isComposing) return;
    const { input, row, column } = place;
    const { selectionStart: start, selectionEnd: end, value: { length } } = input;
    const isAll = start === 0 && end === length;
    const isAtStart = isAll || end === 0;
    const isAtEnd = isAll || start === length;
    const isCtrl = event.ctrlKey || event.metaKey;
    /** @type {Record<string, () => void>} */
    const moves = {
      ArrowUp: () => this.#goTo(row - 1, column),
      ArrowDown: () => this.#goTo(row + 1, column),
      PageUp: () => this.#goTo(Math.max(0, row - ABOVE), column),
      PageDown: () => this.#goTo(Math.min(this.rows.length - 1, row + ABOVE), column),
      Insert: () => this.#addRow(row + 1),
    };
    const isLast = row === this.rows.length - 1;
    if (!isCtrl) moves.Enter = () => (isLast ? this.#addRow(row + 1) : this.#goTo(row + 1, column));
    if (isAtStart && column > 0) moves.ArrowLeft = () => this.#goTo(row, column - 1);
    if (isAtEnd && column < this.columns - 1) moves.ArrowRight = () => this.#goTo(row, column + 1);
    if (isCtrl) moves.Home = () => this.#goTo(0, 0);
    if (isCtrl) moves.End = () => this.#goTo(this.rows.length - 1, this.columns - 1);
    if (isCtrl) moves.Delete = () => this.#removeRow();
    const isLastShown = row === this.first + this.shown.length - 1 && column === this.#endColumn() - 1;
    if (isLastShown && !isLast) moves.Tab = () => this.#goTo(row + 1, this.left);
    const move = event.shiftKey ? undefined : moves[event.key];
    if (!move) return;
    event.preventDefault();
    move();
  }

  #endColumn() {
    return Math.min(this.columns, this.left + COLUMNS);
  }

  /** @param {number} row @param {number} column */
  #goTo(row, column) {
    if (row < 0 || row >= this.rows.length) return;
    const isSeen = column >= this.left && column < this.#endColumn();
    if (!isSeen) this.#turn(column - (column % COLUMNS) - this.left);
    if (row < this.first || row >= this.first + this.shown.length) {
      this.first = row - ABOVE;
      this.#drawRows();
      this.scroller.scrollTop = Math.max(0, (row - 3) * this.#height());
    }
    const input = this.shown[row - this.first]?.inputs[column - this.left];
    input?.focus();
    input?.select();
    input?.scrollIntoView({ block: "nearest" });
  }

  /** @param {number} row */
  #addRow(row) {
    this.#change(withRow(this.field, this.rows, row));
    this.#goTo(row, 0);
  }

  #removeRow() {
    if (!this.at) return;
    const { row, column } = this.at;
    this.#change(withoutRow(this.rows, row));
    if (this.rows.length === 0) this.add?.focus();
    this.#goTo(Math.min(row, this.rows.length - 1), column);
  }

  /** @param {ClipboardEvent} event */
  #pasted(event) {
    const place = this.#place(event);
    const text = event.clipboardData?.getData("text/plain") ?? "";
    if (!place || readNumber(text) !== null) return;
    const read = this.#read(text, place.row, place.column);
    if (!read) return;
    event.preventDefault();
    this.box.put(read.value, read.note);
  }

  /**
   * Reads rows. At the first cell they take the place of the table, elsewhere they replace the cells there.
   * @param {string} text
   * @param {number} row
   * @param {number} column
   * @returns {{value: Rows, note: string} | null}
   */
  #read(text, row, column) {
    const table = parseTable(text, this.width);
    if (table.rows.length === 0) return null;
    const note = `${understood(table)}.`;
    if (row === 0 && column === 0) return { value: valueOf(this.field, table.rows), note };
    return { value: withBlock(this.field, this.rows, row, column, table.rows), note };
  }

  /** @param {Path} path */
  reveal(path) {
    return { control: this, path };
  }

  /** @param {string} text @param {Path} path */
  mark(text, path) {
    if (path.length > 0) this.faults.set(path.slice(0, 2).join("/"), text);
    const place = path.length > 0 ? `${TEXTS.row(Number(path[0]) + 1)}: ` : "";
    this.frame.addFault(place + text);
    this.#drawRows();
    return this.frame.id;
  }

  clear() {
    this.frame.setFault("");
    if (this.faults.size === 0) return;
    this.faults.clear();
    this.#drawRows();
  }

  /** @param {Path} path */
  focus(path) {
    if (this.rows.length === 0) this.add?.focus();
    else this.#goTo(Number(path[0] ?? 0), Number(path[1] ?? 0));
  }
}
