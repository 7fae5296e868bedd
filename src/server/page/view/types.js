// The data that the view draws. Lengths are in mm, times in s, feeds in mm/min; z points up.

/** Kinds of a stretch of the path; `PathData.kinds` holds indices into this list. */
export const KINDS = Object.freeze(
  /** @type {const} */ (["rapid", "cut", "plunge", "ramp", "lead_in", "link", "lead_out", "dwell", "turn"]));

/** @typedef {[number, number, number]} Vec3 */
/** @typedef {{min: Vec3, max: Vec3}} Box */
/** `first` and `count` are vertices; passes and levels are counted from 1.
 *  @typedef {{first: number, count: number, pass: number, level: number|null}} Strip */

/** @typedef {object} PathData
 *  @property {Float32Array} positions   3n, mm
 *  @property {Float32Array} times       n, seconds from the program's start when the tip is at the vertex
 *  @property {Uint8Array} kinds         n, kind of the stretch that ends at the vertex: index into KINDS
 *  @property {Float32Array} feeds       n, mm/min (0: rapid)
 *  @property {Float32Array|null} deviations  n, proved deviation of the stretch that ends at the vertex, mm, NaN where
 *    it is not known; null where none is known
 *  @property {Uint32Array} blocks       n, line of the NC text whose block ends here or later; 0: unknown
 *  @property {Float32Array|null} axes   3n tool axis, null for always +z
 *  @property {Strip[]} strips           connected line strips */

/** @typedef {{positions: Float32Array, normals: Float32Array, indices: Uint32Array}} MeshData */

/** @typedef {{length_mm: number, diameter_mm: number, top_diameter_mm?: number|null}} HolderSection */

/** @typedef {object} ToolData
 *  @property {"ball"|"flat"|"bull_nose"|"v"|"cone"|"drill"} shape
 *  @property {number} diameter_mm
 *  @property {number|null} [corner_radius_mm]
 *  @property {number|null} [tip_angle_deg]     between opposite sides of a `v`
 *  @property {number|null} [point_angle_deg]   between opposite edges of a `drill`
 *  @property {number|null} [taper_angle_deg]   between the side of a `cone` and the axis
 *  @property {number|null} [tip_diameter_mm]
 *  @property {number|null} [flute_length_mm]
 *  @property {number|null} [length_mm]         from the tip to the lower end of the holder
 *  @property {HolderSection[]|null} [holder] */

/** A stretch under the cursor; `point` lies on the stretch.
 *  @typedef {{block: number, kind: string, feed: number, time: number, point: Vec3}} Hit */

/** @typedef {"kind"|"feed"|"deviation"|"level"|"pass"} ColorBy */

/** A row of the legend: a swatch (one colour, or none) or a ramp (`from` to `to`, in `unit`).
 *  `key` is the name that `View.setVisible` takes, or null where nothing can be switched.
 *  @typedef {{type: "swatch"|"ramp", label: string, key: string|null, colors: string[], dashed: boolean,
 *    visible: boolean, from: number|null, to: number|null, unit: string}} LegendRow */
