// Stretches of the path that are cut at once into a map of heights.
//
// Each is a rectangle over the places whose least height it may give. Where one stretch follows another, the
// one before has cut what lies behind, and the next one cuts what lies ahead; so a rectangle reaches past the
// ends of its stretch only as far as the slopes and the turn between both need. On a smooth path this
// leaves a few cells in place of the whole cutter.

import { bindTexture, Program, RECTANGLE_GLSL, textureOf } from "./gl.js";
import { HALVINGS, leadOf, pastCorner } from "./sweep.js";
/** @import { GL } from "./gl.js" */
/** @import { Cutter } from "./tool.js" */

/** Most stretches of a batch, and stretches in a row of the texture that hands them over. */
const [MOST, IN_ROW] = [8192, 512];
/** Numbers of a stretch: start and length; direction, slope, and reach behind; reach ahead on the left and
 * on the right, and two that are free. */
export const NUMBERS = 12;
/** A slope that changes the height by less than this share of a cell over the cutter counts as level. */
const LEVEL_CELLS = 0.01;
/** Rectangles reach this much further, since their corners are rounded to parts of a cell. */
const MARGIN_CELLS = 0.3;
/** Shorter ways over the ground count as upright, in mm. */
const UPRIGHT_MM = 1e-6;
/** What a stretch costs besides its cells, as cells. */
const OWN_CELLS = 200;

const VERTEX = `${RECTANGLE_GLSL}
uniform highp sampler2D uStretches;
uniform vec2 uExtent;
uniform float uRadius;
flat out vec4 vFrom;
flat out vec3 vWay;
vec4 number(int k) {
  int index = rectangle();
  return texelFetch(uStretches, ivec2(3 * (index % ${IN_ROW}) + k, index / ${IN_ROW}), 0);
}
void main() {
  vFrom = number(0);
  vec4 way = number(1);
  vec2 ahead = number(2).xy;
  vWay = way.xyz;
  int which = rectangleCorner();
  bool isLeft = which >= 2;
  float u = (which & 1) == 1 ? vFrom.w + (isLeft ? ahead.x : ahead.y) : -way.w;
  float v = isLeft ? uRadius : -uRadius;
  gl_Position = vec4((vFrom.xy + way.xy * u + vec2(-way.y, way.x) * v) / uExtent * 2.0 - 1.0, 0.0, 1.0);
}`;

/** The shader's copy of `sweep.js`. */
const FRAGMENT = `
flat in vec4 vFrom;
flat in vec3 vWay;
uniform float uRadius, uFlat, uCorner, uSlope, uCell, uDepth, uLevel;
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
  if (abs(slope) <= uLevel) return clamp(u, low, high);
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
  float high = min(u + sqrt(reach), vFrom.w);
  if (low > high) discard;
  float t = travel(vWay.z, u, v, low, high);
  float z = vFrom.z + vWay.z * t + height(min(length(vec2(u - t, v)), uRadius));
  gl_FragDepth = clamp(z / uDepth, 0.0, 1.0);
}`;

export class Stretches {
  /** Stretches in the batch. */
  count = 0;
  #numbers = new Float32Array(NUMBERS * MOST);
  /** Direction of the last stretch in the batch, and how far ahead it has to reach for itself. */
  #dx = 0;
  #dy = 0;
  #ahead = 0;
  #gl;
  #cutter;
  #cell;
  #level;
  #margin;
  #program;
  #array;
  #texture;

  /** @param {GL} gl @param {Cutter} cutter @param {number} cell of the map, mm */
  constructor(gl, cutter, cell) {
    this.#gl = gl;
    this.#cutter = cutter;
    this.#cell = cell;
    this.#level = (LEVEL_CELLS * cell) / cutter.radius;
    this.#margin = MARGIN_CELLS * cell;
    this.#program = new Program(gl, VERTEX, FRAGMENT);
    this.#array = gl.createVertexArray();
    this.#texture = textureOf(gl, gl.RGBA32F, 3 * IN_ROW, MOST / IN_ROW);
  }

  get isFull() { return this.count === MOST; }

  /** Puts a stretch in the batch. Places are mm from the corner of the map.
   * @param {number} x @param {number} y @param {number} z where it starts
   * @param {number} x1 @param {number} y1 @param {number} z1 where it ends
   * @param {boolean} follows whether it starts where the last one in the batch ends
   * @returns {number} cells that it covers, about */
  add(x, y, z, x1, y1, z1, follows) {
    const { radius } = this.#cutter;
    const length = Math.hypot(x1 - x, y1 - y);
    const isUpright = !(length > UPRIGHT_MM);
    const [dx, dy] = isUpright ? [1, 0] : [(x1 - x) / length, (y1 - y) / length];
    const slope = isUpright ? 0 : (z1 - z) / length;
    const lead = isUpright ? radius : Math.abs(slope) > this.#level ? leadOf(this.#cutter, slope) : 0;
    const back = isUpright || !follows ? radius : slope < 0 ? lead : 0;
    if (follows && !isUpright) this.#turn(dx, dy, slope > 0 ? lead : 0);
    const [n, k] = [this.#numbers, NUMBERS * this.count++];
    n[k] = x;
    n[k + 1] = y;
    n[k + 2] = isUpright ? Math.min(z, z1) : z;
    n[k + 3] = isUpright ? 0 : length;
    n[k + 4] = dx;
    n[k + 5] = dy;
    n[k + 6] = slope;
    n[k + 7] = back + this.#margin;
    n[k + 8] = n[k + 9] = radius + this.#margin;
    this.#dx = dx;
    this.#dy = dy;
    this.#ahead = isUpright ? Infinity : slope > 0 ? lead : 0;
    return OWN_CELLS + (2 * radius * (length + back + lead)) / this.#cell ** 2;
  }

  /** Shortens the end of the last stretch, since another follows. @param {number} dx @param {number} dy
   * @param {number} lead of the one that follows, ahead of its tip */
  #turn(dx, dy, lead) {
    const { radius } = this.#cutter;
    const cosine = this.#dx * dx + this.#dy * dy;
    const sine = this.#dx * dy - this.#dy * dx;
    const left = Math.max(this.#ahead, pastCorner(radius, lead, cosine, -sine));
    const right = Math.max(this.#ahead, pastCorner(radius, lead, cosine, sine));
    // The slanting end reaches all places of the corner only where it lies within the cutter.
    const isWhole = !(left <= radius && right <= radius);
    const k = NUMBERS * (this.count - 1);
    this.#numbers[k + 8] = (isWhole ? radius : left) + this.#margin;
    this.#numbers[k + 9] = (isWhole ? radius : right) + this.#margin;
  }

  /** Cuts the batch into the map that is bound, and empties it.
   * @param {[number, number]} extent of the map, mm @param {number} depth of the stock, mm */
  draw(extent, depth) {
    if (this.count === 0) return;
    const gl = this.#gl;
    const { radius, flat, corner, slope } = this.#cutter;
    bindTexture(gl, 0, this.#texture);
    const rows = Math.ceil(this.count / IN_ROW);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 3 * IN_ROW, rows, gl.RGBA, gl.FLOAT, this.#numbers);
    this.#program.use().setWhole({ uStretches: 0 }).set({
      uExtent: extent, uRadius: radius, uFlat: flat, uCorner: corner, uSlope: slope, uCell: this.#cell,
      uDepth: depth, uLevel: this.#level,
    });
    gl.bindVertexArray(this.#array);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * this.count);
    gl.bindVertexArray(null);
    this.count = 0;
  }

  dispose() {
    this.#gl.deleteTexture(this.#texture);
    this.#gl.deleteVertexArray(this.#array);
    this.#gl.deleteProgram(this.#program.program);
  }
}
