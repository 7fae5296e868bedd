// Checks of the 3D view that need no browser: camera, path, cutter, sweep, material, pick and colours.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Camera, VIEWS } from "../view/camera.js";
import { colorTable, countKinds, KIND_COLORS, legendRows, paint, rgb } from "../view/colors.js";
import { gridOf } from "../view/grid.js";
import { parseColor } from "../view/labels.js";
import { Material } from "../view/material.js";
import { add, boxOf, corners, dot, norm, placed, roundDown, scale, sub } from "../view/math.js";
import { PathBoxes } from "../view/pick.js";
import { Scene } from "../view/scene.js";
import { sweptHeight } from "../view/sweep.js";
import {
  isJoined, isUpright, MARK, marksOf, poseAt, simplify, thinned, vertexAfter,
} from "../view/timeline.js";
import { cutterOf, heightOf, outlines, turned } from "../view/tool.js";
import { KINDS } from "../view/types.js";

const TOOLS = [
  { shape: "flat", diameter_mm: 10 },
  { shape: "ball", diameter_mm: 10 },
  { shape: "bull_nose", diameter_mm: 10, corner_radius_mm: 2 },
  { shape: "v", diameter_mm: 10, tip_angle_deg: 90 },
  { shape: "v", diameter_mm: 10, tip_angle_deg: 60, tip_diameter_mm: 1 },
  { shape: "cone", diameter_mm: 10, taper_angle_deg: 20, tip_diameter_mm: 4 },
  { shape: "drill", diameter_mm: 10 },
];

/** Numbers that look random and are the same in every run. */
function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** A path through points; one kind, one mm a second. */
function pathThrough(points, { kinds, strips } = {}) {
  const positions = Float32Array.from(points.flat());
  const times = new Float32Array(points.length);
  for (let i = 1; i < points.length; i++) times[i] = times[i - 1] + norm(sub(points[i], points[i - 1]));
  return {
    positions, times, kinds: Uint8Array.from(kinds ?? points.map(() => 1)),
    feeds: new Float32Array(points.length).fill(60), blocks: Uint32Array.from(points, (_, i) => i + 1),
    deviations: null, axes: null,
    strips: strips ?? [{ first: 0, count: points.length, name: "path", pass: 0, level: null }],
  };
}

/** A spiral of n vertices with turns of 100 vertices, 100 mm wide. */
function spiral(n) {
  const points = [];
  for (let i = 0; i < n; i++) {
    const [angle, r] = [(2 * Math.PI * i) / 100, (50 * i) / n];
    points.push([r * Math.cos(angle), r * Math.sin(angle), -i / n]);
  }
  return pathThrough(points);
}

function cameraAt(yaw, pitch, orthographic) {
  const camera = new Camera();
  Object.assign(camera, { width: 800, height: 600, orthographic, animated: false });
  camera.box = { min: [-30, -10, -5], max: [70, 40, 15] };
  camera.fit();
  camera.orbit(yaw, pitch);
  return camera;
}

function transformed(matrix, [x, y, z], w = 1) {
  return [0, 1, 2, 3].map((k) => matrix[k] * x + matrix[4 + k] * y + matrix[8 + k] * z + matrix[12 + k] * w);
}

const near = (a, b, tolerance, text = "") =>
  assert.ok(Math.abs(a - b) <= tolerance, `${text} ${a} is not ${b}`);

for (const orthographic of [false, true]) {
  const name = orthographic ? "orthographic" : "perspective";

  test(`${name}: matrices, project and ray tell the same place`, () => {
    const camera = cameraAt(0.7, -0.3, orthographic);
    const { view, projection } = camera.matrices();
    for (const point of [[0, 0, 0], [60, 30, 10], [-20, 0, -4]]) {
      const seen = transformed(view, point);
      const [x, y, z, w] = transformed(projection, seen);
      const place = camera.project(point);
      near((x / w + 1) * 400, place.x, 1e-3);
      near((1 - y / w) * 300, place.y, 1e-3);
      assert.ok(Math.abs(z / w) < 1, "inside of the clipping planes");
      const ray = camera.ray(place.x, place.y);
      const along = dot(sub(point, ray.origin), ray.direction);
      near(norm(sub(point, add(ray.origin, scale(ray.direction, along)))), 0, 1e-3);
    }
  });

  test(`${name}: zooming keeps the point under the cursor`, () => {
    const camera = cameraAt(0.2, 0.1, orthographic);
    const point = camera.facing(650, 120);
    camera.zoom(0.4, 650, 120);
    const place = camera.project(point);
    near(place.x, 650, 1e-6);
    near(place.y, 120, 1e-6);
  });

  test(`${name}: turning keeps the pivot where it is seen`, () => {
    const camera = cameraAt(0.2, 0.1, orthographic);
    const pivot = [40, -5, 12];
    const before = camera.project(pivot);
    camera.orbit(1.1, -0.4, pivot);
    const after = camera.project(pivot);
    near(after.x, before.x, 1e-6);
    near(after.y, before.y, 1e-6);
  });

  test(`${name}: every standard view shows the whole box and fills the picture`, () => {
    const camera = cameraAt(0, 0, orthographic);
    for (const view of Object.keys(VIEWS)) {
      assert.ok(camera.look(view));
      const places = corners(camera.box).map((corner) => camera.project(corner));
      const [xs, ys] = [places.map(({ x }) => x / 800), places.map(({ y }) => y / 600)];
      const [left, right, top, bottom] = [
        Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
      assert.ok(left >= 0 && right <= 1 && top >= 0 && bottom <= 1);
      const share = Math.max(right - left, bottom - top);
      assert.ok(share > 0.6, `${view} fills ${share}`);
    }
  });
}

test("the top view has x to the right and y up; the front view has z up", () => {
  const camera = cameraAt(0, 0, true);
  camera.look("top");
  assert.ok(camera.project([1, 0, 0]).x > camera.project([0, 0, 0]).x);
  assert.ok(camera.project([0, 1, 0]).y < camera.project([0, 0, 0]).y);
  camera.look("front");
  assert.ok(camera.project([0, 0, 1]).y < camera.project([0, 0, 0]).y);
  assert.ok(camera.project([0, -1, 0]).depth < camera.project([0, 0, 0]).depth);
  assert.equal(camera.look("toString"), false);
});

test("an animated view arrives after its time, by the shorter way round", () => {
  const camera = cameraAt(Math.PI * 1.9, 0, false);
  camera.animated = true;
  const from = camera.pose.yaw;
  camera.look("front");
  camera.step(1000);
  assert.ok(camera.flying);
  camera.step(2000);
  assert.ok(!camera.flying);
  near(Math.cos(camera.pose.yaw), 1, 1e-9);
  assert.ok(Math.abs(camera.pose.yaw - from) <= Math.PI + 1e-9);
});

test("a fitted camera knows it, until somebody moves it", () => {
  const camera = cameraAt(0, 0, false);
  assert.equal(camera.isFitted, false);
  camera.look("left");
  assert.ok(camera.isFitted);
  const { yaw } = camera.pose;
  camera.width = 300;
  camera.fit();
  assert.ok(camera.isFitted && camera.pose.yaw === yaw);
  camera.pan(5, 0);
  assert.equal(camera.isFitted, false);
});

test("a camera inside of the box keeps its near plane before the eye", () => {
  const camera = cameraAt(0, 0, false);
  camera.zoom(1e-4);
  const { near: plane, projection } = camera.matrices();
  assert.ok(plane > 0 && projection.every(Number.isFinite));
});

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

test("a placed body stands at the tip along the axis", () => {
  const axis = [0.6, 0, 0.8];
  const matrix = placed([1, 2, 3], axis);
  const top = transformed(matrix, [0, 0, 10]);
  [7, 2, 11].forEach((x, k) => near(top[k], x, 1e-5));
});

test("the tip at a time lies between the vertices around it", () => {
  const path = pathThrough([[0, 0, 0], [10, 0, 0], [10, 0, 0], [10, 5, 0]]);
  path.times = Float32Array.from([0, 10, 14, 19]);
  assert.deepEqual(poseAt(path, 4).point, [4, 0, 0]);
  assert.deepEqual(poseAt(path, 12).point, [10, 0, 0]);
  assert.deepEqual(poseAt(path, -5).point, [0, 0, 0]);
  assert.deepEqual(poseAt(path, Infinity).point, [10, 5, 0]);
  assert.equal(vertexAfter(path.times, 10), 1);
  assert.equal(poseAt(pathThrough([]), 1), null);
});

test("a leaning tool is seen in the axes, an upright one is not", () => {
  const path = pathThrough([[0, 0, 0], [1, 0, 0]]);
  assert.ok(isUpright(path));
  path.axes = Float32Array.from([0, 0, 1, 0, 0, 1]);
  assert.ok(isUpright(path));
  path.axes[3] = 0.1;
  assert.ok(!isUpright(path));
});

test("a straight run needs two vertices; changes of kind and ends of strips stay", () => {
  const points = Array.from({ length: 90 }, (_, i) => [i, 0, 0]);
  const path = pathThrough(points, {
    kinds: points.map((_, i) => (i <= 30 ? 1 : 2)),
    strips: [{ first: 0, count: 60, name: "", pass: 0, level: null },
      { first: 60, count: 30, name: "", pass: 0, level: null }],
  });
  const kept = [];
  simplify(path.positions, marksOf(path), 0, 89, 0.01, (vertex) => { kept.push(vertex); });
  assert.deepEqual(kept, [0, 30, 59, 60, 89]);
});

test("a simplified path stays within twice the tolerance, and turns back where the path does", () => {
  const random = randomNumbers(3);
  const points = [[0, 0, 0]];
  for (let i = 1; i < 3000; i++) {
    const heading = Math.sin(i / 40) * 2 + (random() - 0.5) * 0.4;
    const step = [0.3 * Math.cos(heading), 0.3 * Math.sin(heading), (random() - 0.5) * 0.05];
    points.push(add(points[i - 1], step));
  }
  points.push([0, 0, 0], ...points.slice(0, 50).reverse());
  const path = pathThrough(points);
  const kept = [];
  simplify(path.positions, marksOf(path), 0, points.length - 1, 0.1, (vertex) => { kept.push(vertex); });
  assert.ok(kept.length < points.length / 2);
  for (let k = 1; k < kept.length; k++) {
    const [a, b] = [points[kept[k - 1]], points[kept[k]]];
    for (let i = kept[k - 1]; i <= kept[k]; i++) near(toSegment(points[i], a, b), 0, 0.2001);
  }
});

function toSegment(p, a, b) {
  const way = sub(b, a);
  const t = Math.min(1, Math.max(0, dot(sub(p, a), way) / (dot(way, way) || 1)));
  return norm(sub(p, add(a, scale(way, t))));
}

test("a thinned path holds its budget, and never joins what is apart", () => {
  const random = randomNumbers(5);
  const anywhere = () => [random() * 100, random() * 100, random() * 10];
  const wild = pathThrough(Array.from({ length: 20000 }, anywhere));
  for (const path of [wild, spiral(20000)]) {
    const marks = marksOf(path);
    const whole = { positions: path.positions, times: path.times, marks, sources: null };
    const half = thinned(whole, 150, 2000);
    const copy = thinned(whole, 150, 1000);
    assert.deepEqual(half.sources.length > copy.sources.length, true);
    const twice = thinned(half, 150, 700).sources;
    const found = twice.every((vertex) => half.sources.includes(vertex));
    assert.ok(twice.length <= 700 && twice.length > 200 && found);
    assert.ok(copy.sources.length <= 1000 && copy.sources.length > 300, `${copy.sources.length}`);
    for (let j = 1; j < copy.sources.length; j++) {
      const [a, b] = [copy.sources[j - 1], copy.sources[j]];
      if (path === wild && isJoined(copy.marks, j)) assert.equal(b - a, 1);
      assert.ok(b > a || !isJoined(copy.marks, j));
    }
  }
});

test("marks of broken paths stay within their bounds", () => {
  const path = pathThrough([[0, 0, 0], [NaN, 1, 1], [2, 2, 2]], {
    kinds: [1, 200, 7], strips: [{ first: -3, count: 99, name: "", pass: 0, level: null }],
  });
  const marks = marksOf(path);
  assert.equal(marks.length, 12);
  assert.ok([0, 1, 2].every((i) => marks[MARK * i] < KINDS.length));
  assert.deepEqual(boxOf(path.positions), { min: [0, 0, 0], max: [2, 2, 2] });
  assert.equal(boxOf(new Float32Array()), null);
});

test("the pick is the nearest stretch, as a search of all finds it", () => {
  const random = randomNumbers(11);
  const anywhere = () => [random() * 100, random() * 50, random() * 20];
  const path = pathThrough(Array.from({ length: 3000 }, anywhere), {
    kinds: Array.from({ length: 3000 }, (_, i) => i % 3),
  });
  const marks = marksOf(path);
  const boxes = new PathBoxes(path.positions, marks);
  for (const orthographic of [false, true]) {
    const camera = cameraAt(0.3, -0.2, orthographic);
    for (let k = 0; k < 100; k++) {
      const ray = camera.ray(random() * 800, random() * 600);
      const found = boxes.nearest(ray, 8, 0b110);
      const best = bestOfAll(path, marks, ray);
      assert.equal(found === null, best === 0);
      // Where two stretches meet, either may be found.
      if (found) for (const index of [found.index, best]) near(awayFrom(path, index, found.point), 0, 1e-3);
    }
  }
});

function awayFrom(path, index, point) {
  const [a, b] = [index - 1, index].map((i) => [...path.positions.subarray(3 * i, 3 * i + 3)]);
  return toSegment(point, a, b);
}

function bestOfAll(path, marks, ray) {
  let best = { index: 0, away: 8, depth: Infinity };
  for (let i = 1; i < path.times.length; i++) {
    if (!((0b110 >> marks[MARK * i]) & 1)) continue;
    const [a, b] = [i - 1, i].map((v) => [0, 1, 2].map((c) => path.positions[3 * v + c] - ray.origin[c]));
    const flat = (p) => sub(p, scale(ray.direction, dot(p, ray.direction)));
    const [fa, way] = [flat(a), sub(flat(b), flat(a))];
    const t = Math.min(1, Math.max(0, -dot(fa, way) / dot(way, way)));
    const depth = dot(add(a, scale(sub(b, a), t)), ray.direction);
    const away = norm(add(fa, scale(way, t))) / (ray.base + ray.slope * depth);
    if (depth <= 0 || away > 8) continue;
    const isBetter = away <= 2 && best.away <= 2 && best.index ? depth < best.depth : away <= best.away;
    if (isBetter) best = { index: i, away, depth };
  }
  return best.index;
}

test("a million vertices are picked within milliseconds", () => {
  const path = spiral(1_000_000);
  const boxes = new PathBoxes(path.positions, marksOf(path));
  const camera = cameraAt(0, 0.2, false);
  const random = randomNumbers(2);
  const start = performance.now();
  for (let k = 0; k < 40; k++) {
    boxes.nearest(camera.ray(200 + 400 * random(), 150 + 300 * random()), 7, 255);
  }
  const each = (performance.now() - start) / 40;
  console.log(`a pick takes ${each.toFixed(2)} ms`);
  assert.ok(each < 20, `${each} ms`);
});

test("levels, feeds and deviations have colours, also without values", () => {
  const path = pathThrough([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], {
    strips: [{ first: 0, count: 2, name: "", pass: 0, level: 1 },
      { first: 2, count: 2, name: "", pass: 0, level: 2 }],
  });
  path.feeds = Float32Array.from([0, 100, 300, 200]);
  path.deviations = Float32Array.from([NaN, -0.02, 0.01, 0]);
  const marks = marksOf(path);
  const entries = () => [0, 1, 2, 3].map((i) => marks[MARK * i + 1]);
  const feed = paint(path, marks, "feed");
  assert.deepEqual([feed.from, feed.to, feed.unknown], [100, 300, true]);
  assert.deepEqual(entries(), [0, 1, 255, 128]);
  const deviation = paint(path, marks, "deviation");
  near(deviation.to, 0.02, 1e-7);
  assert.deepEqual(entries().filter((_, i) => i !== 2), [0, 1, 128]);
  const level = paint(path, marks, "level");
  assert.deepEqual(level.levels, [1, 2]);
  assert.deepEqual(entries(), [1, 1, 255, 255]);
  const rows = legendRows(level, countKinds(marks), () => true);
  assert.deepEqual(rows.map(({ label }) => label), ["Level 1", "Level 2"]);
  path.deviations = null;
  const none = legendRows(paint(path, marks, "deviation"), countKinds(marks), () => true);
  assert.deepEqual(none.map(({ type }) => type), ["swatch"]);
  const kinds = legendRows(paint(path, marks, "kind"), countKinds(marks), (key) => key !== "cut");
  assert.deepEqual(kinds.map(({ key, visible }) => [key, visible]), [["cut", false]]);
  assert.equal(colorTable("kind").length, 1024);
});

test("kinds of moves stand out on light and dark ground, and from each other for all eyes", () => {
  const linear = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
  const light = (hex) => dot(rgb(hex).map(linear), [0.2126, 0.7152, 0.0722]);
  const contrast = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  for (const hex of KIND_COLORS) {
    for (const ground of ["#f5f7f9", "#15191f"]) {
      assert.ok(contrast(light(hex), light(ground)) >= 2.5, `${hex} on ${ground}`);
    }
  }
  // Linear colours as eyes without long or middle cones see them (Vienot, Brettel, Mollon 1999).
  const eyes = [
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
    [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
  ];
  for (const eye of eyes) {
    const seen = KIND_COLORS.map((hex) => lab(eye.map((row) => dot(row, rgb(hex).map(linear)))));
    seen.forEach((a, i) => seen.slice(0, i).forEach((b, j) => {
      const apart = norm(sub(a, b));
      // Rapids are dashed and dwells are points, so their colours need not differ as much.
      const least = [0, 7].includes(i) || [0, 7].includes(j) ? 12 : 25;
      assert.ok(apart >= least, `${KINDS[i]} and ${KINDS[j]} are ${apart.toFixed(1)} apart`);
    }));
  }
});

function lab([r, g, b]) {
  const xyz = [0.4124 * r + 0.3576 * g + 0.1805 * b, 0.2126 * r + 0.7152 * g + 0.0722 * b,
    0.0193 * r + 0.1192 * g + 0.9505 * b];
  const [x, y, z] = [xyz[0] / 0.9505, xyz[1], xyz[2] / 1.089].map((t) => Math.cbrt(Math.max(t, 0)));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

test("the grid has round spacing and reaches around the box", () => {
  assert.deepEqual([0.9, 1, 2.5, 7, 49, 99, 1000].map(roundDown), [0.5, 1, 2, 5, 20, 50, 1000]);
  const grid = gridOf({ min: [-3, 0, -20], max: [97, 60, 0] });
  assert.deepEqual([grid.spacing, grid.z], [10, -20]);
  assert.ok(grid.x0 < -3 && grid.x1 > 97 && grid.y0 < 0 && grid.y1 > 60);
});

test("colours of the page are read in both notations", () => {
  assert.deepEqual(parseColor("rgb(255, 0, 51)"), [1, 0, 0.2]);
  assert.deepEqual(parseColor("color(srgb 0.1 0.2 1)"), [0.1, 0.2, 1]);
});

/** A stand-in of WebGL2 that keeps height maps as lists of stretches; what it draws it forgets. */
function standIn() {
  const state = { batch: [], drawn: 0, bound: {}, lists: new Map() };
  const list = (target) => state.lists.get(state.bound[target]) ?? [];
  const own = {
    bindFramebuffer(target, buffer) {
      for (const one of target === "FRAMEBUFFER" ? ["DRAW_FRAMEBUFFER", "READ_FRAMEBUFFER"] : [target]) {
        state.bound[one] = buffer;
      }
    },
    bufferSubData: (_, __, data, ___, count) => { state.batch = Array.from(data.subarray(0, count)); },
    clearBufferfv: () => state.lists.set(state.bound.DRAW_FRAMEBUFFER, []),
    blitFramebuffer: () => state.lists.set(state.bound.DRAW_FRAMEBUFFER, [...list("READ_FRAMEBUFFER")]),
    drawArrays(_, __, count) {
      const drawn = state.batch.filter((_, i) => i % 36 < 6);
      state.lists.set(state.bound.DRAW_FRAMEBUFFER, [...list("DRAW_FRAMEBUFFER"), ...drawn]);
      state.drawn += count / 6;
    },
    getAttribLocation: () => 0,
    isContextLost: () => false,
  };
  const gl = new Proxy(own, { get: (_, key) => own[key] ?? (/^[A-Z0-9_]+$/.test(key) ? key : () => ({})) });
  return { gl, state };
}

/** Heights of places after a list of stretches; the stock's top is `top`. */
function heightsOf(stretches, cutter, places, top) {
  return places.map(([x, y]) => {
    let height = top;
    for (let i = 0; i < stretches.length; i += 6) {
      const [ax, ay, az, bx, by, bz] = stretches.slice(i, i + 6);
      const length = Math.hypot(bx - ax, by - ay);
      const [dx, dy] = length > 1e-6 ? [(bx - ax) / length, (by - ay) / length] : [1, 0];
      const [px, py] = [x - ax, y - ay];
      height = Math.min(height, sweptHeight(cutter, length, az, bz, px * dx + py * dy, py * dx - px * dy));
    }
    return Math.max(height, 0);
  });
}

/** All stretches of a path before a time, moved by `origin`. */
function stretchesUntil(path, time, origin) {
  const all = [];
  for (let i = 1; i < path.times.length && path.times[i - 1] < time; i++) {
    const place = (v) => [0, 1, 2].map((k) => path.positions[3 * v + k] - origin[k]);
    const t = Math.min(1, (time - path.times[i - 1]) / (path.times[i] - path.times[i - 1]));
    all.push(...place(i - 1), ...add(place(i - 1), scale(sub(place(i), place(i - 1)), t)));
  }
  return all;
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
    material.setTime(share * end);
    for (let k = 0; material.isBusy && k < 1000; k++) material.step();
    assert.ok(!material.isBusy);
    const expected = heightsOf(stretchesUntil(path, share * end, stock.min), cutter, places, 10);
    const heights = heightsOf(state.lists.get(material.map.buffer), cutter, places, 10);
    heights.forEach((height, i) => near(height, expected[i], 0.02, `at ${share} of the time:`));
  }
});

test("a small step in time draws few stretches", () => {
  const path = spiral(20000);
  const { gl, state } = standIn();
  const stock = { min: [-50, -50, -2], max: [50, 50, 0] };
  const material = new Material(gl, path, marksOf(path), cutterOf({ shape: "flat", diameter_mm: 1 }), stock);
  material.setTime(path.times[15000]);
  while (material.isBusy) material.step();
  state.drawn = 0;
  material.setTime(path.times[15010]);
  while (material.isBusy) material.step();
  assert.ok(state.drawn > 0 && state.drawn <= 11, `${state.drawn}`);
});

test("a scene takes anything: nothing, broken paths, empty parts, five axes", () => {
  const { gl } = standIn();
  const scene = new Scene(gl);
  assert.deepEqual([scene.box, scene.describe(), scene.legend()], [null, [], []]);
  const empty = pathThrough([]);
  for (const path of [empty, pathThrough([[0, 0, 0]]), { ...spiral(500), strips: [] }, spiral(500)]) {
    scene.setPath(path);
    const none = new Float32Array();
    scene.setPart({ positions: none, normals: none, indices: new Uint32Array() });
    const holder = [{ length_mm: 5, diameter_mm: 9 }];
    scene.setTool({ shape: "ball", diameter_mm: 6, length_mm: 20, holder });
    scene.setStock({ min: [0, 0, 0], max: [NaN, 1, 1] });
    assert.equal(scene.stock, null);
    scene.setVisible("material", true);
    for (const time of [0, 3, Infinity, 1]) {
      scene.time = time;
      scene.cut();
    }
    scene.highlight(3);
    scene.highlight(null);
    const camera = cameraAt(0, 0, false);
    assert.doesNotThrow(() => scene.hit(camera.ray(400, 300), 7));
    scene.restore();
  }
  scene.setStock({ min: [-50, -50, -2], max: [50, 50, 0] });
  assert.equal(scene.obstacle, null);
  scene.setPath({ ...spiral(500), axes: new Float32Array(1500).fill(0.577) });
  assert.match(scene.obstacle, /leans/);
  assert.deepEqual(scene.describe().length, 4);
});
