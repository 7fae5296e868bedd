// The course of a quantity over time: its value at a time, its range, and its line with as few points as are seen.

import { vertexAfter } from "../view/timeline.js";

/**
 * A quantity over time as the service tells it: times in s with values. Either course may be empty. `clock` has times
 * of the diagram with the times of the program at the same places, s; empty where they are not known.
 * @typedef {{ name: string, before: [number, number][], after: [number, number][], clock: [number, number][] }} Diagram
 */
/**
 * @typedef {object} Course
 * @property {Float32Array} times  s, rising
 * @property {(k: number) => number} value  at a time; NaN where there is none
 * @property {boolean} isStepped  whether a value holds since the time before, as a feed does
 */

/** @param {[number, number][]} told @returns {Course} */
export function courseOf(told) {
  const values = Float32Array.from(told, ([, value]) => value);
  return { times: Float32Array.from(told, ([time]) => time), value: (k) => values[k] ?? NaN, isStepped: false };
}

/** The value at a time; NaN where there is none. @param {Course} course @param {number} seconds */
export function valueAt({ times, value, isStepped }, seconds) {
  const k = vertexAfter(times, seconds);
  const [before = NaN, after = NaN] = [times[k - 1], times[k]];
  if (k === 0) return seconds === after ? value(0) : NaN;
  if (isStepped || k === times.length) return k === times.length ? NaN : value(k);
  return value(k - 1) + ((value(k) - value(k - 1)) * (seconds - before)) / (after - before);
}

/**
 * The time on one clock for a time on the other one. Before the first pair it is the first time, and after the last pair
 * the last one.
 * @param {[number, number][]} clock
 * @param {number} seconds
 * @param {0 | 1} from the place of the given time in a pair
 */
export function otherTime(clock, seconds, from) {
  const to = from === 0 ? 1 : 0;
  const k = clock.findIndex((pair) => pair[from] >= seconds);
  const after = clock[k] ?? clock.at(-1);
  const before = clock[k - 1];
  if (after === undefined) return seconds;
  if (before === undefined) return after[to];
  return before[to] + ((after[to] - before[to]) * (seconds - before[from])) / (after[from] - before[from]);
}

/** Least and largest value; infinite the wrong way round without any. @param {Course[]} courses @returns {[number, number]} */
export function rangeOf(courses) {
  let [low, high] = [Infinity, -Infinity];
  for (const { times, value } of courses) {
    for (let k = 0; k < times.length; k++) {
      const x = value(k);
      if (x < low && x > -Infinity) low = x;
      if (x > high && x < Infinity) high = x;
    }
  }
  return [low, high];
}

/**
 * The line of a course as data of an SVG path. Each column of a pixel has at most its first, least, largest and last
 * value, so that a million of values draw as fast as a thousand.
 * @param {Course} course
 * @param {(seconds: number) => number} x  pixels
 * @param {(value: number) => number} y  pixels
 */
export function lineOf({ times, value, isStepped }, x, y) {
  const columns = new Columns(y);
  for (let k = 0; k < times.length; k++) {
    const own = value(k);
    if (!Number.isFinite(own)) columns.lift();
    else {
      if (isStepped && k > 0) columns.put(x(times[k - 1] ?? 0), own);
      columns.put(x(times[k] ?? 0), own);
    }
  }
  columns.lift();
  return columns.parts.join("");
}

/** Gathers the points of a line by columns of a pixel. */
class Columns {
  /** @type {string[]} */ parts = [];
  #column = NaN;
  #isDown = false;
  #first = [0, 0];
  #last = [0, 0];
  #low = 0;
  #high = 0;
  #y;

  /** @param {(value: number) => number} y */
  constructor(y) { this.#y = y; }

  /** @param {number} x @param {number} value */
  put(x, value) {
    if (Math.floor(x) !== this.#column) {
      this.#flush();
      this.#column = Math.floor(x);
      this.#first = [x, value];
      this.#low = this.#high = value;
    }
    this.#last = [x, value];
    if (value < this.#low) this.#low = value;
    if (value > this.#high) this.#high = value;
  }

  /** Ends the line; it goes on elsewhere. */
  lift() {
    this.#flush();
    this.#column = NaN;
    this.#isDown = false;
  }

  #flush() {
    if (Number.isNaN(this.#column)) return;
    const [[x = 0, first = 0], [end = 0, last = 0]] = [this.#first, this.#last];
    this.#draw(x, first);
    if (this.#low < Math.min(first, last)) this.#draw((x + end) / 2, this.#low);
    if (this.#high > Math.max(first, last)) this.#draw((x + end) / 2, this.#high);
    if (end !== x || last !== first) this.#draw(end, last);
  }

  /** @param {number} x @param {number} value */
  #draw(x, value) {
    this.parts.push(`${this.#isDown ? "L" : "M"}${x.toFixed(1)} ${this.#y(value).toFixed(1)}`);
    this.#isDown = true;
  }
}

/**
 * Round numbers in a range, at most so many apart from both ends.
 * @param {number} low @param {number} high @param {number} most
 */
export function ticks(low, high, most) {
  const least = (high - low) / most;
  if (!(least > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= least * (1 - 1e-9)) ?? 10);
  const count = Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1;
  const first = Math.ceil(low / step - 1e-9);
  // Twelve digits take away what the multiplication leaves, such as 0.30000000000000004; -0 becomes 0.
  return Array.from({ length: count }, (_, k) => Number(((first + k) * step).toPrecision(12)) || 0);
}
