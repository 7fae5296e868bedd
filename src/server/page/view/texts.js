// Every text of the view that people see.

export const TEXTS = {
  noWebGL: "This browser draws no WebGL2, so there is no 3D view.",
  kinds: /** @type {Record<string, string>} */ ({
    rapid: "Rapid", cut: "Cut", plunge: "Plunge", ramp: "Ramp", lead_in: "Lead-in", link: "Link",
    lead_out: "Lead-out", dwell: "Dwell",
  }),
  feed: "Feed", feedUnit: "mm/min", noFeed: "Rapid or no feed told",
  deviation: "Deviation", deviationUnit: "mm", noDeviation: "No deviation told",
  level: "Level", noLevel: "Without level",
  left: "Left on the part", gouged: "Cut into the part",
  material: {
    noStock: "The material is not shown: the stock is unknown.",
    noTool: "The material is not shown: the tool is unknown.",
    fiveAxes: "The material is not shown: the tool leans, and the view cuts with an upright tool only.",
  },
  axes: /** @type {const} */ (["X", "Y", "Z"]),
  scale: (/** @type {string} */ grid, /** @type {string[]} */ size) =>
    `Grid ${grid} mm; size ${size.join(" × ")} mm`,
  keys: "Arrows turn, Shift and arrows move, + and - zoom, 1 to 7 are views, F shows all.",
  noPicture: "The browser gave no picture.",
  nothing: "3D view: nothing to show.",
  shown: (/** @type {string[]} */ parts) => `3D view: ${parts.join("; ")}.`,
  path: (/** @type {number} */ n, /** @type {string[]} */ kinds) =>
    `path of ${n.toLocaleString("en")} stretches (${kinds.join(", ").toLowerCase()})`,
  part: "part",
  stock: (/** @type {string[]} */ size) => `stock ${size.join(" × ")} mm`,
  removal: "material as it is cut",
  tool: (/** @type {string} */ shape, /** @type {string} */ d) => `${shape.replace("_", " ")} cutter ${d} mm`,
  toolAt: (/** @type {string[]} */ place, /** @type {string} */ time) =>
    `tip at X ${place[0]} Y ${place[1]} Z ${place[2]} mm after ${time} s`,
  seen: { perspective: "in perspective", orthographic: "without perspective" },
};
