// The form of a request: made from the contract, changed in place, with errors at the fields that they name.
import { el } from "../dom.js";
import { fieldOf } from "./field.js";
import { JsonControl } from "./json.js";
import { ListControl } from "./list.js";
import { MapControl } from "./map.js";
import { ObjectControl, Slot, VariantControl } from "./object.js";
import { ChoiceControl, InlineNumbers, NumberControl, TextControl } from "./scalars.js";
import { placeName, Summary } from "./summary.js";
import { TableControl } from "./table.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";
import { isInline } from "./tree.js";
import { pathOf } from "./value.js";

/** @typedef {import("../contract.js").Contract} Contract */
/** @typedef {import("../contract.js").Operation} Operation */
/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("./dom.js").Control} Control */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {{pointer: string, code?: string, detail: string}} FieldError  as the service answers it */

/** Of more errors, the rest is in the answer only. */
const MOST_ERRORS = 100;

const CONTROLS = {
  number: NumberControl, integer: NumberControl, text: TextControl, choice: ChoiceControl,
  flag: ChoiceControl, object: ObjectControl, variant: VariantControl, list: ListControl, map: MapControl,
  points: TableControl, numbers: TableControl, json: JsonControl,
};

/** The form of one request at a time. */
export class RequestForm {
  /**
   * @param {HTMLElement} host
   * @param {Contract} contract
   * @param {{onchange: (value: unknown) => void}} listener  told each value that people make
   */
  constructor(host, contract, { onchange }) {
    this.host = host;
    this.contract = contract;
    this.onchange = onchange;
    /** @type {Operation | null} */
    this.operation = null;
    /** @type {Slot | null} */
    this.root = null;
    /** @type {unknown} */
    this.shown = undefined;
    /** @type {Field | null} of the request */
    this.field = null;
    this.ids = 0;
    /** @type {import("./pastebox.js").PasteBox[]} */
    this.boxes = [];
    this.summary = new Summary();
    this.body = el("div", { class: "form" });
    host.replaceChildren(this.summary.element, this.body);
  }

  /**
   * Shows the request of an operation, without errors: they belong to the request before. The fields of the operation
   * that is shown already are kept.
   * @param {Operation} operation
   * @param {unknown} value
   */
  show(operation, value) {
    this.clearErrors();
    this.shown = value;
    if (this.root && operation === this.operation) {
      this.root.update(value);
      return;
    }
    this.operation = null;
    this.boxes = [];
    const field = this.field = fieldOf(this.contract.resolve, operation.schema, "", true, TEXTS.wholeRequest);
    /** @type {Context} */
    const context = {
      id: () => `f${(this.ids += 1)}`,
      boxes: this.boxes,
      make: (inner, part, emit) => new (controlOf(inner))(context, inner, part, emit),
    };
    this.root = new Slot(context, field, value, (next) => {
      this.summary.follow(this.shown, next);
      this.shown = next;
      this.onchange(next);
    });
    // A value that breaks a control leaves the form without an operation, so that the next one is shown anew.
    this.operation = operation;
    this.body.replaceChildren(this.root.element);
  }

  /** @returns {unknown} the request */
  get value() {
    return this.shown;
  }

  /** @returns {number} how many inputs are marked as wrong */
  get problems() {
    return this.body.querySelectorAll('[aria-invalid="true"]').length;
  }

  /**
   * Puts rows of numbers, such as those of a dropped file, into the first table of the form that they fit.
   * @param {string} text
   * @returns {{label: string, columns: string[], note: string, show: () => void} | null}  null where no table takes them
   */
  takePoints(text) {
    // Fields that are gone leave their boxes behind.
    const boxes = this.boxes.filter(({ element }) => this.body.contains(element));
    this.boxes.splice(0, Infinity, ...boxes);
    const box = boxes.find((one) => one.fits(text));
    if (!box?.take(text)) return null;
    const show = () => box.element.scrollIntoView({ block: "center" });
    return { label: box.label, columns: box.target.width.columns, note: box.told, show };
  }

  /** @returns {string[]}  titles of the operations whose requests need a table of points */
  withTables() {
    return this.contract.operations
      .filter(({ schema }) => needsTable(fieldOf(this.contract.resolve, schema), 0)).map(({ title }) => title);
  }

  /**
   * Shows errors at their fields, all in a summary, and moves the focus to the first.
   * @param {FieldError[]} errors
   */
  setErrors(errors) {
    this.clearErrors();
    const { root, field } = this;
    if (!root || !field) return;
    const lines = errors.slice(0, MOST_ERRORS).map(({ pointer, detail }) => {
      const path = pathOf(pointer);
      root.reveal(path);
      const focus = () => {
        const place = root.reveal(path);
        place.control.focus(place.path);
      };
      return { path, name: placeName(field, this.shown, path), detail, id: root.mark(detail, path), focus };
    });
    this.summary.show(lines);
    lines[0]?.focus();
  }

  /** Takes all errors of the service away. */
  clearErrors() {
    this.root?.clear();
    this.summary.show([]);
  }
}

/** As deep in a request a table of points is looked for. */
const DEPTH = 4;

/**
 * @param {Field} field
 * @param {number} depth
 * @returns {boolean}
 */
function needsTable(field, depth) {
  if (depth > DEPTH) return false;
  switch (field.kind) {
    case "points": return true;
    case "list": return field.item().kind === "points";
    case "object": return field.members().some((member) => member.required && needsTable(member, depth + 1));
    case "variant": return field.shapes().some((shape) => needsTable(shape.field(), depth + 1));
    default: return false;
  }
}

/** @param {Field} field */
function controlOf(field) {
  return isInline(field) ? InlineNumbers : CONTROLS[field.kind];
}
