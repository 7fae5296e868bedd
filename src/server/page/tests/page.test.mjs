// Checks of what the page takes in and gives out: links, commands, files, and programs that are opened.
import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateRawSync } from "node:zlib";
import { programName } from "../downloads.js";
import { fragmentOf, requestOf } from "../link.js";
import { withText } from "../open.js";
import { curl, fileOf, Problem, run } from "../run.js";
import { TEXTS } from "../texts.js";
import { contract } from "./forms.mjs";

const operation = "/v1/arcs/fit";

/** The fragment of any text, as a stranger would make it. */
const packed = (text) => `#${deflateRawSync(text).toString("base64url")}`;

test("a request comes back from its link", async () => {
  for (const body of [{ name: "Fräse", polyline: [[0, 1.5], [2, 3]] }, {}, null, [1], "text"]) {
    assert.deepEqual(await requestOf(await fragmentOf({ operation, body })), { operation, body });
  }
  const wild = Array.from({ length: 30_000 }, (_, k) => Math.sin(k));
  assert.equal(await fragmentOf({ operation, body: wild }), null);
});

test("a hostile link holds no request", async () => {
  const nested = (depth) => `{"operation":"${operation}","body":${"[".repeat(depth)}${"]".repeat(depth)}}`;
  assert.notEqual(await requestOf(packed(nested(20))), null);
  const large = `{"operation":"${operation}","body":"${"x".repeat(50_000_000)}"}`;
  const bad = ["", "#", "#%%%", "#AAAA", packed("no JSON"), packed("null"), packed("[]"), packed('{"operation":1}'),
    packed(nested(100)), packed(nested(200_000)), packed(large)];
  for (const fragment of bad) assert.equal(await requestOf(fragment), null, fragment.slice(0, 30));
  // A link that cannot be opened is not made.
  const deep = JSON.parse(nested(100));
  assert.equal(await fragmentOf(deep), null);
  assert.equal(await fragmentOf({ operation, body: "x".repeat(5_000_000) }), null);
});

test("a body that no command can hold is read from a file", () => {
  const short = curl("http://here/v1?format=json", '{"name":"it\'s"}', "request.json");
  assert.deepEqual(short, {
    needsFile: false,
    command: `curl -s "http://here/v1?format=json" -H "Content-Type: application/json" --data-binary '{"name":"it'\\''s"}'`,
  });
  const long = curl("http://here/v1", `"${"ä".repeat(60_000)}"`, "request.json");
  assert.ok(long.needsFile && long.command.endsWith(" --data-binary @request.json"), long.command.slice(0, 200));
});

test("the file of a program has the name of the program", () => {
  const names = [{ program: { name: "Deckel 7.1" } }, { program: { name: "../a\\b:c" } }, { program: { name: ".." } }, {}, null];
  assert.deepEqual(names.map(programName), ["Deckel 7.1.nc", "abc.nc", "program.nc", "program.nc", "program.nc"]);
});

test("a program is opened by the operation that needs nothing else, or by the chosen one", () => {
  const named = (path) => contract.operations.find((one) => one.path === path);
  const opened = withText(contract, named("/v1/pockets/plan"), {}, "nc", "G0 X1");
  assert.deepEqual([opened.operation.path, opened.body], ["/v1/programs/read", { nc: "G0 X1" }]);
  const kept = withText(contract, named("/v1/programs/verify"), { tolerance_mm: 1, toolpath: {} }, "nc", "G0 X1");
  assert.deepEqual([kept.operation.path, kept.body], ["/v1/programs/verify", { tolerance_mm: 1, nc: "G0 X1" }]);
  assert.equal(withText(contract, named("/v1/pockets/plan"), {}, "cl", "GOTO/0,0,0").operation.path, "/v1/five-axis/smooth");
});

/** Answers the next requests of the page. @param {() => Response | Promise<Response>} answer */
function serve(answer) {
  globalThis.fetch = async () => answer();
}

test("another form of an answer is a file with the service's name, and a refusal tells its detail", async () => {
  serve(() => new Response("G0", { headers: { "content-disposition": 'attachment; filename="program-1.ngc"' } }));
  assert.equal((await fileOf("/v1/x", "gcode", {})).name, "program-1.ngc");
  serve(() => new Response("{}"));
  assert.equal((await fileOf("/v1/x", "json", {})).name, "answer.json");
  serve(() => Response.json({ title: "Refused", detail: "too large" }, { status: 422 }));
  await assert.rejects(fileOf("/v1/x", "svg", {}), (error) => error instanceof Problem && error.message === "too large");
  serve(() => { throw new TypeError("Failed to fetch"); });
  await assert.rejects(fileOf("/v1/x", "svg", {}), { message: TEXTS.noService });
});

test("a run tells its progress, and ends with the answer or with the problem", async () => {
  const asked = () => {
    const told = [];
    const request = { path: "/v1/x", query: {}, body: "{}", signal: new AbortController().signal };
    return { told, answer: run({ ...request, onprogress: ({ stage }) => told.push(stage) }) };
  };
  const stream = (...events) => new Response(events.map(([event, data]) => `event: ${event}\ndata: ${JSON.stringify(data)}\n\n`)
    .join(""), { headers: { "content-type": "text/event-stream" } });
  serve(() => stream(["progress", { stage: "reading" }], ["result", { report: {} }]));
  const good = asked();
  assert.deepEqual([await good.answer, good.told], [{ report: {} }, ["reading"]]);
  serve(() => stream(["problem", { status: 422, detail: "no", errors: [{ pointer: "#/a", code: "b", detail: "c" }] }]));
  await assert.rejects(asked().answer, (error) => error.message === "no" && error.errors[0].pointer === "#/a");
  serve(() => stream(["progress", { stage: "reading" }]));
  await assert.rejects(asked().answer, Problem);
  serve(() => { throw new DOMException("aborted", "AbortError"); });
  await assert.rejects(asked().answer, { name: "AbortError" });
});
