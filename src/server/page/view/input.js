// Mouse, touch, pen, keyboard and 3D mouse: turns what the hand does into moves of the camera.

import { VIEWS } from "./camera.js";
/** @import { Camera } from "./camera.js" */
/** @import { Vec3 } from "./types.js" */

/** What the controls tell the view. Places are in CSS pixels of the canvas.
 * @typedef {object} Listener
 * @property {() => void} moved             the camera moved
 * @property {(x: number, y: number) => Vec3} pivot   the point to turn about
 * @property {(place: {x: number, y: number}|null) => void} hovered
 * @property {(x: number, y: number) => void} picked */

/** Radians a pixel when turning; 400 pixels turn by half a circle. */
const TURN = Math.PI / 400;
/** Turn and shift of a press of an arrow key. */
const [KEY_TURN, KEY_PAN, KEY_ZOOM] = [Math.PI / 24, 40, 1.2];
/** A press that moves by fewer pixels is a pick. */
const STILL = 4;
/** Speed of a 3D mouse at full deflection, a frame. */
const [PAD_TURN, PAD_PAN, PAD_ZOOM, PAD_REST] = [0.03, 12, 0.03, 0.08];
/** Pixels of a wheel's step by its mode: pixels, lines, pages. */
const WHEEL_PIXELS = [1, 16, 400];
const ARROWS = /** @type {Record<string, [number, number]>} */ ({
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
});

/** @typedef {{x: number, y: number}} Place */

export class Controls {
  /** @type {Map<number, Place>} pointers that are down */ #down = new Map();
  /** @type {{pan: boolean, pivot: Vec3, far: number}|null} */ #drag = null;
  #abort = new AbortController();
  #canvas;
  #camera;
  #listener;
  #polling = 0;

  /** @param {HTMLCanvasElement} canvas @param {Camera} camera @param {Listener} listener */
  constructor(canvas, camera, listener) {
    this.#canvas = canvas;
    this.#camera = camera;
    this.#listener = listener;
    const { signal } = this.#abort;
    canvas.addEventListener("pointerdown", (event) => this.#press(event), { signal });
    canvas.addEventListener("pointermove", (event) => this.#move(event), { signal });
    for (const end of /** @type {const} */ (["pointerup", "pointercancel"])) {
      canvas.addEventListener(end, (event) => this.#release(event), { signal });
    }
    canvas.addEventListener("pointerleave", () => listener.hovered(null), { signal });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault(), { signal });
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { signal, passive: false });
    canvas.addEventListener("keydown", (event) => this.#key(event), { signal });
    addEventListener("gamepadconnected", () => this.#poll(), { signal });
  }

  /** @param {MouseEvent} event @returns {Place} */
  #place(event) {
    const box = this.#canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** @param {PointerEvent} event */
  #press(event) {
    const place = this.#place(event);
    this.#canvas.setPointerCapture(event.pointerId);
    this.#down.set(event.pointerId, place);
    const pan = event.button !== 0 || event.shiftKey;
    if (event.button === 1) event.preventDefault();
    const far = this.#down.size > 1 ? STILL : 0;
    this.#drag = { pan, pivot: this.#listener.pivot(place.x, place.y), far };
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const place = this.#place(event);
    const before = this.#down.get(event.pointerId);
    if (!before || !this.#drag) return this.#listener.hovered(place);
    if (this.#down.size > 1) this.#pinch(event.pointerId, before, place);
    else this.#pull(this.#drag, place.x - before.x, place.y - before.y);
    this.#down.set(event.pointerId, place);
  }

  /** @param {{pan: boolean, pivot: Vec3, far: number}} drag @param {number} dx @param {number} dy */
  #pull(drag, dx, dy) {
    drag.far += Math.hypot(dx, dy);
    if (drag.far < STILL) return;
    if (drag.pan) this.#camera.pan(dx, dy);
    else this.#camera.orbit(-dx * TURN, dy * TURN, drag.pivot);
    this.#listener.moved();
  }

  /** Two fingers: their middle moves the scene, their distance zooms.
   * @param {number} id @param {Place} before @param {Place} after */
  #pinch(id, before, after) {
    const other = [...this.#down].find(([key]) => key !== id)?.[1];
    if (!other) return;
    this.#camera.pan((after.x - before.x) / 2, (after.y - before.y) / 2);
    const apart = (/** @type {Place} */ place) => Math.hypot(place.x - other.x, place.y - other.y);
    const factor = apart(before) / apart(after);
    if (factor > 0 && factor < Infinity) {
      this.#camera.zoom(factor, (after.x + other.x) / 2, (after.y + other.y) / 2);
    }
    this.#listener.moved();
  }

  /** @param {PointerEvent} event */
  #release(event) {
    const place = this.#place(event);
    const isPick = this.#drag && this.#drag.far < STILL && this.#down.size === 1 && event.button === 0;
    this.#down.delete(event.pointerId);
    if (isPick && event.type === "pointerup") this.#listener.picked(place.x, place.y);
    const [rest] = this.#down.values();
    this.#drag = rest ? { pan: false, pivot: this.#listener.pivot(rest.x, rest.y), far: STILL } : null;
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    event.preventDefault();
    const pixels = WHEEL_PIXELS[event.deltaMode] ?? 1;
    // A pinch on a touch pad comes as a wheel with ctrl and small steps.
    const speed = event.ctrlKey ? 0.01 : 0.0015;
    const step = Math.max(-300, Math.min(300, event.deltaY * pixels));
    const { x, y } = this.#place(event);
    this.#camera.zoom(Math.exp(step * speed), x, y);
    this.#listener.moved();
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !this.#steerBy(event)) return;
    event.preventDefault();
    this.#listener.moved();
  }

  /** Whether the key is one of the view's. @param {KeyboardEvent} event */
  #steerBy({ key, shiftKey }) {
    const arrow = ARROWS[key];
    const camera = this.#camera;
    if (arrow && shiftKey) camera.pan(arrow[0] * KEY_PAN, arrow[1] * KEY_PAN);
    else if (arrow) camera.orbit(-arrow[0] * KEY_TURN, arrow[1] * KEY_TURN);
    else if (key === "+" || key === "=") camera.zoom(1 / KEY_ZOOM);
    else if (key === "-" || key === "_") camera.zoom(KEY_ZOOM);
    else if (key === "f" || key === "F") camera.fit();
    else return camera.look(Object.keys(VIEWS)[Number(key) - 1] ?? "");
    return true;
  }

  /** Asks gamepads and 3D mice where they stand, as long as there are any. */
  #poll() {
    if (this.#polling) return;
    const ask = () => {
      const pads = navigator.getGamepads().filter((pad) => pad !== null);
      for (const pad of pads) this.#steer(pad.axes);
      this.#polling = pads.length ? requestAnimationFrame(ask) : 0;
    };
    ask();
  }

  /** A 3D mouse has six axes (shift, then turn); a gamepad has two sticks (turn; shift and zoom).
   * @param {readonly number[]} axes */
  #steer(axes) {
    const [a = 0, b = 0, c = 0, d = 0, , f = 0] = axes.map((x) => (Math.abs(x) < PAD_REST ? 0 : x));
    if (!a && !b && !c && !d && !f) return;
    const isMouse = axes.length >= 6;
    const [turn, tilt, zoom] = isMouse ? [f, d, b] : [a, b, d];
    this.#camera.orbit(-turn * PAD_TURN, tilt * PAD_TURN);
    this.#camera.zoom(1 + zoom * PAD_ZOOM);
    this.#camera.pan(isMouse ? a * PAD_PAN : c * PAD_PAN, isMouse ? c * PAD_PAN : 0);
    this.#listener.moved();
  }

  dispose() {
    this.#abort.abort();
    cancelAnimationFrame(this.#polling);
  }
}
