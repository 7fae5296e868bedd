// Checks how the page tells figures: names, units, digits, tables, and courses over time.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Charts } from "../charts/charts.js";
import { courseOf, lineOf, rangeOf, ticks, valueAt } from "../charts/course.js";
import { clock, digits, placeText, shortDigits } from "../figures.js";
import { unitOf } from "../form/names.js";
import { readNumber } from "../form/number.js";
import { bytesOf, readModel } from "../glb.js";
import { isPlace, labelOf, turning, unitInName, unitInReport } from "../names.js";
import { showReport } from "../report.js";
import { TEXTS } from "../texts.js";
import { creases } from "../view/creases.js";
import { KINDS } from "../view/types.js";
import { FakeElement, useFakeDocument } from "./form-dom.mjs";
import { pathThrough } from "./view-aids.mjs";

test("names are told in words, and their units are those that machinists write", () => {
  const units = {
    feed_mm_per_min: "mm/min", acceleration_mm_per_s2: "mm/s²", jerk_max_mm_per_s3: "mm/s³", speed_mm_per_s: "mm/s",
    turn_deg_per_s: "°/s", curvature_max_concave_per_mm: "1/mm", uncut_area_mm2: "mm²", stock_volume_mm3: "mm³",
    angle_deg: "°", spindle_rpm: "1/min", time_s: "s", sample_period_ms: "ms", share_percent: "%", feed_mm_per_tooth: "mm/tooth",
    n_bytes: "", n_arcs: "", elements_per_pass: "", offset_section: "", mm: "",
  };
  for (const [name, unit] of Object.entries(units)) {
    assert.equal(unitInName(name), unit, name);
    assert.equal(unitOf(name, []), unit, name);
  }
  const names = ["uncut_area_mm2", "curvature_max_concave_per_mm", "n_bytes", "part_id", "no_spindle_speed", "max", "s"];
  assert.deepEqual(names.map(labelOf), ["Uncut area", "Curvature max concave", "Number of bytes", "Part ID",
    "No spindle speed", "Max", "S"]);
  assert.equal(unitOf("angle", ["An angle, in degrees."]), "°");
});

test("figures of a report have the unit of what is around them", () => {
  const told = [["bound", "mm"], ["pass", "mm"], ["at", "mm³"], ["excess_at", ""], ["speed", ""], ["least", "mm³"], ["max", ""]]
    .map(([name, outer]) => unitInReport(name, outer));
  assert.deepEqual(told, ["mm", "", "mm", "mm", "mm/s", "mm³", ""]);
  assert.deepEqual(["mm/s²", "mm", "mm³", ""].map(turning), ["°/s²", "°", "mm³", ""]);
});

test("numbers have four digits that matter, and counts all", () => {
  const told = [0, -0, 12345, 1234.5678, 24462130.67, 0.0123456, 0.00000123, -3.14159, NaN].map(digits);
  const wanted = ["0", "0", "12\u202f345", "1\u202f235", "24\u202f460\u202f000", "0.01235", "1.23e-6", "-3.142", "NaN"];
  assert.deepEqual(told, wanted);
  assert.deepEqual([80_907_600, -2.5e5, 99_999].map(shortDigits), ["8.091·10⁷", "-2.5·10⁵", "99\u202f999"]);
  assert.deepEqual([12_000, 24_462_130.67, 1234.5].map(digits).map((text) => readNumber(text)), [12_000, 24_460_000, 1235]);
  assert.deepEqual([clock(61.25), clock(3725)], ["01:01.2", "1:02:05"]);
});

test("places keep micrometres, wherever they lie", () => {
  const places = [123.456, -1234.5678, 0.00004, -0.0001, 7, NaN].map(placeText);
  assert.deepEqual(places, ["123.456", "-1\u202f234.568", "0", "0", "7", "NaN"]);
  const names = ["at", "scallop_at", "bounds", "centroid", "end", "z_mm", "top_z_mm", "feed", "format", "cell_mm"];
  assert.deepEqual(names.filter(isPlace), names.slice(0, 7));
});

test("a report is shown with units, nested figures and rows", () => {
  useFakeDocument();
  const host = new FakeElement("div");
  const charts = new FakeElement("details");
  const answer = {
    engine_version: "1", warnings: [{ code: "coarse_samples", detail: "see `path`" }],
    report: {
      gouge_max_mm: { bound: 0.25, at: [123.4567, 2, 3], pass: 0 }, chosen: "zigzag_stock_offset",
      bounds: { min: [-1234.5678, 0, 0] },
      axis_peaks: [{ axis: "X", speed: 25 }, { axis: "B", speed: 7.5 }],
    },
  };
  showReport(host, answer, charts);
  const text = host.all().filter(({ tag }) => ["td", "th", "li", "code"].includes(tag)).map((node) => node.textContent);
  const parts = ["Coarse samples: see path", "path", "Gouge max", "0.25 mm", "123.457, 2, 3 mm", "-1\u202f234.568, 0, 0 mm",
    "zigzag stock offset", "25 mm/s", "7.5°/s", "Speed"];
  for (const part of parts) {
    assert.ok(text.includes(part), `${part} is not in ${text.join(" | ")}`);
  }
  assert.ok(host.contains(charts));
});

test("the value of a course at a time is between its neighbours, or holds since the time before", () => {
  const course = courseOf([[0, 1], [2, 3], [4, 3]]);
  assert.deepEqual([0, 1, 2, 4, 4.1].map((seconds) => valueAt(course, seconds)), [1, 2, 3, 3, NaN]);
  assert.equal(valueAt({ ...course, isStepped: true }, 1), 3);
  assert.deepEqual(rangeOf([course, courseOf([[0, -1]])]), [-1, 3]);
  assert.ok(Number.isNaN(valueAt(courseOf([]), 0)));
});

test("diagrams of the motion are linked to the program by their clock", () => {
  useFakeDocument();
  globalThis.ResizeObserver = class { observe() {} };
  const asked = [];
  const charts = new Charts((seconds) => asked.push(seconds));
  // The motion begins after a way in of 2 s, takes 4 s, and is 3 s long in the program.
  const clock = [[0, 2], [2, 4], [4, 5]];
  charts.show(pathThrough([[0, 0, 0], [0, 0, 9]]), [{ name: "feed, mm/min", before: [], after: [[0, 1], [4, 2]], clock }]);
  const motionAt = (seconds) => {
    charts.setTime(seconds);
    return charts.motion.seconds;
  };
  assert.deepEqual([0, 2, 3, 4.5, 5, 9].map(motionAt), [0, 0, 1, 3, 4, 4]);
  charts.motion.charts[0].seconds = 0;
  charts.motion.charts[0].area.dispatch("keydown", { key: "End" });
  charts.motion.charts[0].area.dispatch("keydown", { key: "Home" });
  assert.deepEqual(asked, [5, 2]);
});

test("diagrams without a clock have a cursor of their own, and those of the path are linked to the program", () => {
  useFakeDocument();
  globalThis.ResizeObserver = class { observe() {} };
  const asked = [];
  const charts = new Charts((seconds) => asked.push(seconds));
  const path = pathThrough([[0, 0, 0], [0, 0, 9]]);
  charts.show(path, [{ name: "feed, mm/min", before: [], after: [[0, 1], [4, 2]], clock: [] }]);
  assert.deepEqual([charts.program, charts.motion].map((group) => group.charts.map(({ name, end }) => [name, end])),
    [[["Feed", 9], ["Z of the tip", 9]], [["Feed", 4]]]);
  assert.ok(charts.motion.element.textContent.includes(TEXTS.charts.motion));
  charts.setTime(3);
  charts.motion.charts[0].area.dispatch("keydown", { key: "End" });
  assert.deepEqual([charts.program.seconds, charts.motion.seconds, asked], [3, 4, []]);
  charts.program.charts[0].area.dispatch("keydown", { key: "End" });
  assert.deepEqual(asked, [9]);
  charts.show(path, []);
  assert.deepEqual([charts.program.element.hidden, charts.motion.element.hidden], [false, true]);
});

test("a line keeps its extremes in few points, and has gaps where there is no value", () => {
  const n = 100_000;
  const times = Float32Array.from({ length: n }, (_, k) => k);
  const value = (k) => (k === 31_234 ? 9 : k >= 50_000 && k < 60_000 ? NaN : k % 2);
  const line = lineOf({ times, value, isStepped: false }, (seconds) => seconds / 500, (height) => height);
  assert.equal(line.match(/M/g).length, 2);
  assert.ok(line.match(/[ML]/g).length <= 4 * 200, "at most four points in a column");
  assert.match(line, /L62\.\d 9\.0/);
  assert.equal(lineOf(courseOf([[0, 1], [9, 2]]), (t) => t, (y) => y), "M0.0 1.0L9.0 2.0");
  const stepped = { ...courseOf([[0, 1], [9, 2]]), isStepped: true };
  assert.equal(lineOf(stepped, (t) => t, (y) => y), "M0.0 1.0L0.0 2.0L9.0 2.0");
});

test("ticks are round numbers inside of the range", () => {
  assert.deepEqual(ticks(0, 1, 4), [0, 0.5, 1]);
  assert.deepEqual(ticks(-0.35, 0.35, 4), [-0.2, 0, 0.2]);
  assert.deepEqual(ticks(0, 0.3, 3), [0, 0.1, 0.2, 0.3]);
  assert.deepEqual(ticks(5, 5, 3), [5]);
  for (const [low, high] of [[-17, 3000], [1e-5, 3e-5], [1e7, 8e7]]) {
    const found = ticks(low, high, 4);
    assert.ok(found.length >= 2 && found.length <= 5 && found.every((x) => x >= low - 1e-9 && x <= high + 1e-9));
  }
});

/** A binary glTF file of a path with one pass. */
function fileOf(extras, attributes, pass = "pass 1") {
  const entries = Object.entries(attributes);
  const numbers = Float32Array.from(entries.flatMap(([, values]) => values));
  let at = 0;
  const accessors = entries.map(([name, values]) => {
    const shape = name === "POSITION" ? { count: values.length / 3, type: "VEC3" } : { count: values.length, type: "SCALAR" };
    const accessor = { bufferView: 0, byteOffset: at, componentType: 5126, ...shape };
    at += 4 * values.length;
    return accessor;
  });
  const json = JSON.stringify({
    scenes: [{ nodes: [0] }],
    nodes: [{ children: [1], extras }, { name: "path", children: [2] }, { name: pass, mesh: 0, extras: { level: 0 } }],
    meshes: [{ primitives: [{ attributes: Object.fromEntries(entries.map(([name], k) => [name, k])) }] }],
    accessors, bufferViews: [{ byteLength: numbers.byteLength }],
  });
  const text = json.padEnd(Math.ceil(json.length / 4) * 4);
  const bytes = Buffer.alloc(28 + text.length + numbers.byteLength);
  for (const [k, word] of [0x46546c67, 2, bytes.length, text.length, 0x4e4f534a].entries()) bytes.writeUInt32LE(word, 4 * k);
  bytes.write(text, 20);
  bytes.writeUInt32LE(numbers.byteLength, 20 + text.length);
  bytes.writeUInt32LE(0x004e4942, 24 + text.length);
  Buffer.from(numbers.buffer).copy(bytes, 28 + text.length);
  return bytesOf(bytes.toString("base64"));
}

test("times, diagrams and an assumed stock are read from the file", () => {
  const attributes = { POSITION: [0, 0, 0, 1, 0, 0], _TIME: [0, 2] };
  const plain = readModel(fileOf({ metres_per_unit: 0.001 }, attributes));
  assert.deepEqual([plain.diagrams, plain.isStockAssumed], [[], false]);
  assert.deepEqual([plain.path.strips[0].pass, plain.path.strips[0].level], [1, 1]);
  const diagrams = [{ name: "feed, mm/min", after: [[0, 1]] }];
  const clock = [[0, 0.5], [1, 1.5]];
  const extras = { metres_per_unit: 0.001, stock_is_assumed: true, diagrams, clock };
  const told = readModel(fileOf(extras, attributes));
  assert.deepEqual(told.diagrams, [{ name: "feed, mm/min", before: [], after: [[0, 1]], clock }]);
  assert.ok(told.isStockAssumed);
  assert.deepEqual([...told.path.times], [0, 2]);
});

test("kinds are read by their names, and the number of a pass stands in its name", () => {
  const attributes = { POSITION: Array(12).fill(0), _TIME: [0, 1, 2, 3], _KIND: [0, 1, 2, 3] };
  const kinds = ["cut", "turn", "spiral", "rapid"];
  const { path } = readModel(fileOf({ metres_per_unit: 0.001, kinds }, attributes, "pass 7, level 1 of 2"));
  assert.deepEqual([...path.kinds].map((k) => KINDS[k]), ["cut", "turn", "cut", "rapid"]);
  assert.equal(path.strips[0].pass, 7);
  const plain = readModel(fileOf({ metres_per_unit: 0.001 }, attributes)).path;
  assert.deepEqual([[...plain.kinds], plain.strips[0].pass], [[0, 1, 2, 3], 1]);
});

test("deviations are read where they are known, and null where a file has none", () => {
  const attributes = { POSITION: Array(9).fill(0), _TIME: [0, 1, 2], _DEVIATION: [-1, 0, 0.25] };
  const { path } = readModel(fileOf({ metres_per_unit: 0.001 }, attributes));
  assert.deepEqual([...path.deviations], [NaN, 0, 0.25]);
  const plain = readModel(fileOf({ metres_per_unit: 0.001 }, { POSITION: [0, 0, 0], _TIME: [0] })).path;
  assert.equal(plain.deviations, null);
});

test("a strip is parted where the way is not known", () => {
  const attributes = { POSITION: Array(18).fill(0), _TIME: [0, 1, 1, 1, 2, 3], _KIND: [0, 0, 1, 1, 0, 0] };
  const { path } = readModel(fileOf({ metres_per_unit: 0.001, kinds: ["cut", "unknown"] }, attributes, "pass 9"));
  assert.deepEqual(path.strips.map(({ first, count, pass }) => [first, count, pass]), [[0, 2, 9], [3, 3, 9]]);
});

test("a prism of many sides has its rims as edges, and a lone triangle all of its sides", () => {
  const sides = 48;
  const ring = (z) => Array.from({ length: sides }, (_, k) =>
    [Math.cos((2 * Math.PI * k) / sides), Math.sin((2 * Math.PI * k) / sides), z]);
  const positions = Float32Array.from([...ring(0), ...ring(1), [0, 0, 0], [0, 0, 1]].flat());
  const indices = Uint32Array.from(Array.from({ length: sides }, (_, k) => {
    const next = (k + 1) % sides;
    return [k, next, sides + next, k, sides + next, sides + k, next, k, 2 * sides, sides + k, sides + next, 2 * sides + 1];
  }).flat());
  assert.equal(creases({ positions, indices }).length / 6, 2 * sides);
  assert.equal(creases({ positions, indices: Uint32Array.from([0, 1, 2]) }).length / 6, 3);
});
