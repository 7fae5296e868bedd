// Colours of the path: the palette, what a vertex's colour means, and the rows of the legend.

import { isSeen, MARK, vertexCount } from "./timeline.js";
import { at } from "./math.js";
import { KINDS } from "./types.js";
import { VIEW_TEXTS as TEXTS } from "../texts.js";
/** @import { ColorBy, LegendRow, PathData } from "./types.js" */

/** Colours of the kinds; people who see fewer colours tell them apart, on light and on dark ground. */
export const KIND_COLORS = Object.freeze([
  "#82909c", "#2354f5", "#b02520", "#e18400", "#15b07e", "#a03689", "#5f92ff", "#b26a52", "#921daa"]);
/** From low to high. */
const RAMP = ["#2a6fdb", "#7c8cc0", "#b78a55", "#e0650a"];
const UNKNOWN = "#8c929b";
export const LEFT_COLORS = Object.freeze(["#9fb3a6", "#d8a21c", "#d9620f"]);
export const GOUGE_COLOR = "#a3195b";
/** Levels and passes that the legend names one by one; with more it shows a ramp. */
const NAMED_LEVELS = 8;

/** What the colours mean: entry 0 of the table is for what is unknown, 1 to 255 run from `from` to `to`.
 * `known` and `unknown` tell whether there are vertices with and without a value.
 * @typedef {{by: ColorBy, from: number, to: number, known: boolean, unknown: boolean,
 *   levels: number[]}} Coloring */

/** @param {string} hex "#rrggbb" @returns {[number, number, number]} 0 to 1 */
export function rgb(hex) {
  const value = parseInt(hex.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}

/** @param {string[]} stops @param {number} t 0 to 1 @returns {[number, number, number]} */
function between(stops, t) {
  const place = t * (stops.length - 1);
  const i = Math.min(Math.floor(place), stops.length - 2);
  const [a, b] = [rgb(stops[i] ?? UNKNOWN), rgb(stops[i + 1] ?? UNKNOWN)];
  const f = place - i;
  return [a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f, a[2] + (b[2] - a[2]) * f];
}

/** The table of 256 colours that the shader reads, four bytes each. @param {ColorBy} by */
export function colorTable(by) {
  const table = new Uint8Array(1024);
  for (let i = 0; i < 256; i++) {
    const color = by === "kind" ? rgb(KIND_COLORS[i] ?? UNKNOWN)
      : i === 0 ? rgb(UNKNOWN) : between(RAMP, (i - 1) / 254);
    table.set([...color.map((x) => Math.round(x * 255)), 255], 4 * i);
  }
  return table;
}

/** Writes each vertex's entry of the colour table into its mark. @param {PathData} path
 * @param {Uint8Array} marks @param {ColorBy} by @returns {Coloring} */
export function paint(path, marks, by) {
  const n = vertexCount(path);
  if (by === "level" || by === "pass") return paintStrips(path, marks, n, by);
  if (by === "feed") return paintValues(path, marks, path.feeds, by);
  if (by === "deviation") return paintValues(path, marks, path.deviations ?? new Float32Array(0), by);
  for (let i = 0; i < n; i++) marks[MARK * i + 1] = at(marks, MARK * i);
  return { by, from: 0, to: 0, known: true, unknown: false, levels: [] };
}

/** Colours by values of the vertices: a feed of 0 is none, a deviation of 0 is exact.
 * @param {PathData} path @param {Uint8Array} marks @param {Float32Array} values @param {"feed"|"deviation"} by
 * @returns {Coloring} */
function paintValues(path, marks, values, by) {
  const { positions } = path;
  const n = vertexCount(path);
  const isKnown = (/** @type {number} */ x) => (by === "feed" ? x > 0 : x >= 0) && x < Infinity;
  let [from, to, unknown] = [Infinity, -Infinity, false];
  for (let i = 0; i < n; i++) {
    const x = values[i] ?? NaN;
    if (!isKnown(x)) unknown ||= isSeen(positions, marks, i);
    else [from, to] = [x < from ? x : from, x > to ? x : to];
  }
  const known = from <= to;
  if (!known) [from, to] = [0, 0];
  const factor = to > from ? 254 / (to - from) : 0;
  for (let i = 0; i < n; i++) {
    const x = values[i] ?? NaN;
    marks[MARK * i + 1] = isKnown(x) ? 1 + Math.round(factor ? (x - from) * factor : 127) : 0;
  }
  return { by, from, to, known, unknown, levels: [] };
}

/** @param {PathData} path @param {Uint8Array} marks @param {number} n @param {"level"|"pass"} by
 * @returns {Coloring} */
function paintStrips(path, marks, n, by) {
  const told = path.strips.map((strip) => strip[by]).filter((level) => level !== null);
  const levels = [...new Set(told)].sort((a, b) => a - b);
  const rank = new Map(levels.map((level, index) => [level, levelEntry(index, levels.length)]));
  for (let i = 0; i < n; i++) marks[MARK * i + 1] = 0;
  let unknown = false;
  for (const strip of path.strips) {
    const { first, count, [by]: level } = strip;
    const entry = level === null ? 0 : rank.get(level) ?? 0;
    unknown ||= entry === 0;
    const end = Math.min(first + count, n);
    for (let i = Math.max(first, 0); i < end; i++) marks[MARK * i + 1] = entry;
  }
  const [from, to] = [levels[0] ?? 0, levels.at(-1) ?? 0];
  return { by, from, to, known: levels.length > 0, unknown, levels };
}

/** @param {number} index @param {number} count */
const levelEntry = (index, count) => 1 + Math.round(count > 1 ? (254 * index) / (count - 1) : 127);

/** @param {Partial<LegendRow> & {label: string, colors: string[]}} row @returns {LegendRow} */
const row = (row) =>
  ({ type: "swatch", key: null, dashed: false, visible: true, from: null, to: null, unit: "", ...row });

/** The rows that explain the path's colours, and one for each kind, which is switched there.
 * @param {Coloring} coloring @param {Uint32Array} counts stretches of each kind
 * @param {(key: string) => boolean} isVisible @returns {LegendRow[]} */
export function legendRows(coloring, counts, isVisible) {
  const kinds = KINDS.flatMap((key, kind) => (at(counts, kind) === 0 ? [] : [row({
    label: TEXTS.kinds[key] ?? key, key, dashed: key === "rapid", visible: isVisible(key),
    colors: coloring.by === "kind" ? [KIND_COLORS[kind] ?? UNKNOWN] : [],
  })]));
  return [...meanings(coloring), ...kinds];
}

/** The rows that explain colours of something else than the kind. @param {Coloring} coloring @returns {LegendRow[]} */
function meanings(coloring) {
  const { by, from, to, levels } = coloring;
  if (by === "kind") return [];
  const unknown = { feed: TEXTS.noFeed, deviation: TEXTS.noDeviation, level: TEXTS.noLevel, pass: TEXTS.noPass }[by];
  const rest = coloring.unknown ? [row({ label: unknown, colors: [UNKNOWN] })] : [];
  if ((by === "level" || by === "pass") && levels.length <= NAMED_LEVELS) {
    return [...levels.map((level, i) => row({
      label: `${TEXTS[by]} ${level}`,
      colors: [hex(between(RAMP, (levelEntry(i, levels.length) - 1) / 254))],
    })), ...rest];
  }
  const unit = by === "feed" ? TEXTS.feedUnit : by === "deviation" ? TEXTS.deviationUnit : "";
  const ramp = row({ type: "ramp", label: TEXTS[by], colors: RAMP, from, to, unit });
  return coloring.known ? [ramp, ...rest] : rest;
}

/** The rows that explain the colours of the material against the part.
 * @param {number} most mm of the last colour @returns {LegendRow[]} */
export const materialRows = (most) => [
  row({
    type: "ramp", label: TEXTS.left, colors: [...LEFT_COLORS], from: 0, to: most, unit: TEXTS.leftUnit,
  }),
  row({ label: TEXTS.gouged, colors: [GOUGE_COLOR] }),
];

/** @param {[number, number, number]} color */
const hex = (color) => `#${color.map((x) => Math.round(x * 255).toString(16).padStart(2, "0")).join("")}`;

/** Stretches of each kind that are seen. @param {Float32Array} positions @param {Uint8Array} marks of the vertices */
export function countKinds(positions, marks) {
  const counts = new Uint32Array(KINDS.length);
  for (let i = 1; MARK * i < marks.length; i++) {
    if (isSeen(positions, marks, i)) counts[at(marks, MARK * i)] = at(counts, at(marks, MARK * i)) + 1;
  }
  return counts;
}
