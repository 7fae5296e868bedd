// Reads and replaces parts of a JSON value without touching the rest, and turns JSON pointers into paths.

/** @typedef {(string | number)[]} Path  names of members and indices, from the outside inwards */

/**
 * @param {unknown} value
 * @returns {value is Record<string, unknown>}
 */
export function isObject(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/**
 * The part of a value at a path.
 * @param {unknown} value
 * @param {Path} path
 * @returns {unknown}  undefined where nothing is there
 */
export function valueAt(value, path) {
  let part = value;
  for (const step of path) {
    if (Array.isArray(part)) part = part[Number(step)];
    else part = isObject(part) && Object.hasOwn(part, step) ? part[step] : undefined;
  }
  return part;
}

/**
 * A copy of an object with one member replaced, added or removed. The order of the other members stays.
 * A member that is added stands where `order` has it, else at the end.
 * @param {Record<string, unknown>} object
 * @param {string} name
 * @param {unknown} value  undefined removes the member
 * @param {string[]} [order]  names in their wanted order
 * @returns {Record<string, unknown>}
 */
export function withMember(object, name, value, order = []) {
  const entries = Object.entries(object);
  const at = entries.findIndex(([key]) => key === name);
  if (value === undefined) {
    if (at >= 0) entries.splice(at, 1);
  } else if (at >= 0) {
    entries[at] = [name, value];
  } else {
    entries.splice(placeOf(entries.map(([key]) => key), name, order), 0, [name, value]);
  }
  return Object.fromEntries(entries);
}

/**
 * @param {string[]} names
 * @param {string} name
 * @param {string[]} order
 * @returns {number}  the index at which `name` is inserted into `names`
 */
function placeOf(names, name, order) {
  const rank = order.indexOf(name);
  if (rank < 0) return names.length;
  for (let before = rank - 1; before >= 0; before -= 1) {
    const at = names.indexOf(order[before] ?? "");
    if (at >= 0) return at + 1;
  }
  return 0;
}

/**
 * A copy of a list with one item replaced.
 * @param {readonly unknown[]} list
 * @param {number} index
 * @param {unknown} value
 * @returns {unknown[]}
 */
export function withItem(list, index, value) {
  const copy = list.slice();
  copy[index] = value;
  return copy;
}

/**
 * A copy of a value with the part at a path replaced. Only what holds the part is copied.
 * @param {unknown} value
 * @param {Path} path
 * @param {unknown} part
 * @returns {unknown}
 */
export function withValueAt(value, path, part) {
  const [step, ...rest] = path;
  if (step === undefined) return part;
  const inner = withValueAt(valueAt(value, [step]), rest, part);
  if (Array.isArray(value)) return withItem(value, Number(step), inner);
  return withMember(isObject(value) ? value : {}, String(step), inner);
}

/**
 * The path of a JSON pointer such as `#/region/boundary/3/1`.
 * @param {string} pointer  with or without `#`
 * @returns {Path}
 */
export function pathOf(pointer) {
  const isFragment = pointer.startsWith("#");
  const text = isFragment ? decoded(pointer.slice(1)) : pointer;
  return text.split("/").slice(1)
    .map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"))
    .map((step) => (/^(0|[1-9]\d{0,14})$/.test(step) ? Number(step) : step));
}

/**
 * @param {string} text
 * @returns {string}  the text as it is where its percent signs are broken
 */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}
