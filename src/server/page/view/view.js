// The 3D view of a toolpath: path, part, stock, cutter and material; drawn only when something changed.

import { Camera } from "./camera.js";
import { Controls } from "./input.js";
import { Labels } from "./labels.js";
import { clamp, mix, norm, sub } from "./math.js";
import { Scene } from "./scene.js";
import { Stage } from "./stage.js";
import { VIEW_TEXTS as TEXTS } from "../texts.js";
/** @import { Frame } from "./gl.js" */
/** @import { Box, ColorBy, Hit, LegendRow, MeshData, PathData, ToolData, Vec3 } from "./types.js" */

export { NoWebGL } from "./gl.js";
export { VIEWS } from "./camera.js";

/** The view counts as moving until so long after the last move, in ms. */
const REST_MS = 160;
/** Time for cutting material in a frame while somebody moves the view or the time goes on, in ms. */
const MOVING_CUT_MS = 8;
/** At rest cutting takes as many times as long as drawing the picture, within these bounds in ms. */
const [CUT_SHARE, ...CUT_MS] = /** @type {const} */ ([4, 60, 400]);
/** After so many ms of cutting it is seen how much is left. */
const CUT_STEP_MS = 50;
/** Cutting that takes longer, in ms, is told. */
const TOLD_MS = 400;
/** All is shown anew where the scene moves by more than this share of its size, or grows or shrinks by this factor. */
const [MOVED, GROWN] = [0.5, 1.5];
/** How far from a stretch the cursor finds it, in CSS pixels: to tell it, and to turn about it. */
const [NEAR, NEAR_PIVOT] = [7, 40];

/** Whether a scene lies elsewhere than the one before, or is much larger or smaller.
 * @param {Box} box @param {Box} before */
export function isElsewhere(box, before) {
  const size = (/** @type {Box} */ { min, max }) => norm(sub(max, min)) || 1;
  const factor = size(box) / size(before);
  const middle = (/** @type {Box} */ { min, max }) => mix(min, max, 0.5);
  return factor > GROWN || factor < 1 / GROWN || norm(sub(middle(box), middle(before))) > MOVED * size(before);
}

export class View {
  #camera = new Camera();
  #abort = new AbortController();
  /** @type {number} */ #request = 0;
  /** @type {ReturnType<typeof setTimeout>|undefined} */ #rest = undefined;
  #movingUntil = 0;
  /** @type {{frame: Frame, first: number}|null} the rest of a long path that is not drawn yet */
  #bit = null;
  /** Since when the material has been on its way without a pause, ms; 0 where it is not. */
  #cuttingSince = 0;
  /** What drawing the last frame took, in ms. */
  #drawingMs = 0;
  /** @type {Box|null} what was shown as a whole last */ #fitted = null;
  #isStale = true;
  #isLost = false;
  /** @type {Hit|null} */ #hovered = null;
  /** Told when somebody has moved the camera by hand. @type {() => void} */ onsteer = () => {};
  #canvas;
  #stage;
  #labels;
  #scene;
  #controls;
  #theme;
  #listener;

  /** @param {HTMLCanvasElement} canvas
   * @param {{onhover?: (hit: Hit|null) => void, onpick?: (hit: Hit) => void}} [listener]
   * @throws {NoWebGL} where the browser has no WebGL2 */
  constructor(canvas, listener = {}) {
    this.#canvas = canvas;
    this.#listener = listener;
    this.#stage = new Stage(canvas);
    this.#labels = new Labels(canvas);
    this.#scene = new Scene(this.#stage.gl);
    this.#theme = this.#labels.theme();
    this.#controls = new Controls(canvas, this.#camera, {
      moved: () => {
        this.#move();
        this.onsteer();
      },
      pivot: (x, y) => this.#pivot(x, y),
      hovered: (place) => this.#hover(place),
      picked: (x, y) => this.#pick(x, y),
    });
    canvas.setAttribute("role", "img");
    canvas.tabIndex = 0;
    canvas.setAttribute("aria-description", TEXTS.keys);
    this.#listen();
    this.#change();
  }

  #listen() {
    const { signal } = this.#abort;
    this.#canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.#isLost = true;
    }, { signal });
    this.#canvas.addEventListener("webglcontextrestored", () => this.#restore(), { signal });
    const calm = matchMedia("(prefers-reduced-motion: reduce)");
    const follow = () => { this.#camera.animated = !calm.matches; };
    follow();
    calm.addEventListener("change", follow, { signal });
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.refreshColors(), { signal });
    addEventListener("resize", () => this.#draw(), { signal });
    const sizes = new ResizeObserver(() => this.#draw());
    sizes.observe(this.#canvas);
    const themes = new MutationObserver(() => this.refreshColors());
    themes.observe(document.documentElement, { attributes: true });
    signal.addEventListener("abort", () => [sizes, themes].forEach((observer) => observer.disconnect()));
  }

  #restore() {
    this.#isLost = false;
    this.#stage.forget();
    this.#scene.restore();
    this.#change();
  }

  /** @param {PathData|null} path */
  setPath(path) {
    this.#scene.setPath(path);
    this.#tellHover(null);
    this.#change();
  }

  /** @param {MeshData|null} part */
  setPart(part) {
    this.#scene.setPart(part);
    this.#change();
  }

  /** @param {Box|null} stock in mm @param {MeshData|null} [body] the stock itself where it may not fill its box */
  setStock(stock, body = null) {
    this.#scene.setStock(stock, body);
    this.#change();
  }

  /** @param {ToolData|null} tool */
  setTool(tool) {
    this.#scene.setTool(tool);
    this.#change();
  }

  /** Puts the cutter where it is at a time and draws the path after it fainter. @param {number} seconds */
  setTime(seconds) {
    if (Number.isNaN(seconds) || seconds === this.#scene.time) return;
    this.#scene.time = seconds;
    this.#move();
  }

  /** @param {ColorBy} by */
  setColor(by) {
    this.#scene.setColor(by);
    this.#draw();
  }

  /** Shows or hides a kind of the path (its name in `KINDS`), "part", "stock", "tool" or "material".
   * While the material is shown, the part shows as the colours of the material.
   * @param {string} what @param {boolean} visible */
  setVisible(what, visible) {
    this.#scene.setVisible(what, visible);
    this.#change();
  }

  /** Shows the material as it is cut, or not. @param {boolean} shown
   * @returns {string|null} why it cannot be shown, for people; null where it can */
  setMaterial(shown) {
    this.setVisible("material", shown);
    return shown ? this.#scene.obstacle : null;
  }

  /** Why the material cannot be shown, for people; null where it can. */
  get obstacle() { return this.#scene.obstacle; }

  /** @param {string} name one of `VIEWS`; others change nothing */
  look(name) {
    this.#freshen();
    if (this.#camera.look(name)) this.#move();
  }

  /** @param {"perspective"|"orthographic"} projection */
  setProjection(projection) {
    this.#camera.orthographic = projection === "orthographic";
    this.#draw();
  }

  /** Shows all. */
  fit() {
    this.#freshen();
    this.#camera.fit();
    this.#move();
  }

  /** Lights the stretches of a block. @param {number|null} block line of the NC text */
  highlight(block) {
    this.#scene.highlight(block);
    this.#move();
  }

  /** The rows of the legend: what the colours of path and material mean. @returns {LegendRow[]} */
  legend() { return this.#scene.legend(); }

  /** Reads the colours of the page again; needed where they change without the document's attributes. */
  refreshColors() {
    this.#theme = this.#labels.theme();
    this.#change();
  }

  dispose() {
    this.#abort.abort();
    this.#controls.dispose();
    cancelAnimationFrame(this.#request);
    clearTimeout(this.#rest);
    this.#isLost = true;
    this.#scene.dispose();
    this.#labels.dispose();
    this.#stage.dispose();
  }

  /** What is drawn changed: furniture and texts are made anew with the next frame. */
  #change() {
    this.#isStale = true;
    this.#move();
  }

  /** Something moves: frames are coarse until it rests. */
  #move() {
    this.#movingUntil = performance.now() + REST_MS;
    this.#draw();
  }

  /** Asks for a frame. */
  #draw() {
    this.#bit = null;
    this.#ask();
  }

  #ask() {
    if (this.#request === 0 && !this.#isLost) this.#request = requestAnimationFrame((now) => this.#tick(now));
  }

  /** @param {number} now ms */
  #tick(now) {
    this.#request = 0;
    if (this.#isLost) return;
    if (this.#bit) return this.#goOn(this.#bit);
    this.#camera.step(now);
    // What is new is shown at once, even if it took long to take it over.
    const isEarly = this.#isStale || performance.now() < this.#movingUntil;
    const isMoving = isEarly || this.#camera.flying || this.#scene.isBusy;
    const coarse = isMoving && (this.#scene.isThinned || this.#stage.isSlow);
    this.#paint(coarse);
    clearTimeout(this.#rest);
    this.#rest = undefined;
    if (this.#camera.flying || this.#scene.isBusy || this.#bit) this.#ask();
    else if (isMoving) this.#rest = setTimeout(() => this.#settle(coarse), REST_MS);
    else this.#tell();
  }

  /** Nothing moves any more. @param {boolean} isCoarse whether the last frame was */
  #settle(isCoarse) {
    this.#rest = undefined;
    if (isCoarse) this.#draw();
    else this.#tell();
  }

  /** @param {boolean} coarse */
  #paint(coarse) {
    if (this.#isLost) return;
    this.#freshen();
    this.#cut();
    const drawing = performance.now();
    const isLong = !coarse && this.#scene.isLong;
    const frame = this.#stage.frame(this.#camera, this.#theme, coarse || isLong, coarse && this.#isSteered);
    this.#stage.draw(frame, () => this.#scene.draw(frame), isLong);
    this.#bit = isLong ? { frame, first: 0 } : null;
    this.#labels.place(this.#camera);
    this.#stage.wait();
    this.#drawingMs = performance.now() - drawing;
    this.#scene.learn(frame.coarse, this.#drawingMs);
    this.#stage.learn(frame.coarse, this.#drawingMs);
  }

  /** Draws the next bit of a long path at rest. @param {{frame: Frame, first: number}} bit */
  #goOn(bit) {
    const start = performance.now();
    const { frame, first } = bit;
    this.#stage.drawOn(frame, () => { bit.first = this.#scene.drawOn(frame, first); });
    this.#stage.wait();
    if (bit.first > first) {
      this.#scene.learnOn(bit.first - first, performance.now() - start);
      return this.#ask();
    }
    this.#bit = null;
    this.#tell();
  }

  /** Whether somebody moves the view, or the time goes on. */
  get #isSteered() { return performance.now() < this.#movingUntil || this.#camera.flying; }

  /** Cuts the material on. */
  #cut() {
    const begun = performance.now();
    const whole = this.#isSteered ? MOVING_CUT_MS : clamp(CUT_SHARE * this.#drawingMs, ...CUT_MS);
    for (let start = begun; start < begun + whole && this.#scene.cut(Math.min(whole, CUT_STEP_MS));) {
      this.#stage.wait();
      const now = performance.now();
      this.#scene.learnCut(now - start);
      start = now;
    }
    this.#cuttingSince = this.#scene.isBusy ? this.#cuttingSince || begun : 0;
    const isSlow = this.#cuttingSince > 0 && performance.now() > this.#cuttingSince + TOLD_MS;
    this.#labels.tellCutting(isSlow ? this.#scene.cutShare : null);
  }

  /** Takes over a new size of the canvas and a changed scene. */
  #freshen() {
    if (this.#canvas.clientWidth === 0) {
      // A hidden canvas has no size; all is fitted when it is shown.
      this.#fitted = null;
      this.#isStale = true;
      return;
    }
    const isResized = this.#stage.resize(this.#camera);
    if (this.#isStale && !this.#isLost) this.#renew();
    if (isResized && this.#camera.isFitted) this.#jump();
  }

  /** Shows all at once. */
  #jump() {
    const { animated } = this.#camera;
    this.#camera.animated = false;
    this.#camera.fit();
    this.#camera.animated = animated;
  }

  /** Makes what hangs on the whole scene anew. */
  #renew() {
    this.#isStale = false;
    const { box, sizedBox } = this.#scene;
    this.#labels.set(box, sizedBox);
    if (!box) {
      this.#fitted = null;
      return;
    }
    this.#camera.box = box;
    this.#scene.setFurniture(box, this.#theme);
    if (this.#fitted && !this.#camera.isFitted && !isElsewhere(box, this.#fitted)) return;
    this.#jump();
    this.#fitted = box;
  }

  /** Tells screen readers what is drawn. */
  #tell() {
    const words = this.#scene.describe();
    const seen = TEXTS.seen[this.#camera.orthographic ? "orthographic" : "perspective"];
    const text = words.length ? TEXTS.shown([...words, seen]) : TEXTS.nothing;
    this.#canvas.setAttribute("aria-label", text);
  }

  /** @param {number} x @param {number} y CSS pixels @returns {Vec3} */
  #pivot(x, y) {
    return this.#scene.hit(this.#camera.ray(x, y), NEAR_PIVOT)?.point ?? this.#camera.facing(x, y);
  }

  /** @param {{x: number, y: number}|null} place */
  #hover(place) {
    this.#tellHover(place && this.#scene.hit(this.#camera.ray(place.x, place.y), NEAR));
  }

  /** @param {Hit|null} hit */
  #tellHover(hit) {
    if (hit === null && this.#hovered === null) return;
    this.#hovered = hit;
    this.#canvas.classList.toggle("view-on-path", hit !== null);
    this.#listener.onhover?.(hit);
  }

  /** @param {number} x @param {number} y */
  #pick(x, y) {
    const hit = this.#scene.hit(this.#camera.ray(x, y), NEAR);
    if (hit) this.#listener.onpick?.(hit);
  }
}
