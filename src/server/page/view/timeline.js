// The path as numbers: where the tip is at a time, which vertices are joined, and paths with fewer vertices.

import { at, clamp, mix, pointAt, real } from "./math.js";
import { KINDS } from "./types.js";
/** @import { PathData, Vec3 } from "./types.js" */

/** Bytes of a vertex in the table of `marks`: kind, colour, and the number of the strip in two bytes. */
export const MARK = 4;
/** Kind of a stretch whose kind is unknown. */
export const CUT = KINDS.indexOf("cut");
/** This kind and those after it are pauses, in which the tip stays. */
export const DWELL = KINDS.indexOf("dwell");
/** Shorter stretches are not seen, mm: a path of single precision tells their places no better. */
const SEEN_MM = 1e-5;

/** Least cosine of the lean of an axis that counts as upright: a thousandth of a rad. */
const UPRIGHT = 0.9999995;

/** The number of whole vertices that all arrays of the path hold. @param {PathData} path */
export function vertexCount(path) {
  const { positions, times, kinds, feeds, blocks } = path;
  return Math.min(
    Math.floor(positions.length / 3), times.length, kinds.length, feeds.length, blocks.length);
}

/** Marks each vertex with its kind and strip; strip 0 is none, and neighbours have different numbers.
 * @param {PathData} path @returns {Uint8Array} */
export function marksOf(path) {
  const n = vertexCount(path);
  const marks = new Uint8Array(MARK * n);
  for (let i = 0; i < n; i++) {
    const kind = at(path.kinds, i);
    marks[MARK * i] = kind < KINDS.length ? kind : CUT;
  }
  path.strips.forEach((strip, index) => {
    const number = 1 + (index % 65535);
    const [first, end] = [Math.max(strip.first, 0), Math.min(strip.first + strip.count, n)];
    for (let i = first; i < end; i++) {
      marks[MARK * i + 2] = number & 255;
      marks[MARK * i + 3] = number >> 8;
    }
  });
  return marks;
}

/** Whether a stretch of the path ends at vertex `i`. @param {Uint8Array} marks @param {number} i */
export function isJoined(marks, i) {
  const m = MARK * i;
  if (i < 1 || m >= marks.length || (at(marks, m + 2) === 0 && at(marks, m + 3) === 0)) return false;
  return at(marks, m + 2) === at(marks, m - 2) && at(marks, m + 3) === at(marks, m - 1);
}

/** Whether a stretch is seen that ends at vertex `i`: as a line, or as a point where the tip stays.
 * @param {Float32Array} positions @param {Uint8Array} marks @param {number} i */
export function isSeen(positions, marks, i) {
  if (!isJoined(marks, i)) return false;
  if (at(marks, MARK * i) >= DWELL) return true;
  for (let k = 3 * i; k < 3 * i + 3; k++) {
    if (Math.abs(real(positions, k) - real(positions, k - 3)) > SEEN_MM) return true;
  }
  return false;
}

/** The first vertex that the tip reaches at `time` or later; the number of vertices after the end.
 * @param {Float32Array} times @param {number} time seconds */
export function vertexAfter(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (real(times, middle) < time) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Where the tip is at a time, and along which axis the tool stands; null for an empty path.
 * @param {PathData} path @param {number} time seconds
 * @returns {{point: Vec3, axis: Vec3, vertex: number}|null} */
export function poseAt(path, time) {
  const n = vertexCount(path);
  if (n === 0) return null;
  const vertex = clamp(vertexAfter(path.times.subarray(0, n), time), 0, n - 1);
  const before = Math.max(vertex - 1, 0);
  const [start, end] = [real(path.times, before), real(path.times, vertex)];
  const t = end > start ? clamp((time - start) / (end - start), 0, 1) : 1;
  const blend = (/** @type {Float32Array} */ points) =>
    mix(pointAt(points, before), pointAt(points, vertex), t);
  return { point: blend(path.positions), axis: path.axes ? blend(path.axes) : [0, 0, 1], vertex };
}

/** Whether the tool always stands along +z. @param {PathData} path */
export function isUpright(path) {
  const axes = path.axes ?? new Float32Array();
  for (let i = 0; i + 2 < axes.length; i += 3) {
    const [x, y, z] = [real(axes, i), real(axes, i + 1), real(axes, i + 2)];
    if (z < UPRIGHT * Math.hypot(x, y, z)) return false;
  }
  return true;
}

/** Tells `keep` the vertices from `first` to `last` that are needed to follow the path within twice the
 * tolerance, in order. Ends of strips and changes of kind are always needed.
 * @param {Float32Array} positions @param {Uint8Array} marks @param {number} first @param {number} last
 * @param {number} tolerance mm @param {(vertex: number) => boolean|void} keep true ends the work */
export function simplify(positions, marks, first, last, tolerance, keep) {
  let [anchor, dx, dy, dz, reach] = [first, 0, 0, 0, -1];
  let full = keep(first) === true;
  for (let i = first + 1; i <= last && !full; i++) {
    const joined = isJoined(marks, i);
    if (anchor !== i - 1 && (!joined || at(marks, MARK * i) !== at(marks, MARK * i - MARK))) {
      [anchor, reach] = [i - 1, -1];
      full = keep(anchor) === true;
    }
    if (!joined) {
      [anchor, reach] = [i, -1];
      full = full || keep(anchor) === true;
    }
    while (joined) {
      const x = real(positions, 3 * i) - real(positions, 3 * anchor);
      const y = real(positions, 3 * i + 1) - real(positions, 3 * anchor + 1);
      const z = real(positions, 3 * i + 2) - real(positions, 3 * anchor + 2);
      const square = x * x + y * y + z * z;
      if (reach < 0) {
        const away = Math.sqrt(square);
        if (away > tolerance) [dx, dy, dz, reach] = [x / away, y / away, z / away, away];
        break;
      }
      const along = x * dx + y * dy + z * dz;
      if (along >= reach && square - along * along <= tolerance * tolerance) {
        reach = along;
        break;
      }
      [anchor, reach] = [i - 1, -1];
      full = full || keep(anchor) === true;
    }
  }
  if (anchor !== last && !full) keep(last);
}

/** Vertices of a path with what drawing them needs. `sources` are the vertices of the whole path that they
 * are; null for the whole path.
 * @typedef {{positions: Float32Array, times: Float32Array, marks: Uint8Array,
 *   sources: Uint32Array|null}} Vertices */

/** Thins a path to at most `budget` vertices: first by following it less closely, then by leaving
 * stretches out.
 * @param {Vertices} path @param {number} size diagonal of the path's box in mm @param {number} budget
 * @returns {Vertices} */
export function thinned(path, size, budget) {
  const n = path.marks.length / MARK;
  const kept = new Uint32Array(budget);
  for (let tolerance = size / 4000; tolerance < size / 60; tolerance *= 2) {
    let count = 0;
    simplify(path.positions, path.marks, 0, n - 1, tolerance, (vertex) => {
      if (count < budget) kept[count] = vertex;
      return ++count > budget;
    });
    if (count <= budget) return picked(path, kept.slice(0, count), null);
  }
  return everyNth(path, kept, n);
}

/** Every so many a stretch, no two of them joined.
 * @param {Vertices} path @param {Uint32Array} kept room for the vertices @param {number} n */
function everyNth(path, kept, n) {
  let joined = 0;
  for (let i = 1; i < n; i++) if (isJoined(path.marks, i)) joined++;
  const share = Math.min(1, Math.floor(kept.length / 2) / Math.max(joined, 1));
  let [count, seen] = [0, 0];
  for (let i = 1; i < n; i++) {
    if (!isJoined(path.marks, i)) continue;
    if (Math.floor((seen + 1) * share) > Math.floor(seen * share)) {
      kept[count++] = i - 1;
      kept[count++] = i;
    }
    seen++;
  }
  return picked(path, kept.slice(0, count), (index) => 1 + ((index >> 1) & 1));
}

/** @param {Vertices} path @param {Uint32Array} kept
 * @param {((index: number) => number)|null} strip number of the strip in place of the path's
 * @returns {Vertices} */
function picked(path, kept, strip) {
  const positions = new Float32Array(3 * kept.length);
  const marks = new Uint8Array(MARK * kept.length);
  kept.forEach((vertex, j) => {
    for (let k = 0; k < 3; k++) positions[3 * j + k] = real(path.positions, 3 * vertex + k);
    for (let k = 0; k < MARK; k++) marks[MARK * j + k] = at(path.marks, MARK * vertex + k);
    if (strip) marks.set([strip(j), 0], MARK * j + 2);
  });
  const times = Float32Array.from(kept, (vertex) => real(path.times, vertex));
  const { sources } = path;
  return { positions, times, marks, sources: sources ? kept.map((vertex) => at(sources, vertex)) : kept };
}
