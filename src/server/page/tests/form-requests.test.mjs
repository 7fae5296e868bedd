// Checks what the form keeps while one request is edited, and forgets when another one is shown.
import assert from "node:assert/strict";
import { test } from "node:test";
import { contract, example, formOf, inputOf, named, ofClass, openAll } from "./forms.mjs";

const buttonOf = (host, text) => host.all().find((node) => node.tag === "button" && node.textContent === text && !node.hidden);
const errorsOf = (host) => ofClass(host, "form-errors")[0];
const visibleErrors = (host) => ofClass(host, "form-error").filter((node) => !node.hidden).map((node) => node.textContent);

test("a removed object comes back as it was, but not in another request", () => {
  const { operation, value } = example("/v1/pockets/plan", "rectangle");
  const { form, host } = formOf(operation, { ...value, entry: { ramp_angle_deg: 3 } });
  const remove = () => named(host, "Remove Entry").dispatch("click");
  remove();
  assert.equal(form.value.entry, undefined);
  buttonOf(host, "Add Entry").dispatch("click");
  assert.deepEqual(form.value.entry, { ramp_angle_deg: 3 });
  remove();
  form.show(operation, structuredClone(value));
  openAll(host);
  buttonOf(host, "Add Entry").dispatch("click");
  assert.deepEqual(form.value.entry, {});
});

test("another request forgets the undo of a table, and the values of shapes that were chosen before", () => {
  const { operation, value } = example("/v1/arcs/fit", "contour");
  const { form, host } = formOf(operation, value);
  form.takePoints("1;2\n3;4");
  assert.ok(buttonOf(host, "Undo"));
  form.show(operation, structuredClone(value));
  assert.equal(buttonOf(host, "Undo"), undefined);
  assert.doesNotMatch(host.textContent, /2 rows of 2 numbers/);
  const plan = example("/v1/pockets/plan", "rectangle");
  const stocked = { ...plan.value, stock: { kind: "cylinder", diameter_mm: 40 } };
  const other = formOf(plan.operation, stocked);
  const kind = () => inputOf(other.host, "Kind", "Stock");
  kind().type("box");
  other.form.show(plan.operation, structuredClone({ ...stocked, stock: { kind: "box" } }));
  kind().type("cylinder");
  assert.deepEqual(other.form.value.stock, { kind: "cylinder" });
});

test("a change of one entry of a list lets others undo", () => {
  const { operation, value } = example("/v1/pockets/plan", "regions");
  const { form, host } = formOf(operation, value);
  openAll(host);
  const count = form.boxes.length;
  assert.ok(count > 1);
  const { regions } = value;
  form.show(operation, { ...value, regions: [] });
  form.takePoints("1;2");
  assert.ok(form.boxes.length < count, "boxes of fields that are gone are forgotten");
  form.show(operation, { ...value, regions });
  openAll(host);
  form.takePoints("1;2\n3;4\n5;6");
  buttonOf(host, "Add region").dispatch("click");
  assert.ok(buttonOf(host, "Undo"));
});

test("errors on two pages of a list are marked on both, until they are corrected", () => {
  const { operation, value } = example("/v1/five-axis/smooth", "table");
  value.path = Array.from({ length: 50 }, () => ({ ...value.path[0] }));
  const { form, host } = formOf(operation, value);
  form.setErrors([
    { pointer: "#/path/45/tip/1", detail: "too far" }, { pointer: "#/path/3/tip", detail: "too low" },
    { pointer: "#/path/46/tip", detail: "too high" },
  ]);
  const items = () => errorsOf(host).querySelectorAll("li").map((node) => node.textContent);
  assert.deepEqual(items(), ["Path, Pose 46, Tip, y: too far", "Path, Pose 4, Tip: too low", "Path, Pose 47, Tip: too high"]);
  assert.deepEqual(visibleErrors(host), ["too far", "too high"]);
  document.activeElement.type("5");
  assert.equal(form.value.path[45].tip[1], 5);
  assert.deepEqual(items(), ["Path, Pose 4, Tip: too low", "Path, Pose 47, Tip: too high"]);
  buttonOf(host, "Previous").dispatch("click");
  buttonOf(host, "Previous").dispatch("click");
  openAll(host);
  assert.deepEqual(visibleErrors(host), ["too low"]);
  form.show(operation, { ...value, path: value.path.slice(1) });
  assert.deepEqual([visibleErrors(host), errorsOf(host).hidden], [[], true]);
});

test("an error of a row of a table does not stay at another row", () => {
  const { operation, value } = example("/v1/arcs/fit", "contour");
  const { form, host } = formOf(operation, value);
  form.setErrors([{ pointer: "#/polyline/2/1", detail: "too far" }]);
  assert.match(errorsOf(host).textContent, /Polyline, Point 3, y: too far/);
  assert.equal(named(host, "Row 3, y mm").getAttribute("aria-invalid"), "true");
  form.show(operation, { ...value, polyline: value.polyline.slice(1) });
  assert.equal(form.problems, 0);
});

test("an entry of choices that is added shows its choices", () => {
  const { operation, value } = example("/v1/pockets/plan", "rectangle");
  const { form, host } = formOf(operation, { ...value, patterns: ["zigzag"] });
  openAll(host);
  buttonOf(host, "Add pattern").dispatch("click");
  assert.deepEqual(form.value.patterns, ["zigzag", null]);
  assert.equal(document.activeElement.tag, "select");
  assert.equal(host.querySelectorAll("textarea").filter((node) => node.value === "null").length, 0);
});

test("a row is removed only when one of its cells was chosen", () => {
  const { operation, value } = example("/v1/arcs/fit", "contour");
  const { form, host } = formOf(operation, value);
  const remove = buttonOf(host, "Remove row");
  assert.ok(remove.disabled);
  remove.dispatch("click");
  assert.equal(form.value, value);
  named(host, "Row 2, x mm").focus();
  assert.deepEqual([remove.textContent, remove.disabled], ["Remove row 2", false]);
  remove.dispatch("click");
  assert.deepEqual(form.value.polyline, [value.polyline[0], ...value.polyline.slice(2)]);
  document.activeElement = null;
  form.show(operation, structuredClone(value));
  assert.ok(remove.disabled);
});

test("a point with more numbers than the contract knows is shown as a whole", () => {
  const { operation, value } = example("/v1/five-axis/smooth", "table");
  value.path = [{ ...value.path[0], tip: [1, 2, 3, 4] }];
  const { form, host } = formOf(operation, value);
  openAll(host);
  const area = host.querySelectorAll("textarea").find((node) => node.value === "[1, 2, 3, 4]");
  area.type("[1, 2, 3, 5]");
  assert.deepEqual(form.value.path[0].tip, [1, 2, 3, 5]);
});

test("no two elements of a form have the same id", () => {
  for (const operation of contract.operations) {
    for (const value of [...operation.examples.values(), { tool: 1, region: 2, path: [3] }]) {
      const { host } = formOf(operation, value);
      openAll(host);
      const ids = host.all().map(({ id }) => id).filter(Boolean);
      assert.equal(new Set(ids).size, ids.length, ids.find((id, at) => ids.indexOf(id) !== at));
    }
  }
});
