// Checks of cutter, sweep and material that need no browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Material } from "../view/material.js";
import { add, boxOf, norm, scale, sub } from "../view/math.js";
import { Stretches } from "../view/stretches.js";
import { sweptHeight } from "../view/sweep.js";
import { marksOf } from "../view/timeline.js";
import { cutterOf, heightOf, outlines, turned } from "../view/tool.js";
import { TOOLS, near, pathThrough, randomNumbers, spiral, standIn, toSegment } from "./view-aids.mjs";

for (const tool of TOOLS) {
  const cutter = cutterOf(tool);
  const name = `${tool.shape} ${tool.tip_diameter_mm ?? ""}`;

  test(`${name}: the outline to draw is the lower side that cuts`, () => {
    const [lower] = outlines(tool);
    for (const [r, z] of lower.points.slice(0, -2)) near(heightOf(cutter, r), z, 1e-9, `at ${r}`);
    assert.equal(heightOf(cutter, cutter.radius * 1.001), Infinity);
  });

  test(`${name}: the height after a stretch is the least of the cutter along it`, () => {
    const random = randomNumbers(7);
    for (let k = 0; k < 400; k++) {
      const [length, z1] = [random() * 20, k % 4 === 0 ? 0 : (random() - 0.5) * 30];
      const [u, v] = [random() * 32 - 6, random() * 11 - 5.5];
      let least = Infinity;
      for (let i = 0; i <= 4000; i++) {
        const t = i / 4000;
        least = Math.min(least, z1 * t + heightOf(cutter, Math.hypot(u - t * length, v)));
      }
      const height = sweptHeight(cutter, length, 0, z1, u, v);
      assert.ok(height <= least + 1e-5, `${height} is above ${least}`);
      // At the rim the steps above may miss the place, or the lowest point of a steep side.
      const rim = toSegment([u, v, 0], [0, 0, 0], [length, 0, 0]) > cutter.radius - 0.02;
      const apart = least - height;
      if (!rim) assert.ok(!(apart > 0.05), `${height}, not ${least}, at ${u} ${v} of ${length} ${z1}`);
      assert.ok(height >= Math.min(0, z1) - 1e-9, "never below the tip");
    }
  });

  test(`${name}: a plunge leaves the cutter's own shape`, () => {
    for (const r of [0, 1, 2.5, 4.9]) {
      near(sweptHeight(cutter, 0, 5, -3, r, 0), heightOf(cutter, r) - 3, 1e-9);
    }
    assert.equal(sweptHeight(cutter, 0, 5, -3, 5.01, 0), Infinity);
  });

  test(`${name}: the body to draw has unit normals that point outwards`, () => {
    const { positions, normals, indices, ranges } = turned(outlines({ ...tool, length_mm: 40 }));
    assert.equal(ranges.reduce((sum, { count }) => sum + count, 0), indices.length);
    assert.ok(indices.every((i) => 3 * i < positions.length));
    for (let i = 0; i < positions.length; i += 3) {
      near(Math.hypot(normals[i], normals[i + 1], normals[i + 2]), 1, 1e-5);
      assert.ok(normals[i] * positions[i] + normals[i + 1] * positions[i + 1] >= -1e-5);
    }
    near(boxOf(positions).max[2], 40, 1e-5);
  });
}

test("a ball that moves level leaves a groove of its radius", () => {
  const cutter = cutterOf({ shape: "ball", diameter_mm: 10 });
  near(sweptHeight(cutter, 20, 2, 2, 10, 3), 2 + 5 - 4, 1e-12);
  near(sweptHeight(cutter, 20, 2, 2, -4, 0), 2 + 5 - 3, 1e-12);
});

test("a ball that climbs at 45 degrees leaves a cylinder across the slope", () => {
  const cutter = cutterOf({ shape: "ball", diameter_mm: 10 });
  // The centre's line is z = u + 5; the lowest point of the cylinder about it is 5 sqrt(2) below.
  near(sweptHeight(cutter, 40, 0, 40, 20, 0), 25 - 5 * Math.SQRT2, 1e-9);
});

test("holder and shank stand on the cutter", () => {
  const parts = outlines({
    shape: "flat", diameter_mm: 6, flute_length_mm: 12, length_mm: 30,
    holder: [{ length_mm: 10, diameter_mm: 20, top_diameter_mm: 30 }, { length_mm: 5, diameter_mm: 40 }],
  });
  assert.deepEqual(parts.map(({ part }) => part), ["cutter", "shank", "holder"]);
  assert.deepEqual(parts[2].points, [[0, 30], [10, 30], [15, 40], [20, 40], [20, 45], [0, 45]]);
  assert.ok(outlines({ shape: "flat", diameter_mm: NaN }).flatMap(({ points }) => points).length > 0);
});

/** Heights of places after stretches as the shader cuts them; the stock's top is `top`. */
function heightsOf(stretches, cutter, places, top) {
  return places.map(([px, py]) => {
    let height = top;
    for (const [x, y, z, length, dx, dy, slope, back, left, right] of stretches) {
      const u = (px - x) * dx + (py - y) * dy;
      const v = (py - y) * dx - (px - x) * dy;
      const ahead = right + ((left - right) * (v + cutter.radius)) / (2 * cutter.radius);
      if (u < -back || u > length + ahead) continue;
      height = Math.min(height, sweptHeight(cutter, length, z, z + slope * length, u, v));
    }
    return Math.max(height, 0);
  });
}

/** Heights of places after a cutter stood at very many points of a path; its own search, without the sweep. */
function heightsByPoints(points, cutter, places, top) {
  const heights = places.map(() => top);
  points.slice(1).forEach((end, i) => {
    const [start, way] = [points[i], sub(end, points[i])];
    const steps = Math.ceil(norm(way) / 0.01) + 1;
    places.forEach(([px, py], k) => {
      if (toSegment([px, py, 0], [start[0], start[1], 0], [end[0], end[1], 0]) > cutter.radius) return;
      for (let j = 0; j <= steps; j++) {
        const [x, y, z] = add(start, scale(way, j / steps));
        heights[k] = Math.min(heights[k], z + heightOf(cutter, Math.hypot(px - x, py - y)));
      }
    });
  });
  return heights.map((height) => Math.max(height, 0));
}

/** The way of the tip before a time, moved by `origin`. */
function wayUntil(path, time, origin) {
  const place = (v) => [0, 1, 2].map((k) => path.positions[3 * v + k] - origin[k]);
  const points = [place(0)];
  for (let i = 1; i < path.times.length && path.times[i - 1] < time; i++) {
    const t = Math.min(1, (time - path.times[i - 1]) / (path.times[i] - path.times[i - 1]));
    points.push(add(place(i - 1), scale(sub(place(i), place(i - 1)), t)));
  }
  return points;
}

function cutUntil(material, time) {
  material.setTime(time);
  for (let k = 0; material.isBusy && k < 1000; k++) material.step(50);
  assert.ok(!material.isBusy);
}

test("the material at a time is the same from whichever time it comes", () => {
  const random = randomNumbers(9);
  const points = [[5, 5, 12]];
  for (let row = 0; row < 30; row++) {
    const [from, to] = row % 2 ? [75, 5] : [5, 75];
    for (let i = 0; i <= 20; i++) {
      points.push([from + ((to - from) * i) / 20, 5 + row, 6 + 2 * Math.sin(i / 3)]);
    }
  }
  const path = pathThrough(points);
  const stock = { min: [0, 0, 0], max: [80, 40, 10] };
  const cutter = cutterOf({ shape: "ball", diameter_mm: 8 });
  const { gl, state } = standIn();
  const material = new Material(gl, path, marksOf(path), cutter, stock);
  const places = Array.from({ length: 40 }, () => [random() * 80, random() * 40]);
  const end = path.times.at(-1);
  for (const share of [0.02, 0.0203, 0.021, 0.5, 0.9, 0.4999, 0.3, 1, 0.05, 0, 1, 0.77]) {
    cutUntil(material, share * end);
    const expected = heightsByPoints(wayUntil(path, share * end, stock.min), cutter, places, 10);
    const heights = heightsOf(state.lists.get(material.map.buffer), cutter, places, 10);
    heights.forEach((height, i) => near(height, expected[i], 0.02, `at ${share} of the time:`));
  }
});

/** The stretches between points as a batch holds them; whether each follows the one before. */
function stretchesOf(cutter, points, follows) {
  const { gl, state } = standIn();
  const batch = new Stretches(gl, cutter, 0.1);
  points.slice(1).forEach((end, i) => batch.add(...points[i], ...end, follows && i > 0));
  gl.bindFramebuffer("FRAMEBUFFER", "map");
  batch.draw([100, 100], 20);
  return state.lists.get("map");
}

/** Lines, ramps, plunges, arcs level and climbing, sharp turns and turns back. */
function mixedWay() {
  const points = [[10, 10, 12], [10, 10, 6], [30, 10, 6], [45, 14, 3], [45, 14, 8], [45, 30, 5], [20, 30, 5]];
  for (let i = 0; i <= 60; i++) {
    const angle = (Math.PI * i) / 30;
    points.push([30 + 9 * Math.sin(angle), 28 - 9 * Math.cos(angle), 5 - i / 30]);
  }
  for (let i = 0; i <= 90; i++) points.push([10 + i / 2, 45 + 3 * Math.sin(i / 9), 6 + 3 * Math.sin(i / 5)]);
  return [...points, [20, 50, 4], [50, 52, 9], [50, 20, 2.5], [50, 40, 2.5], [30, 40, 2.4999], [30, 55, 2.4999]];
}

for (const tool of TOOLS) {
  test(`${tool.shape}: the material of a mixed way is that of a cutter at all its points`, () => {
    const [points, cutter] = [mixedWay(), cutterOf(tool)];
    const path = pathThrough(points);
    const stock = { min: [0, 0, 0], max: [60, 60, 10] };
    const { gl, state } = standIn();
    const material = new Material(gl, path, marksOf(path), cutter, stock);
    cutUntil(material, path.times.at(-1));
    const random = randomNumbers(13);
    const places = Array.from({ length: 250 }, () => [random() * 60, random() * 60]);
    const stretches = state.lists.get(material.map.buffer);
    const expected = heightsByPoints(points, cutter, places, 10);
    const wrong = heightsOf(stretches, cutter, places, 10).flatMap((height, i) => {
      if (Math.abs(height - expected[i]) <= 2 * material.cell) return [];
      // On a steep side two cells aside may be much deeper.
      const around = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]].map(([dx, dy]) =>
        [places[i][0] + 2 * dx * material.cell, places[i][1] + 2 * dy * material.cell]);
      const beside = heightsByPoints(points, cutter, around, 10);
      const isBetween = height >= Math.min(...beside) - 0.1 && height <= Math.max(...beside) + 0.1;
      return isBetween ? [] : [`${places[i]}: ${height}, not ${expected[i]}`];
    });
    assert.deepEqual(wrong, []);
    assert.ok(expected.some((height) => height < 9));
  });

  test(`${tool.shape}: stretches that leave out what others cut leave out nothing else`, () => {
    const cutter = cutterOf(tool);
    for (let seed = 1; seed <= 40; seed++) {
      const random = randomNumbers(seed);
      const points = [[20, 20, 8]];
      let heading = random() * 7;
      for (let i = 0; i < 25; i++) {
        heading += (random() - 0.5) * (i % 6 === 0 ? 6 : seed % 4 ? 0.9 : 0.1);
        const far = random() < 0.1 ? 0 : random() * (seed % 3 ? 1.5 : 0.2);
        const climb = seed % 5 === 0 ? 0 : (random() - 0.5) * far * (seed % 2 ? 0.3 : 3);
        points.push(add(points.at(-1), [far * Math.cos(heading), far * Math.sin(heading), climb]));
      }
      const [whole, short] = [false, true].map((follows) => stretchesOf(cutter, points, follows));
      const places = Array.from({ length: 300 }, () => {
        const [x, y] = points[Math.floor(random() * points.length)];
        const [angle, away] = [random() * 7, cutter.radius * random() ** 0.3];
        return [x + away * Math.cos(angle), y + away * Math.sin(angle)];
      });
      const expected = heightsOf(whole, cutter, places, 20);
      heightsOf(short, cutter, places, 20).forEach((height, i) => near(height, expected[i], 0.002, `way ${seed}:`));
    }
  });
}

test("a small step in time draws few stretches", () => {
  const path = spiral(20000);
  const { gl, state } = standIn();
  const stock = { min: [-50, -50, -2], max: [50, 50, 0] };
  const material = new Material(gl, path, marksOf(path), cutterOf({ shape: "flat", diameter_mm: 1 }), stock);
  cutUntil(material, path.times[15000]);
  state.drawn = 0;
  cutUntil(material, path.times[15010]);
  assert.ok(state.drawn > 0 && state.drawn <= 11, `${state.drawn}`);
});
