// The field of a list, of which one page is in the document.
import { el } from "../dom.js";
import { button, Frame } from "./dom.js";
import { brief } from "./jsontext.js";
import { Slot } from "./object.js";
import { gridOf, parseTable } from "../paste.js";
import { PasteBox, understood } from "./pastebox.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";
import { blankItem, emptyItem, isSimple } from "./tree.js";
import { withItem } from "./value.js";

/** @typedef {import("./dom.js").Control} Control */
/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("./dom.js").Emit} Emit */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./value.js").Path} Path */
/**
 * @typedef {object} Row
 * @property {HTMLElement} element
 * @property {HTMLDetailsElement | null} details  null for a simple entry
 * @property {HTMLElement} summary
 * @property {{up: HTMLButtonElement, down: HTMLButtonElement, remove: HTMLButtonElement}} buttons
 * @property {Slot | null} slot  null until the entry is opened
 */

/** As many entries are in the document at once. */
const PAGE = 20;
/** Of a list that is no longer than this, the entries are open at first. */
const OPEN = 2;

/**
 * A list of values of one kind.
 * @implements {Control}
 */
export class ListControl {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    this.context = context;
    this.field = field;
    this.item = field.item();
    this.emit = emit;
    this.frame = new Frame(context, field, "");
    /** @type {readonly unknown[]} */
    this.value = Array.isArray(value) ? value : [];
    this.first = 0;
    /** Errors of entries, those of other pages too. @type {{path: Path, text: string}[]} */
    this.faults = [];
    /** @type {PasteBox | null} */
    this.box = null;
    /** @type {Row[]} */
    this.rows = [];
    this.list = el("div", { class: "form-list" });
    this.count = el("span", { class: "form-note", role: "status" });
    this.previous = button(TEXTS.previous, () => this.#turn(-PAGE));
    this.next = button(TEXTS.next, () => this.#turn(PAGE));
    this.add = button(TEXTS.addItem(this.item.label), () => this.#add());
    const bar = el("div", { class: "form-bar" }, this.previous, this.next, this.add, this.count);
    this.element = this.frame.group(this.list, bar);
    if (this.item.kind === "points") this.#addPasteBox();
    this.#draw();
  }

  /** Adds a box that takes all rows of points at once. */
  #addPasteBox() {
    const box = new PasteBox(this.context, this.field.label, {
      width: this.item,
      read: (text) => {
        const table = parseTable(text, this.item);
        const grid = gridOf(table);
        const by = TEXTS.gridRead(grid.rows.length, TEXTS.gridBy[grid.by] ?? "");
        return table.rows.length === 0 ? null : { value: grid.rows, note: `${understood(table)}. ${by}.` };
      },
      current: () => this.value,
      apply: (value) => this.#change(/** @type {unknown[]} */ (value)),
    });
    box.takeDrops(this.element);
    this.element.append(box.element);
    this.box = box;
  }

  /** @param {unknown} value */
  update(value) {
    this.box?.forget();
    this.value = Array.isArray(value) ? value : [];
    this.#draw();
  }

  /** @param {readonly unknown[]} value */
  #change(value) {
    this.value = value;
    this.faults = [];
    this.frame.setFault("");
    this.#draw();
    this.emit(value);
  }

  #draw() {
    const last = Math.max(0, Math.floor((this.value.length - 1) / PAGE) * PAGE);
    this.#goTo(Math.min(this.first, last));
    const end = this.value.length - 1;
    const shown = this.value.slice(this.first, this.first + PAGE);
    while (this.rows.length > shown.length) this.rows.pop()?.element.remove();
    shown.forEach((value, at) => {
      const row = this.rows[at] ?? this.#addRow(at, value);
      row.slot?.update(value ?? undefined);
      row.summary.textContent = this.#heading(at, value);
      row.buttons.up.disabled = this.first + at === 0;
      row.buttons.down.disabled = this.first + at === end;
    });
    const count = this.value.length;
    const isLong = count > PAGE;
    this.previous.hidden = !isLong;
    this.next.hidden = !isLong;
    this.previous.disabled = this.first === 0;
    this.next.disabled = this.first + PAGE >= count;
    this.count.textContent = isLong
      ? TEXTS.page(this.first + 1, this.first + shown.length, count) : TEXTS.items(count);
  }

  /** @param {number} at @param {unknown} value */
  #heading(at, value) {
    return `${TEXTS.item(this.item.label, this.first + at + 1)}: ${brief(value)}`;
  }

  /** @param {number} at  within the page @param {unknown} value @returns {Row} */
  #addRow(at, value) {
    const summary = el("summary", {});
    const label = TEXTS.item(this.item.label, this.first + at + 1);
    const details = isSimple(this.item) ? null
      : el("details", { toggle: () => this.#fill(at) }, summary);
    const index = this.first + at;
    const up = named("↑", TEXTS.moveUp(label), () => this.#move(index, -1), "Alt+ArrowUp");
    const down = named("↓", TEXTS.moveDown(label), () => this.#move(index, 1), "Alt+ArrowDown");
    const copy = named("", TEXTS.duplicate(label), () => this.#duplicate(index));
    copy.classList.add("form-copy");
    const remove = named("×", TEXTS.remove(label), () => this.#remove(index));
    const element = el("div", {
      class: "form-entry",
      keydown: (/** @type {KeyboardEvent} */ event) => this.#pressed(event, index),
    }, el("div", { class: "form-tools" }, up, down, copy, remove), ...(details ? [details] : []));
    /** @type {Row} */
    const row = { element, details, summary, buttons: { up, down, remove }, slot: null };
    this.rows[at] = row;
    if (!details) {
      row.slot = this.#slot(at, label, value);
      element.append(row.slot.element);
      this.#markAgain(at);
    } else if (this.value.length <= OPEN) {
      details.open = true;
      this.#fill(at);
    }
    this.list.append(element);
    return row;
  }

  /** @param {number} at */
  #fill(at) {
    const row = this.rows[at];
    if (!row?.details?.open || row.slot) return;
    row.slot = this.#slot(at, this.item.label, this.value[this.first + at]);
    row.details.append(row.slot.element);
    this.#markAgain(at);
  }

  /** Shows the errors of an entry whose fields are made anew. @param {number} at */
  #markAgain(at) {
    const slot = this.rows[at]?.slot;
    for (const { path: [index, ...rest], text } of this.faults) {
      if (index !== this.first + at) continue;
      slot?.reveal(rest);
      slot?.mark(text, rest);
    }
  }

  /** @param {number} at @param {string} label @param {unknown} value */
  #slot(at, label, value) {
    return new Slot(this.context, { ...this.item, label }, value ?? undefined, (next) => {
      const item = next ?? emptyItem(this.item);
      this.value = withItem(this.value, this.first + at, item);
      this.faults = this.faults.filter(({ path }) => path[0] !== this.first + at);
      const row = this.rows[at];
      if (row) row.summary.textContent = this.#heading(at, item);
      this.frame.setFault("");
      this.emit(this.value);
    });
  }

  #add() {
    this.#change([...this.value, blankItem(this.item)]);
    this.reveal([this.value.length - 1]).control.focus([]);
  }

  /** @param {number} index */
  #remove(index) {
    this.#rearrange(this.value.filter((_, at) => at !== index), index);
    const row = this.rows[Math.min(index, this.value.length - 1) - this.first];
    (row?.buttons.remove ?? this.add).focus();
  }

  /** @param {number} index */
  #duplicate(index) {
    const copy = structuredClone(this.value[index]);
    this.#rearrange([...this.value.slice(0, index + 1), copy, ...this.value.slice(index + 1)], index + 1);
    this.reveal([index + 1]).control.focus([]);
  }

  /** @param {number} index @param {1 | -1} step  down or up */
  #move(index, step) {
    const to = index + step;
    if (to < 0 || to >= this.value.length) return;
    const value = this.value.slice();
    [value[index], value[to]] = [value[to], value[index]];
    this.#rearrange(value, to);
    const { up, down } = this.rows[to - this.first]?.buttons ?? { up: this.add, down: this.add };
    const [wanted, other] = step < 0 ? [up, down] : [down, up];
    (wanted.disabled ? other : wanted).focus();
  }

  /**
   * Moves an entry by Alt and an arrow key. In a list of choices these keys open the list.
   * @param {KeyboardEvent} event
   * @param {number} index
   */
  #pressed(event, index) {
    const step = { ArrowUp: /** @type {const} */ (-1), ArrowDown: /** @type {const} */ (1) }[event.key];
    const isChoice = /** @type {Element} */ (event.target).tagName === "SELECT";
    if (step === undefined || !event.altKey || isChoice || event.defaultPrevented) return;
    event.preventDefault();
    this.#move(index, step);
  }

  /**
   * Shows entries in another order or number. Those that are open stay open.
   * @param {readonly unknown[]} value
   * @param {number} index  of an entry to be seen
   */
  #rearrange(value, index) {
    const open = new Set(this.rows.flatMap(({ details }, at) => (details?.open ? [this.value[this.first + at]] : [])));
    this.#empty(Math.floor(Math.min(index, value.length - 1) / PAGE) * PAGE);
    this.#change(value);
    this.rows.forEach(({ details }, at) => {
      if (details) details.open = open.has(value[this.first + at]);
      this.#fill(at);
    });
  }

  /** @param {number} step */
  #turn(step) {
    this.#goTo(Math.max(0, this.first + step));
    this.#draw();
  }

  /** @param {number} first  of the page that is shown */
  #goTo(first) {
    if (first !== this.first) this.#empty(first);
  }

  /** @param {number} first  of the page that is shown next */
  #empty(first) {
    this.first = Math.max(0, first);
    this.rows = [];
    this.list.replaceChildren();
  }

  /** @param {Path} path @returns {{control: Control, path: Path}} */
  reveal(path) {
    const [index, ...rest] = path;
    if (typeof index !== "number" || index >= this.value.length) return { control: this, path };
    this.#goTo(Math.floor(index / PAGE) * PAGE);
    this.#draw();
    const row = this.rows[index - this.first];
    if (row?.details) row.details.open = true;
    this.#fill(index - this.first);
    return row?.slot?.reveal(rest) ?? { control: this, path };
  }

  /** @param {string} text @param {Path} path */
  mark(text, path) {
    const [index, ...rest] = path;
    const slot = typeof index === "number" ? this.rows[index - this.first]?.slot : undefined;
    if (!slot) {
      this.frame.addFault(text);
      return this.frame.id;
    }
    this.faults.push({ path, text });
    return slot.mark(text, rest);
  }

  clear() {
    this.faults = [];
    this.frame.setFault("");
    for (const row of this.rows) row.slot?.clear();
  }

  focus() {
    if (this.frame.fault) this.element.focus();
    else this.add.focus();
  }
}

/**
 * A small button with a name for its sign.
 * @param {string} sign
 * @param {string} name
 * @param {() => void} press
 * @param {string} [keys]  that do the same
 * @returns {HTMLButtonElement}
 */
function named(sign, name, press, keys = "") {
  const made = button(sign, press, "form-tool");
  made.setAttribute("aria-label", name);
  if (keys) made.setAttribute("aria-keyshortcuts", keys);
  made.title = keys ? TEXTS.withKeys(name, keys) : name;
  return made;
}
