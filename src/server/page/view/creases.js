// The sharp edges of a body, to draw it as lines.

import { cross, dot, pointAt, sub, unit } from "./math.js";
/** @import { Box, MeshData, Vec3 } from "./types.js" */

/** Largest cosine of the turn between two triangles at a sharp edge: 25 degrees. Round walls have flatter turns. */
const SHARP = Math.cos((25 * Math.PI) / 180);

/** The twelve edges of a box. @param {Box} box @returns {number[]} both ends of each edge */
export function boxEdges({ min, max }) {
  /** @type {number[]} */ const lines = [];
  for (const axis of [0, 1, 2]) {
    for (const side of [0, 1, 2, 3]) {
      const from = [0, 0, 0].map((_, k) => {
        const bit = k === (axis + 1) % 3 ? side & 1 : k === (axis + 2) % 3 ? side >> 1 : 0;
        return (bit ? max[k] : min[k]) ?? 0;
      });
      lines.push(...from, ...from.map((x, k) => (k === axis ? max[k] ?? x : x)));
    }
  }
  return lines;
}

/** The edges of a body where its surface turns sharply or ends.
 * @param {MeshData} body @returns {number[]} both ends of each edge */
export function creases({ positions, indices }) {
  /** @type {Map<string, {ends: number[], normal: Vec3}>} edges that only one triangle is known of yet */
  const open = new Map();
  /** @type {number[]} */ const lines = [];
  for (let k = 0; k + 2 < indices.length; k += 3) {
    const corners = [0, 1, 2].map((corner) => pointAt(positions, indices[k + corner] ?? 0));
    const [a = [0, 0, 0], b = a, c = a] = /** @type {Vec3[]} */ (corners);
    const normal = unit(cross(sub(b, a), sub(c, a)));
    for (const [from, to] of /** @type {const} */ ([[a, b], [b, c], [c, a]])) {
      // The triangle beyond an edge has its ends the other way round.
      const beyond = open.get(`${to} ${from}`);
      if (!beyond) open.set(`${from} ${to}`, { ends: [...from, ...to], normal });
      else {
        open.delete(`${to} ${from}`);
        if (dot(normal, beyond.normal) < SHARP) lines.push(...beyond.ends);
      }
    }
  }
  return [...lines, ...[...open.values()].flatMap(({ ends }) => ends)];
}
