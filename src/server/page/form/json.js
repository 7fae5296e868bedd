// Edits values as JSON text: the text beside the form, and the fields that the form cannot show otherwise.
import { el } from "../dom.js";
import { button, OneInput, setInvalid } from "./dom.js";
import { abridged, formatJson, isLonger, parseJson } from "./jsontext.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";

/** @typedef {import("./dom.js").Context} Context */
/** @typedef {import("./dom.js").Emit} Emit */
/** @typedef {import("./field.js").Field} Field */

/** Longer JSON is shown abridged: browsers are slow to lay out and edit more. */
const LARGE = 300_000;

/** The JSON of a value in a text area. */
export class JsonText {
  /**
   * @param {HTMLTextAreaElement} textarea
   * @param {{onchange: (value: unknown) => void, isOptional?: boolean}} listener  `onchange` is told each
   *   legal value that is typed, and undefined for an empty text where `isOptional`
   */
  constructor(textarea, { onchange, isOptional = false }) {
    this.textarea = textarea;
    this.onchange = onchange;
    this.isOptional = isOptional;
    /** @type {unknown} */
    this.value = undefined;
    this.note = el("p", { class: "form-note", hidden: true });
    this.edit = button(TEXTS.editAnyway, () => this.#showWhole());
    this.edit.hidden = true;
    this.error = el("p", { class: "form-error", role: "status", hidden: true });
    this.error.id = `${textarea.id || "json"}-problem`;
    textarea.spellcheck = false;
    const others = textarea.getAttribute("aria-describedby") ?? "";
    textarea.setAttribute("aria-describedby", `${this.error.id} ${others}`.trim());
    textarea.addEventListener("input", () => this.#read());
    textarea.after(el("div", { class: "form-below" }, this.note, this.edit, this.error));
  }

  /**
   * Shows a value. A text that already stands for the value stays, with its caret.
   * @param {unknown} value
   */
  set(value) {
    if (value === this.value) return;
    this.value = value;
    this.#say("");
    const isLarge = isLonger(value, LARGE);
    this.note.hidden = !isLarge;
    this.edit.hidden = !isLarge;
    this.textarea.readOnly = isLarge;
    if (isLarge) this.note.textContent = TEXTS.abridged(LARGE / 1000);
    const text = isLarge ? abridged(value) : value === undefined ? "" : formatJson(value);
    if (this.textarea.value !== text) this.textarea.value = text;
  }

  /** Whether the text is no JSON, so that it stands for no value. */
  get isBroken() {
    return !this.error.hidden;
  }

  #showWhole() {
    this.note.hidden = true;
    this.edit.hidden = true;
    this.textarea.readOnly = false;
    this.textarea.value = JSON.stringify(this.value, null, 1);
    this.textarea.focus();
  }

  #read() {
    const text = this.textarea.value;
    const parsed = this.isOptional && text.trim() === "" ? { value: undefined } : parseJson(text);
    if ("line" in parsed) {
      this.#say(TEXTS.noJson(parsed.line, parsed.column, parsed.what));
      return;
    }
    this.#say("");
    this.value = parsed.value;
    this.onchange(parsed.value);
  }

  /** @param {string} text */
  #say(text) {
    this.error.textContent = text;
    this.error.hidden = text === "";
    setInvalid(this.textarea, text !== "");
  }
}

/** A field that is edited as JSON. */
export class JsonControl extends OneInput {
  /** @param {Context} context @param {Field} field @param {unknown} value @param {Emit} emit */
  constructor(context, field, value, emit) {
    const textarea = el("textarea", { rows: 4, class: "form-text-input" });
    super(context, field, textarea, el("p", { class: "form-note", hidden: value === undefined }, TEXTS.asJson));
    this.json = new JsonText(textarea, { onchange: emit, isOptional: true });
    textarea.addEventListener("input", () => this.clear());
    this.update(value);
  }

  /** @param {unknown} value */
  update(value) {
    this.json.set(value);
  }
}
