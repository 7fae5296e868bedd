// The floor grid, the edges of the stock and the axis cross: coloured lines of constant width.

import { bufferOf, LINE_GLSL, point, Program } from "./gl.js";
import { roundDown } from "./math.js";
/** @import { Color, Frame, GL, Theme } from "./gl.js" */
/** @import { Box, Vec3 } from "./types.js" */

/** Distances between grid lines across the longer side of the scene, about. */
const LINES_ACROSS = 12;
/** The longest axis line, in shares of the scene's diagonal. */
const AXIS_SHARE = 0.12;
/** Colours of the X, Y and Z axes; people who see fewer colours tell them apart. */
const AXIS_COLORS = /** @type {Color[]} */ ([[0.84, 0.29, 0.11], [0.04, 0.6, 0.46], [0.12, 0.47, 0.82]]);
/** Numbers of a line: two points, a colour and the width in CSS pixels. */
const LINE = 10;

const VERTEX = `${LINE_GLSL}
in vec3 aFrom, aTo;
in vec4 aColor;
uniform float uRatio;
out vec3 vColor;
void main() {
  float share;
  vec2 run;
  gl_Position = corner(gl_VertexID, aFrom, aTo, aColor.a * uRatio, share, run);
  vColor = aColor.rgb;
}`;

const FRAGMENT = `
in vec3 vColor;
out vec4 color;
void main() { color = vec4(vColor, 1.0); }`;

/** The floor grid of a scene: round spacing, and from where to where, in mm. @param {Box} box */
export function gridOf(box) {
  const [w, h] = [box.max[0] - box.min[0], box.max[1] - box.min[1]];
  const spacing = roundDown(Math.max(w, h, box.max[2] - box.min[2], 1e-3) / LINES_ACROSS * 1.5);
  const low = (/** @type {number} */ x) => Math.floor(x / spacing - 0.5) * spacing;
  const high = (/** @type {number} */ x) => Math.ceil(x / spacing + 0.5) * spacing;
  const [x0, x1, y0, y1] = [low(box.min[0]), high(box.max[0]), low(box.min[1]), high(box.max[1])];
  return { spacing, x0, x1, y0, y1, z: box.min[2] };
}

/** @param {Box} box @param {Color} color @returns {number[]} */
function gridLines(box, color) {
  const { spacing, x0, x1, y0, y1, z } = gridOf(box);
  /** @type {number[]} */ const lines = [];
  for (let i = 0; i <= Math.round((x1 - x0) / spacing); i++) {
    lines.push(x0 + i * spacing, y0, z, x0 + i * spacing, y1, z, ...color, 1);
  }
  for (let i = 0; i <= Math.round((y1 - y0) / spacing); i++) {
    lines.push(x0, y0 + i * spacing, z, x1, y0 + i * spacing, z, ...color, 1);
  }
  return lines;
}

/** The ends of the three axes from the origin of the program. @param {Box} box @returns {Vec3[]} */
export function axisEnds(box) {
  const length = roundDown(AXIS_SHARE * Math.hypot(...box.max.map((x, k) => x - (box.min[k] ?? x))) || 1);
  return [[length, 0, 0], [0, length, 0], [0, 0, length]];
}

/** @param {number[]} ends both ends of each edge @param {Color} color */
function edgeLines(ends, color) {
  /** @type {number[]} */ const lines = [];
  for (let k = 0; k < ends.length; k += 6) lines.push(...ends.slice(k, k + 6), ...color, 1.2);
  return lines;
}

export class Furniture {
  #gl;
  #program;
  #array;
  /** @type {WebGLBuffer|null} */ #buffer = null;
  #count = 0;

  /** @param {GL} gl */
  constructor(gl) {
    this.#gl = gl;
    this.#program = new Program(gl, VERTEX, FRAGMENT);
    this.#array = gl.createVertexArray();
  }

  /** @param {Box} box of the scene @param {number[]} stock both ends of each of its edges @param {Theme} theme */
  set(box, stock, theme) {
    const gl = this.#gl;
    const axes = axisEnds(box).flatMap((end, k) => [0, 0, 0, ...end, ...(AXIS_COLORS[k] ?? theme.grid), 2.4]);
    const lines = [...axes, ...gridLines(box, theme.grid), ...edgeLines(stock, theme.stock)];
    gl.deleteBuffer(this.#buffer);
    this.#buffer = bufferOf(gl, Float32Array.from(lines));
    this.#count = lines.length / LINE;
    gl.bindVertexArray(this.#array);
    const layout = { stride: 4 * LINE, divisor: 1 };
    point(this.#program, "aFrom", this.#buffer, 3, layout);
    point(this.#program, "aTo", this.#buffer, 3, { ...layout, offset: 12 });
    point(this.#program, "aColor", this.#buffer, 4, { ...layout, offset: 24 });
    gl.bindVertexArray(null);
  }

  /** @param {Frame} frame */
  draw(frame) {
    this.#program.use().setFrame(frame).set({ uRatio: frame.ratio, uBias: 0 });
    this.#run(this.#count);
  }

  /** Draws the axes over all else, so that their letters stand at something. @param {Frame} frame */
  drawAxes(frame) {
    this.#gl.disable(this.#gl.DEPTH_TEST);
    this.#program.use().setFrame(frame).set({ uRatio: frame.ratio });
    this.#run(AXIS_COLORS.length);
    this.#gl.enable(this.#gl.DEPTH_TEST);
  }

  /** @param {number} count of the first lines */
  #run(count) {
    const gl = this.#gl;
    gl.bindVertexArray(this.#array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    gl.bindVertexArray(null);
  }

  dispose() {
    this.#gl.deleteBuffer(this.#buffer);
    this.#gl.deleteVertexArray(this.#array);
    this.#gl.deleteProgram(this.#program.program);
  }
}
