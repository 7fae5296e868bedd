// Reads the contract of the service (OpenAPI 3.1) and lists the operations that a form can be made for.

import { isObject, pathOf } from "./form/value.js";

/** @typedef {Record<string, any>} Schema  a JSON schema of the contract */
/** @typedef {(schema: Schema) => Schema} Resolve */
/** @typedef {{name: string, schema: Schema, help: string}} Param  a parameter of the address */

/**
 * @typedef {object} Operation
 * @property {string} id  the contract's `operationId`
 * @property {string} path  such as `/v1/arcs/fit`
 * @property {string} title  one sentence, without its full stop
 * @property {string} help
 * @property {Schema} schema  of the JSON body
 * @property {Param[]} params
 * @property {string[]} forms  media types of the answer
 * @property {Map<string, any>} examples  bodies by name, or an `Elsewhere`
 */

/** @typedef {{operations: Operation[], resolve: Resolve}} Contract */

/** The address of an example, relative to the page. */
export class Elsewhere {
  /** @param {string} address */
  constructor(address) {
    this.address = address;
  }
}

/**
 * The body of an example.
 * @param {Operation} operation
 * @param {string} name
 * @returns {Promise<any>}  undefined without such an example
 * @throws {Error} where its address does not answer
 */
export async function exampleOf(operation, name) {
  const example = operation.examples.get(name);
  if (!(example instanceof Elsewhere)) return structuredClone(example);
  const response = await fetch(example.address);
  if (!response.ok) throw new Error(`${example.address}: ${response.status}`);
  return response.json();
}

/** How many references may lead on to one another. Without an end, a circle of references never resolves. */
const REFERENCES = 32;

/**
 * Fetches the contract.
 * @param {string} url
 * @returns {Promise<Contract>}
 * @throws {Error} where the address does not answer a contract
 */
export async function loadContract(url) {
  const response = await fetch(url, { headers: { accept: "application/json" } });
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  return contractOf(await response.json());
}

/**
 * Lists the operations of a contract: each POST with a JSON body.
 * @param {any} contract  the parsed OpenAPI document
 * @returns {Contract}
 */
export function contractOf(contract) {
  /** @type {Resolve} */
  const resolve = (schema) => resolved(contract, schema);
  const operations = Object.entries(contract?.paths ?? {})
    .map(([path, item]) => operationOf(path, item, resolve))
    .filter((operation) => operation !== null);
  return { operations, resolve };
}

/**
 * @param {string} path
 * @param {any} item
 * @param {Resolve} resolve
 * @returns {Operation | null}
 */
function operationOf(path, item, resolve) {
  const post = item?.post;
  const json = resolve(post?.requestBody ?? {}).content?.["application/json"];
  if (!post || !json?.schema || path.includes("{")) return null;
  const answer = resolve(post.responses?.["200"] ?? {});
  return {
    id: post.operationId ?? path,
    path,
    title: (post.summary ?? path).replace(/\.$/, ""),
    help: post.description ?? "",
    schema: json.schema,
    params: paramsOf([...(item.parameters ?? []), ...(post.parameters ?? [])], resolve),
    forms: Object.keys(answer.content ?? {}),
    examples: examplesOf(json, resolve),
  };
}

/**
 * @param {any[]} parameters
 * @param {Resolve} resolve
 * @returns {Param[]}  those of the query
 */
function paramsOf(parameters, resolve) {
  return parameters
    .map(resolve)
    .filter((parameter) => parameter.in === "query")
    .map(({ name, schema, description }) => ({ name, schema: schema ?? {}, help: description ?? "" }));
}

/**
 * @param {any} media
 * @param {Resolve} resolve
 * @returns {Map<string, any>}
 */
function examplesOf(media, resolve) {
  /** @type {Map<string, any>} */
  const examples = new Map();
  for (const [name, example] of Object.entries(media.examples ?? {})) {
    const { value, externalValue } = resolve(example);
    if (value !== undefined) examples.set(name, value);
    else if (typeof externalValue === "string") examples.set(name, new Elsewhere(externalValue));
  }
  if (media.example !== undefined) examples.set("example", media.example);
  return examples;
}

/**
 * Follows the references of a schema. What stands beside a reference replaces what it refers to.
 * @param {any} contract
 * @param {any} schema
 * @returns {Schema}
 */
function resolved(contract, schema) {
  let found = /** @type {Schema} */ (isObject(schema) ? schema : {});
  for (let step = 0; step < REFERENCES && typeof found.$ref === "string"; step += 1) {
    const { $ref, ...beside } = found;
    found = { ...target(contract, $ref), ...beside };
  }
  return found;
}

/**
 * @param {any} contract
 * @param {string} reference  such as `#/components/schemas/Tool`
 * @returns {Schema}  empty where nothing is there
 */
function target(contract, reference) {
  if (!reference.startsWith("#/")) return {};
  let place = contract;
  for (const step of pathOf(reference)) {
    place = place?.[step];
  }
  return isObject(place) ? place : {};
}
