// The fields of one value: numbers, texts, choices, and a few numbers side by side.
import { parseTable } from "../paste.js";
import { el, rich } from "../dom.js";
import { button, Frame, OneInput, setInvalid } from "./dom.js";
import { numberProblem, rangeText, readNumber, shownValue, typedValue } from "./number.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";

/** @typedef {import("./dom.js").Control} Control */
/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("./dom.js").Emit} Emit */
/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./value.js").Path} Path */

/** A longer text is not put into an input as a whole: browsers grow slow with megabytes. */
const LARGE = 300_000;
/** As much of a large text is shown. */
const SHOWN = 5_000;

/** A number, kept as it was typed. */
export class NumberControl extends OneInput {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    const input = numberInput(field.fallback);
    super(context, field, input);
    this.text = input;
    input.addEventListener("input", () => {
      const typed = typedValue(input.value);
      this.clear();
      this.frame.checkNumber(typed);
      emit(typed);
    });
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    keepTyped(this.text, value);
    this.frame.checkNumber(value);
  }
}

/**
 * @param {string} [placeholder]
 * @returns {HTMLInputElement}
 */
export function numberInput(placeholder = "") {
  return el("input", {
    type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false", class: "form-number-input",
    placeholder, title: placeholder,
  });
}

/**
 * Shows a number in an input, unless the input shows it already in another writing.
 * @param {HTMLInputElement} input
 * @param {unknown} value
 */
export function keepTyped(input, value) {
  if (value !== undefined && value !== null && readNumber(input.value) === value) return;
  const text = shownValue(value);
  if (input.value !== text) input.value = text;
}

/** A text of one line or of several. */
export class TextControl extends OneInput {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    const placeholder = field.fallback;
    const attributes = { spellcheck: "false", autocomplete: "off", placeholder, class: "form-text-input" };
    const input = field.isLong
      ? el("textarea", { ...attributes, rows: 4 })
      : el("input", { ...attributes, type: "text" });
    const note = el("p", { class: "form-note", hidden: true });
    const empty = button(TEXTS.replaceText, () => {
      this.update(undefined);
      emit(undefined);
      input.focus();
    });
    empty.hidden = true;
    super(context, field, input, note, empty);
    this.text = input;
    this.note = note;
    this.empty = empty;
    input.addEventListener("input", () => {
      this.clear();
      this.#check(input.value);
      emit(input.value === "" ? undefined : input.value);
    });
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    const text = shownValue(value);
    const isLarge = text.length > LARGE;
    const shown = isLarge ? text.slice(0, SHOWN) : text;
    this.text.readOnly = isLarge;
    this.note.hidden = !isLarge;
    this.empty.hidden = !isLarge;
    if (isLarge) this.note.textContent = TEXTS.largeText(text.length, SHOWN);
    if (this.text.value.replaceAll("\r\n", "\n") !== shown.replaceAll("\r\n", "\n")) this.text.value = shown;
    this.#check(text);
  }

  /** @param {string} text */
  #check(text) {
    const { maxLength } = this.frame.field;
    this.frame.setProblem(text.length > maxLength ? TEXTS.tooLong(maxLength) : "");
  }
}

/** One of several values, or yes and no. */
export class ChoiceControl extends OneInput {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    const select = el("select", { class: "form-choice-input" });
    const help = el("p", { class: "form-note", "aria-live": "polite" });
    super(context, field, select, help);
    this.select = select;
    this.help = help;
    this.choices = field.kind === "flag" ? flagChoices() : field.choices;
    select.append(el("option", { value: "" }, noChoice(field)),
      ...this.choices.map(({ label }, at) => el("option", { value: String(at) }, label)));
    select.addEventListener("change", () => {
      const chosen = this.choices[Number(select.value || NaN)]?.value;
      this.clear();
      this.update(chosen);
      emit(chosen);
    });
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    const at = this.choices.findIndex((choice) => choice.value === value);
    const isUnknown = value !== undefined && at < 0;
    this.select.querySelector("[data-unknown]")?.remove();
    if (isUnknown) {
      this.select.append(el("option", { value: "unknown", "data-unknown": true }, String(value)));
    }
    const shown = isUnknown ? "unknown" : at < 0 ? "" : String(at);
    if (this.select.value !== shown) this.select.value = shown;
    this.help.replaceChildren(...rich(this.choices[at]?.help ?? ""));
    this.frame.setProblem(isUnknown ? TEXTS.unknownChoice(String(value)) : "");
  }
}

/**
 * @param {Field} field
 * @returns {string}  what is shown where nothing is chosen
 */
function noChoice({ kind, fallback, required }) {
  if (required) return TEXTS.choose;
  if (fallback === "") return TEXTS.notSet;
  if (kind !== "flag") return TEXTS.standard(fallback.replaceAll("_", " "));
  return TEXTS.standard(fallback === "true" ? TEXTS.yes : fallback === "false" ? TEXTS.no : fallback);
}

/** @returns {import("./field.js").Choice[]} */
function flagChoices() {
  return [{ value: true, label: TEXTS.yes, help: "" }, { value: false, label: TEXTS.no, help: "" }];
}

/**
 * A few numbers side by side, such as a point.
 * @implements {Control}
 */
export class InlineNumbers {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    this.range = field.item();
    this.emit = emit;
    this.frame = new Frame(context, field, rangeText(this.range));
    this.inputs = Array.from({ length: field.most }, () => numberInput());
    const cells = this.inputs.map((input, at) => {
      const name = field.columns[at] ?? TEXTS.column(at + 1);
      input.id = `${this.frame.id}-${at}`;
      this.frame.describe(input);
      input.addEventListener("input", () => {
        this.clear();
        this.#check();
        emit(this.#value());
      });
      input.addEventListener("paste", (event) => this.#pasted(event, at));
      return el("label", { class: "form-cell" }, name, " ", input);
    });
    this.element = this.frame.group(el("div", { class: "form-cells" }, ...cells));
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    const numbers = Array.isArray(value) ? value : [];
    this.inputs.forEach((input, at) => keepTyped(input, numbers[at]));
    this.#check();
  }

  /** @param {ClipboardEvent} event @param {number} at  index of the input that takes the first number */
  #pasted(event, at) {
    const text = event.clipboardData?.getData("text/plain") ?? "";
    const row = parseTable(text).rows[0] ?? [];
    if (readNumber(text) !== null || row.length < 2 || row.length > this.inputs.length - at) return;
    event.preventDefault();
    this.inputs.slice(at, at + row.length).forEach((input, offset) => keepTyped(input, row[offset]));
    this.#check();
    this.emit(this.#value());
  }

  /** @returns {unknown[] | undefined}  undefined where all inputs are empty */
  #value() {
    const cells = this.inputs.map((input) => typedValue(input.value) ?? null);
    while (cells.length > this.frame.field.least && cells.at(-1) === null) cells.pop();
    return cells.every((cell) => cell === null) ? undefined : cells;
  }

  #check() {
    const problems = this.inputs.map((input) => numberProblem(typedValue(input.value), this.range));
    this.frame.setProblem(problems.find(Boolean) ?? "");
    if (!this.frame.fault) this.inputs.forEach((input, at) => setInvalid(input, Boolean(problems[at])));
  }

  /** @param {Path} path */
  reveal(path) {
    return { control: this, path };
  }

  /** @param {string} text @param {Path} path */
  mark(text, path) {
    this.frame.addFault(text);
    return this.inputs[Number(path[0] ?? 0)]?.id ?? this.frame.id;
  }

  clear() {
    this.frame.setFault("");
  }

  /** @param {Path} path */
  focus(path) {
    this.inputs[Number(path[0] ?? 0)]?.focus();
  }
}
