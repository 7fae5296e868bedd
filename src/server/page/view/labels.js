// The text over the canvas (letters of the axes, grid spacing and size), and the colours of the page.

import { digits } from "../figures.js";
import { crossEnds, gridOf } from "./grid.js";
import { VIEW_TEXTS as TEXTS } from "../texts.js";
/** @import { Camera } from "./camera.js" */
/** @import { Color, Theme } from "./gl.js" */
/** @import { Box } from "./types.js" */

/** The CSS variables that colour the view, each called `--view-` and the name. */
const THEME = /** @type {const} */ (["background", "grid", "part", "stock", "tool", "holder", "highlight"]);

/** Numbers of a computed colour, 0 to 1: "rgb(1, 2, 3)" or "color(srgb 0.1 0.2 0.3)".
 * @param {string} text @returns {Color} */
export function parseColor(text) {
  const numbers = text.replace(/^color\(\S+/, "").match(/-?[\d.]+(e-?\d+)?/g) ?? [];
  const [r = 0, g = 0, b = 0] = numbers.map(Number);
  return text.startsWith("color(") ? [r, g, b] : [r / 255, g / 255, b / 255];
}

/** Lengths of a box's edges in mm, for people. @param {Box} box */
export const sizeOf = ({ min, max }) => max.map((x, k) => digits(x - (min[k] ?? x)));

export class Labels {
  #host = document.createElement("div");
  #scale = document.createElement("p");
  #cutting = document.createElement("p");
  #probe = document.createElement("span");
  #axes = TEXTS.axes.map((text) => this.#letter(text));
  #canvas;

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.#canvas = canvas;
    this.#host.className = "view-labels";
    this.#host.setAttribute("aria-hidden", "true");
    this.#scale.className = "view-scale";
    this.#cutting.className = "view-cutting";
    this.#cutting.hidden = true;
    this.#probe.hidden = true;
    this.#host.append(this.#scale, this.#cutting, ...this.#axes, this.#probe);
    canvas.classList.add("view-canvas");
    canvas.parentElement?.classList.add("view-host");
    canvas.after(this.#host);
  }

  /** @param {string} text */
  #letter(text) {
    const letter = document.createElement("span");
    letter.className = "view-axis";
    letter.textContent = text;
    return letter;
  }

  /** The colours that the page gives the view now. @returns {Theme} */
  theme() {
    const colors = THEME.map((name) => {
      this.#probe.style.color = `var(--view-${name})`;
      return [name, parseColor(getComputedStyle(this.#probe).color)];
    });
    return Object.fromEntries(colors);
  }

  /** @param {Box|null} box of the scene; null hides all @param {Box|null} sized box whose size is told */
  set(box, sized) {
    this.#host.hidden = !box;
    if (box) this.#scale.textContent = TEXTS.scale(digits(gridOf(box).spacing), sizeOf(sized ?? box));
  }

  /** Tells how much of the way to the present time the material is cut. @param {number|null} share null: all */
  tellCutting(share) {
    this.#cutting.hidden = share === null;
    if (share !== null) this.#cutting.textContent = TEXTS.cutting(Math.floor(100 * share));
  }

  /** Puts the letters to the ends of the axes. @param {Camera} camera */
  place(camera) {
    const { offsetLeft, offsetTop } = this.#canvas;
    crossEnds(camera).forEach(({ x, y }, k) => {
      const letter = this.#axes[k];
      if (letter) letter.style.transform = `translate(${offsetLeft + x}px, ${offsetTop + y}px)`;
    });
  }

  dispose() { this.#host.remove(); }
}
