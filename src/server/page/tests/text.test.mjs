// Checks how the form reads tables, numbers and JSON, and how it changes values.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { contractOf } from "../contract.js";
import { abridged, brief, formatJson, isLonger, parseJson } from "../form/jsontext.js";
import { numberProblem, readNumber, typedValue } from "../form/number.js";
import { understood } from "../form/pastebox.js";
import { columnCount, withBlock, withCell, withoutRow, withRow } from "../form/rows.js";
import { pathOf, withMember, withValueAt } from "../form/value.js";
import { opened } from "../open.js";
import { gridOf, parseTable } from "../paste.js";
import { FORM_TEXTS, TEXTS } from "../texts.js";

const file = new URL("../../../../openapi/openapi.json", import.meta.url);
const contract = contractOf(JSON.parse(readFileSync(file, "utf8")));

test("tables of text are read with the separator and the decimal sign of the whole text", () => {
  const read = (text, width) => {
    const { rows, separator, decimal } = parseTable(text, width);
    return [rows, separator, decimal];
  };
  assert.deepEqual(read("1,5;2,5"), [[[1.5, 2.5]], ";", ","]);
  assert.deepEqual(read("1.5,2.5"), [[[1.5, 2.5]], ",", "."]);
  assert.deepEqual(read("1,5\t2\n3\t4"), [[[1.5, 2], [3, 4]], "\t", ","]);
  assert.deepEqual(read("1,5 2,5\n\n-3e1 +4"), [[[1.5, 2.5], [-30, 4]], " ", ","]);
  assert.deepEqual(read("1,5, 2,5"), [[[1.5, 2.5]], ",", ","]);
  assert.deepEqual(read("0\n1,5\n2"), [[[0], [1.5], [2]], "", ","]);
  assert.deepEqual(read("0,0\n10,0,0.4\n10,10"), [[[0, 0], [10, 0, 0.4], [10, 10]], ",", "."]);
  assert.deepEqual(read('"1,5","2,5"'), [[[1.5, 2.5]], ",", ","]);
  assert.deepEqual(read("1,2"), [[[1, 2]], ",", ""]);
  assert.deepEqual(read("1,2", { least: 1, most: 1 }), [[[1.2]], "", ","]);
  assert.deepEqual(read("1;2;\n3;4;"), [[[1, 2], [3, 4]], ";", ""]);
  assert.deepEqual(read(""), [[], "", ""]);
  assert.ok(parseTable("1,2").isAmbiguous);
  assert.ok(!parseTable("1,2,3\n4,5,6").isAmbiguous);
  const { rows, header, skipped } = parseTable("x y z\n# points\n1 2 3\nend 1\n4 5 6 # last\n7;8");
  assert.deepEqual([rows, header], [[[1, 2, 3], [4, 5, 6]], ["x", "y", "z"]]);
  assert.deepEqual(skipped.map(({ line }) => line), [4, 6]);
  const told = understood(parseTable("1,5\t2\n3\t4"));
  assert.equal(told, "2 rows of 2 numbers, separated by tabs, decimal comma");
  const long = parseTable(`${"1;2\n".repeat(30_000)}1,5;2,5`);
  assert.deepEqual([long.rows.length, long.rows.at(-1), long.decimal], [30_001, [1.5, 2.5], ","]);
});

test("an opened file is known by its text", () => {
  const kinds = {
    json: ['{"nc": "G0 X1"}', " {}\n"],
    table: ["x,y,z\n1,2,3\n", "X;Y\n1,5;2\n3;4", "1\t2\n3\t4", "# comment\n\n0 0\n1 0\n", "[[1, 2], [3, 4]]",
      "point 1\n1 2\n3 4\n5 6", "\uFEFF1;2;3\r\n4;5;6\r\n"],
    nc: ["%\nO0001\nN10 G0 X1 Y2\nX5\n", "G1X1Y2F100", "0 BEGIN PGM A MM\n1 L X+1 Y+2", "(only)\nG0\n", "/N5 X-.5"],
    cl: ["$$ a blade\nPARTNO/BLADE\nUNITS/MM\nGOTO/1,2,3,0,0,1\n"],
    unknown: ["", "Dear reader,\nthis is a letter.", "[1, 2", "[]"],
  };
  for (const [kind, texts] of Object.entries(kinds)) for (const text of texts) assert.equal(opened(text).kind, kind, text);
  assert.equal(opened("[[1, 2], [3, 4]]").text, "1\t2\n3\t4");
});

test("points are split into the rows of a grid", () => {
  const grid = [[[0, 0, 1], [0, 5, 2]], [[9, 0, 3], [9, 5, 4]], [[18, 0, 3], [18, 5, 4]]];
  const lines = (row) => row.map((point) => point.join(" ")).join("\n");
  const text = (rows, between) => rows.map(lines).join(between);
  assert.deepEqual(gridOf(parseTable(text(grid, "\n\n"))), { rows: grid, by: "blank" });
  assert.deepEqual(gridOf(parseTable(text(grid, "\n"))), { rows: grid, by: "0" });
  assert.deepEqual(gridOf(parseTable("1 2 3\n2 3 4")).by, "none");
});

test("numbers are read with a comma or a point, and their problems told", () => {
  const read = (...texts) => texts.map((text) => readNumber(text));
  assert.deepEqual(read("1,5", " -2. ", ".5", "1e3", "\u22124"), [1.5, -2, 0.5, 1000, -4]);
  assert.deepEqual(read("12\u202f000", "1\u00a0234\u00a0567,5", "\u202f"), [12_000, 1_234_567.5, null]);
  assert.deepEqual(read("", "1,000.5", "1e999", "x", "-", "1 2"), Array(6).fill(null));
  assert.deepEqual([typedValue(" "), typedValue("4x"), typedValue("4")], [undefined, "4x", 4]);
  const range = { kind: "integer", min: 1, max: 6, unit: "" };
  assert.deepEqual([1, undefined].map((value) => numberProblem(value, range)), ["", ""]);
  for (const value of [0, 7, 1.5, "x"]) assert.notEqual(numberProblem(value, range), "");
});

test("values are changed without touching the rest", () => {
  const value = { a: { b: [1, { c: 2 }] }, d: {} };
  const next = withValueAt(value, ["a", "b", 1, "c"], 3);
  assert.deepEqual(next, { a: { b: [1, { c: 3 }] }, d: {} });
  assert.equal(next.d, value.d);
  assert.deepEqual(Object.keys(withMember({ a: 1, c: 3 }, "b", 2, ["a", "b", "c"])), ["a", "b", "c"]);
  assert.deepEqual(withMember({ a: 1, b: 2 }, "a", undefined), { b: 2 });
  assert.deepEqual(pathOf("#/a~1b/0/%20c/01"), ["a/b", 0, " c", "01"]);
  assert.deepEqual([pathOf(""), pathOf("#"), pathOf("#/%zz")], [[], [], ["%zz"]]);
  const points = { kind: "points", least: 2, most: 3 };
  assert.deepEqual(withCell(points, [[1, 2, 3]], 0, 2, undefined), [[1, 2]]);
  assert.deepEqual(withCell(points, [[1, 2]], 0, 1, undefined), [[1, null]]);
  assert.deepEqual(withBlock(points, [[1, 2]], 0, 1, [[8], [9]]), [[1, 8], [null, 9]]);
  assert.deepEqual(withRow({ kind: "numbers", least: 4 }, [1], 1), [1, null]);
  assert.deepEqual([withoutRow([1, 2, 3], 1), columnCount(points, [[1, 2, 3, 4]])], [[1, 3], 4]);
});

test("JSON is written to be read, and its errors are found", () => {
  for (const { examples } of contract.operations) {
    for (const value of examples.values()) {
      assert.equal(JSON.stringify(JSON.parse(formatJson(value))), JSON.stringify(value));
    }
  }
  const place = (text) => {
    const parsed = parseJson(text);
    return "line" in parsed ? [parsed.line, parsed.column] : parsed.value;
  };
  assert.deepEqual(place('{"a": 1,\n "b" 2}'), [2, 6]);
  assert.deepEqual(place('{"a": [1, 2,]}'), [1, 13]);
  assert.deepEqual(place('{"a": "x\n"}'), [1, 7]);
  assert.deepEqual(place("[1] 2"), [1, 5]);
  assert.deepEqual(place('{"a": 01}'), [1, 8]);
  assert.deepEqual(place("{,}"), [1, 2]);
  assert.deepEqual([place(""), place("{"), place("tru")], [[1, 1], [1, 2], [1, 1]]);
  const large = { points: Array.from({ length: 300_000 }, () => [1, 2, 3]) };
  assert.ok(isLonger(large, 300_000) && !isLonger(large.points[0], 300));
  assert.ok(abridged(large).length < 1000);
});

test("page and form tell a file that is too large in the same words, with their own limits", () => {
  assert.equal(TEXTS.fileTooLarge, FORM_TEXTS.fileTooLarge);
  assert.match(TEXTS.fileTooLarge("a.csv", 64_000_000), /^a\.csv is too large .* at most 64 MB/);
});

test("the heading of an entry counts what brackets in brackets hold", () => {
  assert.equal(brief([[0, 0, 1], [10, 0, 2]]), "2 entries");
  assert.equal(brief([0, 1.5]), "[0, 1.5]");
});
