// What is drawn: path, part, stock, tool and material, made anew from the data when the context was lost.

import { digits, placeText } from "../figures.js";
import { countKinds, legendRows, materialRows } from "./colors.js";
import { boxEdges, creases } from "./creases.js";
import { Furniture } from "./grid.js";
import { boxAround, boxOf, placed } from "./math.js";
import { Material } from "./material.js";
import { Mesh } from "./mesh.js";
import { PathLayer } from "./path.js";
import { PathBoxes } from "./pick.js";
import { sizeOf } from "./labels.js";
import { Surface } from "./surface.js";
import { VIEW_TEXTS as TEXTS } from "../texts.js";
import { isUpright, poseAt } from "./timeline.js";
import { cutterOf, outlines, turned } from "./tool.js";
import { KINDS } from "./types.js";
/** @import { Ray } from "./camera.js" */
/** @import { Frame, GL, Theme } from "./gl.js" */
/** @import { Range } from "./tool.js" */
/** @import { Box, ColorBy, Hit, LegendRow, MeshData, PathData, ToolData } from "./types.js" */

const HOLDER_ALPHA = 0.45;
const NAMES = /** @type {readonly string[]} */ ([...KINDS, "part", "stock", "tool", "material"]);

/** The box where it is one; else null. @param {Box|null} box */
const sound = (box) => (box && box.max.every((x, k) => x > (box.min[k] ?? x)) ? box : null);

/** Whether a body is a box as large as the box around it: all of its corners are corners of the box.
 * @param {MeshData} body @param {Box} box */
const fills = ({ positions }, { min, max }) => positions.every((x, k) => x === min[k % 3] || x === max[k % 3]);

export class Scene {
  /** @type {PathData|null} */ path = null;
  /** @type {MeshData|null} */ part = null;
  /** @type {Box|null} */ stock = null;
  /** @type {MeshData|null} what the stock is where it does not fill its box */ #stockBody = null;
  /** @type {number[]} both ends of each edge of the stock */ #stockEdges = [];
  /** @type {ToolData|null} */ tool = null;
  /** Seconds; after the end the tool stands at the end. */
  time = Infinity;
  /** @type {ColorBy} */ #colorBy = "kind";
  /** @type {number|null} */ #block = null;
  /** @type {Map<string, boolean>} */ #visible = new Map(NAMES.map((name) => [name, name !== "material"]));
  /** @type {Box|null} */ #pathBox = null;
  /** @type {Box|null} */ #partBox = null;
  #counts = new Uint32Array(KINDS.length);
  /** @type {PathLayer|null} */ #pathLayer = null;
  /** @type {PathBoxes|null} */ #boxes = null;
  /** @type {Mesh|null} */ #partMesh = null;
  /** @type {{mesh: Mesh, ranges: Range[]}|null} */ #toolMesh = null;
  /** @type {Material|null} */ #material = null;
  /** @type {Surface|null} */ #surface = null;
  /** @type {Furniture|null} */ #furniture = null;
  #gl;

  /** @param {GL} gl */
  constructor(gl) { this.#gl = gl; }

  /** @param {PathData|null} path */
  setPath(path) {
    this.#pathLayer?.dispose();
    this.path = path;
    this.#block = null;
    this.#pathBox = path ? boxOf(path.positions) : null;
    this.#pathLayer = path ? new PathLayer(this.#gl, path, this.#pathBox) : null;
    this.#boxes = this.#pathLayer ? new PathBoxes(this.#pathLayer.positions, this.#pathLayer.marks) : null;
    this.#counts = countKinds(path?.positions ?? new Float32Array(), this.#pathLayer?.marks ?? new Uint8Array());
    this.#pathLayer?.setColor(this.#colorBy);
    this.#refresh();
  }

  /** @param {MeshData|null} part */
  setPart(part) {
    this.#partMesh?.dispose();
    const isSound = part && part.indices.length >= 3 && part.normals.length === part.positions.length;
    this.part = isSound ? part : null;
    this.#partBox = this.part ? boxOf(this.part.positions) : null;
    this.#partMesh = this.part ? new Mesh(this.#gl, this.part) : null;
    this.#refresh();
  }

  /** @param {Box|null} stock @param {MeshData|null} body where it may not fill its box */
  setStock(stock, body) {
    this.stock = sound(stock);
    this.#stockBody = this.stock && body && !fills(body, this.stock) ? body : null;
    this.#stockEdges = this.#stockBody ? creases(this.#stockBody) : this.stock ? boxEdges(this.stock) : [];
    this.#refresh();
  }

  /** @param {ToolData|null} tool */
  setTool(tool) {
    this.#toolMesh?.mesh.dispose();
    this.tool = tool;
    const body = tool ? turned(outlines(tool)) : null;
    this.#toolMesh = body ? { mesh: new Mesh(this.#gl, body), ranges: body.ranges } : null;
    this.#refresh();
  }

  /** @param {ColorBy} by */
  setColor(by) {
    this.#colorBy = by;
    this.#pathLayer?.setColor(by);
  }

  /** @param {number|null} block */
  highlight(block) {
    this.#block = block;
    this.#pathLayer?.highlight(block);
  }

  /** @param {string} name */
  isVisible(name) { return this.#visible.get(name) ?? false; }

  /** @param {string} name @param {boolean} visible */
  setVisible(name, visible) {
    if (!this.#visible.has(name) || this.isVisible(name) === visible) return;
    this.#visible.set(name, visible);
    if (name === "material") this.#refresh();
  }

  /** Why the material cannot be shown; null where it can. @returns {string|null} */
  get obstacle() {
    if (!this.stock) return TEXTS.material.noStock;
    if (!this.tool || !this.path) return TEXTS.material.noTool;
    return isUpright(this.path) ? null : TEXTS.material.fiveAxes;
  }

  /** Makes the material anew, since what it hangs on changed. */
  #refresh() {
    this.#material?.dispose();
    this.#material = null;
    const layer = this.#pathLayer;
    if (!this.isVisible("material") || this.obstacle || !this.stock || !this.tool || !layer) return;
    this.#material = new Material(this.#gl, layer.path, layer.marks, cutterOf(this.tool), this.stock);
    this.#material.setPart(this.#partMesh);
    if (this.#stockBody) this.#material.setStock(new Mesh(this.#gl, this.#stockBody));
    this.#surface ??= new Surface(this.#gl);
  }

  /** Makes all drawings anew in a context that was lost. */
  restore() {
    this.#material = this.#surface = this.#furniture = this.#toolMesh = this.#partMesh = null;
    this.#pathLayer = null;
    const block = this.#block;
    this.setPart(this.part);
    this.setTool(this.tool);
    this.setPath(this.path);
    this.highlight(block);
  }

  /** The box of all that there is; null for nothing. */
  get box() { return boxAround([this.stock, this.#partBox, this.#pathBox]); }

  /** The box whose size is of interest: of the stock, else of the part, else of the path. */
  get sizedBox() { return this.stock ?? this.#partBox ?? this.#pathBox; }

  /** Whether a moving view draws less than everything. */
  get isThinned() { return this.#material !== null || (this.#pathLayer?.isThinned ?? false); }

  /** Whether the whole path takes so long that it is drawn bit by bit. */
  get isLong() { return this.#pathLayer?.isLong ?? false; }

  /** Draws the next bit of the whole path. @param {Frame} frame @param {number} first vertex
   * @returns {number} vertex to go on from; 0 at the end */
  drawOn(frame, first) { return this.#pathLayer?.drawOn(frame, first) ?? 0; }

  /** Tells the scene what a bit took. @param {number} count vertices @param {number} elapsed ms */
  learnOn(count, elapsed) { this.#pathLayer?.learnOn(count, elapsed); }

  /** Whether the material is still on its way to the present time. */
  get isBusy() { return this.#material?.isBusy ?? false; }

  /** The share of the way to the present time that is cut, 0 to 1. */
  get cutShare() { return this.#material?.share ?? 1; }

  /** @param {boolean} coarse @param {number} elapsed ms */
  learn(coarse, elapsed) {
    if (this.#material) this.#surface?.learn(coarse, elapsed);
    else this.#pathLayer?.learn(coarse, elapsed);
  }

  /** Tells the scene what a step of cutting took. @param {number} elapsed ms */
  learnCut(elapsed) { this.#material?.learn(elapsed); }

  /** Cuts the material on towards the present time; false where there is nothing to cut.
   * @param {number} ms how long it may take, about */
  cut(ms) {
    this.#material?.setTime(this.time);
    return this.#material?.step(ms) ?? false;
  }

  /** @param {Box} box of the scene @param {Theme} theme */
  setFurniture(box, theme) {
    this.#furniture ??= new Furniture(this.#gl);
    this.#furniture.set(box, this.isVisible("stock") ? this.#stockEdges : [], theme);
  }

  /** @param {Frame} frame */
  draw(frame) {
    this.#furniture?.draw(frame);
    if (this.#material) this.#surface?.draw(frame, this.#material);
    else if (this.isVisible("part")) this.#partMesh?.draw(frame, frame.theme.part);
    if (this.#pathLayer) {
      this.#pathLayer.time = this.time;
      this.#pathLayer.shown = this.shownKinds;
      this.#pathLayer.draw(frame);
    }
    if (this.isVisible("tool")) this.#drawTool(frame);
    this.#furniture?.drawAxes(frame);
  }

  /** @param {Frame} frame */
  #drawTool(frame) {
    const pose = this.path && poseAt(this.path, this.time);
    if (!pose || !this.#toolMesh) return;
    const { mesh, ranges } = this.#toolMesh;
    const model = placed(pose.point, pose.axis);
    for (const range of ranges) {
      const isHolder = range.part === "holder";
      const color = range.part === "cutter" ? frame.theme.tool : frame.theme.holder;
      mesh.draw(frame, color, isHolder ? HOLDER_ALPHA : 1, model, range);
    }
  }

  /** Bit k: stretches of kind k are shown. */
  get shownKinds() { return KINDS.reduce((bits, name, k) => bits | (this.isVisible(name) ? 1 << k : 0), 0); }

  /** The stretch near a line of sight. @param {Ray} ray @param {number} pixels @returns {Hit|null} */
  hit(ray, pixels) {
    const { path } = this;
    const found = this.#boxes?.nearest(ray, pixels, this.shownKinds);
    if (!found || !path) return null;
    const { index, t, point } = found;
    const [start = 0, end = 0] = [path.times[index - 1], path.times[index]];
    return {
      block: path.blocks[index] ?? 0, kind: KINDS[path.kinds[index] ?? 1] ?? "cut",
      feed: path.feeds[index] ?? 0, time: start + (end - start) * t, point,
    };
  }

  /** @returns {LegendRow[]} */
  legend() {
    const rows = this.#pathLayer
      ? legendRows(this.#pathLayer.coloring, this.#counts, (key) => this.isVisible(key)) : [];
    return this.#material?.part ? [...rows, ...materialRows(Surface.most(this.#material))] : rows;
  }

  /** What is drawn, in words. @returns {string[]} */
  describe() {
    const kinds = KINDS.filter((name, k) => this.#counts[k] && this.isVisible(name));
    const count = this.#counts.reduce((sum, n) => sum + n, 0);
    const pose = this.path && poseAt(this.path, this.time);
    const words = [
      this.path && TEXTS.path(count, kinds.map((name) => TEXTS.kinds[name] ?? name)),
      this.#material ? TEXTS.removal : this.part && this.isVisible("part") && TEXTS.part,
      this.stock && TEXTS.stock(sizeOf(this.stock)),
      this.tool && TEXTS.tool(this.tool.shape, digits(this.tool.diameter_mm)),
      this.tool && pose && TEXTS.toolAt(pose.point.map(placeText), digits(this.path?.times[pose.vertex] ?? 0)),
    ];
    return words.filter((word) => typeof word === "string");
  }

  dispose() {
    for (const layer of [this.#pathLayer, this.#partMesh, this.#toolMesh?.mesh, this.#material, this.#surface,
      this.#furniture]) layer?.dispose();
  }
}
