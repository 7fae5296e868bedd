// The smallest body of each operation. The bodies must compile with the types that are generated from the
// contract.

import type { components, operations } from "./contract.js";

type Body<Operation extends keyof operations> = operations[Operation] extends {
  requestBody: { content: { "application/json": infer Json } };
}
  ? Json
  : never;

type Answer<Operation extends keyof operations> = operations[Operation] extends {
  responses: { 200: { content: { "application/json": infer Json } } };
}
  ? Json
  : never;

const surface: components["schemas"]["Surface"] = {
  kind: "point_grid",
  points: [
    [[0, 0, 0], [0, 1, 0]],
    [[10, 0, 0], [10, 1, 0]],
  ],
};

const tool: components["schemas"]["Tool"] = { shape: "ball", diameter_mm: 6 };

export const fit: Body<"fitArcs"> = {
  polyline: [[0, 0], [10, 0], [20, 0]],
  tolerance_mm: 0.01,
};

export const put: Body<"putArcs"> = fit;

export const interpolate: Body<"interpolateCurve"> = {
  curve: { kind: "graph", expression: "sin(x)", domain: [0, 6.5] },
  method: "linear",
  band: { below_mm: 0.1, above_mm: 0.1 },
};

export const drop: Body<"dropCutter"> = { surface, tool, points: [[5, 0.5]] };

export const mill: Body<"millSurface"> = {
  surface,
  tool,
  strategy: { kind: "cl_cartesian", stepover_mm: 2 },
  tolerance_mm: 0.01,
  cutting: { feed_mm_per_min: 500 },
};

export const plan: Body<"planPocket"> = {
  region: { boundary: [[0, 0], [50, 0], [50, 30, 0.5], [0, 30]] },
  floor_z_mm: -3,
  stepdown_max_mm: 3,
  tool: { shape: "flat", diameter_mm: 8 },
  stepover_mm: 3,
  cutting: { feed_mm_per_min: 800 },
};

// Outlines with an arc by its radius and as a section curve, and a tool with its body.
export const planned: Body<"planPocket"> = {
  ...plan,
  region: {
    boundary: [[0, 0], [50, 0], { to: [50, 30], radius_mm: 20 }, [0, 30]],
    islands: ["l(10,10) r(20,10,2) l(20,20) l(10,20)"],
  },
  tool: {
    shape: "flat",
    diameter_mm: 8,
    flute_length_mm: 20,
    length_mm: 35,
    n_flutes: 3,
    max_rpm: 18_000,
    holder: [{ length_mm: 40, diameter_mm: 20, top_diameter_mm: 32 }],
  },
  machine: { max_rpm: 12_000 },
  entry: { at: [40, 15], predrilled_diameter_mm: 10 },
};

// Several pockets, each level of both before the next level.
export const several: Body<"planPocket"> = {
  regions: [
    { boundary: [[0, 0], [30, 0], [30, 30], [0, 30]] },
    { boundary: [[40, 0], [60, 0], [60, 30], [40, 30]] },
  ],
  order: "level_first",
  sequence: "as_given",
  floor_z_mm: -4,
  stepdown_max_mm: 2,
  tool: { shape: "flat", diameter_mm: 8 },
  stepover_mm: 3,
  cutting: { feed_mm_per_min: 800 },
};

// Files in base64, in place of a region and on their own.
export const inspect: Body<"inspectPart"> = { file: { name: "a.xyz", base64: btoa("0 0 0\n0 9 1\n9 0 1\n9 9 0\n") }, units: "mm" };

export const drawn: Body<"planPocket"> = {
  ...several,
  regions: [{ kind: "file", name: "plate.dxf", layer: "POCKETS", units: "mm" }],
};

export const model: Body<"modelSurface"> = { surface };

export const smooth: Body<"smoothPath"> = {
  path: [
    { tip: [0, 0, 0], axis: [0, 0, 1] },
    { tip: [10, 0, 0], axis: [0, 0, 1] },
  ],
  feed_mm_per_min: 800,
  tolerance_mm: 0.01,
  tolerance_deg: 0.5,
};

export const read: Body<"readProgram"> = { nc: "G21 G90\nG0 X0 Y0 Z5\nG1 X10 F500\nM2\n" };

export const verify: Body<"verifyProgram"> = {
  nc: "G21 G90\nG1 X10 F500\nM2\n",
  start: [0, 0, 0],
  tool: { shape: "flat", diameter_mm: 4 },
  stock: { kind: "box", min: [0, -5, -9], max: [10, 5, 1] },
  tolerance_mm: 0.01,
};

export const write: Body<"writeProgram"> = {
  toolpath: {
    start: [0, 0, 5],
    passes: [{ moves: [{ kind: "line", to: [0, 0, -1], feed_mm_per_min: 100 }] }],
  },
};

// `kind` tells the objects of a union apart.
export function length(move: components["schemas"]["Move"]): number {
  switch (move.kind) {
    case "rapid":
    case "line":
      return move.to.length;
    case "arc":
      return move.center.length;
    case "parabola":
      return move.control.length;
    case "turn":
      return move.axis.length;
    case "dwell":
      return move.seconds;
  }
}

// Does not compile when an operation with a body is missing above.
type Built = "fitArcs" | "putArcs" | "interpolateCurve" | "dropCutter" | "millSurface" | "modelSurface" | "inspectPart" | "planPocket" | "readProgram" | "smoothPath" | "verifyProgram" | "writeProgram";
type WithBody = { [Name in keyof operations]: Body<Name> extends never ? never : Name }[keyof operations];
export const every: WithBody extends Built ? true : never = true;

export function passes(answer: Answer<"millSurface">): number {
  return answer.report.n_passes + answer.warnings.length + (answer.toolpath?.passes.length ?? 0);
}

// An answer leaves out what is absent, and never holds `null` there.
export function time(answer: Answer<"millSurface">): number | undefined {
  return answer.measures?.total_time_s;
}

// What an answer holds in any case may be `null`, where the service sends `null`.
export function rest(answer: Answer<"millSurface">): number | null {
  return answer.report.rest_max_mm;
}

// A toolpath from an answer may be sent. A request may hold `null` for what is absent.
export function again(toolpath: NonNullable<Answer<"millSurface">["toolpath"]>): Body<"writeProgram"> {
  return { toolpath, cutting: null };
}

// @ts-expect-error: a ruled surface has no points.
export const wrong: components["schemas"]["Surface"] = { kind: "ruled", points: [] };
