// Small wrappers of WebGL2: programs with their uniforms, buffers, vertex arrays and textures.

/** @typedef {WebGL2RenderingContext} GL */

/** Thrown where the browser has no WebGL2. */
export class NoWebGL extends Error {}

/** What all layers need to draw a frame. Sizes in pixels of the screen, colours 0 to 1.
 * @typedef {object} Frame
 * @property {Float32Array} view
 * @property {Float32Array} projection
 * @property {number} near mm
 * @property {[number, number]} size
 * @property {number} ratio pixels of the screen in a CSS pixel
 * @property {number} bias mm by which lines come nearer to the viewer
 * @property {boolean} coarse while the view moves
 * @property {Theme} theme */

/** @typedef {[number, number, number]} Color */
/** @typedef {Record<"background"|"grid"|"part"|"stock"|"tool"|"holder"|"highlight", Color>} Theme */

const HEADER = "#version 300 es\nprecision highp float;\nprecision highp int;\n";

/** A program and the places of its uniforms. */
export class Program {
  /** @type {Map<string, WebGLUniformLocation|null>} */ #places = new Map();
  /** @type {Map<string, number>} */ #attributes = new Map();

  /** @param {GL} gl @param {string} vertex @param {string} fragment GLSL without version and precision */
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [type, source] of /** @type {const} */ ([
      [gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]])) {
      const shader = gl.createShader(type);
      if (!shader) continue;
      gl.shaderSource(shader, HEADER + source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
      gl.deleteShader(shader);
    }
    gl.linkProgram(this.program);
  }

  /** Makes the program current. @throws {Error} where it does not compile */
  use() {
    if (this.#places.size === 0) this.#check();
    this.gl.useProgram(this.program);
    return this;
  }

  #check() {
    const { gl, program } = this;
    if (gl.getProgramParameter(program, gl.LINK_STATUS) || gl.isContextLost()) return;
    const logs = (gl.getAttachedShaders(program) ?? []).map((shader) => gl.getShaderInfoLog(shader));
    throw new Error([gl.getProgramInfoLog(program), ...logs].join("\n"));
  }

  /** @param {string} name */
  #place(name) {
    const known = this.#places.get(name);
    if (known !== undefined) return known;
    const place = this.gl.getUniformLocation(this.program, name);
    this.#places.set(name, place);
    return place;
  }

  /** Sets uniforms by length: 1 to 4 numbers or a matrix of 16.
   * @param {Record<string, number|ArrayLike<number>>} values */
  set(values) {
    for (const [name, value] of Object.entries(values)) {
      const place = this.#place(name);
      const list = typeof value === "number" ? [value] : value;
      if (list.length === 16) this.gl.uniformMatrix4fv(place, false, Float32Array.from(list));
      else if (list.length === 4) this.gl.uniform4fv(place, Float32Array.from(list));
      else if (list.length === 3) this.gl.uniform3fv(place, Float32Array.from(list));
      else if (list.length === 2) this.gl.uniform2fv(place, Float32Array.from(list));
      else this.gl.uniform1f(place, list[0] ?? 0);
    }
    return this;
  }

  /** Sets uniforms that are whole numbers or samplers. @param {Record<string, number>} values */
  setWhole(values) {
    for (const [name, value] of Object.entries(values)) this.gl.uniform1i(this.#place(name), value);
    return this;
  }

  /** Sets what every drawing of the scene needs. @param {Frame} frame */
  setFrame(frame) {
    const { view, projection, near, size, bias } = frame;
    return this.set({ uView: view, uProjection: projection, uNear: near, uSize: size, uBias: bias });
  }

  /** @param {string} name @returns {number} place of an attribute; -1 for none */
  attribute(name) {
    const known = this.#attributes.get(name) ?? this.gl.getAttribLocation(this.program, name);
    this.#attributes.set(name, known);
    return known;
  }
}

/** @param {GL} gl @param {ArrayBufferView} data @param {number} [target] */
export function bufferOf(gl, data, target = gl.ARRAY_BUFFER) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(target, buffer);
  gl.bufferData(target, data, gl.STATIC_DRAW);
  return buffer;
}

/** Points an attribute of floats at a buffer.
 * @param {Program} program @param {string} name @param {WebGLBuffer} buffer
 * @param {number} size numbers a vertex
 * @param {{stride?: number, offset?: number, divisor?: number}} [layout] bytes */
export function point(program, name, buffer, size, { stride = 0, offset = 0, divisor = 0 } = {}) {
  const { gl } = program;
  const place = program.attribute(name);
  if (place < 0) return;
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.enableVertexAttribArray(place);
  gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride, offset);
  gl.vertexAttribDivisor(place, divisor);
}

/** A texture whose values are read one by one. @param {GL} gl @param {number} format sized internal format
 * @param {number} width @param {number} height */
export function textureOf(gl, format, width, height) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return texture;
}

/** @param {GL} gl @param {number} unit @param {WebGLTexture} texture */
export function bindTexture(gl, unit, texture) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, texture);
}

/** GLSL: the corner of a rectangle that a vertex stands for, where each rectangle is two triangles. Many
 * small rectangles are drawn like this: as instances each takes 30 us without a graphics card. */
export const RECTANGLE_GLSL = `
const int CORNERS[6] = int[6](0, 1, 2, 2, 1, 3);
int rectangle() { return gl_VertexID / 6; }
int rectangleCorner() { return CORNERS[gl_VertexID % 6]; }
`;

/** GLSL: `corner` gives the place of corner 0 to 3 of a line that is `width` pixels wide. It tells the
 * share of the line before the corner, and the pixels from the line's start (with the weight `w`, which
 * the fragment divides by, so that dashes are even in perspective). */
export const LINE_GLSL = `
uniform mat4 uView, uProjection;
uniform vec2 uSize;
uniform float uNear, uBias;
const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);
vec4 corner(int which, vec3 p0, vec3 p1, float width, out float share, out vec2 run) {
  vec3 a = (uView * vec4(p0, 1.0)).xyz;
  vec3 b = (uView * vec4(p1, 1.0)).xyz;
  float front = -uNear;
  share = 0.0;
  run = vec2(0.0, 1.0);
  if (a.z > front && b.z > front) return NOWHERE;
  float start = a.z > front ? (front - a.z) / (b.z - a.z) : 0.0;
  float end = b.z > front ? (front - a.z) / (b.z - a.z) : 1.0;
  vec3 c = mix(a, b, start);
  vec3 d = mix(a, b, end);
  vec4 ca = uProjection * vec4(c, 1.0);
  vec4 cb = uProjection * vec4(d, 1.0);
  vec2 sa = ca.xy / ca.w * uSize * 0.5;
  vec2 sb = cb.xy / cb.w * uSize * 0.5;
  vec2 way = sb - sa;
  float size = length(way);
  way = size > 1e-3 ? way / size : vec2(1.0, 0.0);
  bool isEnd = (which & 1) == 1;
  vec2 s = isEnd ? sb + way * width * 0.5 : sa - way * width * 0.5;
  s += vec2(-way.y, way.x) * width * (which < 2 ? -0.5 : 0.5);
  share = isEnd ? end : start;
  vec3 nearer = isEnd ? d : c;
  float w = isEnd ? cb.w : ca.w;
  nearer.z = min(nearer.z + uBias, front);
  vec4 q = uProjection * vec4(nearer, 1.0);
  run = vec2(isEnd ? size : 0.0, 1.0) * w;
  return vec4(s / (uSize * 0.5) * w, q.z / q.w * w, w);
}
`;
