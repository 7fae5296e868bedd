// The cutter and its holder: the outline about the axis in mm over the tip, and the turned body to draw.

import { clamp } from "./math.js";
/** @import { ToolData } from "./types.js" */

/** A cutter's lower side: flat out to `flat`, then a rounded corner, or a cone that rises by `slope` mm
 * a mm, out to `radius`. @typedef {{radius: number, flat: number, corner: number, slope: number}} Cutter */
/** A point of an outline: distance from the axis and height. @typedef {[number, number]} Outpoint */
/** @typedef {{part: "cutter"|"shank"|"holder", points: Outpoint[]}} Outline */
/** @typedef {{part: Outline["part"], first: number, count: number}} Range indices of a part of the tool */

/** Steps of a rounded corner over a right angle, and steps about the axis. */
const CORNER_STEPS = 12;
const TURN_STEPS = 40;
/** Edges of an outline that bend by less than this are shaded as one round side. */
const SMOOTH_RAD = 0.5;
const DRILL_POINT_DEG = 118;
/** Length of a cutter of unknown length, in diameters. */
const LENGTH_IN_DIAMETERS = 4;

/** @param {number} deg */
const tan = (deg) => Math.tan((clamp(deg, 0.05, 89.95) * Math.PI) / 180);

/** The lower side of a cutter. @param {ToolData} tool @returns {Cutter} */
export function cutterOf(tool) {
  const radius = Math.max(tool.diameter_mm / 2, 1e-4) || 1e-4;
  const tip = clamp((tool.tip_diameter_mm ?? 0) / 2, 0, radius);
  const corner = clamp(tool.corner_radius_mm ?? 0, 0, radius);
  switch (tool.shape) {
    case "ball": return { radius, flat: 0, corner: radius, slope: 0 };
    case "bull_nose": return { radius, flat: radius - corner, corner, slope: 0 };
    case "v": return { radius, flat: tip, corner: 0, slope: 1 / tan((tool.tip_angle_deg ?? 90) / 2) };
    case "cone": return { radius, flat: tip, corner: 0, slope: 1 / tan(tool.taper_angle_deg ?? 5) };
    case "drill":
      return { radius, flat: 0, corner: 0, slope: 1 / tan((tool.point_angle_deg ?? DRILL_POINT_DEG) / 2) };
    default: return { radius, flat: radius, corner: 0, slope: 0 };
  }
}

/** Height of a cutter's lower side over the tip, at a distance from the axis; infinite outside.
 * @param {Cutter} cutter @param {number} distance mm */
export function heightOf(cutter, distance) {
  if (distance > cutter.radius) return Infinity;
  const over = distance - cutter.flat;
  if (over <= 0) return 0;
  if (cutter.corner === 0) return cutter.slope * over;
  return cutter.corner - Math.sqrt(Math.max(cutter.corner ** 2 - over ** 2, 0));
}

/** The outlines of cutter, shank and holder, from below upwards.
 * @param {ToolData} tool @returns {Outline[]} */
export function outlines(tool) {
  const cutter = cutterOf(tool);
  const points = lowerSide(cutter);
  const tip = points.at(-1)?.[1] ?? 0;
  const whole = Math.max(tool.length_mm ?? LENGTH_IN_DIAMETERS * tool.diameter_mm, tip);
  const flutes = clamp(tool.flute_length_mm ?? whole, tip, whole);
  const { radius } = cutter;
  /** @type {Outline[]} */ const all = [{ part: "cutter", points: [...points, [radius, flutes]] }];
  if (whole > flutes) all.push({ part: "shank", points: [[radius, flutes], [radius, whole]] });
  const holder = holderPoints(tool, whole);
  if (holder.length === 0) all.at(-1)?.points.push([0, whole]);
  else all.push({ part: "holder", points: [[0, whole], ...holder, [0, holder.at(-1)?.[1] ?? whole]] });
  return all;
}

/** @param {ToolData} tool @param {number} start @returns {Outpoint[]} */
function holderPoints(tool, start) {
  let z = start;
  return (tool.holder ?? []).flatMap((section) => {
    const [lower, upper] = [section.diameter_mm / 2, (section.top_diameter_mm ?? section.diameter_mm) / 2];
    z += section.length_mm;
    return /** @type {Outpoint[]} */ ([[lower, z - section.length_mm], [upper, z]]);
  });
}

/** @param {Cutter} cutter @returns {Outpoint[]} */
function lowerSide(cutter) {
  const { radius, flat, corner, slope } = cutter;
  /** @type {Outpoint[]} */ const points = [[0, 0]];
  if (flat > 0) points.push([flat, 0]);
  for (let i = 1; corner > 0 && i <= CORNER_STEPS; i++) {
    const angle = (i / CORNER_STEPS) * (Math.PI / 2);
    points.push([flat + corner * Math.sin(angle), corner * (1 - Math.cos(angle))]);
  }
  if (corner === 0 && radius > flat) points.push([radius, slope * (radius - flat)]);
  return points;
}

/** Turns outlines about the z axis. @param {Outline[]} outlines
 * @returns {{positions: Float32Array, normals: Float32Array, indices: Uint32Array, ranges: Range[]}} */
export function turned(outlines) {
  /** @type {number[]} */ const positions = [];
  /** @type {number[]} */ const normals = [];
  /** @type {number[]} */ const indices = [];
  const ranges = outlines.map(({ part, points }) => {
    const first = indices.length;
    const edges = points.slice(1).map((end, i) => edgeNormal(points[i] ?? end, end));
    points.slice(1).forEach((end, i) => {
      const own = edges[i] ?? [0, 0];
      ring(positions, normals, points[i] ?? end, blended(own, edges[i - 1]));
      ring(positions, normals, end, blended(own, edges[i + 1]));
      band(indices, positions.length / 3 - 2 * (TURN_STEPS + 1));
    });
    return { part, first, count: indices.length - first };
  });
  return {
    positions: Float32Array.from(positions), normals: Float32Array.from(normals),
    indices: Uint32Array.from(indices), ranges,
  };
}

/** @param {Outpoint} a @param {Outpoint} b @returns {Outpoint} the normal that points away from the axis */
function edgeNormal(a, b) {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  return [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
}

/** @param {Outpoint} own @param {Outpoint|undefined} other @returns {Outpoint} */
function blended(own, other) {
  if (!other || own[0] * other[0] + own[1] * other[1] < Math.cos(SMOOTH_RAD)) return own;
  const sum = /** @type {const} */ ([own[0] + other[0], own[1] + other[1]]);
  const length = Math.hypot(...sum);
  return [sum[0] / length, sum[1] / length];
}

/** @param {number[]} positions @param {number[]} normals @param {Outpoint} point @param {Outpoint} normal */
function ring(positions, normals, [r, z], [nr, nz]) {
  for (let i = 0; i <= TURN_STEPS; i++) {
    const angle = (2 * Math.PI * i) / TURN_STEPS;
    positions.push(r * Math.cos(angle), r * Math.sin(angle), z);
    normals.push(nr * Math.cos(angle), nr * Math.sin(angle), nz);
  }
}

/** @param {number[]} indices @param {number} first vertex of the lower of two rings */
function band(indices, first) {
  for (let i = first; i < first + TURN_STEPS; i++) {
    const upper = i + TURN_STEPS + 1;
    indices.push(i, i + 1, upper + 1, i, upper + 1, upper);
  }
}
