// The diagrams of an answer: quantities over the time of the program, all with the same cursor.

/** @import { PathData } from "../view/types.js" */
/** @import { Course, Diagram } from "./course.js" */

import { el } from "../dom.js";
import { unitInWords } from "../names.js";
import { TEXTS } from "../texts.js";
import { Chart } from "./chart.js";
import { courseOf, rangeOf } from "./course.js";

export class Charts {
  /** @param {(seconds: number) => void} onseek  when a diagram asks for another time */
  constructor(onseek) {
    this.onseek = onseek;
    /** @type {Chart[]} */
    this.charts = [];
    this.width = 0;
    this.seconds = 0;
    this.host = el("div", {});
    this.element = el("details", { class: "charts", open: true, hidden: true }, el("summary", {}, TEXTS.charts.title), this.host);
    new ResizeObserver(() => this.#resize()).observe(this.host);
  }

  /** Shows the diagrams of an answer. @param {PathData | null} path @param {Diagram[]} diagrams */
  show(path, diagrams) {
    const told = diagrams.map(ofDiagram);
    // What the service tells counts more than what the moves tell of the same.
    const own = (path === null ? [] : ofPath(path)).filter(({ name }) => !told.some((one) => one.name === name));
    const contents = [...told, ...own].filter(({ before, after }) => before !== null || after !== null);
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
  const { times, feeds, positions, deviations } = path;
  const { feed, height, deviation } = TEXTS.charts;
  const course = (/** @type {(k: number) => number} */ value, isStepped = false) => known({ times, value, isStepped });
  return [
    // Rapids and rests have no feed: the line has gaps.
    { ...feed, before: null, after: course((k) => feeds[k] || NaN, true) },
    { ...height, before: null, after: course((k) => positions[3 * k + 2] ?? NaN) },
    { ...deviation, before: null, after: deviations && course((k) => deviations[k] ?? NaN) },
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
