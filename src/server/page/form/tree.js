// Brings fields and values together: what a field can show, which shape a value has, what a new value is.
import { isObject, valueAt } from "./value.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {import("./field.js").Shape} Shape */
/** @typedef {import("./value.js").Path} Path */

/** As many numbers stand side by side; more are shown as a table. */
const INLINE = 6;

/**
 * Whether a member always has the same value, so that nothing is to be filled in.
 * @param {Field} field
 * @returns {boolean}
 */
export function isFixed(field) {
  return field.kind === "choice" && field.required && field.choices.length === 1;
}

/**
 * Whether the numbers stand side by side, as those of a point do.
 * @param {Field} field
 * @returns {boolean}
 */
export function isInline(field) {
  return field.kind === "numbers" && field.most <= INLINE;
}

/**
 * Whether a field is one input, or a few, which may stay empty. Other fields are added by a button.
 * @param {Field} field
 * @returns {boolean}
 */
export function isSimple(field) {
  return isInline(field) || ["number", "integer", "text", "choice", "flag", "json"].includes(field.kind);
}

/**
 * Whether the inputs of a field can show a value, be it legal or not. Other values are shown as JSON.
 * @param {Field} field
 * @param {unknown} value
 * @returns {boolean}
 */
export function canShow(field, value) {
  if (value === undefined) return true;
  switch (field.kind) {
    case "number": case "integer": return typeof value === "number" || typeof value === "string";
    case "text": return typeof value === "string";
    case "choice": return typeof value !== "object";
    case "flag": return typeof value === "boolean";
    case "object": case "map": return isObject(value);
    case "variant": return shapeOf(field, value) !== undefined;
    case "list": return Array.isArray(value);
    case "numbers": return Array.isArray(value) && value.every(isCell) && (!isInline(field) || value.length <= field.most);
    case "points": return Array.isArray(value) && value.every(isRow);
    default: return true;
  }
}

/**
 * @param {unknown} value
 * @returns {boolean}  whether an input of a table can show the value
 */
function isCell(value) {
  return typeof value === "number" || typeof value === "string" || value === null;
}

/**
 * @param {unknown} value
 * @returns {boolean}
 */
function isRow(value) {
  return Array.isArray(value) && value.every(isCell);
}

/**
 * The field as which a value is shown: the field itself, or a list where rows are of several kinds, or JSON.
 * @param {Field} field
 * @param {unknown} value
 * @returns {Field}
 */
export function shownAs(field, value) {
  if (canShow(field, value)) return field;
  const isMixed = field.kind === "points" && field.item().kind === "variant" && Array.isArray(value);
  return { ...field, kind: isMixed ? "list" : "json" };
}

/**
 * The shape of a variant that a value has.
 * @param {Field} field
 * @param {unknown} value
 * @returns {Shape | undefined}
 */
export function shapeOf(field, value) {
  const shapes = field.shapes();
  if (field.tag) {
    if (!isObject(value)) return undefined;
    const tag = valueAt(value, [field.tag]);
    return shapes.find(({ name, isTagged }) => (isTagged ? name === tag : tag === undefined));
  }
  return shapes.find((shape) => isOfKind(shape.field(), value));
}

/**
 * @param {Field} field
 * @param {unknown} value
 * @returns {boolean}  whether a value is of the field's kind
 */
function isOfKind(field, value) {
  switch (field.kind) {
    case "number": case "integer": return typeof value === "number";
    case "choice": return field.choices.some((choice) => choice.value === value);
    case "points": case "numbers": case "list": return Array.isArray(value);
    case "json": return false;
    default: return value !== undefined && canShow(field, value);
  }
}

/**
 * A new value of a field, with what is fixed in it.
 * @param {Field} field
 * @returns {unknown}  undefined for a simple field
 */
export function blankOf(field) {
  switch (field.kind) {
    case "object": return Object.fromEntries(field.members().filter(isFixed)
      .map((member) => [member.name, member.choices[0]?.value]));
    case "variant": {
      const first = field.shapes()[0];
      return first && blankOf(first.field());
    }
    case "map": return {};
    case "list": return [];
    case "points": case "numbers": return isInline(field) ? undefined : [];
    case "choice": return isFixed(field) ? field.choices[0]?.value : undefined;
    default: return undefined;
  }
}

/**
 * A new entry of a list.
 * @param {Field} item
 * @returns {unknown}  null or an empty text where the entry has no value yet
 */
export function blankItem(item) {
  return blankOf(item) ?? emptyItem(item);
}

/**
 * What stands in a list in place of an entry without a value.
 * @param {Field} item
 * @returns {unknown}
 */
export function emptyItem(item) {
  if (item.kind === "text") return "";
  return item.kind === "numbers" ? [] : null;
}

/**
 * The field of a part of a value.
 * @param {Field} field  of the whole value
 * @param {unknown} value  the whole value
 * @param {Path} path  of the part
 * @returns {Field | undefined}  undefined where the contract does not know the part
 */
export function fieldAt(field, value, path) {
  const [step, ...rest] = path;
  if (step === undefined) return field;
  const inner = innerField(shownAs(field, value), value, step);
  return inner && fieldAt(inner, valueAt(value, [step]), rest);
}

/**
 * @param {Field} field
 * @param {unknown} value
 * @param {string | number} step
 * @returns {Field | undefined}
 */
function innerField(field, value, step) {
  switch (field.kind) {
    case "object": return field.members().find((member) => member.name === step);
    case "list": case "points": case "numbers": case "map": return field.item();
    case "variant": {
      const shape = shapeOf(field, value)?.field();
      return shape && innerField(shownAs(shape, value), value, step);
    }
    default: return undefined;
  }
}
