// Paths, cameras, tools and a stand-in of WebGL2 for the checks of the 3D view.

import assert from "node:assert/strict";
import { Camera } from "../view/camera.js";
import { add, dot, norm, scale, sub } from "../view/math.js";
import { NUMBERS } from "../view/stretches.js";

export const TOOLS = [
  { shape: "flat", diameter_mm: 10 },
  { shape: "ball", diameter_mm: 10 },
  { shape: "bull_nose", diameter_mm: 10, corner_radius_mm: 2 },
  { shape: "v", diameter_mm: 10, tip_angle_deg: 90 },
  { shape: "v", diameter_mm: 10, tip_angle_deg: 60, tip_diameter_mm: 1 },
  { shape: "cone", diameter_mm: 10, taper_angle_deg: 20, tip_diameter_mm: 4 },
  { shape: "drill", diameter_mm: 10 },
];

/** Numbers that look random and are the same in every run. */
export function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** A path through points; one kind, one mm a second. */
export function pathThrough(points, { kinds, strips } = {}) {
  const positions = Float32Array.from(points.flat());
  const times = new Float32Array(points.length);
  for (let i = 1; i < points.length; i++) times[i] = times[i - 1] + norm(sub(points[i], points[i - 1]));
  return {
    positions, times, kinds: Uint8Array.from(kinds ?? points.map(() => 1)),
    feeds: new Float32Array(points.length).fill(60), blocks: Uint32Array.from(points, (_, i) => i + 1),
    axes: null,
    strips: strips ?? [{ first: 0, count: points.length, pass: 0, level: null }],
  };
}

/** A spiral of n vertices with turns of 100 vertices, 100 mm wide. */
export function spiral(n) {
  const points = [];
  for (let i = 0; i < n; i++) {
    const [angle, r] = [(2 * Math.PI * i) / 100, (50 * i) / n];
    points.push([r * Math.cos(angle), r * Math.sin(angle), -i / n]);
  }
  return pathThrough(points);
}

export function cameraAt(yaw, pitch, orthographic) {
  const camera = new Camera();
  Object.assign(camera, { width: 800, height: 600, orthographic, animated: false });
  camera.box = { min: [-30, -10, -5], max: [70, 40, 15] };
  camera.fit();
  camera.orbit(yaw, pitch);
  return camera;
}

/** Where a point is seen, in CSS pixels from the upper left corner, and how far before the eye. */
export function project(camera, point) {
  const { right, up, back } = camera.axes();
  const offset = sub(point, camera.pose.target);
  const depth = camera.pose.distance - dot(offset, back);
  const pixel = camera.orthographic ? camera.pixel() : (camera.pixel() * depth) / camera.pose.distance;
  return { x: camera.width / 2 + dot(offset, right) / pixel, y: camera.height / 2 - dot(offset, up) / pixel, depth };
}

export function transformed(matrix, [x, y, z], w = 1) {
  return [0, 1, 2, 3].map((k) => matrix[k] * x + matrix[4 + k] * y + matrix[8 + k] * z + matrix[12 + k] * w);
}

export const near = (a, b, tolerance, text = "") =>
  assert.ok(Math.abs(a - b) <= tolerance, `${text} ${a} is not ${b}`);

/** How far a point lies from a stretch. */
export function toSegment(p, a, b) {
  const way = sub(b, a);
  const t = Math.min(1, Math.max(0, dot(sub(p, a), way) / (dot(way, way) || 1)));
  return norm(sub(p, add(a, scale(way, t))));
}

/** A stand-in of WebGL2 that keeps height maps as lists of stretches; what it draws it forgets. */
export function standIn() {
  const state = { batch: [], drawn: 0, bound: {}, lists: new Map() };
  const list = (target) => state.lists.get(state.bound[target]) ?? [];
  const own = {
    bindFramebuffer(target, buffer) {
      for (const one of target === "FRAMEBUFFER" ? ["DRAW_FRAMEBUFFER", "READ_FRAMEBUFFER"] : [target]) {
        state.bound[one] = buffer;
      }
    },
    texSubImage2D: (...given) => { state.batch = given.at(-1); },
    clearBufferfv: () => state.lists.set(state.bound.DRAW_FRAMEBUFFER, []),
    blitFramebuffer: () => state.lists.set(state.bound.DRAW_FRAMEBUFFER, [...list("READ_FRAMEBUFFER")]),
    drawArrays(_, __, count) {
      const drawn = Array.from({ length: count / 6 }, (_, i) => state.batch.slice(NUMBERS * i, NUMBERS * (i + 1)));
      state.lists.set(state.bound.DRAW_FRAMEBUFFER, [...list("DRAW_FRAMEBUFFER"), ...drawn]);
      state.drawn += drawn.length;
    },
    getAttribLocation: () => 0,
    isContextLost: () => false,
  };
  const gl = new Proxy(own, { get: (_, key) => own[key] ?? (/^[A-Z0-9_]+$/.test(key) ? key : () => ({})) });
  return { gl, state };
}
