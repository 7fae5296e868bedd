// What fields of the form have in common: label, help and error, and the parts of a field of one input.
import { button as plainButton, el, rich } from "../dom.js";
import { numberProblem, rangeText } from "./number.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./value.js").Path} Path */

/**
 * @typedef {object} Control  the part of the form that shows one value
 * @property {HTMLElement} element
 * @property {(value: unknown) => void} update  shows another value; what has the focus stays
 * @property {(path: Path) => Place} reveal  opens what hides the place, and answers the nearest control
 * @property {(text: string, path: Path) => string} mark  shows an error at the place, once it is revealed; answers the
 *   id of the input
 * @property {() => void} clear  takes all errors away
 * @property {(path: Path) => void} focus
 */
/** @typedef {{control: Control, path: Path}} Place  a control, and the path from its value on */
/** @typedef {(value: unknown) => void} Emit  tells a new value; undefined where nothing is left */
/**
 * @typedef {object} Context
 * @property {(field: Field, value: unknown, emit: Emit) => Control} make
 * @property {() => string} id  a new id of an element
 * @property {import("./pastebox.js").PasteBox[]} boxes  of the tables of the form
 */

/**
 * A small button of the form.
 * @param {string} text
 * @param {(event: Event) => void} press
 * @param {string} [name]  of the class
 * @returns {HTMLButtonElement}
 */
export function button(text, press, name = "form-button") {
  return plainButton(text, press, name);
}

/** Label, help and error of a field. */
export class Frame {
  /**
   * @param {Context} context
   * @param {Field} field
   * @param {string} [range]  what is said of the allowed numbers
   */
  constructor(context, field, range = rangeText(field)) {
    this.id = context.id();
    this.field = field;
    this.problem = "";
    this.fault = "";
    /** @type {HTMLElement[]} */
    this.inputs = [];
    const helps = [field.help, range && TEXTS.range(range, field.unit)].filter(Boolean).join(" ");
    this.help = el("p", { id: `${this.id}-help`, class: "form-help", hidden: true }, ...rich(helps));
    this.error = el("p", { id: `${this.id}-error`, class: "form-error", hidden: true });
    this.toggle = button(TEXTS.helpSign, () => this.#toggleHelp(), "form-ask");
    this.toggle.setAttribute("aria-label", TEXTS.help(field.label));
    this.toggle.setAttribute("aria-expanded", "false");
    this.toggle.setAttribute("aria-controls", this.help.id);
    this.toggle.hidden = helps === "";
  }

  /** @returns {Node[]} the readable name, with the exact name as a title */
  title() {
    const { label, name, required } = this.field;
    const nodes = [el("span", { title: name || label }, label)];
    if (required && name) nodes.push(el("span", { class: "form-required", title: TEXTS.required }, "*"));
    return nodes;
  }

  /**
   * A line of label, input and unit, with help and error below.
   * @param {HTMLElement} input
   * @param {...Node} further
   * @returns {HTMLElement}
   */
  line(input, ...further) {
    input.id = this.id;
    this.describe(input);
    const label = el("label", { for: this.id, class: "form-label" }, ...this.title());
    const unit = el("span", { class: "form-unit" }, this.field.unit);
    return el("div", { class: "form-field" }, label, this.toggle,
      el("span", { class: "form-input" }, input, unit), ...further, this.help, this.error);
  }

  /**
   * A group of inputs under one legend.
   * @param {...Node} content
   * @returns {HTMLElement}
   */
  group(...content) {
    const { kind, unit } = this.field;
    const legend = el("legend", {}, ...this.title(), " ", el("span", { class: "form-unit" }, unit));
    return el("fieldset", { class: `form-group form-${kind}`, id: this.id, tabindex: -1 },
      legend, this.toggle, this.help, this.error, ...content);
  }

  /** @param {HTMLElement} input  to be described by help and error */
  describe(input) {
    input.setAttribute("aria-describedby", `${this.error.id} ${this.help.id}`);
    if (this.field.required && this.field.name) input.setAttribute("aria-required", "true");
    this.inputs.push(input);
  }

  /** @param {string} text  what is wrong with what was typed; empty for nothing */
  setProblem(text) {
    this.problem = text;
    this.#show();
  }

  /** @param {string} text  what the service says, beside what it said before */
  addFault(text) {
    this.setFault([this.fault, text].filter(Boolean).join(" "));
  }

  /** @param {string} text  what the service says; empty for nothing */
  setFault(text) {
    this.fault = text;
    this.#show();
  }

  /**
   * Marks a number that is out of its range, or no number.
   * @param {unknown} value
   */
  checkNumber(value) {
    this.setProblem(numberProblem(value, this.field));
  }

  #show() {
    const text = this.fault || this.problem;
    this.error.replaceChildren(...rich(text));
    this.error.hidden = text === "";
    for (const input of this.inputs) setInvalid(input, text !== "");
  }

  #toggleHelp() {
    this.help.hidden = !this.help.hidden;
    this.toggle.setAttribute("aria-expanded", String(!this.help.hidden));
  }
}

/**
 * @param {HTMLElement} input
 * @param {boolean} isInvalid
 */
export function setInvalid(input, isInvalid) {
  if (isInvalid) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

/**
 * What all fields of one input have in common.
 * @implements {Control}
 */
export class OneInput {
  /**
   * @param {Context} context
   * @param {Field} field
   * @param {HTMLElement} input
   * @param {...Node} further
   */
  constructor(context, field, input, ...further) {
    this.frame = new Frame(context, field);
    this.input = input;
    this.element = this.frame.line(input, ...further);
  }

  /** @param {unknown} _value */
  update(_value) {}

  /** @param {Path} path */
  reveal(path) {
    return { control: this, path };
  }

  /** @param {string} text */
  mark(text) {
    this.frame.addFault(text);
    return this.frame.id;
  }

  clear() {
    this.frame.setFault("");
  }

  focus() {
    this.input.focus();
  }
}
