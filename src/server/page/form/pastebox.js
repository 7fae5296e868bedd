// Takes rows of numbers that are pasted, dropped or in a file, says what it understood, and can undo it.
import { el } from "../dom.js";
import { button } from "./dom.js";
import { parseTable } from "../paste.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";

/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("../paste.js").Table} Table */
/**
 * @typedef {object} Target
 * @property {{least: number, most: number, columns: string[]}} width  how many numbers a row may have, and their names
 * @property {(text: string) => {value: unknown, note: string} | null} read  null where there are no numbers
 * @property {() => unknown} current
 * @property {(value: unknown) => void} apply
 */

/** A larger file is not read: more bytes than any table of the contract may have. */
const LARGEST_FILE = 64_000_000;
/** As many skipped lines are told one by one. */
const LINES = 3;

/** A closed section with a place to paste into and a choice of a file; a line tells what was read. */
export class PasteBox {
  /** @param {Context} context @param {string} label  of the table @param {Target} target */
  constructor(context, label, target) {
    this.label = label;
    this.target = target;
    context.boxes.push(this);
    /** @type {unknown} */
    this.before = undefined;
    const id = context.id();
    this.text = el("textarea", { rows: 2, id, class: "form-text-input", input: () => this.#take() });
    this.file = el("input", { type: "file", id: `${id}-file`, accept: ".csv,.txt,.tsv,.xyz,text/*" });
    this.file.addEventListener("change", () => this.#load(this.file.files?.[0]));
    this.note = el("span", { role: "status" });
    this.undo = button(TEXTS.undo, () => this.#undo());
    this.undo.hidden = true;
    this.details = el("details", { class: "form-paste" },
      el("summary", { "aria-label": `${TEXTS.paste}: ${label}` }, TEXTS.paste),
      el("label", { for: id }, TEXTS.pasteHere), this.text,
      el("label", { for: this.file.id }, TEXTS.file), this.file);
    this.element = el("div", {}, el("p", { class: "form-note" }, this.note, " ", this.undo), this.details);
  }

  /**
   * Reads files and texts that are dropped on an element.
   * @param {HTMLElement} element
   */
  takeDrops(element) {
    element.addEventListener("dragover", (event) => {
      event.preventDefault();
      event.stopPropagation();
      element.classList.add("form-drop");
    });
    element.addEventListener("dragleave", () => element.classList.remove("form-drop"));
    element.addEventListener("drop", (event) => {
      event.preventDefault();
      event.stopPropagation();
      element.classList.remove("form-drop");
      const file = event.dataTransfer?.files[0];
      if (file) this.#load(file);
      else this.take(event.dataTransfer?.getData("text/plain") ?? "");
    });
  }

  /** @returns {string} what was said last */
  get told() {
    return this.note.textContent ?? "";
  }

  /**
   * @param {string} text
   * @returns {boolean}  whether the rows of a text are as wide as those of the table
   */
  fits(text) {
    const { least, most } = this.target.width;
    const { rows } = parseTable(text, this.target.width);
    return rows.length > 0 && rows.every((row) => row.length >= least && row.length <= most);
  }

  /**
   * Reads a text in place of the value.
   * @param {string} text
   * @returns {boolean}  whether the text had numbers
   */
  take(text) {
    const read = this.target.read(text);
    if (read) this.put(read.value, read.note);
    else this.say(TEXTS.nothingRead, false);
    return read !== null;
  }

  /**
   * Replaces the value, so that it can be undone.
   * @param {unknown} value
   * @param {string} note
   */
  put(value, note) {
    this.before = this.target.current();
    this.target.apply(value);
    this.say(note, true);
  }

  /** @param {string} note @param {boolean} canUndo */
  say(note, canUndo) {
    this.note.textContent = note;
    this.undo.hidden = !canUndo;
  }

  #take() {
    if (this.text.value.trim() === "") return;
    this.take(this.text.value);
    this.text.value = "";
  }

  /** @param {File | undefined} file */
  async #load(file) {
    if (!file) return;
    if (file.size > LARGEST_FILE) this.say(TEXTS.fileTooLarge(file.name, LARGEST_FILE), false);
    else this.take(await file.text());
    this.file.value = "";
  }

  /** Another request is shown: what was said and replaced belongs to the one before. */
  forget() {
    this.before = undefined;
    this.say("", false);
  }

  #undo() {
    this.target.apply(this.before);
    this.before = undefined;
    this.say(TEXTS.undone, false);
    this.text.focus();
  }
}

/**
 * Says how a text was read.
 * @param {Table} table
 * @returns {string}  such as `120 rows of 3 numbers, separated by tabs, decimal comma; 1 line skipped: …`
 */
export function understood(table) {
  const least = table.rows.reduce((low, row) => Math.min(low, row.length), Infinity);
  const most = table.rows.reduce((high, row) => Math.max(high, row.length), 0);
  const how = [TEXTS.separators[table.separator], TEXTS.decimals[table.decimal]].join(", ");
  const parts = [TEXTS.understood(table.rows.length, TEXTS.numbersOf(least, most), how)];
  if (table.header) parts.push(TEXTS.headerRead(table.header.join(", ").slice(0, 80)));
  const { skipped } = table;
  if (skipped.length > 0) {
    const told = skipped.slice(0, LINES).map(({ line, text }) => TEXTS.skippedLine(line, text));
    parts.push(TEXTS.skipped(skipped.length, told.join(", ") + (skipped.length > LINES ? ", …" : "")));
  }
  if (table.isAmbiguous) parts.push(TEXTS.ambiguous);
  return parts.join("; ");
}
