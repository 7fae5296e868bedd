// Draws the path: lines of constant width, coloured by a table, and coarser copies while the view moves.

import { bindTexture, LINE_GLSL, Program, RECTANGLE_GLSL, textureOf } from "./gl.js";
import { at, real } from "./math.js";
import { colorTable, paint } from "./colors.js";
import { DWELL, isJoined, MARK, marksOf, thinned, vertexCount } from "./timeline.js";
/** @import { Coloring } from "./colors.js" */
/** @import { Frame, GL } from "./gl.js" */
/** @import { Vertices } from "./timeline.js" */
/** @import { Box, ColorBy, PathData } from "./types.js" */

/** Vertices of the coarser copies; a path with fewer vertices has no such copy. */
const BUDGETS = [160_000, 40_000, 10_000];
/** A moving view may spend this long on the path, in ms: half of a frame at 30 frames a second. */
const MOVING_MS = 16;
/** A whole path that takes longer than this at rest, in ms, is drawn bit by bit, in lines one pixel wide;
 * and how long a bit takes. */
const [LONG_MS, RUN_MS] = [250, 120];
/** Stretches of a long path, of a bit at least, and of a path whose picture tells what stretches cost. */
const [LONG, LEAST_RUN, LEAST_LEARNT] = [50_000, 2000, 5000];
/** Where a stretch takes longer, in ms, a moving view has lines one pixel wide. */
const THIN_COST = 5e-4;
/** Width of a line and of a lit line in CSS pixels. */
const [WIDTH, LIT_WIDTH] = [1.6, 4];
/** Runs of stretches that are lit at most: a block has few. */
const MOST_RUNS = 64;

/** Vertices in a row of the textures that hold the path: a power of two. */
const ROW = 2048;
/** Rows of places that are handed over at once, 2 MB. */
const ROWS_AT_ONCE = 64;

const VERTEX = `${LINE_GLSL}${RECTANGLE_GLSL}
uniform highp sampler2D uPlaces;
uniform highp usampler2D uMarks;
uniform int uShown, uFirst, uThin;
uniform float uWidth;
uniform vec4 uLit;
uniform sampler2D uColors;
out vec4 vColor;
out vec3 vRun;
void main() {
  int before = uFirst + (uThin == 1 ? gl_VertexID / 2 : rectangle());
  int after = before + 1;
  ivec2 from = ivec2(before % ${ROW}, before / ${ROW});
  ivec2 to = ivec2(after % ${ROW}, after / ${ROW});
  uvec4 mark = texelFetch(uMarks, to, 0);
  int kind = int(mark.x);
  vColor = vec4(0.0);
  vRun = vec3(0.0);
  gl_Position = NOWHERE;
  bool joined = texelFetch(uMarks, from, 0).zw == mark.zw && (mark.z > 0u || mark.w > 0u);
  if (!joined || (uShown >> kind & 1) == 0) return;
  vec4 start = texelFetch(uPlaces, from, 0);
  vec4 end = texelFetch(uPlaces, to, 0);
  vec3 own = texelFetch(uColors, ivec2(int(mark.y), 0), 0).rgb;
  vColor = uLit.a > 0.0 ? uLit : vec4(own, kind == 0 ? 0.5 : 1.0);
  float share;
  vec2 run;
  float width = uThin == 1 ? 0.0 : kind >= ${DWELL} ? uWidth * 3.0 : uWidth;
  int which = uThin == 1 ? gl_VertexID % 2 : rectangleCorner();
  gl_Position = corner(which, start.xyz, end.xyz, width, share, run);
  vRun = vec3(run, mix(start.w, end.w, share));
}`;

const FRAGMENT = `
in vec4 vColor;
in vec3 vRun;
uniform float uTime, uDash;
uniform vec3 uBackground;
out vec4 color;
void main() {
  if (vColor.a < 1.0 && fract(vRun.x / vRun.y / uDash) > 0.6) discard;
  color = vec4(mix(vColor.rgb, uBackground, vRun.z > uTime ? 0.72 : 0.0), 1.0);
}`;

/** Textures of a path or of a coarser copy.
 * @typedef {{count: number, places: WebGLTexture, marks: WebGLTexture, vertices: Vertices}} Copy */

export class PathLayer {
  /** Bit k: stretches of kind k are drawn. */
  shown = -1;
  /** What lies after this time in s is drawn fainter. */
  time = Infinity;
  /** @type {[number, number][]} first and last vertex of lit runs */ #lit = [];
  /** @type {Copy[]} from fine to coarse */ #copies = [];
  /** Time that drawing a stretch takes, in ms: of a small machine without graphics card, until measured. */
  #cost = 2e-4;
  #gl;
  #program;
  #array;
  #table;

  /** @param {GL} gl @param {PathData} path @param {Box|null} box of the path */
  constructor(gl, path, box) {
    this.#gl = gl;
    this.path = path;
    this.positions = path.positions;
    this.marks = marksOf(path);
    this.#program = new Program(gl, VERTEX, FRAGMENT);
    this.#array = gl.createVertexArray();
    this.#table = textureOf(gl, gl.RGBA8, 256, 1);
    const n = vertexCount(path);
    const size = box ? Math.hypot(...box.max.map((x, k) => x - (box.min[k] ?? x))) : 1;
    /** @type {Vertices} */
    let copy = { positions: path.positions, times: path.times, marks: this.marks, sources: null };
    this.#copies.push(this.#upload(copy));
    for (const budget of BUDGETS.filter((budget) => budget < n)) {
      copy = thinned(copy, size, budget);
      this.#copies.push(this.#upload(copy));
    }
    /** @type {Coloring} */ this.coloring = this.setColor("kind");
  }

  /** @param {Vertices} vertices @returns {Copy} */
  #upload(vertices) {
    const gl = this.#gl;
    const most = ROW * Number(gl.getParameter(gl.MAX_TEXTURE_SIZE));
    const count = Math.min(vertices.marks.length / MARK, most);
    const rows = Math.max(1, Math.ceil(count / ROW));
    const places = textureOf(gl, gl.RGBA32F, ROW, rows);
    for (let row = 0; row < rows; row += ROWS_AT_ONCE) {
      const height = Math.min(ROWS_AT_ONCE, rows - row);
      const texels = placesOf(vertices, row * ROW, height * ROW);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, row, ROW, height, gl.RGBA, gl.FLOAT, texels);
    }
    return { count, vertices, places, marks: textureOf(gl, gl.RGBA8UI, ROW, rows) };
  }

  /** Hands the marks over anew. @param {Copy} copy */
  #uploadMarks({ count, vertices, marks }) {
    const gl = this.#gl;
    const [rows, rest] = [Math.floor(count / ROW), count % ROW];
    bindTexture(gl, 0, marks);
    const [format, type] = [gl.RGBA_INTEGER, gl.UNSIGNED_BYTE];
    if (rows) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ROW, rows, format, type, vertices.marks);
    const last = vertices.marks.subarray(MARK * ROW * rows);
    if (rest) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, rows, rest, 1, format, type, last);
  }

  /** @param {ColorBy} by */
  setColor(by) {
    const gl = this.#gl;
    this.coloring = paint(this.path, this.marks, by);
    for (const copy of this.#copies) {
      const { marks, sources } = copy.vertices;
      sources?.forEach((vertex, j) => { marks[MARK * j + 1] = at(this.marks, MARK * vertex + 1); });
      this.#uploadMarks(copy);
    }
    bindTexture(gl, 0, this.#table);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, 1, gl.RGBA, gl.UNSIGNED_BYTE, colorTable(by));
    return this.coloring;
  }

  /** Lights the stretches of a block. @param {number|null} block line of the NC text */
  highlight(block) {
    this.#lit = [];
    if (block === null || block <= 0) return;
    const { blocks } = this.path;
    const n = vertexCount(this.path);
    for (let i = 1; i < n && this.#lit.length < MOST_RUNS; i++) {
      if (blocks[i] !== block || !isJoined(this.marks, i)) continue;
      const first = i - 1;
      while (i + 1 < n && blocks[i + 1] === block) i++;
      this.#lit.push([first, i]);
    }
  }

  /** Whether a moving view draws a coarser copy at the present speed. */
  get isThinned() { return this.#choose(true) > 0; }

  /** Tells the layer what a frame took, in ms, so that a moving view stays smooth.
   * @param {boolean} coarse @param {number} elapsed */
  learn(coarse, elapsed) {
    const count = this.#copies[this.#choose(coarse)]?.count ?? 0;
    // The rest of the picture would count as cost of a short path.
    if (count >= LEAST_LEARNT) this.learnOn(count, elapsed);
  }

  /** Tells the layer what some stretches took. @param {number} count @param {number} elapsed ms */
  learnOn(count, elapsed) {
    if (count >= LEAST_RUN) this.#cost = 0.5 * this.#cost + (0.5 * elapsed) / count;
  }

  /** @param {boolean} coarse */
  #choose(coarse) {
    if (!coarse) return 0;
    const fit = this.#copies.findIndex(({ count }) => count * this.#cost <= MOVING_MS);
    return fit < 0 ? this.#copies.length - 1 : fit;
  }

  /** @param {Frame} frame */
  draw(frame) {
    const gl = this.#gl;
    const copy = this.#copies[this.#choose(frame.coarse)];
    if (!copy || copy.count < 2) return;
    gl.bindVertexArray(this.#array);
    this.#setUp(frame);
    this.#run(copy, 0, copy.count - 1, frame.coarse && this.#cost > THIN_COST);
    if (this.#lit.length) this.#drawLit(frame);
    gl.bindVertexArray(null);
  }

  /** Draws the next stretches of the whole path on a picture that has a coarser copy.
   * @param {Frame} frame @param {number} first vertex @returns {number} vertex to go on from; 0 at the end */
  drawOn(frame, first) {
    const [whole] = this.#copies;
    if (!whole) return 0;
    const last = Math.min(whole.count - 1, first + Math.max(LEAST_RUN, Math.floor(RUN_MS / this.#cost)));
    this.#gl.bindVertexArray(this.#array);
    this.#setUp(frame);
    this.#run(whole, first, last, true);
    this.#gl.bindVertexArray(null);
    return last < whole.count - 1 ? last : 0;
  }

  /** Whether the whole path takes so long that it is drawn bit by bit. */
  get isLong() {
    const count = this.#copies[0]?.count ?? 0;
    return count > LONG && count * this.#cost > LONG_MS;
  }

  /** @param {Frame} frame */
  #setUp(frame) {
    bindTexture(this.#gl, 0, this.#table);
    const whole = { uColors: 0, uPlaces: 1, uMarks: 2, uShown: this.shown };
    this.#program.use().setFrame(frame).setWhole(whole).set({
      uWidth: WIDTH * frame.ratio, uDash: 9 * frame.ratio, uTime: Math.min(this.time, 3e38),
      uBackground: frame.theme.background, uLit: [0, 0, 0, 0],
    });
  }

  /** @param {Frame} frame */
  #drawLit(frame) {
    const [whole] = this.#copies;
    if (!whole) return;
    this.#program.set({
      uWidth: LIT_WIDTH * frame.ratio, uLit: [...frame.theme.highlight, 1], uTime: 3e38,
      uBias: 2 * frame.bias,
    });
    for (const [first, last] of this.#lit) this.#run(whole, first, last);
  }

  /** Draws the stretches between two vertices of a copy.
   * @param {Copy} copy @param {number} first @param {number} last
   * @param {boolean} [thin] one pixel wide */
  #run(copy, first, last, thin = false) {
    const gl = this.#gl;
    bindTexture(gl, 1, copy.places);
    bindTexture(gl, 2, copy.marks);
    this.#program.setWhole({ uFirst: first, uThin: thin ? 1 : 0 });
    gl.drawArrays(thin ? gl.LINES : gl.TRIANGLES, 0, (thin ? 2 : 6) * (last - first));
  }

  dispose() {
    const gl = this.#gl;
    for (const { places, marks } of this.#copies) {
      gl.deleteTexture(places);
      gl.deleteTexture(marks);
    }
    gl.deleteVertexArray(this.#array);
    gl.deleteTexture(this.#table);
    gl.deleteProgram(this.#program.program);
  }
}

/** Places and times as the texture takes them, four numbers a vertex.
 * @param {Vertices} vertices @param {number} first @param {number} count */
function placesOf({ positions, times }, first, count) {
  const texels = new Float32Array(4 * count);
  for (let i = 0; i < count; i++) {
    texels[4 * i] = real(positions, 3 * (first + i));
    texels[4 * i + 1] = real(positions, 3 * (first + i) + 1);
    texels[4 * i + 2] = real(positions, 3 * (first + i) + 2);
    texels[4 * i + 3] = real(times, first + i);
  }
  return texels;
}
