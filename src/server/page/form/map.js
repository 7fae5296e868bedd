// The field of names with values.
import { el } from "../dom.js";
import { button, Frame, setInvalid } from "./dom.js";
import { Slot } from "./object.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";
import { blankItem, emptyItem } from "./tree.js";
import { isObject } from "./value.js";

/** @typedef {import("./dom.js").Control} Control */
/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("./dom.js").Emit} Emit */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./value.js").Path} Path */

/** As many entries are shown: browsers are slow to lay out more. */
const MOST = 200;

/**
 * Names with values.
 * @implements {Control}
 */
export class MapControl {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    this.context = context;
    this.item = field.item();
    this.emit = emit;
    this.frame = new Frame(context, field, "");
    /** @type {[string, unknown][]} */
    this.entries = [];
    /** @type {{name: HTMLInputElement, slot: Slot, element: HTMLElement}[]} */
    this.rows = [];
    this.list = el("div", { class: "form-list" });
    this.add = button(TEXTS.addItem(TEXTS.entry), () => this.#add());
    this.element = this.frame.group(this.list, el("div", { class: "form-bar" }, this.add));
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    const entries = Object.entries(isObject(value) ? value : {});
    const isTyping = this.entries.some(([name]) => name === "") && this.list.contains(document.activeElement);
    if (isTyping) return;
    this.entries = entries;
    this.#draw();
  }

  #draw() {
    while (this.rows.length > this.entries.length) this.rows.pop()?.element.remove();
    this.entries.slice(0, MOST).forEach(([name, value], at) => {
      const row = this.rows[at] ?? this.#addRow(at, value);
      if (row.name.value !== name) row.name.value = name;
      row.slot.update(value === null ? undefined : value);
    });
  }

  /** @param {number} at @param {unknown} value */
  #addRow(at, value) {
    const name = el("input", {
      type: "text", autocomplete: "off", "aria-label": TEXTS.mapName, placeholder: TEXTS.mapName,
      input: () => this.#change(at, name.value, this.entries[at]?.[1]),
    });
    const field = { ...this.item, label: TEXTS.mapValue, required: true };
    const slot = new Slot(this.context, field, value === null ? undefined : value, (next) =>
      this.#change(at, name.value, next ?? emptyItem(this.item)));
    const remove = button("×", () => this.#remove(at), "form-remove");
    remove.setAttribute("aria-label", TEXTS.remove(TEXTS.item(this.frame.field.label, at + 1)));
    const element = el("div", { class: "form-entry form-pair" }, remove, name, slot.element);
    this.list.append(element);
    const row = { name, slot, element };
    this.rows[at] = row;
    return row;
  }

  /** @param {number} at @param {string} name @param {unknown} value */
  #change(at, name, value) {
    this.entries[at] = [name, value];
    this.#tell();
  }

  /** Tells the entries, unless two have the same name: one of them would be lost. */
  #tell() {
    const names = this.entries.map(([name]) => name).filter((name) => name !== "");
    const isTwice = new Set(names).size < names.length;
    this.frame.setProblem(isTwice ? TEXTS.nameTwice : "");
    for (const { name } of this.rows) {
      setInvalid(name, names.indexOf(name.value) !== names.lastIndexOf(name.value));
    }
    this.frame.setFault("");
    if (!isTwice) this.emit(Object.fromEntries(this.entries.filter(([name]) => name !== "")));
  }

  #add() {
    this.entries.push(["", blankItem(this.item)]);
    this.#draw();
    this.rows.at(-1)?.name.focus();
  }

  /** @param {number} at */
  #remove(at) {
    this.entries.splice(at, 1);
    this.#draw();
    this.#tell();
    this.add.focus();
  }

  /** @param {Path} path @returns {{control: Control, path: Path}} */
  reveal(path) {
    const at = this.entries.findIndex(([name]) => name === String(path[0]));
    return this.rows[at]?.slot.reveal(path.slice(1)) ?? { control: this, path };
  }

  /** @param {string} text @param {Path} path */
  mark(text, [name, ...rest]) {
    const row = this.rows[this.entries.findIndex((entry) => entry[0] === String(name))];
    if (row) return row.slot.mark(text, rest);
    this.frame.addFault(text);
    return this.frame.id;
  }

  clear() {
    this.frame.setFault("");
    for (const row of this.rows) row.slot.clear();
  }

  focus() {
    if (this.frame.fault) this.element.focus();
    else this.add.focus();
  }
}
