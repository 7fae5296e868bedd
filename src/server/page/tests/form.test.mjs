// Checks the form against the contract: every example is shown as a whole, and comes out as it went in.
import assert from "node:assert/strict";
import { test } from "node:test";
import { contractOf } from "../contract.js";
import { fieldOf } from "../form/field.js";
import { JsonText } from "../form/json.js";
import { canShow, fieldAt, shownAs } from "../form/tree.js";
import { valueAt } from "../form/value.js";
import { FakeElement } from "./form-dom.mjs";
import { contract, example, formOf, inputOf, named, ofClass, openAll } from "./forms.mjs";

const examples = contract.operations.flatMap((operation) =>
  [...operation.examples].map(([name, value]) => ({ name: `${operation.id} ${name}`, operation, value })));

/** All paths of a value, those of its parts included. */
function pathsOf(value, path = []) {
  const inner = typeof value === "object" && value !== null
    ? Object.entries(value).flatMap(([name, part]) =>
      pathsOf(part, [...path, Array.isArray(value) ? Number(name) : name]))
    : [];
  return [path, ...inner];
}

test("the contract lists every operation with a JSON body once", () => {
  assert.equal(contract.operations.length, new Set(contract.operations.map(({ path }) => path)).size);
  assert.ok(contract.operations.every(({ path }) => path.startsWith("/v1/") && !path.startsWith("/v1/dnc")));
  assert.ok(examples.length >= 66);
});

test("a new operation appears by itself, and a reference may lead on to another", () => {
  const { operations, resolve } = contractOf({
    paths: { "/v1/new": { post: { summary: "New.", requestBody: { content: { "application/json": {
      schema: { $ref: "#/components/schemas/A" }, examples: { one: { value: { n: 1 } } },
    } } } } } },
    components: { schemas: {
      A: { $ref: "#/components/schemas/B", description: "outer" }, B: { type: "object" },
    } },
  });
  assert.equal(operations[0].title, "New");
  assert.deepEqual(operations[0].examples.get("one"), { n: 1 });
  assert.deepEqual(resolve(operations[0].schema), { type: "object", description: "outer" });
  assert.deepEqual(contractOf({}).operations, []);
  assert.deepEqual(resolve({ $ref: "#/nowhere/at/all" }), {});
});

test("the tree of fields knows every part of every example, and shows none of it as JSON", () => {
  for (const { name, operation, value } of examples) {
    const root = fieldOf(contract.resolve, operation.schema);
    for (const path of pathsOf(value)) {
      const field = fieldAt(root, value, path);
      assert.ok(field, `${name}: ${path.join("/")}`);
      assert.notEqual(shownAs(field, valueAt(value, path)).kind, "json", `${name}: ${path.join("/")}`);
    }
  }
});

test("the form shows every example, and tells nothing before anything is typed", () => {
  for (const { name, operation, value } of examples) {
    const before = JSON.stringify(value);
    const { form, host, told } = formOf(operation, value);
    openAll(host);
    assert.equal(JSON.stringify(form.value), before, name);
    assert.equal(form.problems, 0, name);
    assert.deepEqual(told, [], name);
    form.show(operation, structuredClone(value));
    assert.deepEqual(told, [], name);
  }
});

test("every input of every example, typed again, gives the same value in the same order", () => {
  for (const { name, operation, value } of examples) {
    const { form, host } = formOf(operation, value);
    openAll(host);
    for (const input of host.all().filter(({ tag }) => ["input", "select", "textarea"].includes(tag))) {
      const text = input.value;
      if (text === "" || !host.contains(input)) continue;
      input.type(text);
      assert.equal(JSON.stringify(form.value), JSON.stringify(value), `${name}: ${input.id} ${text}`);
    }
  }
});

test("a member that is emptied and typed again keeps its place; other members are not touched", () => {
  const { operation, value } = example("/v1/pockets/plan", "rectangle");
  const { form, host } = formOf(operation, value);
  const input = inputOf(host, "Feed", "Cutting");
  input.type("");
  assert.ok(!("feed_mm_per_min" in form.value.cutting));
  input.type("812,5");
  assert.equal(input.value, "812,5");
  assert.deepEqual(form.value.cutting, { ...value.cutting, feed_mm_per_min: 812.5 });
  assert.deepEqual(Object.keys(form.value), Object.keys(value));
  assert.deepEqual(Object.keys(form.value.cutting), Object.keys(value.cutting));
  assert.equal(form.value.region, value.region);
  input.type("12x");
  assert.equal(input.getAttribute("aria-invalid"), "true");
  assert.equal(form.value.cutting.feed_mm_per_min, "12x");
  input.type("-1");
  assert.match(input.parentElement.parentElement.textContent, /Allowed: 0\.001 to 1000000 mm\/min/);
});

test("an optional object is added and removed by buttons", () => {
  const { operation, value } = example("/v1/pockets/plan", "rectangle");
  const { form, host } = formOf(operation, value);
  openAll(host);
  const press = (label) => {
    const buttons = host.all().filter(({ tag }) => tag === "button");
    buttons.find((node) => (node.getAttribute("aria-label") ?? node.textContent) === label).dispatch("click");
  };
  press("Add Stock");
  assert.deepEqual(form.value.stock, { kind: "box" });
  const kind = inputOf(host, "Kind", "Stock");
  kind.type("cylinder");
  assert.deepEqual(form.value.stock, { kind: "cylinder" });
  inputOf(host, "Diameter", "Stock").type("40");
  inputOf(host, "Top z", "Stock").type("1");
  kind.type("outline");
  assert.deepEqual(form.value.stock, { kind: "outline", top_z_mm: 1 });
  kind.type("cylinder");
  assert.deepEqual(form.value.stock, { kind: "cylinder", diameter_mm: 40, top_z_mm: 1 });
  press("Remove Stock");
  assert.deepEqual(form.value, value);
  press("Add Entry");
  inputOf(host, "Ramp angle", "Entry").type("3");
  assert.deepEqual(form.value.entry, { ramp_angle_deg: 3 });
  const entry = fieldAt(fieldOf(contract.resolve, operation.schema), form.value, ["entry"]);
  assert.ok(host.textContent.includes(`${entry.members().length} more`));
});

test("errors stand at the fields that they name, in closed sections too", () => {
  const { operation, value } = example("/v1/pockets/plan", "rectangle");
  const { form, host } = formOf(operation, value);
  const errors = [
    { pointer: "#/tool/diameter_mm", code: "out_of_range", detail: "too wide" },
    { pointer: "#/entry", detail: "no entry" },
    { pointer: "#/allowance_mm", detail: "too much" },
    { pointer: "#/region/boundary/3/1", detail: "too far" },
    { pointer: "#/region/islands/0/2", detail: "not there" },
    { pointer: "#/unknown/member", detail: "unknown" },
    { pointer: "", detail: "all of it" },
  ];
  form.setErrors(errors);
  const diameter = inputOf(host, "Diameter", "Tool");
  assert.equal(document.activeElement, diameter);
  assert.equal(diameter.getAttribute("aria-invalid"), "true");
  const described = diameter.getAttribute("aria-describedby").split(" ");
  assert.ok(host.all().some((node) => described.includes(node.id) && node.textContent === "too wide"));
  const texts = ofClass(host, "form-error").filter((node) => !node.hidden).map((node) => node.textContent);
  for (const { detail } of errors) assert.ok(texts.some((text) => text.includes(detail)), detail);
  assert.equal(ofClass(host, "form-errors")[0].querySelectorAll("li").length, 7);
  form.clearErrors();
  assert.equal(form.problems, 0);
});

test("an error of an entry far down a list opens its page, and one of a variant stands at its choice", () => {
  const { operation, value } = example("/v1/five-axis/smooth", "table");
  value.path = Array.from({ length: 1000 }, () => value.path[0]);
  const { form, host } = formOf(operation, value);
  form.setErrors([{ pointer: "#/path/777/tip/1", detail: "too far" }]);
  assert.ok(host.querySelectorAll("summary").some((node) => node.textContent.startsWith("Pose 778:")));
  document.activeElement.type("5");
  assert.equal(form.value.path[777].tip[1], 5);
  assert.equal(form.value.path[776], value.path[776]);
  const mill = example("/v1/surfaces/mill", "one-pass");
  const other = formOf(mill.operation, mill.value);
  other.form.setErrors([{ pointer: "#/strategy/kind", detail: "unknown" }]);
  assert.equal(document.activeElement.tag, "select");
  assert.equal(document.activeElement.value, "cl_cartesian");
  other.form.setErrors([{ pointer: "#/surface", detail: "odd" }]);
  assert.equal(document.activeElement.value, "point_grid");
});

test("a table takes what is pasted, and holds few rows of a long list", () => {
  const { operation, value } = example("/v1/arcs/fit", "contour");
  value.polyline = Array.from({ length: 100_000 }, (_, at) => [at, at % 7]);
  const { form, host } = formOf(operation, value);
  const rows = () => host.all().filter((node) => node.tag === "tr").length;
  assert.ok(rows() < 100);
  const scroller = ofClass(host, "form-table")[0];
  scroller.scrollTop = 30 * 50_000;
  scroller.dispatch("scroll");
  assert.ok(rows() < 100);
  const cell = named(host, "Row 50001, x mm");
  cell.type("1,25");
  assert.deepEqual(form.value.polyline[50_000], [1.25, 50_000 % 7]);
  cell.dispatch("paste", { clipboardData: { getData: () => "7\t8\n9\t10\n" } });
  assert.deepEqual(form.value.polyline.slice(50_000, 50_003), [[7, 8], [9, 10], [50_002, 50_002 % 7]]);
  scroller.scrollTop = 0;
  scroller.dispatch("scroll");
  const first = named(host, "Row 1, x mm");
  first.focus();
  first.dispatch("paste", { clipboardData: { getData: () => "x;y\n1,5;2\n3;4,5\nend" } });
  assert.deepEqual(form.value.polyline, [[1.5, 2], [3, 4.5]]);
  assert.match(host.textContent, /2 rows of 2 numbers, separated by semicolons, decimal comma; header: x, y/);
  ofClass(host, "form-button").find((node) => node.textContent === "Undo" && !node.hidden).dispatch("click");
  assert.equal(form.value.polyline.length, 100_000);
  const taken = form.takePoints("# measured\nx\ty\tz\n1\t2\t3\n\n4\t5\t6\n");
  assert.deepEqual(form.value.polyline, [[1, 2, 3], [4, 5, 6]]);
  assert.deepEqual([taken.label, taken.note],
    ["Polyline", "2 rows of 3 numbers, separated by tabs, whole numbers; header: x, y, z."]);
  for (const text of ["nothing", "1 2 3 4", "1"]) assert.equal(form.takePoints(text), null, text);
});

test("keys move between the cells of a table, add rows and remove them", () => {
  const { operation, value } = example("/v1/arcs/fit", "contour");
  const { form, host } = formOf(operation, value);
  const count = value.polyline.length;
  const press = (key, more = {}) => document.activeElement.dispatch("keydown", { key, ...more });
  const isAt = (label) => assert.equal(document.activeElement.getAttribute("aria-label"), label);
  named(host, "Row 1, x mm").focus();
  press("ArrowDown");
  isAt("Row 2, x mm");
  press("ArrowUp");
  press("ArrowUp");
  isAt("Row 1, x mm");
  press("Insert");
  isAt("Row 2, x mm");
  assert.deepEqual(form.value.polyline[1], [null, null]);
  document.activeElement.type("3");
  assert.deepEqual(form.value.polyline[1], [3, null]);
  press("Delete", { ctrlKey: true });
  assert.deepEqual(form.value.polyline, value.polyline);
  press("End", { ctrlKey: true });
  press("Enter");
  assert.equal(form.value.polyline.length, count + 1);
  isAt(`Row ${count + 1}, x mm`);
});

test("another example of the same operation brings the members that it sets to the top", () => {
  const { operation, value } = example("/v1/pockets/plan", "rectangle");
  const { form, host } = formOf(operation, value);
  const other = operation.examples.get("regions");
  const top = () => ofClass(host, "form-members")[0].children.map((node) => node.textContent);
  form.show(operation, other);
  assert.ok(top().some((text) => text.startsWith("×Regions")));
  assert.equal(top().length, Object.keys(other).length);
  form.show(operation, value);
  assert.equal(top().length, Object.keys(value).length);
});

test("form and JSON follow each other", () => {
  const { operation, value } = example("/v1/curves/interpolate", "band-of-x");
  const { form, host } = formOf(operation, value);
  const area = new FakeElement("textarea");
  host.append(area);
  const json = new JsonText(area, { onchange: (next) => form.show(operation, next) });
  json.set(form.value);
  assert.deepEqual(JSON.parse(area.value), value);
  area.type(JSON.stringify({ ...value, tool: { shape: "ball", diameter_mm: 5 } }));
  assert.equal(inputOf(host, "Diameter", "Tool").value, "5");
  area.type('{\n  "curve": ]');
  assert.equal(area.getAttribute("aria-invalid"), "true");
  assert.equal(form.value.tool.diameter_mm, 5);
  area.type("[1, 2]");
  assert.deepEqual(form.value, [1, 2]);
  area.type(JSON.stringify(value));
  assert.deepEqual(form.value, value);
  const large = { nc: "G1 X1\n".repeat(100_000) };
  json.set(large);
  assert.ok(area.readOnly && area.value.length < 2000);
});

test("any JSON can be shown for any operation", () => {
  const values = [null, 1, "a", [], {}, [[]],
    { region: 1, tool: [], cutting: null, meta: { a: 1 }, surface: { kind: "no" } },
    { region: { boundary: [[0, 0], { to: [1, 1], radius_mm: 1 }, "x"] }, path: [1, null] },
    { toolpath: { passes: {} }, machine: { rotary: [1, {}] } },
  ];
  for (const operation of contract.operations) {
    for (const value of values) {
      const { form, host } = formOf(operation, value);
      openAll(host);
      form.setErrors([{ pointer: "#/region/boundary/1/to/0", detail: "wrong" }]);
      assert.equal(form.value, value);
    }
  }
});

test("every field is named, and its unit is not repeated", () => {
  const seen = new Set();
  const walk = (field, depth) => {
    if (depth > 9 || seen.has(`${field.name} ${depth}`)) return;
    seen.add(`${field.name} ${depth}`);
    assert.ok(depth === 0 || field.label !== "", field.name);
    assert.ok(canShow(field, undefined));
    for (const member of field.members()) walk(member, depth + 1);
    for (const shape of field.shapes()) walk(shape.field(), depth + 1);
    if (["list", "points", "map"].includes(field.kind)) walk(field.item(), depth + 1);
  };
  for (const { schema } of contract.operations) walk(fieldOf(contract.resolve, schema), 0);
  const { operation } = example("/v1/pockets/plan", "rectangle");
  const root = fieldOf(contract.resolve, operation.schema);
  const feed = fieldAt(root, { cutting: {} }, ["cutting", "plunge_feed_mm_per_min"]);
  assert.deepEqual([feed.label, feed.unit, feed.fallback, feed.min, feed.required],
    ["Plunge feed", "mm/min", "half of feed_mm_per_min", 0.001, false]);
  assert.match(fieldAt(root, {}, ["direction"]).choices[0].help, /^on the right of the cutter/);
});

test("a schema that refers to itself, and one that nobody understands, give fields", () => {
  const { resolve } = contractOf({ components: { schemas: {
    Tree: { type: "object", properties: { inner: { $ref: "#/components/schemas/Tree" }, odd: { not: {} } } },
    Loop: { $ref: "#/components/schemas/Loop" },
  } } });
  const tree = fieldOf(resolve, { $ref: "#/components/schemas/Tree" });
  assert.equal(fieldAt(tree, { inner: { inner: {} } }, ["inner", "inner", "odd"]).kind, "json");
  assert.equal(fieldOf(resolve, { $ref: "#/components/schemas/Loop" }).kind, "json");
});
