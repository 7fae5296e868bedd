// The fields that hold members: objects, and variants, which are one of several objects or values.
import { el, rich } from "../dom.js";
import { button, Frame } from "./dom.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";
import { blankOf, canShow, isFixed, isSimple, shapeOf, shownAs } from "./tree.js";
import { isObject, withMember } from "./value.js";

/** @typedef {import("./dom.js").Control} Control */
/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("./dom.js").Emit} Emit */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./field.js").Shape} Shape */
/** @typedef {import("./value.js").Path} Path */

/**
 * The place of a field: holds the control that can show the value, or a button that adds the value.
 * @implements {Control}
 */
export class Slot {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    this.context = context;
    this.field = field;
    this.emit = emit;
    this.kind = "";
    /** @type {unknown} */
    this.value = undefined;
    /** What was removed, to be added again. @type {unknown} */
    this.removed = undefined;
    /** @type {Control | null} */
    this.control = null;
    this.id = context.id();
    this.error = el("p", { class: "form-error", id: `${this.id}-error`, hidden: true });
    this.element = el("div", { class: "form-slot" });
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    this.removed = undefined;
    // A list shows its entries again when one of them changes.
    if (value !== this.value || this.kind === "") this.#show(value);
  }

  /** @param {unknown} value */
  #show(value) {
    this.value = value;
    const field = shownAs(this.field, value);
    const canBeAdded = !this.field.required && !isSimple(this.field);
    const kind = canBeAdded && value === undefined ? "absent" : field.kind;
    if (kind === this.kind) this.control?.update(value);
    else this.#build(kind, field, value, canBeAdded);
  }

  /** @param {string} kind @param {Field} field @param {unknown} value @param {boolean} canBeAdded */
  #build(kind, field, value, canBeAdded) {
    this.kind = kind;
    this.error.hidden = true;
    this.control = kind === "absent" ? null : this.context.make(field, value, (next) => this.#tell(next));
    const parts = [this.control?.element ?? this.#addLine(), this.error];
    if (canBeAdded && this.control) parts.unshift(this.#removeButton());
    this.element.replaceChildren(...parts);
  }

  #addLine() {
    const { label, name, help } = this.field;
    const add = button(TEXTS.add(label), () => this.#replace(this.removed ?? blankOf(this.field) ?? {}), "form-add");
    add.id = this.id;
    add.title = name;
    add.setAttribute("aria-describedby", `${this.error.id} ${this.id}-help`);
    const first = /^.*?[.;:](?=\s|$)/.exec(help)?.[0] ?? help;
    return el("div", {}, add, " ", el("span", { class: "form-note", id: `${this.id}-help` }, ...rich(first)));
  }

  #removeButton() {
    const remove = button("×", () => {
      this.removed = this.value;
      this.#replace(undefined);
    }, "form-remove");
    remove.setAttribute("aria-label", TEXTS.remove(this.field.label));
    remove.title = TEXTS.remove(this.field.label);
    return remove;
  }

  /** @param {unknown} value */
  #replace(value) {
    this.#show(value);
    this.emit(value);
    this.focus([]);
  }

  /** @param {unknown} value */
  #tell(value) {
    this.value = value;
    this.emit(value);
  }

  /** @param {Path} path @returns {{control: Control, path: Path}} */
  reveal(path) {
    return this.control?.reveal(path) ?? { control: this, path };
  }

  /** @param {string} text @param {Path} path */
  mark(text, path) {
    if (this.control) return this.control.mark(text, path);
    this.error.replaceChildren(...rich(text));
    this.error.hidden = false;
    return this.id;
  }

  clear() {
    this.error.hidden = true;
    this.control?.clear();
  }

  /** @param {Path} path */
  focus(path) {
    if (this.control) this.control.focus(path);
    else this.element.querySelector("button")?.focus();
  }
}

/**
 * An object: its members, those that are not set under a closed section.
 * @implements {Control}
 */
export class ObjectControl {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    this.context = context;
    this.field = field;
    this.emit = emit;
    this.frame = new Frame(context, field);
    /** @type {Map<string, Slot>} */
    this.slots = new Map();
    this.members = field.members().filter((member) => !isFixed(member));
    /** @type {Record<string, unknown>} */
    this.value = {};
    /** @type {string[]} */
    this.order = [];
    this.top = el("div", { class: "form-members" });
    this.rest = el("div", { class: "form-members" });
    this.count = el("summary", {});
    /** @type {string | null} names of the members on top */
    this.onTop = null;
    this.more = el("details", { class: "form-more", toggle: () => this.#fillRest() }, this.count, this.rest);
    this.further = el("p", { class: "form-note", hidden: true });
    this.element = this.frame.group(this.top, this.more, this.further);
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    this.value = isObject(value) ? value : /** @type {Record<string, unknown>} */ (blankOf(this.field));
    this.order = [...new Set([...Object.keys(this.value), ...this.order])];
    for (const [name, slot] of this.slots) slot.update(this.value[name]);
    this.#arrange();
    const names = this.field.members().map(({ name }) => name);
    const further = Object.keys(this.value).filter((name) => !names.includes(name));
    this.further.textContent = TEXTS.furtherMembers(further.slice(0, 20).join(", "));
    this.further.hidden = further.length === 0;
  }

  /** Puts required members and those that are set on top. Nothing is moved while a member has the focus. */
  #arrange() {
    const onTop = this.members.filter(({ name, required }) => required || this.value[name] !== undefined);
    const names = onTop.map(({ name }) => name).join();
    if (names === this.onTop || this.element.contains(document.activeElement)) return;
    this.onTop = names;
    this.top.replaceChildren(...onTop.map((member) => this.#slot(member).element));
    const left = this.members.length - onTop.length;
    this.count.textContent = TEXTS.more(left);
    this.more.hidden = left === 0;
    if (onTop.length === 0) this.more.open = true;
    this.#fillRest();
  }

  /** @param {string} name */
  #isOnTop(name) {
    return this.slots.get(name)?.element.parentElement === this.top;
  }

  /** @param {Field} member @returns {Slot} */
  #slot(member) {
    const { name } = member;
    const before = this.slots.get(name);
    if (before) return before;
    const slot = new Slot(this.context, member, this.value[name], (value) => {
      this.value = withMember(this.value, name, value, this.order);
      if (!this.order.includes(name)) this.order.push(name);
      this.frame.setFault("");
      this.emit(this.value);
    });
    this.slots.set(name, slot);
    return slot;
  }

  #fillRest() {
    if (!this.more.open) return;
    const others = this.members.filter(({ name }) => !this.#isOnTop(name));
    const rest = others.map((member) => this.#slot(member).element);
    if (rest.length !== this.rest.childElementCount) this.rest.replaceChildren(...rest);
  }

  /** @param {Path} path @returns {{control: Control, path: Path}} */
  reveal(path) {
    const [name, ...rest] = path;
    if (!this.members.some((member) => member.name === name)) return { control: this, path };
    if (!this.#isOnTop(String(name))) {
      this.more.open = true;
      this.#fillRest();
    }
    return this.slots.get(String(name))?.reveal(rest) ?? { control: this, path };
  }

  /** @param {string} text @param {Path} path */
  mark(text, [name, ...rest]) {
    const slot = this.slots.get(String(name));
    if (slot) return slot.mark(text, rest);
    this.frame.addFault(text);
    return this.frame.id;
  }

  clear() {
    this.frame.setFault("");
    for (const slot of this.slots.values()) slot.clear();
  }

  /** @param {Path} [_path] */
  focus(_path) {
    const first = this.slots.values().next().value;
    if (first && !this.frame.fault) first.focus([]);
    else this.element.focus();
  }
}

/**
 * One of several shapes, chosen by a list.
 * @implements {Control}
 */
export class VariantControl {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    this.context = context;
    this.field = field;
    this.emit = emit;
    this.frame = new Frame(context, field, "");
    /** @type {Map<string, unknown>} values of the shapes that were shown before */
    this.before = new Map();
    /** @type {Shape | undefined} */
    this.shape = undefined;
    /** @type {Slot | null} */
    this.slot = null;
    this.value = value;
    this.body = el("div", {});
    this.note = el("p", { class: "form-note", "aria-live": "polite" });
    this.select = el("select", { id: `${this.frame.id}-kind`, change: () => this.#choose() },
      el("option", { value: "" }, TEXTS.choose),
      ...field.shapes().map(({ name, label }) => el("option", { value: name }, label)));
    this.frame.describe(this.select);
    const label = el("label", { for: this.select.id, class: "form-label" },
      el("span", { title: field.tag || TEXTS.kind }, TEXTS.kind));
    const line = el("div", { class: "form-field" }, label, this.select, this.note);
    this.element = this.frame.group(line, this.body);
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    this.before.clear();
    this.value = value;
    const shape = shapeOf(this.field, value);
    if (shape === this.shape) this.slot?.update(value);
    else if (!this.#isTyping(value)) this.#show(shape, value);
  }

  /** @param {unknown} value */
  #isTyping(value) {
    return this.body.contains(document.activeElement) && !this.field.tag
      && this.shape !== undefined && canShow(this.shape.field(), value);
  }

  #choose() {
    if (this.shape) this.before.set(this.shape.name, this.value);
    const shape = this.field.shapes().find(({ name }) => name === this.select.value);
    const value = shape && (this.before.get(shape.name) ?? this.#carried(shape.field()));
    this.value = value;
    this.#show(shape, value);
    this.emit(value);
  }

  /** @param {Field} field @returns {unknown}  a new value, with the members that the old value shares */
  #carried(field) {
    const blank = blankOf(field);
    if (!isObject(blank) || !isObject(this.value)) return blank;
    const names = field.members().filter((member) => !isFixed(member)).map(({ name }) => name);
    const shared = Object.entries(this.value).filter(([name]) => names.includes(name));
    return { ...blank, ...Object.fromEntries(shared) };
  }

  /** @param {Shape | undefined} shape @param {unknown} value */
  #show(shape, value) {
    this.shape = shape;
    this.select.value = shape?.name ?? "";
    const label = this.field.tag ? shape?.label ?? "" : this.field.label;
    const field = shape && { ...shape.field(), name: "", label, required: true };
    this.note.replaceChildren(...rich(this.field.tag ? field?.help ?? "" : ""));
    const isAlone = field !== undefined && isFixed(field);
    this.slot = !field || isAlone ? null : new Slot(this.context, field, value, (next) => {
      this.value = next;
      this.frame.setFault("");
      this.emit(next);
    });
    this.body.replaceChildren(...(this.slot ? [this.slot.element] : []));
  }

  /** The slot that shows a place; null for the choice itself. @param {Path} path */
  #slotOf(path) {
    return path.length === 0 || path[0] === this.field.tag ? null : this.slot;
  }

  /** @param {Path} path @returns {{control: Control, path: Path}} */
  reveal(path) {
    return this.#slotOf(path)?.reveal(path) ?? { control: this, path };
  }

  /** @param {string} text @param {Path} path */
  mark(text, path) {
    const slot = this.#slotOf(path);
    if (slot) return slot.mark(text, path);
    this.frame.addFault(text);
    return this.select.id;
  }

  clear() {
    this.frame.setFault("");
    this.slot?.clear();
  }

  /** @param {Path} path */
  focus(path) {
    const slot = this.#slotOf(path);
    if (slot) slot.focus(path);
    else this.select.focus();
  }
}
