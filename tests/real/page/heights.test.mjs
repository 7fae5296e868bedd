// Checks of the computed heights against closed forms.

import assert from "node:assert/strict";
import { test } from "node:test";
import { cutterOf, Heights, topOf, waysOf } from "./heights.mjs";
import { wrongCells } from "./material.mjs";

const STOCK = { min: [0, 0, 0], max: [60, 40, 10] };
const near = (a, b, tolerance = 1e-6) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const cut = (tool, ...ways) => new Heights(ways, cutterOf(tool), STOCK);

test("a flat cutter leaves a slot of its width", () => {
  const heights = cut({ shape: "flat", diameter_mm: 8 }, [[10, 20, 4], [50, 20, 4]]);
  for (const [x, y, z] of [[30, 23.99, 4], [30, 24.01, 10], [53.9, 20, 4], [54.1, 20, 10], [53.9, 22, 10]]) near(heights.at(x, y), z);
});

test("a flat cutter on a ramp cuts deepest with its lower rim", () => {
  const heights = cut({ shape: "flat", diameter_mm: 8 }, [[10, 20, 8], [50, 20, 4]]);
  near(heights.at(30, 20), 6 - 0.4);
  near(heights.at(30, 23), 6 - 0.1 * Math.sqrt(7));
});

test("a ball on a ramp leaves a tilted groove", () => {
  const heights = cut({ shape: "ball", diameter_mm: 8 }, [[10, 20, 9], [50, 20, 3]]);
  const slope = -0.15;
  // The centre's line is 4 above the tip's; the cylinder about it is steeper than round over the ground.
  for (const v of [0, 1, 2]) near(heights.at(30, 20 + v), 6 + 4 - Math.sqrt((16 - v * v) * (1 + slope * slope)), 1e-9);
});

test("a bull nose leaves a flat floor with round corners", () => {
  const heights = cut({ shape: "bull_nose", diameter_mm: 10, corner_radius_mm: 2 }, [[10, 20, 4], [50, 20, 4]]);
  near(heights.at(30, 22.9), 4);
  near(heights.at(30, 24), 4 + 2 - Math.sqrt(3));
  near(heights.at(30, 25.01), 10);
});

test("a bull nose on a ramp cuts as low as at the best of very many places", () => {
  const cutter = cutterOf({ shape: "bull_nose", diameter_mm: 10, corner_radius_mm: 2 });
  const heights = new Heights([[[10, 20, 9], [50, 20, 3]]], cutter, STOCK);
  for (const [x, y] of [[30, 20], [30, 23], [20, 24.5], [12, 17]]) {
    let least = 10;
    for (let k = 0; k <= 400_000; k++) {
      const away = Math.hypot(x - 10 - k / 1e4, y - 20);
      if (away <= cutter.radius) least = Math.min(least, 9 - 0.15 * (k / 1e4) + cutter.lower(away));
    }
    near(heights.at(x, y), least, 1e-6);
  }
});

test("a plunge leaves the cutter's own shape, and nothing below the stock is left", () => {
  const heights = cut({ shape: "ball", diameter_mm: 8 }, [[30, 20, 20], [30, 20, 5]], [[10, 10, 20], [10, 10, -3]]);
  near(heights.at(32, 20), 5 + 4 - Math.sqrt(12));
  near(heights.at(10, 10), 0);
});

test("arcs of all planes, whole turns, helices and parabolas lie on their curves", () => {
  const move = (kind, to, rest) => ({ kind, to, role: "cut", ...rest });
  const way = (start, ...moves) => waysOf({ start, passes: [{ moves }] }, 1e-4)[0];
  const turn = way([5, 0, 1], move("arc", [5, 0, 1], { center: [0, 0, 1], plane: "xy", direction: "cw" }));
  turn.forEach(([x, y, z]) => near(Math.hypot(x, y) + z, 6, 1e-9));
  near(turn[Math.floor(turn.length / 4)][1], -5, 0.05);
  const helix = way([5, 0, 1], move("arc", [0, 5, 3], { center: [0, 0, 1], plane: "xy", direction: "ccw" }));
  near(helix.length > 20 ? helix[Math.round((helix.length - 1) / 2)][2] : 0, 2, 0.05);
  const upright = way([0, 0, 5], move("arc", [5, 0, 0], { center: [0, 0, 0], plane: "zx", direction: "ccw" }));
  upright.forEach(([x, y, z]) => near(Math.hypot(x, z) + y, 5, 1e-9));
  assert.ok(upright.every(([x, , z]) => x >= -1e-9 && z >= -1e-9));
  const side = way([0, 5, 0], move("arc", [0, 0, 5], { center: [0, 0, 0], plane: "yz", direction: "cw" }));
  assert.ok(side.some(([, y]) => y < -4.9) && side.some(([, , z]) => z < -4.9));
  const bent = way([0, 0, 0], move("parabola", [10, 0, 0], { control: [5, 10, 0] }));
  bent.forEach(([x, y]) => near(y, x * 2 * (1 - x / 10), 1e-9));
  assert.ok(bent.length > 50);
});

test("a jump cuts nothing", () => {
  const ways = waysOf({ start: [10, 20, 4], passes: [
    { moves: [{ kind: "line", to: [12, 20, 4] }] }, { start: [50, 20, 4], moves: [{ kind: "dwell", seconds: 1 }, { kind: "rapid", to: [48, 20, 4] }] },
  ] }, 1e-3);
  near(cut({ shape: "flat", diameter_mm: 8 }, ...ways).at(30, 20), 10);
});

test("the top of triangles is the highest over a place", () => {
  const positions = [0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 5, 10, 0, 5, 0, 10, 8];
  const top = topOf({ positions, indices: [0, 1, 2, 3, 4, 5] }, -1);
  near(top(2, 5), 6.5);
  near(top(8, 8), -1);
});

/** A map of a slot as the page would have it: cells of 0.1 mm. @param {number} aside mm */
function slot(aside) {
  const [columns, rows, cell] = [200, 100, 0.1];
  const heights = new Float32Array(columns * rows);
  for (let k = 0; k < heights.length; k++) {
    const [x, y] = [((k % columns) + 0.5) * cell, (Math.floor(k / columns) + 0.5) * cell];
    heights[k] = Math.hypot(Math.max(5 - x, 0, x - 15), y - 5 - aside) <= 2 ? 4 : 10;
  }
  return { columns, rows, cell, origin: [0, 0, 0], depth: 10, heights };
}

test("two cells aside agree, three do not, and one wrong cell does not", () => {
  const computed = new Heights([[[5, 5, 4], [15, 5, 4]]], cutterOf({ shape: "flat", diameter_mm: 4 }), { min: [0, 0, 0], max: [20, 10, 10] });
  assert.deepEqual(wrongCells(slot(0), computed, 1), []);
  assert.deepEqual(wrongCells(slot(0.2), computed, 1), []);
  assert.ok(wrongCells(slot(0.3), computed, 1000).length > 100);
  const map = slot(0);
  map.heights[50 * 200 + 100] = 4.05;
  assert.equal(wrongCells(map, computed, 9).length, 1);
});
