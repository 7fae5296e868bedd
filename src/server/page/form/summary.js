// The errors of a request above its form, each with the way to its field.
import { el, rich } from "../dom.js";
import { labelOf } from "../names.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";
import { fieldAt } from "./tree.js";
import { valueAt } from "./value.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./value.js").Path} Path */
/**
 * @typedef {object} Line
 * @property {Path} path
 * @property {string} name  of the place
 * @property {string} detail
 * @property {string} id  of the field
 * @property {() => void} focus  goes to the field
 */

export class Summary {
  constructor() {
    this.element = el("div", { class: "form-errors", role: "alert", hidden: true });
    /** @type {Line[]} */
    this.lines = [];
  }

  /** @param {Line[]} lines */
  show(lines) {
    this.lines = lines;
    this.element.hidden = lines.length === 0;
    const parts = lines.length === 0 ? []
      : [el("p", {}, TEXTS.errors(lines.length)), el("ul", {}, ...lines.map(listItem))];
    this.element.replaceChildren(...parts);
  }

  /**
   * Takes away the errors whose places have got another value.
   * @param {unknown} before  the request
   * @param {unknown} after
   */
  follow(before, after) {
    const left = this.lines.filter(({ path }) => valueAt(before, path) === valueAt(after, path));
    if (left.length < this.lines.length) this.show(left);
  }
}

/** @param {Line} line */
function listItem({ name, detail, id, focus }) {
  const press = (/** @type {Event} */ event) => {
    event.preventDefault();
    focus();
  };
  return el("li", {}, el("a", { href: `#${id}`, click: press }, name), ": ", ...rich(detail));
}

/**
 * The name of a place in a request, as the form tells it: entries are counted from 1.
 * @param {Field} field  of the whole request
 * @param {unknown} value  the whole request
 * @param {Path} path
 * @returns {string}  such as `Region, Boundary, Point 4, y`
 */
export function placeName(field, value, path) {
  const names = path.map((step, at) => {
    const own = fieldAt(field, value, path.slice(0, at + 1));
    if (typeof step === "string") return own?.label || labelOf(step);
    return columnName(field, value, path, at) ?? TEXTS.item(own?.label || TEXTS.entry, step + 1);
  });
  return names.join(", ") || TEXTS.wholeRequest;
}

/**
 * @param {Field} field
 * @param {unknown} value
 * @param {Path} path
 * @param {number} at  place of a number in the path
 * @returns {string | undefined}  its name, where it is the number of a column
 */
function columnName(field, value, path, at) {
  const row = fieldAt(field, value, path.slice(0, at));
  const table = at > 0 ? fieldAt(field, value, path.slice(0, at - 1)) : undefined;
  const columns = row?.kind === "points" ? [] : table?.kind === "points" ? table.columns : row?.columns ?? [];
  return columns[Number(path[at])];
}
