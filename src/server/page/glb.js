// Reads the binary glTF file of an answer: the path with its times, and the triangles of the solids.

/** @import { Diagram } from "./charts/course.js" */
/** @import { MeshData, PathData } from "./view/types.js" */

import { CUT } from "./view/timeline.js";
import { KINDS } from "./view/types.js";

const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;
const HEADER_BYTES = 12;
const FLOAT = 5126;

/**
 * @typedef {{ bufferView: number, byteOffset?: number, componentType: number, count: number, type: string }} Accessor
 * @typedef {{ byteOffset?: number, byteLength: number, byteStride?: number }} BufferView
 * @typedef {{ attributes: Record<string, number>, indices?: number, mode?: number }} Primitive
 * @typedef {{ name?: string, mesh?: number, children?: number[], translation?: number[], extras?: Record<string, unknown> }} Node
 * @typedef {{ nodes: Node[], scenes: { nodes: number[] }[], meshes?: { primitives: Primitive[] }[],
 *   accessors?: Accessor[], bufferViews?: BufferView[] }} Description
 * @typedef {object} Model
 * @property {PathData | null} path
 * @property {Map<string, MeshData>} solids by the names of their nodes
 * @property {boolean} isStockAssumed whether the service chose the size of the stock
 * @property {Diagram[]} diagrams
 */

/** The model of an answer without a file. @type {Model} */
export const NO_MODEL = { path: null, solids: new Map(), isStockAssumed: false, diagrams: [] };

class Reader {
  /** @param {ArrayBuffer} file */
  constructor(file) {
    const view = new DataView(file);
    if (file.byteLength < HEADER_BYTES || view.getUint32(0, true) !== MAGIC) throw new Error("no binary glTF file");
    /** @type {Description | null} */
    let json = null;
    let start = file.byteLength;
    for (let at = HEADER_BYTES; at + 8 <= file.byteLength;) {
      const length = view.getUint32(at, true);
      const kind = view.getUint32(at + 4, true);
      if (kind === JSON_CHUNK) json = JSON.parse(new TextDecoder().decode(new Uint8Array(file, at + 8, length)));
      if (kind === BIN_CHUNK) start = at + 8;
      at += 8 + length;
    }
    if (json === null) throw new Error("the glTF file has no description");
    this.json = json;
    this.bytes = file;
    this.start = start;
    const root = this.node(json.scenes[0]?.nodes[0] ?? 0);
    this.children = (root.children ?? []).map((k) => this.node(k));
    this.extras = root.extras ?? {};
    this.scale = 1 / Number(this.extras["metres_per_unit"] ?? 1);
    const [x = 0, y = 0, z = 0] = root.translation ?? [];
    // The root turns z of the part to y.
    this.origin = [x * this.scale, -z * this.scale, y * this.scale];
  }

  /** @param {number} index */
  node(index) {
    const node = this.json.nodes[index];
    if (node === undefined) throw new Error(`the glTF file has no node ${index}`);
    return node;
  }

  /** @param {number | undefined} index */
  accessor(index) {
    const accessor = index === undefined ? undefined : this.json.accessors?.[index];
    const view = accessor && this.json.bufferViews?.[accessor.bufferView];
    if (accessor === undefined || view === undefined) throw new Error("the glTF file lacks numbers");
    return { ...accessor, from: this.start + (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0) };
  }

  /** The numbers of an accessor, without a copy. @param {number | undefined} index */
  floats(index) {
    const { componentType, count, type, from } = this.accessor(index);
    if (componentType !== FLOAT) throw new Error("the glTF file has other numbers than expected");
    return new Float32Array(this.bytes, from, count * (type === "VEC3" ? 3 : 1));
  }

  /** @param {number | undefined} index */
  indices(index) {
    const { count, from } = this.accessor(index);
    return new Uint32Array(this.bytes, from, count);
  }

  /** @param {Node} node */
  primitive(node) {
    return node.mesh === undefined ? undefined : this.json.meshes?.[node.mesh]?.primitives[0];
  }

  /** Places of the part, mm. @param {Float32Array} metres */
  places(metres) {
    const places = new Float32Array(metres.length);
    for (let k = 0; k < metres.length; k++) places[k] = (metres[k] ?? 0) * this.scale + (this.origin[k % 3] ?? 0);
    return places;
  }
}

/**
 * The model in a file.
 * @param {ArrayBuffer} file
 * @returns {Model}
 */
export function readModel(file) {
  const reader = new Reader(file);
  /** @type {Map<string, MeshData>} */
  const solids = new Map();
  /** @type {PathData | null} */
  let path = null;
  for (const node of reader.children) {
    const primitive = reader.primitive(node);
    if (node.name === "path") path = readPath(reader, node);
    else if (primitive !== undefined) solids.set(node.name ?? "", solid(reader, primitive, node.name === "cutter"));
  }
  const { stock_is_assumed: isStockAssumed, diagrams, clock } = reader.extras;
  return {
    path, solids, isStockAssumed: isStockAssumed === true,
    diagrams: Array.isArray(diagrams) ? diagrams.map((told) => diagram(told, Array.isArray(clock) ? clock : [])) : [],
  };
}

/** @param {Partial<Diagram>} told @param {[number, number][]} clock @returns {Diagram} */
function diagram({ name = "", before = [], after = [] }, clock) {
  return { name, before, after, clock };
}

/** @param {Reader} reader @param {Primitive} primitive @param {boolean} isFree of the origin of the part */
function solid(reader, primitive, isFree) {
  const metres = reader.floats(primitive.attributes["POSITION"]);
  const positions = isFree ? metres.map((x) => x * reader.scale) : reader.places(metres);
  // Copies, so that the whole file need not be kept for them.
  const normals = reader.floats(primitive.attributes["NORMAL"]).slice();
  return { positions, normals, indices: reader.indices(primitive.indices).slice() };
}

/** @param {Reader} reader @param {Node} node @returns {PathData | null} */
function readPath(reader, node) {
  const passes = (node.children ?? []).map((k) => reader.node(k));
  const count = passes.reduce((sum, pass) => sum + vertices(reader, pass), 0);
  if (count === 0) return null;
  const path = {
    positions: new Float32Array(3 * count),
    times: new Float32Array(count),
    kinds: new Uint8Array(count),
    feeds: new Float32Array(count),
    blocks: new Uint32Array(count),
    axes: /** @type {Float32Array | null} */ (null),
    deviations: /** @type {Float32Array | null} */ (null),
    strips: /** @type {PathData["strips"]} */ ([]),
  };
  const kinds = kindNames(reader);
  let first = 0;
  // People count passes and levels from 1.
  for (const [k, pass] of passes.entries()) {
    const attributes = reader.primitive(pass)?.attributes;
    if (attributes === undefined) continue;
    const places = reader.places(reader.floats(attributes["POSITION"]));
    path.positions.set(places, 3 * first);
    for (const [name, numbers] of /** @type {const} */ ([["_TIME", path.times], ["_KIND", path.kinds],
      ["_FEED", path.feeds], ["_BLOCK", path.blocks]])) {
      if (attributes[name] !== undefined) numbers.set(reader.floats(attributes[name]), first);
    }
    if (attributes["_AXIS"] !== undefined) {
      path.axes ??= new Float32Array(3 * count);
      path.axes.set(reader.floats(attributes["_AXIS"]), 3 * first);
    }
    if (attributes["_DEVIATION"] !== undefined) {
      path.deviations ??= new Float32Array(count).fill(NaN);
      path.deviations.set(reader.floats(attributes["_DEVIATION"]).map((mm) => (mm < 0 ? NaN : mm)), first);
    }
    const level = pass.extras?.["level"];
    const length = places.length / 3;
    // Passes without moves have no strip, so the number of the pass stands in the name.
    const number = Number(/\d+/.exec(pass.name ?? "")?.[0] ?? k + 1);
    const told = { pass: number, level: typeof level === "number" ? level + 1 : null };
    const parts = connected(path.kinds.subarray(first, first + length), kinds.indexOf("unknown"));
    path.strips.push(...parts.map(({ from, to }) => ({ first: first + from, count: to - from, ...told })));
    first += length;
  }
  const numbers = kindNumbers(kinds);
  for (let k = 0; k < count; k++) path.kinds[k] = numbers[path.kinds[k] ?? CUT] ?? CUT;
  return path;
}

/**
 * The parts of a strip between the ways that the program does not tell. Such a way ends at the last of the vertices that
 * have its kind.
 * @param {Uint8Array} kinds of the vertices
 * @param {number} unknown the number of such a way; -1 for none
 */
function connected(kinds, unknown) {
  /** @type {{ from: number, to: number }[]} */
  const parts = [];
  let from = 0;
  for (const [k, kind] of kinds.entries()) {
    if (kind !== unknown) continue;
    if (k - from > 1) parts.push({ from, to: k });
    from = k;
  }
  parts.push({ from, to: kinds.length });
  return parts;
}

/** The names of the kinds of a file. @param {Reader} reader @returns {readonly unknown[]} */
function kindNames(reader) {
  const names = reader.extras["kinds"];
  return Array.isArray(names) ? names : KINDS;
}

/** The view's number of each kind of a file; what the view does not know counts as a cut. @param {readonly unknown[]} names */
function kindNumbers(names) {
  return names.map((name) => /** @type {readonly unknown[]} */ (KINDS).indexOf(name)).map((k) => (k < 0 ? CUT : k));
}

/** @param {Reader} reader @param {Node} pass */
function vertices(reader, pass) {
  const primitive = reader.primitive(pass);
  return primitive === undefined ? 0 : reader.accessor(primitive.attributes["POSITION"]).count;
}

/** The bytes of a text in base64. @param {string} text @returns {ArrayBuffer} */
export function bytesOf(text) {
  const padding = text.endsWith("==") ? 2 : text.endsWith("=") ? 1 : 0;
  const bytes = new Uint8Array((text.length >> 2) * 3 - padding);
  // Groups of four characters stand for three bytes each.
  const step = 4 << 18;
  let to = 0;
  for (let at = 0; at < text.length; at += step) {
    const decoded = atob(text.slice(at, at + step));
    for (let k = 0; k < decoded.length; k++) bytes[to++] = decoded.charCodeAt(k);
  }
  return bytes.buffer;
}
