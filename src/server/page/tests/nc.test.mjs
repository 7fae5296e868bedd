// Checks of the program's text that need no document: its lines, and what is found in it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { lineStarts, ProgramText } from "../nc.js";
import { lineAt, timeOf } from "../player.js";
import { pathThrough } from "./view-aids.mjs";

/** Finds in a text as the page does. */
function find(text, wanted, lit = 0) {
  const program = Object.assign(Object.create(ProgramText.prototype), { text, starts: lineStarts(text), lit });
  return program.find(wanted);
}

test("a text is found behind the lit line, else from the start, in capitals or not", () => {
  const text = "G0 X1\nG1 Y2\ng1 z3\nM30\n";
  assert.equal(find(text, "g1"), 2);
  assert.equal(find(text, "G1", 2), 3);
  assert.equal(find(text, "G1", 3), 2);
  assert.equal(find(text, "M30", 4), 4);
  assert.equal(find(text, "G2"), 0);
  assert.equal(find(text, ""), 0);
});

test("signs that mean something in patterns stand for themselves", () => {
  const text = "X1.5\n(a+b)\n#1=[2*3]\nX165\n";
  assert.equal(find(text, "1.5", 1), 1);
  assert.equal(find(text, "(a+"), 2);
  assert.equal(find(text, "[2*3]"), 3);
  assert.equal(find(text, "$"), 0);
});

test("lines start behind each end of a line", () => {
  assert.deepEqual([...lineStarts("a\nbb\n\nc")], [0, 2, 5, 6]);
  assert.deepEqual([...lineStarts("")], [0]);
});

test("the line of a move is found by the time, and the time by the line", () => {
  const path = pathThrough([[0, 0, 0], [10, 0, 0], [10, 5, 0], [10, 5, 0], [0, 5, 0]]);
  path.blocks = Uint32Array.from([0, 4, 7, 8, 8]);
  assert.deepEqual([0, 3, 10, 12, 15, 20, 25, 99].map((seconds) => lineAt(path, seconds)), [0, 4, 4, 7, 7, 8, 8, 0]);
  assert.deepEqual([4, 7, 8, 5, 0].map((line) => timeOf(path, line)), [10, 15, 15, null, null]);
});
