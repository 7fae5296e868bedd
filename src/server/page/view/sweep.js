// The height to which a cutter lowers the material while it moves along a straight stretch.
//
// The stretch runs along u from (0, 0, z0) to (length, 0, z1), in mm. Above a place (u, v) the cutter's lower
// side at travel t is z0 + slope t + h(sqrt((u - t)^2 + v^2)). It is convex in t, because h is convex and
// rises; so the least is where its derivative changes sign. Flat and ball have it in closed form, the
// others by bisection. The shader in `stretches.js` computes the same.

import { heightOf } from "./tool.js";
import { clamp } from "./math.js";
/** @import { Cutter } from "./tool.js" */

/** Halvings of the range of travel: 24 reach the precision of the shader's numbers. */
export const HALVINGS = 24;
/** With sharper turns a stretch cuts its whole end. */
const LEAST_COSINE = 0.7;

/** The least height of the cutter's lower side over a place beside a stretch; infinite where it does not
 * pass. All in mm.
 * @param {Cutter} cutter @param {number} length along the ground
 * @param {number} z0 height of the tip at the start @param {number} z1 at the end
 * @param {number} u place along @param {number} v place across */
export function sweptHeight(cutter, length, z0, z1, u, v) {
  const { radius } = cutter;
  if (Math.abs(v) > radius) return Infinity;
  const half = Math.sqrt(radius ** 2 - v ** 2);
  const [low, high] = [Math.max(u - half, 0), Math.min(u + half, length)];
  if (low > high) return Infinity;
  if (length < 1e-6) return Math.min(z0, z1) + heightOf(cutter, Math.hypot(u, v));
  const slope = (z1 - z0) / length;
  const t = travelOfLeast(cutter, slope, u, v, low, high);
  // At the rim the distance may be more than the radius by rounding.
  return z0 + slope * t + heightOf(cutter, Math.min(Math.hypot(u - t, v), radius));
}

/** @param {Cutter} cutter @param {number} slope mm a mm @param {number} u @param {number} v
 * @param {number} low @param {number} high range of travel in which the cutter covers the place */
function travelOfLeast(cutter, slope, u, v, low, high) {
  if (slope === 0) return clamp(u, low, high);
  if (cutter.flat >= cutter.radius) return slope > 0 ? low : high;
  if (cutter.flat === 0 && cutter.corner > 0) {
    const behind = slope * Math.sqrt((cutter.radius ** 2 - v ** 2) / (1 + slope ** 2));
    return clamp(u - behind, low, high);
  }
  for (let i = 0; i < HALVINGS; i++) {
    const middle = (low + high) / 2;
    if (slope + rise(cutter, u - middle, v) < 0) low = middle;
    else high = middle;
  }
  return (low + high) / 2;
}

/** Derivative of the lower side's height over a place by the travel. @param {Cutter} cutter
 * @param {number} q how far the place lies ahead of the tip @param {number} v */
function rise(cutter, q, v) {
  const distance = Math.hypot(q, v);
  const over = distance - cutter.flat;
  if (over <= 0) return 0;
  const round = Math.sqrt(Math.max(cutter.corner ** 2 - over ** 2, 1e-12));
  const steep = cutter.corner > 0 ? over / round : cutter.slope;
  return (-steep * q) / distance;
}

/** How far from the tip, along the way, the place lies at most whose height is the least just there, in mm:
 * ahead of a tip that climbs, behind a tip that falls. Beside a level way it is the place beside the tip.
 * @param {Cutter} cutter @param {number} slope mm a mm */
export function leadOf(cutter, slope) {
  const { radius, flat, corner } = cutter;
  const steep = Math.abs(slope);
  if (steep === 0) return 0;
  if (flat >= radius) return radius;
  if (corner > 0) return flat + (corner * steep) / Math.sqrt(1 + steep ** 2);
  return steep < cutter.slope ? Math.max(flat, (radius * steep) / cutter.slope) : radius;
}

/** How far past its end a stretch has to cut on one side, so that it and the next stretch leave no place out
 * in the corner between them, in mm. The places that the corner lowers lie ahead of the first way and
 * behind the second.
 * @param {number} radius of the cutter @param {number} lead of the next stretch, ahead of its tip
 * @param {number} cosine of the turn @param {number} sine of the turn, above 0 towards the other side */
export function pastCorner(radius, lead, cosine, sine) {
  return cosine < LEAST_COSINE ? radius : (lead + radius * sine) / cosine;
}
