// Vectors, 4 x 4 matrices (columns first, as WebGL takes them) and boxes.

/** @import { Box, Vec3 } from "./types.js" */

/** The entry of an array of whole numbers; 0 where the array ends before.
 * @param {Uint32Array|Uint8Array} array @param {number} index */
export const at = (array, index) => array[index] ?? 0;

/** The same for fractions; a function of its own stays fast, since it sees one kind of array only.
 * @param {Float32Array} array @param {number} index */
export const real = (array, index) => array[index] ?? 0;

/** @param {Float32Array} array @param {number} index @returns {Vec3} entry of an array of points */
export const pointAt = (array, index) =>
  [real(array, 3 * index), real(array, 3 * index + 1), real(array, 3 * index + 2)];

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @param {Vec3} a @param {number} k @returns {Vec3} */
export const scale = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
/** @param {Vec3} a @param {Vec3} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @param {Vec3} a @param {Vec3} b @param {number} t @returns {Vec3} */
export const mix = (a, b, t) => add(scale(a, 1 - t), scale(b, t));
/** @param {Vec3} a */
export const norm = (a) => Math.sqrt(dot(a, a));
/** The vector at length 1; +z for a vector without length. @param {Vec3} a @returns {Vec3} */
export const unit = (a) => (norm(a) > 1e-12 ? scale(a, 1 / norm(a)) : [0, 0, 1]);
/** @param {number} x @param {number} low @param {number} high */
export const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

/** The matrix that puts a body upright at the origin to `place`, its z axis along `axis`.
 * @param {Vec3} place @param {Vec3} axis */
export function placed(place, axis) {
  const z = unit(axis);
  const x = unit(cross(Math.abs(z[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], z));
  const y = cross(z, x);
  return new Float32Array([...x, 0, ...y, 0, ...z, 0, ...place, 1]);
}

/** The smallest box about points in mm; null without a finite point.
 * @param {Float32Array} positions @returns {Box|null} */
export function boxOf(positions) {
  /** @type {Vec3} */ const min = [Infinity, Infinity, Infinity];
  /** @type {Vec3} */ const max = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < 3; k++) {
    for (let i = k; i < positions.length; i += 3) {
      const x = real(positions, i);
      if (x < min[/** @type {0} */ (k)] && x > -Infinity) min[k] = x;
      if (x > max[/** @type {0} */ (k)] && x < Infinity) max[k] = x;
    }
  }
  return min.every((x, k) => x <= (max[k] ?? x - 1)) ? { min, max } : null;
}

/** The box about all boxes that are there; null without any. @param {(Box|null)[]} boxes */
export function boxAround(boxes) {
  /** @type {Box|null} */ let all = null;
  for (const box of boxes) {
    if (!box) continue;
    all = all ? { min: each(Math.min, all.min, box.min), max: each(Math.max, all.max, box.max) } : box;
  }
  return all;
}

/** @param {(a: number, b: number) => number} f @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const each = (f, a, b) => [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2])];

/** @param {Box} box @returns {Vec3[]} its eight corners */
export function corners(box) {
  const ends = [box.min, box.max];
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) =>
    /** @type {Vec3} */ ([0, 1, 2].map((k) => ends[(i >> k) & 1]?.[k] ?? 0)));
}

/** The largest of 1, 2 and 5 times a power of ten that is at most `x`. @param {number} x */
export function roundDown(x) {
  const power = 10 ** Math.floor(Math.log10(x) + 1e-9);
  return power * (x / power >= 5 - 1e-9 ? 5 : x / power >= 2 - 1e-9 ? 2 : 1);
}
