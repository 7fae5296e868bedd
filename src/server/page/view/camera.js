// The camera: orbit, pan, zoom, fit and standard views about a scene in mm, z up. It knows no document.

import { add, clamp, corners, dot, mix, scale, sub } from "./math.js";
/** @import { Box, Vec3 } from "./types.js" */

/** @typedef {{target: Vec3, distance: number, yaw: number, pitch: number}} Pose angles in rad */
/** A line of sight: at distance t from `origin`, a pixel is `base + slope * t` mm wide.
 * @typedef {{origin: Vec3, direction: Vec3, base: number, slope: number}} Ray */

const RIGHT_ANGLE = Math.PI / 2;
/** Half of the opening angle upwards: 20 degrees look natural on a screen. */
const TAN_HALF_VIEW = Math.tan(Math.PI / 9);
/** Share of the picture that a fitted box fills. */
const FITTED = 0.86;
const ANIMATION_MS = 280;
/** Room that the clipping planes leave around the box, in shares of its depth, for grid and cutter. */
const AROUND = 0.4;
/** Nearest and farthest distance of the camera, in mm. */
const DISTANCES = /** @type {const} */ ([0.01, 1e7]);

/** Yaw and pitch of the standard views, in rad; the keys 1 to 7 take them in this order. */
export const VIEWS = /** @type {Record<string, [number, number]>} */ (Object.freeze({
  top: [0, RIGHT_ANGLE], front: [0, 0], right: [RIGHT_ANGLE, 0], iso: [Math.PI / 4, 0.6155],
  bottom: [0, -RIGHT_ANGLE], back: [Math.PI, 0], left: [-RIGHT_ANGLE, 0],
}));

export class Camera {
  /** @type {Pose} */ #pose = { target: [0, 0, 0], distance: 100, yaw: Math.PI / 4, pitch: 0.6155 };
  /** @type {{from: Pose, to: Pose, start: number|null}|null} */ #flight = null;
  orthographic = false;
  /** Size of the picture in CSS pixels. */
  width = 1;
  height = 1;
  /** @type {Box} The box of all that is drawn; the clipping planes enclose it. */
  box = { min: [-50, -50, -50], max: [50, 50, 50] };
  /** Whether the whole box is shown, as nobody has moved the camera since. */
  isFitted = false;
  /** Whether the camera flies to a view or jumps. */
  animated = true;

  get pose() { return this.#pose; }

  /** The directions right, up and towards the viewer. @param {Pose} [pose] */
  axes({ yaw, pitch } = this.#pose) {
    const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
    return {
      right: /** @type {Vec3} */ ([cy, sy, 0]),
      up: /** @type {Vec3} */ ([-sy * sp, cy * sp, cp]),
      back: /** @type {Vec3} */ ([sy * cp, -cy * cp, sp]),
    };
  }

  /** @returns {Vec3} the place of the eye, in mm */
  eye() { return add(this.#pose.target, scale(this.axes().back, this.#pose.distance)); }

  /** Width of a CSS pixel at the target, in mm. */
  pixel() { return (2 * this.#pose.distance * TAN_HALF_VIEW) / this.height; }

  /** Matrices for the shaders, and the distance of the near plane in mm. */
  matrices() {
    const { right, up, back } = this.axes();
    const eye = this.eye();
    const { near, far } = this.#planes(eye, back);
    const view = new Float32Array([
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
    return { view, projection: this.#projection(near, far), near };
  }

  /** @param {Vec3} eye @param {Vec3} back */
  #planes(eye, back) {
    const depths = corners(this.box).map((corner) => dot(sub(eye, corner), back));
    const reach = Math.max(...depths) - Math.min(...depths) + this.#pose.distance * 0.1;
    const far = Math.max(Math.max(...depths) + AROUND * reach, this.#pose.distance * 0.02);
    const near = Math.min(...depths) - AROUND * reach;
    return { near: this.orthographic ? near : Math.max(near, this.#pose.distance / 200), far };
  }

  /** @param {number} near @param {number} far */
  #projection(near, far) {
    const [aspect, depth] = [this.width / this.height, far - near];
    if (this.orthographic) {
      const half = this.#pose.distance * TAN_HALF_VIEW;
      return new Float32Array([
        1 / (half * aspect), 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / depth, 0,
        0, 0, -(far + near) / depth, 1]);
    }
    const k = 1 / TAN_HALF_VIEW;
    return new Float32Array([
      k / aspect, 0, 0, 0, 0, k, 0, 0, 0, 0, -(far + near) / depth, -1,
      0, 0, (-2 * far * near) / depth, 0]);
  }

  /** The line of sight through a place of the picture in CSS pixels from its upper left corner.
   * @param {number} x @param {number} y @returns {Ray} */
  ray(x, y) {
    const { right, up, back } = this.axes();
    const [dx, dy] = [x - this.width / 2, this.height / 2 - y];
    const pixel = this.pixel();
    const shift = add(scale(right, dx * pixel), scale(up, dy * pixel));
    if (this.orthographic) {
      const reach = this.#pose.distance + 2 * Math.hypot(...sub(this.box.max, this.box.min));
      const origin = add(add(this.#pose.target, shift), scale(back, reach));
      return { origin, direction: scale(back, -1), base: pixel, slope: 0 };
    }
    const way = sub(shift, scale(back, this.#pose.distance));
    const length = Math.hypot(...way);
    return { origin: this.eye(), direction: scale(way, 1 / length), base: 0, slope: pixel / length };
  }

  /** The point under the cursor on the plane through the target that faces the viewer.
   * @param {number} x @param {number} y @returns {Vec3} */
  facing(x, y) {
    const { right, up } = this.axes();
    const pixel = this.pixel();
    const across = scale(right, (x - this.width / 2) * pixel);
    return add(this.#pose.target, add(across, scale(up, (this.height / 2 - y) * pixel)));
  }

  /** Turns about `pivot`, which stays where it is in the picture. @param {number} yaw rad
   * @param {number} pitch rad @param {Vec3} pivot */
  orbit(yaw, pitch, pivot = this.#pose.target) {
    const before = this.axes();
    const offset = sub(pivot, this.#pose.target);
    const next = {
      ...this.#pose, yaw: this.#pose.yaw + yaw,
      pitch: clamp(this.#pose.pitch + pitch, -RIGHT_ANGLE, RIGHT_ANGLE),
    };
    const after = this.axes(next);
    const turned = add(
      add(scale(after.right, dot(offset, before.right)), scale(after.up, dot(offset, before.up))),
      scale(after.back, dot(offset, before.back)));
    this.#set({ ...next, target: sub(pivot, turned) });
  }

  /** Moves the scene by CSS pixels to the right and down. @param {number} dx @param {number} dy */
  pan(dx, dy) {
    const { right, up } = this.axes();
    const pixel = this.pixel();
    const shift = add(scale(right, -dx * pixel), scale(up, dy * pixel));
    this.#set({ ...this.#pose, target: add(this.#pose.target, shift) });
  }

  /** Multiplies the distance; the point under the cursor stays. @param {number} factor below 1: nearer
   * @param {number} x @param {number} y CSS pixels */
  zoom(factor, x = this.width / 2, y = this.height / 2) {
    const distance = clamp(this.#pose.distance * factor, ...DISTANCES);
    const fixed = this.facing(x, y);
    const target = mix(fixed, this.#pose.target, distance / this.#pose.distance);
    this.#set({ ...this.#pose, target, distance });
  }

  /** Shows the whole box from where the camera looks. */
  fit() {
    const { yaw, pitch } = this.#flight?.to ?? this.#pose;
    this.#fly(this.#fitted(yaw, pitch));
  }

  /** Shows the whole box in a standard view; false for a name that is none. @param {string} name */
  look(name) {
    const view = Object.hasOwn(VIEWS, name) ? VIEWS[name] : undefined;
    if (!view) return false;
    this.#fly(this.#fitted(...view));
    return true;
  }

  /** @param {number} yaw @param {number} pitch @returns {Pose} */
  #fitted(yaw, pitch) {
    const target = mix(this.box.min, this.box.max, 0.5);
    const { right, up, back } = this.axes({ ...this.#pose, yaw, pitch });
    const tall = TAN_HALF_VIEW * FITTED;
    const wide = (tall * this.width) / this.height;
    const needed = corners(this.box).map((corner) => {
      const offset = sub(corner, target);
      const flat = Math.max(Math.abs(dot(offset, up)) / tall, Math.abs(dot(offset, right)) / wide);
      return flat + (this.orthographic ? 0 : dot(offset, back));
    });
    return { target, yaw, pitch, distance: clamp(Math.max(...needed), ...DISTANCES) };
  }

  /** @param {Pose} pose */
  #set(pose) {
    this.isFitted = false;
    this.#flight = null;
    this.#pose = pose;
  }

  /** @param {Pose} to */
  #fly(to) {
    this.isFitted = true;
    if (!this.animated) {
      this.#flight = null;
      this.#pose = to;
      return;
    }
    const full = 2 * Math.PI;
    const yaw = to.yaw + full * Math.round((this.#pose.yaw - to.yaw) / full);
    this.#flight = { from: this.#pose, to: { ...to, yaw }, start: null };
  }

  /** Whether the camera is on its way to a view. */
  get flying() { return this.#flight !== null; }

  /** Moves the camera on to its place at the time `now` in ms. @param {number} now */
  step(now) {
    const flight = this.#flight;
    if (!flight) return;
    flight.start ??= now;
    const t = clamp((now - flight.start) / ANIMATION_MS, 0, 1);
    const s = t * t * (3 - 2 * t);
    const { from, to } = flight;
    this.#pose = {
      target: mix(from.target, to.target, s), distance: from.distance * (to.distance / from.distance) ** s,
      yaw: from.yaw + (to.yaw - from.yaw) * s, pitch: from.pitch + (to.pitch - from.pitch) * s,
    };
    if (t === 1) this.#flight = null;
  }
}
