// The floor grid, the edges of the stock, and the axis cross in a corner: coloured lines of constant width.

import { bufferOf, LINE_GLSL, point, Program } from "./gl.js";
import { dot, roundDown } from "./math.js";
/** @import { Camera } from "./camera.js" */
/** @import { Color, Frame, GL, Theme } from "./gl.js" */
/** @import { Box, Vec3 } from "./types.js" */

/** Distances between grid lines across the longer side of the scene, about. */
const LINES_ACROSS = 12;
/** The axis cross: the middle of its square from the left and from below, half of the side, and the length of an axis,
 * in CSS pixels. Below the cross is room for a line of text. */
const CROSS = { left: 40, bottom: 68, half: 36, length: 26 };
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

/** @type {Vec3[]} */
const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** Where the axes of the cross end, in CSS pixels from the upper left corner of the canvas.
 * @param {Pick<Camera, "axes"|"height">} camera */
export function crossEnds(camera) {
  const { right, up } = camera.axes();
  const y = camera.height - CROSS.bottom;
  return AXES.map((axis) => ({ x: CROSS.left + CROSS.length * dot(axis, right), y: y - CROSS.length * dot(axis, up) }));
}

/** The frame that draws the cross in its square: as the camera looks, without perspective.
 * @param {Frame} frame @returns {Frame} */
function crossFrame(frame) {
  const side = Math.round(2 * CROSS.half * frame.ratio);
  const share = CROSS.length / CROSS.half;
  const view = frame.view.slice();
  view.set([0, 0, 0], 12);
  const projection = new Float32Array([share, 0, 0, 0, 0, share, 0, 0, 0, 0, -0.5, 0, 0, 0, 0, 1]);
  // All of the cross lies before the near plane.
  return { ...frame, view, projection, near: -2, bias: 0, size: [side, side] };
}

/** @param {number[]} ends both ends of each edge @param {Color} color */
function edgeLines(ends, color) {
  /** @type {number[]} */ const lines = [];
  for (let k = 0; k < ends.length; k += 6) lines.push(...ends.slice(k, k + 6), ...color, 1.2);
  return lines;
}

/** Lines in a buffer, each an instance. */
class Lines {
  #gl;
  #array;
  /** @type {WebGLBuffer|null} */ #buffer = null;
  #count = 0;

  /** @param {GL} gl */
  constructor(gl) {
    this.#gl = gl;
    this.#array = gl.createVertexArray();
  }

  /** @param {Program} program @param {number[]} lines */
  set(program, lines) {
    const gl = this.#gl;
    gl.deleteBuffer(this.#buffer);
    this.#buffer = bufferOf(gl, Float32Array.from(lines));
    this.#count = lines.length / LINE;
    gl.bindVertexArray(this.#array);
    const layout = { stride: 4 * LINE, divisor: 1 };
    point(program, "aFrom", this.#buffer, 3, layout);
    point(program, "aTo", this.#buffer, 3, { ...layout, offset: 12 });
    point(program, "aColor", this.#buffer, 4, { ...layout, offset: 24 });
    gl.bindVertexArray(null);
  }

  draw() {
    const gl = this.#gl;
    gl.bindVertexArray(this.#array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.#count);
    gl.bindVertexArray(null);
  }

  dispose() {
    this.#gl.deleteBuffer(this.#buffer);
    this.#gl.deleteVertexArray(this.#array);
  }
}

export class Furniture {
  #gl;
  #program;
  #lines;
  #cross;

  /** @param {GL} gl */
  constructor(gl) {
    this.#gl = gl;
    this.#program = new Program(gl, VERTEX, FRAGMENT);
    this.#lines = new Lines(gl);
    this.#cross = new Lines(gl);
    this.#cross.set(this.#program, AXES.flatMap((end, k) => [0, 0, 0, ...end, ...(AXIS_COLORS[k] ?? [0, 0, 0]), 2.4]));
  }

  /** @param {Box} box of the scene @param {number[]} stock both ends of each of its edges @param {Theme} theme */
  set(box, stock, theme) {
    this.#lines.set(this.#program, [...gridLines(box, theme.grid), ...edgeLines(stock, theme.stock)]);
  }

  /** @param {Frame} frame */
  draw(frame) {
    this.#program.use().setFrame(frame).set({ uRatio: frame.ratio, uBias: 0 });
    this.#lines.draw();
  }

  /** Draws the axes into their corner, over all else. @param {Frame} frame */
  drawAxes(frame) {
    const gl = this.#gl;
    const cross = crossFrame(frame);
    const [left, bottom] = [CROSS.left, CROSS.bottom].map((x) => Math.round((x - CROSS.half) * frame.ratio));
    gl.viewport(left ?? 0, bottom ?? 0, ...cross.size);
    gl.disable(gl.DEPTH_TEST);
    this.#program.use().setFrame(cross).set({ uRatio: frame.ratio });
    this.#cross.draw();
    gl.enable(gl.DEPTH_TEST);
    gl.viewport(0, 0, ...frame.size);
  }

  dispose() {
    this.#lines.dispose();
    this.#cross.dispose();
    this.#gl.deleteProgram(this.#program.program);
  }
}
