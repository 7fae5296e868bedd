// One diagram: a quantity over time, with a cursor at the present time that is moved by mouse, finger and keys.

/** @import { Course } from "./course.js" */

import { el } from "../dom.js";
import { digits, shortDigits } from "../figures.js";
import { TEXTS } from "../texts.js";
import { lineOf, rangeOf, ticks, valueAt } from "./course.js";

/** Pixels: height of the diagram, room for numbers at its left and below, and room at the other sides. */
const [HEIGHT, LEFT, BELOW, ROOM] = [84, 52, 16, 6];
/** Most numbers at the left, and pixels of a number below. */
const [MOST_VALUES, TIME_WIDTH] = [4, 70];
/** Room above and below the line, as a part of the range of values. */
const MARGIN = 0.04;
/** A value counts as 0 below this part of the largest one: it is the rest of a subtraction. */
const NOTHING = 1e-7;
/** Parts of the time that arrows and page keys go. */
const STEPS = /** @type {Record<string, number>} */ ({
  ArrowRight: 0.005, ArrowUp: 0.005, ArrowLeft: -0.005, ArrowDown: -0.005, PageUp: 0.05, PageDown: -0.05, Home: -1, End: 1,
});

/** @param {string} tag @param {Record<string, string | number>} attributes @param {string} [text] */
function svg(tag, attributes, text = "") {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  node.textContent = text;
  return node;
}

export class Chart {
  /**
   * @param {{ name: string, unit: string, before: Course | null, after: Course | null }} content
   * @param {number} end  of the time, s
   * @param {(seconds: number) => void} onseek
   */
  constructor({ name, unit, before, after }, end, onseek) {
    this.name = name;
    this.unit = unit;
    this.courses = { before, after };
    this.end = end;
    this.onseek = onseek;
    this.seconds = 0;
    const [low, high] = rangeOf([before, after].filter((course) => course !== null));
    this.range = { low, high };
    const margin = high > low ? MARGIN * (high - low) : Math.max(Math.abs(high) / 10, 1e-6);
    this.shown = { low: low - margin, high: high + margin };
    this.width = 0;
    this.cursor = svg("line", { class: "chart-cursor", y1: ROOM, y2: HEIGHT - BELOW });
    this.drawing = svg("svg", { height: HEIGHT, "aria-hidden": "true" });
    this.value = el("span", { class: "number" });
    this.area = el("div", {
      class: "chart-area", role: "slider", tabindex: 0, "aria-valuemin": 0, "aria-valuemax": end, "aria-valuenow": 0,
      "aria-label": TEXTS.charts.label(this.title, shortDigits(low), shortDigits(high)),
    }, this.drawing);
    this.element = el("div", { class: "chart" }, el("p", {}, el("span", {}, this.title), this.value), this.area);
    this.#listen();
  }

  get title() { return this.unit === "" ? this.name : `${this.name}, ${this.unit}`; }

  #listen() {
    const { area } = this;
    area.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      area.setPointerCapture(event.pointerId);
      this.#seek(event);
    });
    area.addEventListener("pointermove", (event) => {
      if (area.hasPointerCapture(event.pointerId)) this.#seek(event);
    });
    area.addEventListener("keydown", (event) => {
      const step = STEPS[event.key];
      if (step === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.onseek(Math.min(this.end, Math.max(0, this.seconds + step * this.end)));
    });
  }

  /** Goes to the time under the pointer. @param {PointerEvent} event */
  #seek(event) {
    const share = (event.clientX - this.area.getBoundingClientRect().left - LEFT) / (this.width - LEFT - ROOM);
    this.onseek(Math.min(1, Math.max(0, share)) * this.end);
  }

  /** @param {number} seconds */
  #x(seconds) { return LEFT + ((this.width - LEFT - ROOM) * seconds) / this.end; }

  /** @param {number} value */
  #y(value) {
    const { low, high } = this.shown;
    return ROOM + ((HEIGHT - BELOW - ROOM) * (high - value)) / (high - low);
  }

  /** Draws all anew. @param {number} width  pixels */
  draw(width) {
    this.width = width;
    this.drawing.setAttribute("width", String(width));
    const { before, after } = this.courses;
    this.drawing.replaceChildren(...this.#values(), ...this.#times(),
      ...this.#line(before, "chart-before"), ...this.#line(after, "chart-after"), this.cursor);
    this.mark(this.seconds);
  }

  /** @param {Course | null} course @param {string} name  of the class */
  #line(course, name) {
    if (course === null) return [];
    return [svg("path", { class: name, d: lineOf(course, (seconds) => this.#x(seconds), (value) => this.#y(value)) })];
  }

  /** Lines across with their values. */
  #values() {
    return ticks(this.shown.low, this.shown.high, MOST_VALUES).flatMap((value) => {
      const y = this.#y(value);
      return [
        svg("line", { class: "chart-grid", x1: LEFT, x2: this.width - ROOM, y1: y, y2: y }),
        svg("text", { x: LEFT - 4, y: y + 4, "text-anchor": "end" }, shortDigits(value)),
      ];
    });
  }

  /** Lines upright with their times. */
  #times() {
    const most = Math.max(1, Math.floor((this.width - LEFT) / TIME_WIDTH));
    return ticks(0, this.end, most).flatMap((seconds) => {
      const x = this.#x(seconds);
      const isLast = x > this.width - TIME_WIDTH / 2;
      return [
        svg("line", { class: "chart-grid", x1: x, x2: x, y1: ROOM, y2: HEIGHT - BELOW }),
        svg("text", { x: isLast ? this.width - ROOM : x, y: HEIGHT - 3, "text-anchor": isLast ? "end" : "middle" },
          `${digits(seconds)} s`),
      ];
    });
  }

  /** Puts the cursor at a time, and tells the value there. @param {number} seconds */
  mark(seconds) {
    this.seconds = Math.min(seconds, this.end);
    const x = this.#x(this.seconds).toFixed(1);
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
    const [before, after] = [this.#told(this.courses.before), this.#told(this.courses.after)];
    const told = this.courses.before === null ? after : TEXTS.charts.beforeAndAfter(before, after);
    this.value.textContent = told;
    this.area.setAttribute("aria-valuenow", String(this.seconds));
    this.area.setAttribute("aria-valuetext", `${digits(this.seconds)} s: ${told} ${this.unit}`);
  }

  /** The value of a course at the present time as a text. @param {Course | null} course */
  #told(course) {
    const value = course === null ? NaN : valueAt(course, this.seconds);
    if (Number.isNaN(value)) return "–";
    const most = Math.max(Math.abs(this.range.low), Math.abs(this.range.high));
    return shortDigits(Math.abs(value) < NOTHING * most ? 0 : value);
  }
}
