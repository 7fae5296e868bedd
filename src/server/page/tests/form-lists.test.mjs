// Checks lists of the form, and what files that are opened make of the form.
import assert from "node:assert/strict";
import { test } from "node:test";
import { fieldOf } from "../form/field.js";
import { withText } from "../open.js";
import { contract, example, formOf, named, ofClass, openAll } from "./forms.mjs";

test("entries of a list move, are duplicated and removed; those that are open stay open, and the focus goes along", () => {
  const { operation, value } = example("/v1/five-axis/smooth", "table");
  value.path = Array.from({ length: 22 }, (_, at) => ({ tip: [at, 0, 0], axis: [0, 0, 1] }));
  const { form, host } = formOf(operation, value);
  openAll(host);
  const tips = () => form.value.path.map(({ tip }) => tip[0]);
  const opened = () => ofClass(host, "form-entry").map((entry) => entry.querySelector("details"))
    .filter((details) => details?.open).map((details) => details.querySelector("summary").textContent.slice(0, 7));
  const press = (name) => {
    named(host, name).focus();
    named(host, name).dispatch("click");
  };
  const focused = () => document.activeElement.getAttribute("aria-label");
  for (const details of host.querySelectorAll("details")) details.open = details.textContent.startsWith("Pose 2:");
  press("Move Pose 2 up");
  assert.deepEqual(tips().slice(0, 3), [1, 0, 2]);
  assert.deepEqual(opened(), ["Pose 1:"]);
  assert.equal(focused(), "Move Pose 1 down");
  assert.ok(named(host, "Move Pose 1 up").disabled);
  document.activeElement.dispatch("keydown", { key: "ArrowDown", altKey: true });
  assert.deepEqual([tips()[1], focused()], [1, "Move Pose 2 down"]);
  press("Duplicate Pose 2");
  assert.deepEqual(tips().slice(0, 4), [0, 1, 1, 2]);
  assert.notEqual(form.value.path[1], form.value.path[2]);
  document.activeElement.type("9");
  assert.deepEqual(form.value.path[2].tip, [9, 0, 0]);
  press("Remove Pose 3");
  assert.deepEqual([tips()[2], focused()], [2, "Remove Pose 3"]);
  press("Move Pose 20 down");
  assert.deepEqual([tips()[20], focused()], [19, "Move Pose 21 down"]);
  press("Remove Pose 22");
  assert.deepEqual([form.value.path.length, focused()], [21, "Remove Pose 21"]);
  press("Remove Pose 21");
  assert.deepEqual([form.value.path.length, focused()], [20, "Remove Pose 20"]);
});

test("entries of lists have a name in the singular", () => {
  /** @type {Map<string, Set<string>>} */
  const names = new Map();
  const walk = (field, depth) => {
    if (depth > 9) return;
    if (field.kind === "list") names.set(field.label, (names.get(field.label) ?? new Set()).add(field.item().label));
    for (const member of field.members()) walk(member, depth + 1);
    for (const shape of field.shapes()) walk(shape.field(), depth + 1);
    if (["list", "points", "map"].includes(field.kind)) walk(field.item(), depth + 1);
  };
  for (const { schema } of contract.operations) walk(fieldOf(contract.resolve, schema), 0);
  const expected = {
    Islands: "Island", Regions: "Region", Passes: "Pass", Moves: "Move", Holder: "Section", Rotary: "Rotary axis",
    Path: "Pose", Header: "Line", Points: "Row", Patches: "Row", Row: "Patch", Patch: "Row", Cleared: "Emptied place",
  };
  for (const [list, entry] of Object.entries(expected)) assert.deepEqual([...names.get(list)], [entry], list);
  for (const entries of names.values()) for (const entry of entries) assert.doesNotMatch(entry, /[^si]s$/);
});

test("rows of numbers go to the table that they fit; without one, operations with tables are named", () => {
  const drop = example("/v1/surfaces/drop", "grid");
  const { operation, value } = drop.value ? drop : { ...drop, value: [...drop.operation.examples.values()][0] };
  const { form } = formOf(operation, value);
  assert.equal(form.takePoints("1;2\n3;4").label, "Points");
  assert.deepEqual(form.value.points, [[1, 2], [3, 4]]);
  const read = contract.operations.find(({ path }) => path === "/v1/programs/read");
  form.show(read, { nc: "G0 X1" });
  assert.equal(form.takePoints("1;2\n3;4"), null);
  assert.ok(form.withTables().some((title) => title.startsWith("Replace points")));
  assert.ok(!form.withTables().includes(read.title));
});

test("an opened program takes the place of what said the same, in the operation that takes it", () => {
  const of = (path) => contract.operations.find((one) => one.path === path);
  const verify = of("/v1/programs/verify");
  assert.deepEqual(withText(contract, verify, { tolerance_mm: 1, toolpath: {} }, "nc", "G0"),
    { operation: verify, body: { tolerance_mm: 1, nc: "G0" } });
  assert.equal(withText(contract, of("/v1/pockets/plan"), {}, "nc", "G0").operation, of("/v1/programs/read"));
  assert.equal(withText(contract, of("/v1/pockets/plan"), {}, "cl", "GOTO/0,0,0").operation, of("/v1/five-axis/smooth"));
});
