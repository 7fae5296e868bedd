// The diagrams of an answer: quantities over time, in groups that share a clock.

/** @import { PathData } from "../view/types.js" */
/** @import { Course, Diagram } from "./course.js" */
/** @typedef {{ name: string, unit: string, before: Course | null, after: Course | null }} Content  of a diagram */

import { el } from "../dom.js";
import { unitInWords } from "../names.js";
import { TEXTS } from "../texts.js";
import { Chart } from "./chart.js";
import { courseOf, otherTime, rangeOf } from "./course.js";

export class Charts {
  /** @param {(seconds: number) => void} onseek  when a diagram asks for another time of the program */
  constructor(onseek) {
    this.onseek = onseek;
    /** Times of the motion with those of the program. @type {[number, number][]} */
    this.clock = [];
    this.program = new Group(TEXTS.charts.title, "", onseek);
    this.motion = new Group(TEXTS.charts.motionTitle, TEXTS.charts.motion, (seconds) => this.#seek(seconds));
    this.element = el("div", {}, this.motion.element, this.program.element);
  }

  /** Shows the diagrams of an answer. @param {PathData | null} path @param {Diagram[]} diagrams */
  show(path, diagrams) {
    this.clock = diagrams[0]?.clock ?? [];
    this.program.show(path === null ? [] : ofPath(path));
    this.motion.show(diagrams.map(ofDiagram));
    this.motion.setTime(0);
  }

  /** Puts the cursors at a time of the program. @param {number} seconds */
  setTime(seconds) {
    this.program.setTime(seconds);
    if (this.clock.length > 0) this.motion.setTime(otherTime(this.clock, seconds, 1));
  }

  /** Goes to a time of the motion. Without a clock, the cursors of the motion go there alone. @param {number} seconds */
  #seek(seconds) {
    if (this.clock.length > 0) this.onseek(otherTime(this.clock, seconds, 0));
    else this.motion.setTime(seconds);
  }
}

/** Diagrams with the same time, and the same cursor. */
class Group {
  /**
   * @param {string} title @param {string} note  may be empty
   * @param {(seconds: number) => void} onseek  when a diagram asks for another time
   */
  constructor(title, note, onseek) {
    this.onseek = onseek;
    /** @type {Chart[]} */
    this.charts = [];
    this.width = 0;
    this.seconds = 0;
    this.host = el("div", {});
    this.element = el("details", { class: "charts", open: true, hidden: true }, el("summary", {}, title),
      ...(note === "" ? [] : [el("p", { class: "chart-legend" }, note)]), this.host);
    new ResizeObserver(() => this.#resize()).observe(this.host);
  }

  /** @param {Content[]} told */
  show(told) {
    const contents = told.filter(({ before, after }) => before !== null || after !== null);
    const courses = contents.flatMap(({ before, after }) => [before, after]).filter((course) => course !== null);
    const end = Math.max(0, ...courses.map(({ times }) => times.at(-1) ?? 0));
    this.charts = end > 0 ? contents.map((content) => new Chart(content, end, this.onseek)) : [];
    const isCompared = contents.some(({ before }) => before !== null);
    this.host.replaceChildren(...(isCompared ? [legend()] : []), ...this.charts.map(({ element }) => element));
    this.element.hidden = this.charts.length === 0;
    this.#draw();
  }

  /** Puts the cursors at a time. @param {number} seconds */
  setTime(seconds) {
    this.seconds = seconds;
    // What is not seen is marked when it is drawn again.
    if (this.width > 0) for (const chart of this.charts) chart.mark(seconds);
  }

  #resize() {
    if (this.host.clientWidth === this.width) return;
    this.width = this.host.clientWidth;
    this.#draw();
  }

  #draw() {
    if (this.width === 0) return;
    for (const chart of this.charts) {
      chart.draw(this.width);
      chart.mark(this.seconds);
    }
  }
}

function legend() {
  const row = (/** @type {string} */ kind, /** @type {string} */ text) => [el("span", { class: `swatch ${kind}` }), text];
  const { before, after } = TEXTS.charts;
  return el("p", { class: "chart-legend" }, ...row("chart-before", before), " ", ...row("chart-after", after));
}

/** What the path itself tells over time. @param {PathData} path */
function ofPath(path) {
  const { times, feeds, positions } = path;
  const { feed, height } = TEXTS.charts;
  const course = (/** @type {(k: number) => number} */ value, isStepped = false) => known({ times, value, isStepped });
  return [
    // Rapids and rests have no feed: the line has gaps.
    { ...feed, before: null, after: course((k) => feeds[k] || NaN, true) },
    { ...height, before: null, after: course((k) => positions[3 * k + 2] ?? NaN) },
  ];
}

/** A diagram whose name ends with its unit. @param {Diagram} diagram */
function ofDiagram({ name, before, after }) {
  const [, words = name, unit = ""] = /^(.*), ([^,]*)$/.exec(name) ?? [];
  return {
    name: words.charAt(0).toUpperCase() + words.slice(1),
    unit: unitInWords(unit) || unit,
    before: known(courseOf(before)), after: known(courseOf(after)),
  };
}

/** A course that has a value; else null. @param {Course} course */
function known(course) {
  const [low, high] = rangeOf([course]);
  return low <= high ? course : null;
}
