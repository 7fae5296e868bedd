// Checks what the picture tells beside the path: which kinds there are, when all is shown anew, and the axis cross.

import assert from "node:assert/strict";
import { test } from "node:test";
import { VIEW_TEXTS } from "../texts.js";
import { showLegend, Toolbar } from "../toolbar.js";
import { countKinds, KIND_COLORS, paint } from "../view/colors.js";
import { crossEnds } from "../view/grid.js";
import { marksOf } from "../view/timeline.js";
import { KINDS } from "../view/types.js";
import { isElsewhere } from "../view/view.js";
import { FakeElement, useFakeDocument } from "./form-dom.mjs";
import { cameraAt, near, pathThrough } from "./view-aids.mjs";

const kind = (name) => KINDS.indexOf(name);

test("each kind has a name and a colour of its own", () => {
  assert.equal(new Set(KINDS.map((name) => VIEW_TEXTS.kinds[name])).size, KINDS.length);
  assert.equal(new Set(KIND_COLORS).size, KINDS.length);
});

test("only kinds that are seen are counted: moves with a length, and pauses as points", () => {
  const path = pathThrough([[0, 0, 0], [0, 0, 0], [9, 0, 0], [9, 0, 0], [9, 0, 0]], {
    kinds: ["rapid", "rapid", "cut", "dwell", "turn"].map(kind),
  });
  const marks = marksOf(path);
  const counts = countKinds(path.positions, marks);
  assert.deepEqual(KINDS.filter((_, k) => counts[k] > 0), ["cut", "dwell", "turn"]);
  path.feeds.set([0, 0]);
  assert.equal(paint(path, marks, "feed").unknown, false);
  path.feeds[2] = 0;
  assert.equal(paint(path, marks, "feed").unknown, true);
});

test("a path is coloured by the deviations that are known", () => {
  const path = pathThrough([[0, 0, 0], [3, 0, 0], [6, 0, 0], [9, 0, 0]], { kinds: ["rapid", "cut", "cut", "cut"].map(kind) });
  const marks = marksOf(path);
  path.deviations = new Float32Array([NaN, 0, 0.004, NaN]);
  const { known, unknown, from, to } = paint(path, marks, "deviation");
  assert.deepEqual([known, unknown, from, Math.fround(0.004)], [true, true, 0, to]);
  path.deviations = null;
  assert.equal(paint(path, marks, "deviation").known, false);
});

test("a scene is elsewhere where it moves by half of its size, or is much larger or smaller", () => {
  const box = (x, size) => ({ min: [x, 0, 0], max: [x + size, size, size] });
  assert.ok(!isElsewhere(box(0, 10), box(0, 10)));
  assert.ok(!isElsewhere(box(2, 12), box(0, 10)));
  for (const [x, size] of [[20, 10], [0, 20], [0, 5]]) assert.ok(isElsewhere(box(x, size), box(0, 10)), `${x} ${size}`);
});

test("a box of the legend keeps the focus when it is switched", () => {
  useFakeDocument();
  const host = new FakeElement("div");
  const switched = [];
  const row = { type: "swatch", dashed: false, visible: true, from: null, to: null, unit: "" };
  const rows = [{ ...row, label: "Level 1", key: null, colors: ["#123456"] }, { ...row, label: "Cut", key: "cut", colors: [] }];
  showLegend(host, { legend: () => rows, setVisible: (...told) => switched.push(told) });
  const box = host.querySelector("input");
  box.focus();
  box.checked = false;
  box.dispatch("change");
  assert.deepEqual(switched, [["cut", false]]);
  assert.ok(host.contains(document.activeElement));
  assert.deepEqual(host.all().filter(({ tag, hidden }) => tag === "span" && hidden).length, 1);
});

test("a view can be chosen again once the picture is turned by hand", () => {
  useFakeDocument();
  globalThis.Option = function option(text, value) {
    return Object.assign(new FakeElement("option"), { textContent: text }, value !== undefined && { id: value });
  };
  const host = new FakeElement("div");
  const view = { onsteer() {} };
  new Toolbar(host, view, () => {});
  const views = host.querySelector("select");
  const shown = views.typed;
  view.onsteer();
  assert.deepEqual([shown, views.typed], ["iso", ""]);
});

test("the axis cross points as the camera looks, and stays in its corner", () => {
  const camera = cameraAt(0, 0, true);
  camera.look("top");
  const before = crossEnds(camera);
  const [x, y, z] = before;
  assert.ok(x.x > z.x && y.y < z.y);
  near(x.y, z.y, 1e-9);
  camera.pan(200, 100);
  camera.zoom(0.1);
  assert.deepEqual(crossEnds(camera), before);
  for (const end of before) assert.ok(end.x > 0 && end.x < 80 && end.y > camera.height - 110 && end.y < camera.height - 25);
});
