// Calls every operation of the service at the given address with openapi-fetch and the types of the contract:
// JSON in and out, programs as text in and out, and refusals with their places.

import createClient from "openapi-fetch";

import * as bodies from "./bodies.js";
import type { operations, paths } from "./contract.js";

declare const process: { argv: string[] };
const [address] = process.argv.slice(2);
const client = createClient<paths, "application/json" | "application/problem+json">({ baseUrl: address ?? "" });
const PROGRAM = "G21 G90\nG0 X0 Y0 Z5\nG1 X10 F500\nX20\nM2\n";
const AS_TEXT = { bodySerializer: (text: unknown) => String(text), headers: { "content-type": "text/x-gcode" } };

/** The operations that were called. */
const called = new Set<keyof operations>();

/** What an operation answers; fails where it is refused. */
async function got<T>(name: keyof operations, answer: Promise<{ data?: T; error?: unknown }>): Promise<NonNullable<T>> {
  const { data, error } = await answer;
  if (data === undefined || data === null) throw new Error(`${name}: ${JSON.stringify(error)}`);
  called.add(name);
  return data;
}

function check(holds: boolean, what: string): void {
  if (!holds) throw new Error(what);
}

const mill = await got("millSurface", client.POST("/v1/surfaces/mill", { body: bodies.mill }));
check(mill.report.n_passes === 2 && (mill.measures?.total_time_s ?? 0) > 0, "millSurface");
const drop = await got("dropCutter", client.POST("/v1/surfaces/drop", { body: bodies.drop }));
check(drop.report.tips.length === 1, "dropCutter");
const model = await got("modelSurface", client.POST("/v1/surfaces/model", { body: bodies.model }));
check(model.report.n_patches === 1, "modelSurface");
const plan = await got("planPocket", client.POST("/v1/pockets/plan", { body: bodies.plan, params: { query: { points: true } } }));
check(plan.report.levels.length === 1 && (plan.polyline?.length ?? 0) > 2, "planPocket");
const inspected = await got("inspectPart", client.POST("/v1/parts/inspect", { body: bodies.inspect }));
check(inspected.report.points?.grid?.n_rows === 2, "inspectPart");
const smooth = await got("smoothPath", client.POST("/v1/five-axis/smooth", { body: bodies.smooth }));
check(smooth.report.within_tolerance, "smoothPath");
const curve = await got("interpolateCurve", client.POST("/v1/curves/interpolate", { body: bodies.interpolate }));
check(curve.report.deviation_max_mm <= 0.1, "interpolateCurve");
await got("fitArcs", client.POST("/v1/arcs/fit", { body: bodies.fit }));
await got("putArcs", client.PUT("/v1/arcs/fit", { body: bodies.put }));
await got("readProgram", client.POST("/v1/programs/read", { body: bodies.read }));
const verdict = await got("verifyProgram", client.POST("/v1/programs/verify", { body: bodies.verify }));
check(["pass", "fail", "undecided"].includes(verdict.report.verdict), "verifyProgram");
// A toolpath of an answer is the request of another operation.
check(mill.toolpath !== undefined, "the answer has no toolpath");
if (mill.toolpath) {
  const body = { ...bodies.again(mill.toolpath), cutting: { feed_mm_per_min: 500 } };
  const query = { format: "json" } as const;
  const written = await got("writeProgram", client.POST("/v1/programs/write", { body, params: { query } }));
  check(typeof written === "object" && (written.nc ?? "").includes("G1"), "writeProgram");
}

// Text out, and text in.
const program: string = await got("millSurface", client.POST("/v1/surfaces/mill", {
  body: bodies.mill, params: { query: { format: "gcode" } }, parseAs: "text",
}));
check(program.includes("M30"), "no program as text");
const read = await got("readProgram", client.POST("/v1/programs/read", { body: PROGRAM, ...AS_TEXT }));
check(read.measures?.cutting_length_mm === 20, "readProgram of text");
const fitted: string = await got("fitArcs", client.POST("/v1/arcs/fit", {
  body: PROGRAM, ...AS_TEXT, params: { query: { tolerance_mm: 0.01, dialect: "linuxcnc" } }, parseAs: "text",
}));
check(fitted.includes("M2"), "fitArcs of text");

// What has no body.
const limits = await got("getLimits", client.GET("/v1/limits"));
check(limits.workers >= 1, "getLimits");
const dialects = await got("listDialects", client.GET("/v1/dialects"));
check(dialects.dialects.some(({ name }) => name === dialects.default), "listDialects");
await got("listMachines", client.GET("/v1/machines"));
await got("listControls", client.GET("/v1/dnc"));
await got("getContract", client.GET("/openapi.json"));
const { error } = await client.POST("/v1/surfaces/mill", { body: { ...bodies.mill, tolerance_mm: -1 } });
check(error?.errors[0]?.pointer === "#/tolerance_mm", "the refusal names no place");
const unknown = await client.POST("/v1/dnc/{target}", { params: { path: { target: "none" } }, body: PROGRAM, ...AS_TEXT });
check(unknown.error?.code === "not_found", `sendProgram: ${unknown.error?.code}`);

console.log(`TypeScript: openapi-fetch called ${called.size} operations, and read and sent programs as text`);
