// The material while it is cut, as a map of heights over the stock on the graphics card (three axes only).
//
// The map is a depth buffer: each stretch of the path is drawn from above with the least height of the
// cutter over each cell as its depth, and the depth test keeps the lowest. So the order of the stretches
// does not matter, and no extension is needed. Depth 0 is the bottom of the stock, depth 1 its top.

import { bindTexture, point, Program, RECTANGLE_GLSL, textureOf } from "./gl.js";
import { pointAt, real, sub } from "./math.js";
import { isJoined, MARK, poseAt, simplify } from "./timeline.js";
import { HALVINGS } from "./sweep.js";
/** @import { GL } from "./gl.js" */
/** @import { Mesh } from "./mesh.js" */
/** @import { Cutter } from "./tool.js" */
/** @import { Box, PathData, Vec3 } from "./types.js" */

/** Cells along the longer side of the stock. */
const CELLS = 1024;
/** Copies of the map on the way, for going back in time; 4 MB each. */
const CHECKPOINTS = 8;
/** Stretches drawn at once. */
const BATCH = 4096;
/** Straight runs are drawn as one stretch where that moves the cutter by at most a tenth of a cell. */
const TOLERANCE_CELLS = 0.05;
/** Cells that a step may lower at first, until its speed is known; and the least. */
const [FIRST_CELLS, LEAST_CELLS, MOST_CELLS] = [4e6, 2e6, 2e9];
/** A stretch costs at least as much as so many cells. */
const STRETCH_CELLS = 150;
/** What a step should take, in ms. */
const STEP_MS = 50;

const SWEEP_VERTEX = `${RECTANGLE_GLSL}
in vec3 aFrom, aTo;
uniform vec2 uExtent;
uniform float uRadius;
flat out vec3 vFrom;
flat out vec4 vWay;
void main() {
  vec2 way = aTo.xy - aFrom.xy;
  float size = length(way);
  vec2 along = size > 1e-6 ? way / size : vec2(1.0, 0.0);
  int which = rectangleCorner();
  float u = (which & 1) == 1 ? size + uRadius : -uRadius;
  float v = which < 2 ? -uRadius : uRadius;
  vFrom = size > 1e-6 ? aFrom : vec3(aFrom.xy, min(aFrom.z, aTo.z));
  vWay = vec4(along, size, size > 1e-6 ? (aTo.z - aFrom.z) / size : 0.0);
  gl_Position = vec4((aFrom.xy + along * u + vec2(-along.y, along.x) * v) / uExtent * 2.0 - 1.0, 0.0, 1.0);
}`;

/** The shader's copy of `sweep.js`. */
const SWEEP_FRAGMENT = `
flat in vec3 vFrom;
flat in vec4 vWay;
uniform float uRadius, uFlat, uCorner, uSlope, uCell, uDepth;
float height(float away) {
  float over = away - uFlat;
  if (over <= 0.0) return 0.0;
  return uCorner > 0.0 ? uCorner - sqrt(max(uCorner * uCorner - over * over, 0.0)) : uSlope * over;
}
float rise(float q, float v) {
  float away = sqrt(q * q + v * v);
  float over = away - uFlat;
  if (over <= 0.0) return 0.0;
  float steep = uCorner > 0.0 ? over / sqrt(max(uCorner * uCorner - over * over, 1e-12)) : uSlope;
  return -steep * q / away;
}
float travel(float slope, float u, float v, float low, float high) {
  if (slope == 0.0) return clamp(u, low, high);
  if (uFlat >= uRadius) return slope > 0.0 ? low : high;
  if (uFlat == 0.0 && uCorner > 0.0) {
    return clamp(u - slope * sqrt((uRadius * uRadius - v * v) / (1.0 + slope * slope)), low, high);
  }
  for (int i = 0; i < ${HALVINGS}; i++) {
    float middle = (low + high) * 0.5;
    if (slope + rise(u - middle, v) < 0.0) low = middle;
    else high = middle;
  }
  return (low + high) * 0.5;
}
void main() {
  vec2 place = gl_FragCoord.xy * uCell - vFrom.xy;
  float u = dot(place, vWay.xy);
  float v = dot(place, vec2(-vWay.y, vWay.x));
  float reach = uRadius * uRadius - v * v;
  if (reach < 0.0) discard;
  float low = max(u - sqrt(reach), 0.0);
  float high = min(u + sqrt(reach), vWay.z);
  if (low > high) discard;
  float t = travel(vWay.w, u, v, low, high);
  float z = vFrom.z + vWay.w * t + height(min(length(vec2(u - t, v)), uRadius));
  gl_FragDepth = clamp(z / uDepth, 0.0, 1.0);
}`;

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

const READ_VERTEX = `
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

const READ_FRAGMENT = `
uniform highp sampler2D uHeights;
out vec4 bytes;
void main() {
  uint bits = floatBitsToUint(texelFetch(uHeights, ivec2(gl_FragCoord.xy), 0).r);
  bytes = vec4(bits & 255u, bits >> 8 & 255u, bits >> 16 & 255u, bits >> 24) / 255.0;
}`;

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
  #allowance = FIRST_CELLS;
  /** Both ends of each stretch, once for each of the six vertices of its rectangle. */
  #batch = new Float32Array(36 * BATCH);
  #gl;
  #path;
  #marks;
  #cutter;
  #sweep;
  #array;
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
    this.#sweep = new Program(gl, SWEEP_VERTEX, SWEEP_FRAGMENT);
    this.#array = gl.createVertexArray();
    this.#stretches = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#stretches);
    gl.bufferData(gl.ARRAY_BUFFER, this.#batch.byteLength, gl.DYNAMIC_DRAW);
    this.#layOut();
    this.map = this.#newMap();
    this.#clear(this.map, 1);
    /** @type {HeightMap|null} heights of the part; 0 where it is not */ this.part = null;
  }

  #layOut() {
    this.#gl.bindVertexArray(this.#array);
    point(this.#sweep, "aFrom", this.#stretches, 3, { stride: 24 });
    point(this.#sweep, "aTo", this.#stretches, 3, { stride: 24, offset: 12 });
    this.#gl.bindVertexArray(null);
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

  /** Size of the map in mm. @returns {[number, number]} */
  get extent() { return [this.columns * this.cell, this.rows * this.cell]; }

  /** Draws the part's own heights, to compare the material with. @param {Mesh|null} mesh */
  setPart(mesh) {
    if (!mesh) return;
    const gl = this.#gl;
    this.part = this.#newMap();
    this.#clear(this.part, 0);
    const program = new Program(gl, PART_VERTEX, PART_FRAGMENT);
    program.use().set({ uOrigin: this.origin, uExtent: this.extent, uDepth: this.depth });
    this.#begin(this.part, gl.GREATER);
    mesh.drawPlain();
    this.#end();
    gl.deleteProgram(program.program);
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
    else this.#clear(this.map, 1);
  }

  /** Cuts on towards the time asked for, as much as a step allows; false where there is nothing to do. */
  step() {
    if (!this.isBusy) return false;
    const { radius, flat, corner, slope } = this.#cutter;
    this.#sweep.use().set({
      uExtent: this.extent, uRadius: radius, uFlat: flat, uCorner: corner, uSlope: slope, uCell: this.cell,
      uDepth: this.depth,
    });
    let left = this.#allowance;
    while (left > 0 && this.#done < this.#goal.vertex) left -= this.#cutRun(left);
    this.#reached = real(this.#path.times, this.#done);
    if (left > 0) this.#finish();
    this.#gl.bindFramebuffer(this.#gl.FRAMEBUFFER, null);
    return true;
  }

  /** Cuts the part of a stretch that lies before the time asked for. */
  #finish() {
    const { point, time } = this.#goal;
    if (point && this.#put(0, pointAt(this.#path.positions, this.#done), point) > 0) this.#draw(1);
    this.#reached = time;
    this.isBusy = false;
  }

  /** Tells the material what its last step took. @param {number} elapsed ms */
  learn(elapsed) {
    const factor = Math.min(Math.max(STEP_MS / Math.max(elapsed, 1), 0.4), 2);
    this.#allowance = Math.min(Math.max(this.#allowance * factor, LEAST_CELLS), MOST_CELLS);
  }

  /** Cuts the next run of stretches.
   * @param {number} most cells @returns {number} cells that it lowered, about */
  #cutRun(most) {
    const every = Math.max(1, Math.ceil(this.#marks.length / MARK / CHECKPOINTS));
    const checkpoint = (Math.floor(this.#done / every) + 1) * every;
    const end = Math.min(this.#goal.vertex, checkpoint, this.#done + 8 * BATCH);
    let [cells, count, before] = [0, 0, this.#done];
    const { positions } = this.#path;
    simplify(positions, this.#marks, this.#done, end, this.cell * TOLERANCE_CELLS, (vertex) => {
      if (vertex > before && isJoined(this.#marks, vertex)) {
        const own = this.#put(count, pointAt(positions, before), pointAt(positions, vertex));
        if (own > 0) count++;
        cells += own;
      }
      before = vertex;
      return count === BATCH || cells > most;
    });
    this.#draw(count);
    this.#done = before;
    if (before === checkpoint && !this.#saved.has(before)) this.#save(before);
    return cells + 1;
  }

  /** Puts a stretch in the batch; 0 where it cannot touch the stock. @param {number} index
   * @param {Vec3} a @param {Vec3} b @returns {number} cells that it covers, about */
  #put(index, a, b) {
    const [radius, [w, h], o] = [this.#cutter.radius, this.extent, this.origin];
    const misses = Math.min(a[2], b[2]) >= o[2] + this.depth
      || Math.max(a[0], b[0]) + radius < o[0] || Math.min(a[0], b[0]) - radius > o[0] + w
      || Math.max(a[1], b[1]) + radius < o[1] || Math.min(a[1], b[1]) - radius > o[1] + h;
    if (misses) return 0;
    const ends = [...sub(a, o), ...sub(b, o)];
    for (let corner = 0; corner < 6; corner++) this.#batch.set(ends, 36 * index + 6 * corner);
    if (![...a, ...b].every(Number.isFinite)) return 0;
    const area = (Math.hypot(b[0] - a[0], b[1] - a[1]) + 2 * radius) * 2 * radius;
    return STRETCH_CELLS + Math.min(area / this.cell ** 2, this.columns * this.rows);
  }

  /** @param {number} count stretches of the batch */
  #draw(count) {
    if (count === 0) return;
    const gl = this.#gl;
    this.#begin(this.map, gl.LESS);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#stretches);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, this.#batch, 0, 36 * count);
    gl.bindVertexArray(this.#array);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * count);
    gl.bindVertexArray(null);
    this.#end();
  }

  /** @param {number} vertex */
  #save(vertex) {
    const copy = this.#newMap();
    this.#copy(this.map, copy);
    this.#saved.set(vertex, copy);
  }

  /** The heights of all cells, row by row from the least y; `z` in mm. Slow: for tests.
   * @param {HeightMap|null} [map] */
  readHeights(map = this.map) {
    const gl = this.#gl;
    const [w, h] = [this.columns, this.rows];
    const bytes = new Uint8Array(4 * w * h);
    const [target, texture] = [gl.createFramebuffer(), textureOf(gl, gl.RGBA8, w, h)];
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.viewport(0, 0, w, h);
    gl.disable(gl.DEPTH_TEST);
    const program = new Program(gl, READ_VERTEX, READ_FRAGMENT);
    program.use().setWhole({ uHeights: 0 });
    if (map) bindTexture(gl, 0, map.texture);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    this.#end();
    gl.deleteFramebuffer(target);
    gl.deleteTexture(texture);
    gl.deleteProgram(program.program);
    const heights = new Float32Array(bytes.buffer).map((depth) => this.origin[2] + depth * this.depth);
    return { heights, columns: w, rows: h, cell: this.cell, origin: this.origin };
  }

  dispose() {
    const gl = this.#gl;
    for (const map of [this.map, ...this.#saved.values(), ...(this.part ? [this.part] : [])]) {
      gl.deleteTexture(map.texture);
      gl.deleteFramebuffer(map.buffer);
    }
    gl.deleteBuffer(this.#stretches);
    gl.deleteVertexArray(this.#array);
    gl.deleteProgram(this.#sweep.program);
  }
}
