// Compares the material that the page shows after the whole path with heights computed from the toolpath.
//
// A height agrees where it lies between the least and the largest computed height of the cells within two
// cells, give or take what the page states as its own inexactness.

import { bytesOf, readModel } from "../../../src/server/page/glb.js";
import { TEXTS } from "../../../src/server/page/texts.js";
import { cutterOf, Heights, topOf, waysOf } from "./heights.mjs";

/** How many cells aside a height may be found. */
const ASIDE = 2;
/** The page moves the cutter by up to this share of a cell, so that it draws fewer stretches. */
const MOVED_CELLS = 0.1;
/** Curves of the path on the page, and those of the computed heights, are chords within this, mm. */
const CHORD_MM = 1e-3;
/** So many cells that differ are told of an example. */
const MOST_TOLD = 5;
/** A path that is moved by so many cells, aside or up, has to be found out. */
const SHIFT_CELLS = 3;
/** The page may cut for so long, ms. */
const PATIENCE = 60_000;

/** A map as the page has it; all in mm.
 * @typedef {{ columns: number, rows: number, cell: number, origin: number[], depth: number,
 *   heights: Float32Array }} HeightMap */

/** Examples and what is changed in them: other cutters, and a stock where none is stated.
 * @type {[string, string, object][]} */
const VARIED = [
  ["/v1/surfaces/mill", "die", { tool: { shape: "bull_nose", diameter_mm: 10, corner_radius_mm: 2 } }],
  ["/v1/surfaces/mill", "die", { tool: { shape: "flat", diameter_mm: 6 } }],
  ...["job-order", "one-pass", "wire-union"].map((name) => (
    ["/v1/surfaces/mill", name, { stock: { kind: "on_surface", thickness_mm: 1 } }])),
];

/** The material of requests that no example has. @param {import("./checks.mjs").Bench} bench */
export async function otherMaterials({ page, address, fault, choose, run }) {
  for (const [path, name, change] of VARIED) {
    await choose(path, name);
    await page.click("#tab-json");
    const body = { ...JSON.parse(await page.inputValue("#json")), ...change };
    await page.fill("#json", JSON.stringify(body));
    const when = `${path} ${name} with ${JSON.stringify(change)}`;
    const status = await run();
    if (!status.startsWith("Done")) fault(`${when}: ${status}`);
    const differs = await differences(page, address, path, body) ?? ["no material is shown"];
    for (const what of differs) fault(`${when}: ${what}`);
  }
}

/**
 * Compares the material of the answer that the page shows.
 * @param {import("playwright-core").Page} page
 * @param {string} address of the service
 * @param {string} path of the operation
 * @param {any} body of the request
 * @returns {Promise<string[] | null>} what differs; null where there is no stock, and no material is shown
 */
export async function differences(page, address, path, body) {
  const response = await fetch(`${address}${path}?glb=true&toolpath=true`, {
    method: "POST", headers: { "content-type": "application/json", accept: "application/json" }, body: JSON.stringify(body),
  });
  const { glb, toolpath } = await response.json();
  const stock = readModel(bytesOf(glb)).solids.get("stock");
  const map = await cutMap(page);
  if (stock === undefined) return map === null ? null : ["the page shows material without a stock"];
  if (map === null) return ["the page does not show the material to its end"];
  const box = boxOf(stock);
  const misplaced = wrongPlace(map, box);
  if (misplaced !== null) return [misplaced];
  const whole = { ...box, topAt: fillsBox(stock, box) ? undefined : topOf(stock, box.min[2]) };
  const ways = waysOf(toolpath, CHORD_MM);
  const wrong = (some, most) => wrongCells(map, new Heights(some, cutterOf(body.tool), whole), most);
  const faults = wrong(ways, MOST_TOLD);
  const shift = SHIFT_CELLS * map.cell;
  for (const [what, by] of [["moved aside", [shift, shift, 0]], ["raised", [0, 0, shift]]]) {
    const other = ways.map((way) => way.map((point) => point.map((x, axis) => x + by[axis])));
    if (wrong(other, 1).length === 0) faults.push(`a path that is ${what} is not found out`);
  }
  return faults;
}

/** The first cells that differ, in words.
 * @param {HeightMap} map @param {Heights} computed @param {number} most */
export function wrongCells({ columns, rows, cell, origin, heights }, computed, most) {
  const known = new Float64Array(columns * rows).fill(NaN);
  const place = (column, row) => [origin[0] + (column + 0.5) * cell, origin[1] + (row + 0.5) * cell];
  const at = (column, row) => {
    const k = row * columns + column;
    if (Number.isNaN(known[k])) known[k] = computed.at(...place(column, row));
    return known[k];
  };
  const inexact = MOVED_CELLS * cell + 2 * CHORD_MM;
  const told = [];
  for (let k = 0; k < heights.length && told.length < most; k++) {
    const [column, row] = [k % columns, Math.floor(k / columns)];
    if (Math.abs(heights[k] - at(column, row)) <= inexact) continue;
    let [least, greatest] = [Infinity, -Infinity];
    for (let y = Math.max(row - ASIDE, 0); y <= Math.min(row + ASIDE, rows - 1); y++) {
      for (let x = Math.max(column - ASIDE, 0); x <= Math.min(column + ASIDE, columns - 1); x++) {
        least = Math.min(least, at(x, y));
        greatest = Math.max(greatest, at(x, y));
      }
    }
    if (heights[k] >= least - inexact && heights[k] <= greatest + inexact) continue;
    const [x, y] = place(column, row).map((mm) => mm.toFixed(3));
    told.push(`over X${x} Y${y} the material ends at Z${heights[k]}, computed ${least} to ${greatest}`);
  }
  return told;
}

/** The box around a body. @param {{ positions: Float32Array }} body */
function boxOf({ positions }) {
  const [min, max] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  positions.forEach((x, k) => {
    min[k % 3] = Math.min(min[k % 3], x);
    max[k % 3] = Math.max(max[k % 3], x);
  });
  return { min, max };
}

/** Whether all corners of a body are corners of its box. */
function fillsBox({ positions }, { min, max }) {
  return positions.every((x, k) => x === min[k % 3] || x === max[k % 3]);
}

/** How the map does not lie over the stock; null where it does.
 * @param {HeightMap} map @param {{ min: number[], max: number[] }} box */
function wrongPlace({ columns, rows, cell, origin, depth }, { min, max }) {
  const corner = [origin[0] + columns * cell, origin[1] + rows * cell, origin[2] + depth];
  const off = [0, 1, 2].flatMap((k) => [origin[k] - min[k], corner[k] - max[k]]).map(Math.abs);
  return Math.max(...off) > cell ? `the map from ${origin} to ${corner} is not over the stock from ${min} to ${max}` : null;
}

/** The map of heights once the page has cut to the end of the path; null where it does not.
 * @param {import("playwright-core").Page} page @returns {Promise<HeightMap | null>} */
async function cutMap(page) {
  await page.evaluate(watchMaterial);
  const box = page.locator("#tools label", { hasText: TEXTS.material }).locator("input");
  if (await box.isDisabled()) return null;
  await box.check();
  const isCut = () => globalThis.material !== null && !globalThis.material.isBusy;
  const map = await page.waitForFunction(isCut, null, { timeout: PATIENCE })
    .then(() => page.evaluate(readMap), () => null);
  await box.uncheck();
  if (map === null) return null;
  const bytes = Buffer.from(map.heights, "base64");
  const shares = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  return { ...map, heights: shares.map((share) => map.origin[2] + share * map.depth) };
}

/** Keeps the material that the page cuts. In the page. */
async function watchMaterial() {
  const { Material } = await import("/page/view/material.js");
  globalThis.material = null;
  globalThis.step ??= Material.prototype.step;
  Material.prototype.step = function (ms) {
    globalThis.material = this;
    return globalThis.step.call(this, ms);
  };
}

/** Reads the depths of the map from the graphics processor. In the page. */
async function readMap() {
  const { columns, rows, cell, origin, depth, map } = globalThis.material;
  const gl = document.querySelector("#picture").getContext("webgl2");
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }"],
    [gl.FRAGMENT_SHADER, "precision highp float; uniform highp sampler2D map; out uvec4 bits;"
      + "void main() { bits = uvec4(floatBitsToUint(texelFetch(map, ivec2(gl_FragCoord.xy), 0).r), 0u, 0u, 0u); }"],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\n${text}`);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  const target = gl.createTexture();
  const buffer = gl.createFramebuffer();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, target);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32UI, columns, rows);
  gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  gl.bindTexture(gl.TEXTURE_2D, map.texture);
  gl.viewport(0, 0, columns, rows);
  gl.disable(gl.DEPTH_TEST);
  gl.disable(gl.BLEND);
  gl.useProgram(program);
  gl.bindVertexArray(null);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const bits = new Uint32Array(4 * columns * rows);
  gl.readPixels(0, 0, columns, rows, gl.RGBA_INTEGER, gl.UNSIGNED_INT, bits);
  const error = gl.getError();
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteFramebuffer(buffer);
  gl.deleteTexture(target);
  gl.deleteProgram(program);
  if (error !== gl.NO_ERROR) throw new Error(`reading the map: error ${error}`);
  const bytes = new Uint8Array(Uint32Array.from({ length: columns * rows }, (_, k) => bits[4 * k]).buffer);
  const url = await new Promise((done) => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result);
    reader.readAsDataURL(new Blob([bytes]));
  });
  return { columns, rows, cell, origin, depth, heights: url.slice(url.indexOf(",") + 1) };
}
