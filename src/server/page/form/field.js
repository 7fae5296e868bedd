// Turns the JSON schemas of the contract into a tree of fields, each of a kind that the form can show.
// The tree is made as it is asked for, so that schemas may refer to themselves.
import { labelOf } from "../names.js";
import { choiceHelp, columnsOf, entryOf, fallbackOf, singular, unitOf } from "./names.js";
import { FORM_TEXTS as TEXTS } from "../texts.js";
import { isObject } from "./value.js";

/** @typedef {import("../contract.js").Schema} Schema */
/** @typedef {import("../contract.js").Resolve} Resolve */
/**
 * @typedef {"number" | "integer" | "text" | "choice" | "flag" | "object" | "variant" | "list" | "points"
 *   | "numbers" | "map" | "json"} Kind
 */
/** @typedef {{value: unknown, label: string, help: string}} Choice */
/**
 * @typedef {object} Shape  one of the forms of a variant
 * @property {string} name  the value of the member `tag`, or the kind of value
 * @property {boolean} isTagged  whether the member `tag` names the shape
 * @property {string} label
 * @property {() => Field} field
 */
/**
 * @typedef {object} Field
 * @property {Kind} kind
 * @property {string} name  exact name of the member; empty for the whole request and for entries of lists
 * @property {string} label
 * @property {string} unit
 * @property {string} help
 * @property {boolean} required
 * @property {string} fallback  the default, as a text
 * @property {number} min  least number
 * @property {number} max  largest number
 * @property {boolean} isLong  whether a text has lines
 * @property {number} maxLength  of a text
 * @property {Choice[]} choices
 * @property {string[]} columns  names of the numbers of a row
 * @property {number} least  fewest numbers of a row of points, or of numbers
 * @property {number} most  most numbers of a row of points, or of numbers
 * @property {string} tag  the member that names the shape of a variant; empty where the kind of value tells
 * @property {() => Field[]} members  required members first
 * @property {() => Shape[]} shapes
 * @property {() => Field} item  an entry of a list, of points, of numbers or of a map
 */

/** A row of more numbers than this has no names, and is not shown as a row of single inputs. */
const NAMED = 8;
/** A longer text than this is edited in several lines. */
const LINE = 1000;
/** How many schemas may be wrapped into each other before they count as not understood. */
const WRAPS = 32;

/**
 * The field of a schema.
 * @param {Resolve} resolve
 * @param {Schema} schema
 * @param {string} [name]
 * @param {boolean} [required]
 * @param {string} [label]  in place of the readable name
 * @returns {Field}
 */
export function fieldOf(resolve, schema, name = "", required = true, label = labelOf(name)) {
  const { schema: plain, texts } = unwrapped(resolve, schema);
  const help = texts[0] ?? "";
  /** @type {Field} */
  const field = {
    kind: "json", name, label, required, help,
    unit: unitOf(name, texts),
    fallback: fallbackOf(plain, help),
    min: plain.minimum ?? -Infinity,
    max: plain.maximum ?? Infinity,
    isLong: false, maxLength: plain.maxLength ?? Infinity,
    choices: [], columns: [], least: 0, most: Infinity, tag: "",
    members: () => [], shapes: () => [], item: () => field,
  };
  return Object.assign(field, detailsOf(resolve, plain, texts, field));
}

/**
 * Takes a schema out of references, of `oneOf` with null, and of lists of one.
 * @param {Resolve} resolve
 * @param {Schema} schema
 * @returns {{schema: Schema, texts: string[]}}  the schema, and the descriptions from the outside inwards
 */
function unwrapped(resolve, schema) {
  /** @type {string[]} */
  const texts = [];
  let found = schema;
  for (let step = 0; step < WRAPS; step += 1) {
    const text = found.description;
    if (typeof text === "string" && texts.at(-1) !== text) texts.push(text);
    const { $ref, oneOf, anyOf, allOf, description, ...own } = found;
    const several = (oneOf ?? anyOf)?.filter((/** @type {Schema} */ each) => resolve(each).type !== "null");
    if ($ref) found = { ...resolve({ $ref }), ...own };
    else if (several?.length === 1) found = { ...several[0], ...own };
    else if (allOf?.length === 1) found = { ...allOf[0], ...own };
    else if (allOf) found = { ...merged(resolve, allOf), ...own };
    else return { schema: { ...found, ...(several && { oneOf: several }), type: typeOf(found.type) }, texts };
  }
  return { schema: {}, texts };
}

/**
 * @param {Resolve} resolve
 * @param {Schema[]} schemas  all of which hold
 * @returns {Schema}
 */
function merged(resolve, schemas) {
  const parts = schemas.map(resolve);
  return {
    ...Object.assign({}, ...parts),
    properties: Object.assign({}, ...parts.map((part) => part.properties)),
    required: parts.flatMap((part) => part.required ?? []),
  };
}

/**
 * @param {string | string[] | undefined} type
 * @returns {string | undefined}  the one type beside null
 */
function typeOf(type) {
  if (!Array.isArray(type)) return type;
  const types = type.filter((each) => each !== "null");
  return types.length === 1 ? types[0] : undefined;
}

/**
 * @param {Resolve} resolve
 * @param {Schema} schema
 * @param {string[]} texts
 * @param {Field} field
 * @returns {Partial<Field>}  what the kind of field adds
 */
function detailsOf(resolve, schema, texts, field) {
  const choices = choicesOf(resolve, schema, texts);
  if (choices) return { kind: "choice", choices, unit: "" };
  if (schema.oneOf) return variantOf(resolve, schema, field);
  switch (schema.type) {
    case "boolean": return { kind: "flag", unit: "" };
    case "number": return { kind: "number" };
    case "integer": return { kind: "integer", unit: unitOf(field.name, []) };
    case "string": return { kind: "text", unit: "", isLong: isLong(schema, field) };
    case "array": return rowsOf(resolve, schema, texts, field);
    case "object": return objectOf(resolve, schema);
    default: return { kind: "json", unit: "" };
  }
}

/**
 * @param {Schema} schema
 * @param {Field} field
 * @returns {boolean}
 */
function isLong(schema, field) {
  if (schema.maxLength !== undefined) return schema.maxLength > LINE;
  return /\btext of\b|\bprogram\b|\bdocument\b/.test(field.help);
}

/**
 * @param {Resolve} resolve
 * @param {Schema} schema
 * @param {string[]} texts
 * @returns {Choice[] | null}  null where the schema is no choice
 */
function choicesOf(resolve, schema, texts) {
  const each = schema.oneOf?.map((/** @type {Schema} */ one) => resolve(one)) ?? [schema];
  /** @type {{value: unknown, help: string}[]} */
  const found = [];
  for (const one of each) {
    const values = "const" in one ? [one.const] : one.enum;
    if (!Array.isArray(values)) return null;
    const help = schema.oneOf && values.length === 1 ? one.description ?? "" : "";
    found.push(...values.filter((value) => value !== null).map((value) => ({ value, help })));
  }
  const names = found.map(({ value }) => String(value));
  const told = texts.map((text) => choiceHelp(text, names));
  return found.map(({ value, help }, at) => {
    const name = names[at] ?? "";
    const toldHelp = told.find((map) => map.has(name))?.get(name) ?? "";
    return { value, label: name.replaceAll("_", " "), help: help || toldHelp };
  });
}

/**
 * @param {Resolve} resolve
 * @param {Schema} schema
 * @param {Field} outer
 * @returns {Partial<Field>}
 */
function variantOf(resolve, schema, outer) {
  /** @type {Schema[]} */
  const schemas = schema.oneOf;
  const tag = schema.discriminator?.propertyName ?? tagOf(resolve, schemas);
  const shapes = once(() => schemas.map((one) => {
    const value = tag ? tagValue(resolve, one, tag) : undefined;
    const field = once(() => {
      const inner = fieldOf(resolve, one, outer.name, outer.required, outer.label);
      return { ...inner, unit: inner.unit || (isNumeric(inner) ? outer.unit : "") };
    });
    if (value !== undefined) {
      return { name: String(value), label: labelOf(String(value)), isTagged: true, field };
    }
    if (tag) return { name: TEXTS.untagged, label: TEXTS.untagged, isTagged: false, field };
    const { kind, choices } = field();
    const only = kind === "choice" && choices.length === 1 ? choices[0]?.label : undefined;
    return { name: only ?? kind, label: only ?? TEXTS.shapes[kind] ?? kind, isTagged: false, field };
  }));
  return { kind: "variant", tag, shapes };
}

/**
 * @param {Field} field
 * @returns {boolean}
 */
function isNumeric({ kind }) {
  return kind === "number" || kind === "points" || kind === "numbers";
}

/**
 * @param {Resolve} resolve
 * @param {Schema[]} schemas
 * @returns {string}  the member that has another fixed value in each schema, of which one may lack the member; empty
 *   where there is none
 */
function tagOf(resolve, schemas) {
  const members = schemas.map((one) => Object.keys(unwrapped(resolve, one).schema.properties ?? {}));
  if (members.some((names) => names.length === 0)) return "";
  return members.flat().find((name) => {
    const having = schemas.filter((_, at) => members[at]?.includes(name));
    const values = having.map((one) => tagValue(resolve, one, name));
    return having.length >= Math.max(1, schemas.length - 1)
      && !values.includes(undefined) && new Set(values).size === having.length;
  }) ?? "";
}

/**
 * @param {Resolve} resolve
 * @param {Schema} schema
 * @param {string} tag
 * @returns {unknown}  the one value that the member may have
 */
function tagValue(resolve, schema, tag) {
  const member = resolve(unwrapped(resolve, schema).schema.properties?.[tag]);
  return member.const ?? (member.enum?.length === 1 ? member.enum[0] : undefined);
}

/**
 * @param {Resolve} resolve
 * @param {Schema} schema
 * @returns {Partial<Field>}
 */
function objectOf(resolve, schema) {
  const { properties, additionalProperties: further } = schema;
  if (!properties && isObject(further)) {
    return { kind: "map", unit: "", item: once(() => fieldOf(resolve, further, "", true, TEXTS.mapValue)) };
  }
  if (!properties) return { kind: "json", unit: "" };
  /** @type {string[]} */
  const required = (schema.required ?? []).filter((/** @type {string} */ name) => name in properties);
  const others = Object.keys(properties).filter((name) => !required.includes(name));
  const members = once(() => [...required, ...others]
    .map((name) => fieldOf(resolve, properties[name], name, required.includes(name))));
  return { kind: "object", unit: "", members };
}

/**
 * @param {Resolve} resolve
 * @param {Schema} schema  of an array
 * @param {string[]} texts
 * @param {Field} outer
 * @returns {Partial<Field>}
 */
function rowsOf(resolve, schema, texts, outer) {
  if (!isObject(schema.items)) return { kind: "json", unit: "" };
  const inner = unwrapped(resolve, schema.items);
  const item = once(() => {
    const field = fieldOf(resolve, schema.items, "", true, singular(outer.label));
    return { ...field, label: entryLabel(field, outer, texts), unit: field.unit || (isNumeric(field) ? outer.unit : "") };
  });
  if (isNumber(inner.schema)) return { kind: "numbers", item, ...widthOf(schema, texts) };
  const rows = [inner.schema, ...(inner.schema.oneOf ?? [])].map((one) => unwrapped(resolve, one));
  const row = rows.find(({ schema: { type, items } }) =>
    type === "array" && isNumber(unwrapped(resolve, items ?? {}).schema));
  if (!row) return { kind: "list", item, unit: "" };
  const numbers = unwrapped(resolve, row.schema.items).schema;
  const width = widthOf(row.schema, [...texts, ...inner.texts, ...row.texts]);
  return {
    kind: "points", item, ...width, unit: outer.unit || unitOf("", [...inner.texts, ...row.texts]),
    min: numbers.minimum ?? -Infinity, max: numbers.maximum ?? Infinity,
  };
}

/**
 * What one entry of a list is called.
 * @param {Field} entry
 * @param {Field} list
 * @param {string[]} texts  of the list
 * @returns {string}
 */
function entryLabel(entry, list, texts) {
  if (isGridRow(entry)) return TEXTS.gridRow;
  // A label in the plural gives the name, and so does the label of the list around a list.
  if (entry.label !== list.label || (list.name === "" && entry.kind === "list")) return entry.label;
  const isPoint = entry.kind === "numbers" || entry.kind === "variant";
  return entryOf(texts) || (isPoint ? TEXTS.point : TEXTS.entry);
}

/**
 * Whether an entry is a row of a grid: of points, or of nets of points.
 * @param {Field} entry
 * @returns {boolean}
 */
function isGridRow({ kind, item }) {
  return kind === "points" || (kind === "list" && item().kind === "list" && item().item().kind === "points");
}

/**
 * @param {Schema} schema
 * @returns {boolean}
 */
function isNumber(schema) {
  return !schema.enum && (schema.type === "number" || schema.type === "integer");
}

/**
 * @param {Schema} schema  of a row of numbers
 * @param {string[]} texts
 * @returns {{least: number, most: number, columns: string[]}}
 */
function widthOf(schema, texts) {
  const most = schema.maxItems ?? Infinity;
  return { least: schema.minItems ?? 0, most, columns: most <= NAMED ? columnsOf(texts, most) : [] };
}

/**
 * @template T
 * @param {() => T} make
 * @returns {() => T}  makes the value at the first call, and answers the same value again
 */
function once(make) {
  /** @type {{value: T} | null} */
  let made = null;
  return () => {
    made ??= { value: make() };
    return made.value;
  };
}
