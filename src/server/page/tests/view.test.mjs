// Checks of the 3D view that need no browser: camera, path, pick, colours and scene.

import assert from "node:assert/strict";
import { test } from "node:test";
import { VIEWS } from "../view/camera.js";
import { colorTable, countKinds, KIND_COLORS, legendRows, paint, rgb } from "../view/colors.js";
import { gridOf } from "../view/grid.js";
import { parseColor } from "../view/labels.js";
import { add, boxOf, corners, dot, norm, placed, roundDown, scale, sub } from "../view/math.js";
import { PathBoxes } from "../view/pick.js";
import { Scene } from "../view/scene.js";
import { isJoined, isUpright, MARK, marksOf, poseAt, simplify, thinned, vertexAfter } from "../view/timeline.js";
import { KINDS } from "../view/types.js";
import { cameraAt, near, pathThrough, project, randomNumbers, spiral, standIn, toSegment, transformed } from "./view-aids.mjs";

for (const orthographic of [false, true]) {
  const name = orthographic ? "orthographic" : "perspective";

  test(`${name}: matrices, project and ray tell the same place`, () => {
    const camera = cameraAt(0.7, -0.3, orthographic);
    const { view, projection } = camera.matrices();
    for (const point of [[0, 0, 0], [60, 30, 10], [-20, 0, -4]]) {
      const seen = transformed(view, point);
      const [x, y, z, w] = transformed(projection, seen);
      const place = project(camera, point);
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
    const place = project(camera, point);
    near(place.x, 650, 1e-6);
    near(place.y, 120, 1e-6);
  });

  test(`${name}: turning keeps the pivot where it is seen`, () => {
    const camera = cameraAt(0.2, 0.1, orthographic);
    const pivot = [40, -5, 12];
    const before = project(camera, pivot);
    camera.orbit(1.1, -0.4, pivot);
    const after = project(camera, pivot);
    near(after.x, before.x, 1e-6);
    near(after.y, before.y, 1e-6);
  });

  test(`${name}: every standard view shows the whole box and fills the picture`, () => {
    const camera = cameraAt(0, 0, orthographic);
    for (const view of Object.keys(VIEWS)) {
      assert.ok(camera.look(view));
      const places = corners(camera.box).map((corner) => project(camera, corner));
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
  assert.ok(project(camera, [1, 0, 0]).x > project(camera, [0, 0, 0]).x);
  assert.ok(project(camera, [0, 1, 0]).y < project(camera, [0, 0, 0]).y);
  camera.look("front");
  assert.ok(project(camera, [0, 0, 1]).y < project(camera, [0, 0, 0]).y);
  assert.ok(project(camera, [0, -1, 0]).depth < project(camera, [0, 0, 0]).depth);
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
    strips: [{ first: 0, count: 60, pass: 0, level: null },
      { first: 60, count: 30, pass: 0, level: null }],
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
    kinds: [1, 200, 7], strips: [{ first: -3, count: 99, pass: 0, level: null }],
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

test("levels and feeds have colours, also without values", () => {
  const path = pathThrough([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], {
    strips: [{ first: 0, count: 2, pass: 0, level: 1 },
      { first: 2, count: 2, pass: 0, level: 2 }],
  });
  path.feeds = Float32Array.from([0, 100, 300, 200]);
  const marks = marksOf(path);
  const entries = () => [0, 1, 2, 3].map((i) => marks[MARK * i + 1]);
  const feed = paint(path, marks, "feed");
  // No stretch ends at the first vertex, so nothing has the colour of its missing feed.
  assert.deepEqual([feed.from, feed.to, feed.unknown], [100, 300, false]);
  assert.deepEqual(entries(), [0, 1, 255, 128]);
  const level = paint(path, marks, "level");
  assert.deepEqual(level.levels, [1, 2]);
  assert.deepEqual(entries(), [1, 1, 255, 255]);
  const counts = countKinds(path.positions, marks);
  const rows = legendRows(level, counts, () => true);
  assert.deepEqual(rows.map(({ label, key }) => [label, key]), [["Level 1", null], ["Level 2", null], ["Cut", "cut"]]);
  assert.deepEqual(rows.at(-1).colors, []);
  path.feeds.fill(0);
  const none = legendRows(paint(path, marks, "feed"), counts, () => true);
  assert.deepEqual(none.map(({ type, key }) => [type, key]), [["swatch", null], ["swatch", "cut"]]);
  const kinds = legendRows(paint(path, marks, "kind"), counts, (key) => key !== "cut");
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
      scene.cut(50);
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
