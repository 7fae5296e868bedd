// Draws the map of heights of the material as a shaded body, coloured by what is left above the part.

import { GOUGE_COLOR, LEFT_COLORS, rgb } from "./colors.js";
import { bindTexture, Program } from "./gl.js";
import { LIGHT_GLSL } from "./mesh.js";
/** @import { Frame, GL } from "./gl.js" */
/** @import { Material } from "./material.js" */

/** Frames at rest and while moving that take longer, in ms, get fewer vertices; the shading uses every
 * cell all the same. */
const [FINE_MS, COARSE_MS] = [500, 22];
/** Most cells between vertices. */
const MOST_STEP = 12;
/** What is drawn: the surface from above, the four sides, the bottom. */
const [SURFACE, SIDES, BOTTOM] = [0, 1, 2];
/** Within this height the material counts as finished: mm, or the share of a cell where it is more. */
const [FINISHED_MM, FINISHED_CELLS] = [0.03, 0.3];

const VERTEX = `
uniform mat4 uView, uProjection;
uniform vec3 uOrigin;
uniform float uCell, uDepth;
uniform int uMode, uStep, uRow;
uniform highp sampler2D uHeights;
out vec3 vPlace;
flat out vec3 vSide;
ivec2 cells;
int texel(int index, int count) { return min(index * uStep, count - 1); }
float place(int index, int count) {
  int last = (count - 1 + uStep - 1) / uStep;
  return index <= 0 ? 0.0 : index >= last ? float(count) * uCell : (float(texel(index, count)) + 0.5) * uCell;
}
vec3 onMap(int column, int row, bool isLow) {
  ivec2 cell = ivec2(texel(column, cells.x), texel(row, cells.y));
  float height = isLow ? 0.0 : texelFetch(uHeights, cell, 0).r * uDepth;
  return vec3(place(column, cells.x), place(row, cells.y), height);
}
void main() {
  cells = textureSize(uHeights, 0);
  int strip = gl_VertexID / uRow;
  int index = clamp(gl_VertexID % uRow - 1, 0, uRow - 3);
  int along = index >> 1;
  bool second = (index & 1) == 1;
  vSide = vec3(0.0);
  if (uMode == ${SURFACE}) vPlace = onMap(along, strip + (second ? 1 : 0), false);
  else if (uMode == ${SIDES}) {
    bool isX = strip < 2;
    bool isFar = (strip & 1) == 1;
    int far = isFar ? 1 << 20 : 0;
    vPlace = isX ? onMap(far, along, second) : onMap(along, far, second);
    vSide = isX ? vec3(isFar ? 1.0 : -1.0, 0.0, 0.0) : vec3(0.0, isFar ? 1.0 : -1.0, 0.0);
  } else {
    vPlace = vec3(vec2(along, second) * vec2(cells) * uCell, 0.0);
    vSide = vec3(0.0, 0.0, -1.0);
  }
  gl_Position = uProjection * (uView * vec4(vPlace + uOrigin, 1.0));
}`;

const SIDE_FRAGMENT = `${LIGHT_GLSL}
in vec3 vPlace;
flat in vec3 vSide;
uniform mat4 uView;
uniform float uCell;
uniform int uMode;
uniform highp sampler2D uHeights;
uniform vec3 uStock;
out vec4 color;
void main() {
  ivec2 cell = min(ivec2(vPlace.xy / uCell), textureSize(uHeights, 0) - 1);
  if (uMode == ${BOTTOM} && texelFetch(uHeights, cell, 0).r <= 0.0) discard;
  color = vec4(lit(uStock, mat3(uView) * vSide), 1.0);
}`;

const FRAGMENT = `${LIGHT_GLSL}
in vec3 vPlace;
uniform mat4 uView;
uniform float uCell, uDepth, uMost, uFinished;
uniform int uHasPart;
uniform highp sampler2D uHeights, uPart;
uniform vec3 uStock, uDone, uSome, uMuch, uGouge;
out vec4 color;
ivec2 cells;
float height(ivec2 cell) { return texelFetch(uHeights, clamp(cell, ivec2(0), cells - 1), 0).r * uDepth; }
const ivec2 AROUND[5] = ivec2[5](ivec2(0), ivec2(1, 1), ivec2(-1, 1), ivec2(1, -1), ivec2(-1, -1));
vec3 compared(ivec2 cell, float own) {
  float high = 0.0;
  float low = 1e9;
  for (int i = 0; i < 5; i++) {
    float h = texelFetch(uPart, clamp(cell + AROUND[i], ivec2(0), cells - 1), 0).r * uDepth;
    high = max(high, h);
    low = min(low, h);
  }
  if (high <= 0.0) return uStock;
  if (own < low - uFinished) return uGouge;
  float over = (own - high - uFinished) / uMost;
  if (over <= 0.0) return uDone;
  if (over < 0.5) return mix(uDone, uSome, min(over * 2.0 + 0.25, 1.0));
  return mix(uSome, uMuch, min(over * 2.0 - 1.0, 1.0));
}
void main() {
  cells = textureSize(uHeights, 0);
  ivec2 cell = clamp(ivec2(floor(vPlace.xy / uCell)), ivec2(0), cells - 1);
  float own = height(cell);
  // Where nothing is left, only the lower parts of the walls around are drawn.
  if (own <= 0.0 && vPlace.z <= 1e-3 * uDepth) discard;
  // On a wall the cells beside it do: between single cells its direction would jump.
  vec3 flank = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
  int far = abs(flank.z) < 0.6 ? 4 : 1;
  float dx = height(cell + ivec2(far, 0)) - height(cell - ivec2(far, 0));
  float dy = height(cell + ivec2(0, far)) - height(cell - ivec2(0, far));
  vec3 base = uHasPart == 1 ? compared(cell, own) : uStock;
  color = vec4(lit(base, mat3(uView) * vec3(-dx, -dy, 2.0 * float(far) * uCell)), 1.0);
}`;

export class Surface {
  #gl;
  #surface;
  #sides;
  #array;
  /** Cells between vertices at rest and while the view moves. */
  #fine = 2;
  #coarse = 4;

  /** @param {GL} gl */
  constructor(gl) {
    this.#gl = gl;
    this.#surface = new Program(gl, VERTEX, FRAGMENT);
    this.#sides = new Program(gl, VERTEX, SIDE_FRAGMENT);
    this.#array = gl.createVertexArray();
  }

  /** Height over the part, in mm, that has the last colour. @param {Material} material */
  static most(material) { return Math.max(material.depth / 10, 0.5); }

  /** Draws fewer vertices where a frame took too long. @param {boolean} coarse @param {number} elapsed ms */
  learn(coarse, elapsed) {
    if (coarse && elapsed > COARSE_MS) this.#coarse = Math.min(this.#coarse + 4, MOST_STEP);
    if (!coarse && elapsed > FINE_MS) this.#fine = Math.min(this.#fine + 1, this.#coarse);
  }

  /** @param {Frame} frame @param {Material} material */
  draw(frame, material) {
    const step = frame.coarse ? this.#coarse : this.#fine;
    const [columns, rows] = [material.columns, material.rows].map((count) => Math.ceil((count - 1) / step));
    this.#gl.bindVertexArray(this.#array);
    this.#setUp(this.#surface, frame, material, step);
    this.#run(this.#surface, SURFACE, 2 * ((columns ?? 0) + 1), rows ?? 0);
    this.#setUp(this.#sides, frame, material, step);
    this.#run(this.#sides, SIDES, 2 * (Math.max(columns ?? 0, rows ?? 0) + 1), 4);
    this.#run(this.#sides, BOTTOM, 4, 1);
    this.#gl.bindVertexArray(null);
  }

  /** @param {Program} program @param {Frame} frame @param {Material} material
   * @param {number} step cells between vertices */
  #setUp(program, frame, material, step) {
    const gl = this.#gl;
    bindTexture(gl, 0, material.map.texture);
    bindTexture(gl, 1, (material.part ?? material.map).texture);
    const [done, some, much] = LEFT_COLORS.map(rgb);
    program.use().setFrame(frame).set({
      uOrigin: material.origin, uCell: material.cell, uDepth: material.depth, uMost: Surface.most(material),
      uFinished: Math.max(FINISHED_MM, FINISHED_CELLS * material.cell), uStock: frame.theme.stock,
      uDone: done ?? [], uSome: some ?? [], uMuch: much ?? [], uGouge: rgb(GOUGE_COLOR),
    }).setWhole({ uHeights: 0, uPart: 1, uHasPart: material.part ? 1 : 0, uStep: step });
  }

  /** Draws strips of triangles as a single one; the ends of each stand twice, so that nothing lies between
   * them. As instances each would take 100 us without a graphics card.
   * @param {Program} program @param {number} mode @param {number} vertices of a strip @param {number} strips */
  #run(program, mode, vertices, strips) {
    program.setWhole({ uMode: mode, uRow: vertices + 2 });
    this.#gl.drawArrays(this.#gl.TRIANGLE_STRIP, 0, (vertices + 2) * strips);
  }

  dispose() {
    this.#gl.deleteVertexArray(this.#array);
    this.#gl.deleteProgram(this.#surface.program);
    this.#gl.deleteProgram(this.#sides.program);
  }
}
