// The material while it is cut, as a map of heights over the stock on the graphics card (three axes only).
//
// The map is a depth buffer: each stretch of the path is drawn from above with the least height of the
// cutter over each cell as its depth, and the depth test keeps the lowest. So the order of the stretches
// does not matter, and no extension is needed. Depth 0 is the bottom of the stock, depth 1 its top.

import { Program, textureOf } from "./gl.js";
import { real } from "./math.js";
import { isJoined, MARK, poseAt, simplify } from "./timeline.js";
import { Stretches } from "./stretches.js";
/** @import { GL } from "./gl.js" */
/** @import { Mesh } from "./mesh.js" */
/** @import { Cutter } from "./tool.js" */
/** @import { Box, PathData, Vec3 } from "./types.js" */

/** Cells along the longer side of the stock. */
const CELLS = 1024;
/** Copies of the map on the way, for going back in time; 4 MB each. */
const CHECKPOINTS = 8;
/** Vertices that are looked at before the next bit of the path is cut. */
const VERTICES_AT_ONCE = 65_536;
/** Straight runs are drawn as one stretch where that moves the cutter by at most a tenth of a cell. */
const TOLERANCE_CELLS = 0.05;
/** Cells that are lowered in a ms, until the speed is known: without a graphics card. A step lowers at least
 * so many cells; steps with fewer do not tell the speed. */
const [FIRST_SPEED, LEAST_CELLS] = [4e4, 2e5];

const PART_VERTEX = `
layout(location = 0) in vec3 aPosition;
uniform vec3 uOrigin;
uniform vec2 uExtent;
uniform float uDepth;
out float vHeight;
void main() {
  vec3 p = aPosition - uOrigin;
  vHeight = p.z / uDepth;
  gl_Position = vec4(p.xy / uExtent * 2.0 - 1.0, 0.0, 1.0);
}`;

const PART_FRAGMENT = `
in float vHeight;
void main() { gl_FragDepth = clamp(vHeight, 0.0, 1.0); }`;

/** A map of depths and the frame buffer that writes it.
 * @typedef {{texture: WebGLTexture, buffer: WebGLFramebuffer}} HeightMap */

export class Material {
  /** Vertex up to which the material is cut. */
  #done = 0;
  /** Time in s up to which the material is cut. */
  #reached = -Infinity;
  /** @type {{vertex: number, point: Vec3|null, time: number}} last whole vertex, and the tip after it */
  #goal = { vertex: 0, point: null, time: -Infinity };
  /** Whether the map is not yet at the time asked for. */
  isBusy = false;
  /** @type {Map<number, HeightMap>} checkpoints by vertex */ #saved = new Map();
  /** @type {HeightMap|null} heights of the stock; null where it fills its box */ #stock = null;
  #speed = FIRST_SPEED;
  /** Cells that the last step lowered. */
  #lowered = 0;
  #gl;
  #path;
  #marks;
  #cutter;
  #stretches;

  /** @param {GL} gl @param {PathData} path @param {Uint8Array} marks
   * @param {Cutter} cutter @param {Box} stock */
  constructor(gl, path, marks, cutter, stock) {
    this.#gl = gl;
    this.#path = path;
    this.#marks = marks;
    this.#cutter = cutter;
    this.origin = stock.min;
    const size = stock.max.map((x, k) => Math.max(x - (stock.min[k] ?? x), 1e-6));
    this.cell = Math.max(size[0] ?? 1, size[1] ?? 1) / CELLS;
    this.columns = Math.max(2, Math.round((size[0] ?? 1) / this.cell));
    this.rows = Math.max(2, Math.round((size[1] ?? 1) / this.cell));
    this.depth = size[2] ?? 1;
    this.#stretches = new Stretches(gl, cutter, this.cell);
    this.map = this.#newMap();
    this.#clear(this.map, 1);
    /** @type {HeightMap|null} heights of the part; 0 where it is not */ this.part = null;
  }

  /** @returns {HeightMap} */
  #newMap() {
    const gl = this.#gl;
    const texture = textureOf(gl, gl.DEPTH_COMPONENT32F, this.columns, this.rows);
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    gl.drawBuffers([gl.NONE]);
    gl.readBuffer(gl.NONE);
    return { texture, buffer };
  }

  /** @param {HeightMap} map @param {number} depth 0 to 1 */
  #clear(map, depth) {
    const gl = this.#gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, map.buffer);
    gl.depthMask(true);
    gl.clearBufferfv(gl.DEPTH, 0, [depth]);
  }

  /** @param {HeightMap} from @param {HeightMap} to */
  #copy(from, to) {
    const gl = this.#gl;
    const [w, h] = [this.columns, this.rows];
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, from.buffer);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to.buffer);
    gl.blitFramebuffer(0, 0, w, h, 0, 0, w, h, gl.DEPTH_BUFFER_BIT, gl.NEAREST);
  }

  /** The share of the way to the time asked for that is cut, 0 to 1. */
  get share() { return this.#goal.vertex > 0 ? this.#done / this.#goal.vertex : 1; }

  /** Size of the map in mm. @returns {[number, number]} */
  get extent() { return [this.columns * this.cell, this.rows * this.cell]; }

  /** Draws the part's own heights, to compare the material with. @param {Mesh|null} mesh */
  setPart(mesh) {
    if (mesh) this.part = this.#heightsOf(mesh);
  }

  /** Begins with the heights of a body in place of the whole box. @param {Mesh} body is disposed of */
  setStock(body) {
    this.#stock = this.#heightsOf(body);
    body.dispose();
    this.#fill();
  }

  /** Puts back all of the stock. */
  #fill() {
    if (this.#stock) this.#copy(this.#stock, this.map);
    else this.#clear(this.map, 1);
  }

  /** The upper surface of a body; 0 where the body is not. @param {Mesh} mesh */
  #heightsOf(mesh) {
    const gl = this.#gl;
    const map = this.#newMap();
    this.#clear(map, 0);
    const program = new Program(gl, PART_VERTEX, PART_FRAGMENT);
    program.use().set({ uOrigin: this.origin, uExtent: this.extent, uDepth: this.depth });
    this.#begin(map, gl.GREATER);
    mesh.drawPlain();
    this.#end();
    gl.deleteProgram(program.program);
    return map;
  }

  /** @param {HeightMap} map @param {number} test */
  #begin(map, test) {
    const gl = this.#gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, map.buffer);
    gl.viewport(0, 0, this.columns, this.rows);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.CULL_FACE);
    gl.depthFunc(test);
  }

  #end() {
    this.#gl.depthFunc(this.#gl.LESS);
    this.#gl.bindFramebuffer(this.#gl.FRAMEBUFFER, null);
  }

  /** Asks for the material at a time; `step` then works towards it. @param {number} time s */
  setTime(time) {
    const pose = poseAt(this.#path, time);
    if (!pose || time === this.#goal.time) return;
    const isThere = real(this.#path.times, pose.vertex) <= time;
    const vertex = isThere ? this.#lastAt(pose.vertex) : Math.max(pose.vertex - 1, 0);
    const isOnWay = !isThere && isJoined(this.#marks, vertex + 1);
    this.#goal = { vertex, point: isOnWay ? pose.point : null, time };
    this.isBusy = true;
    if (time < this.#reached) this.#goBack();
  }

  /** The last of the vertices that the tip reaches at the same time. @param {number} vertex */
  #lastAt(vertex) {
    const { times } = this.#path;
    let last = vertex;
    while (last + 1 < this.#marks.length / MARK && real(times, last + 1) <= real(times, vertex)) last++;
    return last;
  }

  #goBack() {
    const before = [...this.#saved.keys()].filter((vertex) => vertex <= this.#goal.vertex);
    this.#done = Math.max(0, ...before);
    this.#reached = real(this.#path.times, this.#done);
    const saved = this.#saved.get(this.#done);
    if (saved) this.#copy(saved, this.map);
    else this.#fill();
  }

  /** Cuts on towards the time asked for; false where there is nothing to do.
   * @param {number} ms how long it should take, about */
  step(ms) {
    if (!this.isBusy) return false;
    const most = Math.max(LEAST_CELLS, ms * this.#speed);
    let left = most;
    while (left > 0 && this.#done < this.#goal.vertex) left -= this.#cutRun(left);
    this.#lowered = most - left;
    this.#reached = real(this.#path.times, this.#done);
    if (left > 0) this.#finish();
    this.#gl.bindFramebuffer(this.#gl.FRAMEBUFFER, null);
    return true;
  }

  /** Cuts the part of a stretch that lies before the time asked for. */
  #finish() {
    const { point, time } = this.#goal;
    if (point) this.#put(...this.#tip(this.#done), point[0], point[1], point[2], false);
    this.#draw();
    this.#reached = time;
    this.isBusy = false;
  }

  /** @param {number} vertex @returns {[number, number, number]} */
  #tip(vertex) {
    const { positions } = this.#path;
    return [real(positions, 3 * vertex), real(positions, 3 * vertex + 1), real(positions, 3 * vertex + 2)];
  }

  /** Tells the material what its last step took. @param {number} elapsed ms */
  learn(elapsed) {
    if (this.#lowered >= LEAST_CELLS) this.#speed = 0.5 * this.#speed + (0.5 * this.#lowered) / Math.max(elapsed, 0.5);
  }

  /** Cuts the next run of stretches.
   * @param {number} most cells @returns {number} cells that it lowered, about */
  #cutRun(most) {
    const every = Math.max(1, Math.ceil(this.#marks.length / MARK / CHECKPOINTS));
    const checkpoint = (Math.floor(this.#done / every) + 1) * every;
    const end = Math.min(this.#goal.vertex, checkpoint, this.#done + VERTICES_AT_ONCE);
    let [cells, before, follows] = [0, this.#done, false];
    const p = this.#path.positions;
    simplify(p, this.#marks, this.#done, end, this.cell * TOLERANCE_CELLS, (vertex) => {
      if (vertex > before) {
        const [a, b] = [3 * before, 3 * vertex];
        const own = isJoined(this.#marks, vertex) ? this.#put(
          real(p, a), real(p, a + 1), real(p, a + 2), real(p, b), real(p, b + 1), real(p, b + 2), follows) : 0;
        follows = own > 0;
        cells += own;
      }
      before = vertex;
      return this.#stretches.isFull || cells > most;
    });
    this.#draw();
    // A vertex costs about as much as a cell, also where nothing is cut.
    const looked = Math.max(before - this.#done, 1);
    this.#done = before;
    if (before === checkpoint && !this.#saved.has(before)) this.#save(before);
    return cells + looked;
  }

  /** Puts a stretch in the batch; 0 where it cannot touch the stock.
   * @param {number} x @param {number} y @param {number} z where it starts, mm
   * @param {number} x1 @param {number} y1 @param {number} z1 where it ends
   * @param {boolean} follows whether it follows the last one in the batch
   * @returns {number} cells that it covers, about */
  #put(x, y, z, x1, y1, z1, follows) {
    const { radius } = this.#cutter;
    const [w, h] = this.extent;
    const [ox, oy, oz] = this.origin;
    const touches = Math.min(z, z1) < oz + this.depth
      && Math.max(x, x1) + radius >= ox && Math.min(x, x1) - radius <= ox + w
      && Math.max(y, y1) + radius >= oy && Math.min(y, y1) - radius <= oy + h;
    // A sum with a number that is none, or without end, is none either.
    if (!touches || !(Math.abs(x + y + z + x1 + y1 + z1) < Infinity)) return 0;
    return this.#stretches.add(x - ox, y - oy, z - oz, x1 - ox, y1 - oy, z1 - oz, follows);
  }

  /** Cuts the stretches of the batch. */
  #draw() {
    if (this.#stretches.count === 0) return;
    this.#begin(this.map, this.#gl.LESS);
    this.#stretches.draw(this.extent, this.depth);
    this.#end();
  }

  /** @param {number} vertex */
  #save(vertex) {
    const copy = this.#newMap();
    this.#copy(this.map, copy);
    this.#saved.set(vertex, copy);
  }

  dispose() {
    const gl = this.#gl;
    for (const map of [this.map, ...this.#saved.values(), this.part, this.#stock]) {
      if (!map) continue;
      gl.deleteTexture(map.texture);
      gl.deleteFramebuffer(map.buffer);
    }
    this.#stretches.dispose();
  }
}
