// Plays the program in time: a scrubber, a button, and a speed. Also finds lines of the program by time and times by line.

/** @import { PathData } from "./view/types.js" */

import { clock } from "./figures.js";
import { TEXTS } from "./texts.js";
import { vertexAfter } from "./view/timeline.js";

/** The line of the program whose move is made at a time, counted from 1; 0 where there is none.
 * @param {PathData} path @param {number} seconds */
export const lineAt = ({ times, blocks }, seconds) => blocks[vertexAfter(times, seconds)] ?? 0;

/** When the first move of a line ends, s; null for a line without moves. @param {PathData} path @param {number} line */
export function timeOf({ times, blocks }, line) {
  const vertex = line > 0 ? blocks.indexOf(line) : -1;
  return times[vertex] ?? null;
}

export class Player {
  /**
   * @param {{ slider: HTMLInputElement, button: HTMLButtonElement, clock: HTMLElement, speed: HTMLSelectElement }} parts
   * @param {(seconds: number) => void} ontime
   */
  constructor(parts, ontime) {
    this.parts = parts;
    this.ontime = ontime;
    this.end = 0;
    this.seconds = 0;
    this.isPlaying = false;
    /** @type {number | null} */
    this.before = null;
    for (const [name, factor] of TEXTS.speeds) parts.speed.add(new Option(name, String(factor), factor === 10, factor === 10));
    parts.slider.addEventListener("input", () => this.set(Number(parts.slider.value)));
    parts.button.addEventListener("click", () => this.toggle());
    this.load(0);
  }

  /** A program of this length, s; 0 for none. @param {number} end */
  load(end) {
    this.end = end;
    this.stop();
    this.parts.slider.max = String(end || 1);
    this.parts.slider.disabled = this.parts.button.disabled = end === 0;
    this.set(end);
  }

  /** @param {number} seconds */
  set(seconds) {
    this.seconds = Math.min(this.end, Math.max(0, seconds));
    this.parts.slider.value = String(this.seconds);
    const told = this.end > 0 ? `${clock(this.seconds)} / ${clock(this.end)}` : "";
    this.parts.clock.textContent = told;
    this.parts.slider.setAttribute("aria-valuetext", told);
    this.ontime(this.seconds);
  }

  toggle() {
    if (this.isPlaying) return this.stop();
    if (this.seconds >= this.end) this.set(0);
    this.isPlaying = true;
    this.before = null;
    this.parts.button.textContent = TEXTS.pause;
    requestAnimationFrame((now) => this.step(now));
  }

  stop() {
    this.isPlaying = false;
    this.parts.button.textContent = TEXTS.play;
  }

  /** @param {number} now ms */
  step(now) {
    if (!this.isPlaying) return;
    const passed = this.before === null ? 0 : (now - this.before) / 1000;
    this.before = now;
    this.set(this.seconds + passed * Number(this.parts.speed.value));
    if (this.seconds >= this.end) this.stop();
    else requestAnimationFrame((next) => this.step(next));
  }
}
