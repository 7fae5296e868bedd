// The stretch of a path that is nearest to the cursor, found through boxes about runs of vertices.

import { add, at, clamp, pointAt, real, scale, sub } from "./math.js";
import { isJoined, MARK } from "./timeline.js";
/** @import { Ray } from "./camera.js" */
/** @import { Vec3 } from "./types.js" */

/** Stretches in a box of the lowest row, and boxes in a box of the row above. */
const LEAF = 8;
const FAN = 4;
/** Within this many pixels the stretch nearest to the viewer is taken; else the one nearest to the cursor. */
const ON_LINE = 2;

export class PathBoxes {
  /** Rows of boxes, six numbers a box, from small ones to a single one. @type {Float32Array[]} */ #rows = [];
  #positions;
  #marks;

  /** @param {Float32Array} positions @param {Uint8Array} marks */
  constructor(positions, marks) {
    this.#positions = positions;
    this.#marks = marks;
    const n = marks.length / MARK;
    if (n < 2) return;
    let row = this.#leaves(n);
    this.#rows.push(row);
    while (row.length > 6) {
      row = merged(row);
      this.#rows.push(row);
    }
  }

  /** @param {number} n */
  #leaves(n) {
    const row = new Float32Array(6 * Math.ceil((n - 1) / LEAF));
    for (let b = 0; 6 * b < row.length; b++) {
      const end = Math.min(b * LEAF + LEAF, n - 1);
      for (let k = 0; k < 3; k++) {
        let [low, high] = [Infinity, -Infinity];
        for (let i = b * LEAF; i <= end; i++) {
          const x = real(this.#positions, 3 * i + k);
          if (x < low) low = x;
          if (x > high) high = x;
        }
        row[6 * b + k] = low;
        row[6 * b + 3 + k] = high;
      }
    }
    return row;
  }

  /** The best stretch within `pixels` of a line of sight; null without one.
   * @param {Ray} ray @param {number} pixels @param {number} shown bit k: stretches of kind k are seen
   * @returns {{index: number, t: number, point: Vec3}|null} `t`: share of the stretch before the point */
  nearest(ray, pixels, shown) {
    /** @type {Found} */ const found = { index: 0, t: 0, away: pixels, depth: Infinity };
    const top = this.#rows.length - 1;
    if (top >= 0) this.#visit(top, 0, 1, new Probe(ray), shown, found);
    if (found.index === 0) return null;
    const [a, b] = [pointAt(this.#positions, found.index - 1), pointAt(this.#positions, found.index)];
    return { index: found.index, t: found.t, point: add(a, scale(sub(b, a), found.t)) };
  }

  /** Looks through boxes of a row and what they hold.
   * @param {number} level @param {number} first @param {number} end boxes @param {Probe} probe
   * @param {number} shown @param {Found} found */
  #visit(level, first, end, probe, shown, found) {
    const row = this.#rows[level] ?? new Float32Array();
    const last = Math.min(end, row.length / 6);
    for (let box = first; box < last; box++) {
      if (!probe.isNear(row, 6 * box, found)) continue;
      if (level === 0) this.#search(box, probe, shown, found);
      else this.#visit(level - 1, box * FAN, box * FAN + FAN, probe, shown, found);
    }
  }

  /** @param {number} leaf @param {Probe} probe @param {number} shown @param {Found} found */
  #search(leaf, probe, shown, found) {
    const marks = this.#marks;
    const end = Math.min(leaf * LEAF + LEAF, marks.length / MARK - 1);
    for (let i = leaf * LEAF + 1; i <= end; i++) {
      if ((shown >> at(marks, MARK * i)) & 1 && isJoined(marks, i)) probe.measure(this.#positions, i, found);
    }
  }
}

/** @typedef {{index: number, t: number, away: number, depth: number}} Found `away` in pixels */

/** A line of sight as plain numbers, since it meets a hundred thousand boxes. */
class Probe {
  /** @param {Ray} ray */
  constructor({ origin, direction, base, slope }) {
    this.ox = origin[0];
    this.oy = origin[1];
    this.oz = origin[2];
    this.dx = direction[0];
    this.dy = direction[1];
    this.dz = direction[2];
    const inverse = (/** @type {number} */ x) => 1 / (Math.abs(x) < 1e-9 ? 1e-9 : x);
    this.ix = inverse(this.dx);
    this.iy = inverse(this.dy);
    this.iz = inverse(this.dz);
    this.base = base;
    this.slope = slope;
  }

  /** Whether the line passes a box within the distance that still counts.
   * @param {Float32Array} row @param {number} b place of the box @param {Found} found */
  isNear(row, b, found) {
    const x0 = real(row, b) - this.ox;
    const y0 = real(row, b + 1) - this.oy;
    const z0 = real(row, b + 2) - this.oz;
    const x1 = real(row, b + 3) - this.ox;
    const y1 = real(row, b + 4) - this.oy;
    const z1 = real(row, b + 5) - this.oz;
    const far = this.dx * (this.dx > 0 ? x1 : x0) + this.dy * (this.dy > 0 ? y1 : y0)
      + this.dz * (this.dz > 0 ? z1 : z0);
    if (far <= 0) return false;
    const margin = Math.max(found.away, ON_LINE) * (this.base + this.slope * far);
    const xa = (x0 - margin) * this.ix;
    const xb = (x1 + margin) * this.ix;
    const ya = (y0 - margin) * this.iy;
    const yb = (y1 + margin) * this.iy;
    const za = (z0 - margin) * this.iz;
    const zb = (z1 + margin) * this.iz;
    const enter = Math.max(0, xa < xb ? xa : xb, ya < yb ? ya : yb, za < zb ? za : zb);
    const leave = Math.min(xa < xb ? xb : xa, ya < yb ? yb : ya, za < zb ? zb : za);
    // Of what lies under the cursor only what is nearer than the present find can win.
    return enter <= leave && !(found.index > 0 && found.away <= ON_LINE && enter > found.depth + margin);
  }

  /** Compares the stretch that ends at a vertex with the best so far.
   * @param {Float32Array} p positions @param {number} i @param {Found} found */
  measure(p, i, found) {
    const x = real(p, 3 * i - 3);
    const y = real(p, 3 * i - 2);
    const z = real(p, 3 * i - 1);
    const ax = x - this.ox;
    const ay = y - this.oy;
    const az = z - this.oz;
    const ex = real(p, 3 * i) - x;
    const ey = real(p, 3 * i + 1) - y;
    const ez = real(p, 3 * i + 2) - z;
    const depth = ax * this.dx + ay * this.dy + az * this.dz;
    const run = ex * this.dx + ey * this.dy + ez * this.dz;
    const fx = ax - depth * this.dx;
    const fy = ay - depth * this.dy;
    const fz = az - depth * this.dz;
    const gx = ex - run * this.dx;
    const gy = ey - run * this.dy;
    const gz = ez - run * this.dz;
    const square = gx * gx + gy * gy + gz * gz;
    const t = square > 1e-18 ? clamp(-(fx * gx + fy * gy + fz * gz) / square, 0, 1) : 0.5;
    const hx = fx + t * gx;
    const hy = fy + t * gy;
    const hz = fz + t * gz;
    const deep = depth + t * run;
    consider(found, i, t, Math.sqrt(hx * hx + hy * hy + hz * hz) / (this.base + this.slope * deep), deep);
  }
}

/** Takes a stretch where it is better than the best so far.
 * @param {Found} found @param {number} index @param {number} t @param {number} away @param {number} depth */
function consider(found, index, t, away, depth) {
  if (!(depth > 0)) return;
  const isTie = away <= ON_LINE && found.away <= ON_LINE && found.index > 0;
  if (isTie ? depth >= found.depth : !(away <= found.away)) return;
  found.index = index;
  found.t = t;
  found.away = away;
  found.depth = depth;
}

/** @param {Float32Array} row */
function merged(row) {
  const count = row.length / 6;
  const next = new Float32Array(6 * Math.ceil(count / FAN));
  for (let b = 0; b < count; b++) {
    const to = 6 * Math.floor(b / FAN);
    for (let k = 0; k < 6; k++) {
      const x = real(row, 6 * b + k);
      const y = real(next, to + k);
      next[to + k] = b % FAN === 0 ? x : k < 3 ? Math.min(y, x) : Math.max(y, x);
    }
  }
  return next;
}
