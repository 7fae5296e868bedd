// The picture of an answer: part, stock, tool and path in three dimensions, and the time in the program.

/** @import { Operation } from "./contract.js" */
/** @import { Model } from "./glb.js" */
/** @import { Obstacles } from "./toolbar.js" */
/** @import { Hit, PathData, ToolData } from "./view/types.js" */

import { Charts } from "./charts/charts.js";
import { byId } from "./dom.js";
import { digits, placeText } from "./figures.js";
import { valueAt } from "./form/value.js";
import { bytesOf, NO_MODEL, readModel } from "./glb.js";
import { lineAt, Player, timeOf } from "./player.js";
import { detailOf, fileOf } from "./run.js";
import { showLegend, Toolbar } from "./toolbar.js";
import { TEXTS } from "./texts.js";
import { boxOf } from "./view/math.js";
import { NoWebGL, View } from "./view/view.js";

export class Picture {
  /** @param {(line: number) => void} online when another line of the program is cut, or is pointed at */
  constructor(online) {
    this.online = online;
    this.hint = byId("hint", HTMLParagraphElement);
    this.hover = byId("hover", HTMLParagraphElement);
    this.legend = byId("legend", HTMLElement);
    this.sheet = byId("sheet", HTMLImageElement);
    this.charts = new Charts((seconds) => this.player.set(seconds));
    this.player = new Player({
      slider: byId("time", HTMLInputElement), button: byId("play", HTMLButtonElement),
      clock: byId("clock", HTMLElement), speed: byId("speed", HTMLSelectElement),
    }, (seconds) => this.#follow(seconds));
    /** @type {PathData | null} */
    this.path = null;
    /** The line of the program that is lit; 0 for none. */
    this.line = 0;
    /** The text in place of a picture: why nothing is drawn, or how to begin. */
    this.reason = TEXTS.hint;
    /** Whether the browser has taken the graphics processor away. */
    this.isLost = false;
    /** The answer whose sheet is shown or asked for. */
    this.nAnswers = 0;
    /** @type {View | null} */
    this.view = null;
    /** @type {Toolbar | null} */
    this.toolbar = null;
    this.#begin(byId("picture", HTMLCanvasElement));
  }

  /** @param {HTMLCanvasElement} canvas */
  #begin(canvas) {
    try {
      this.view = new View(canvas, {
        onhover: (hit) => this.tell(hit),
        onpick: (hit) => {
          this.player.set(hit.time);
          if (hit.block > 0) this.#light(hit.block);
        },
      });
      this.toolbar = new Toolbar(byId("tools", HTMLElement), this.view, () => this.refresh());
      this.toolbar.offer(null, obstacles(NO_MODEL, null, this.view), false);
      for (const event of ["webglcontextlost", "webglcontextrestored"]) {
        canvas.addEventListener(event, () => {
          this.isLost = event === "webglcontextlost";
          this.#explain();
        });
      }
    } catch (error) {
      this.view = null;
      this.reason = error instanceof NoWebGL ? TEXTS.noWebGL : TEXTS.noPicture(detailOf(error));
      this.#explain();
    }
  }

  /** Shows in place of the picture why nothing is drawn. */
  #explain() {
    this.hint.textContent = this.isLost ? TEXTS.contextLost : this.reason;
    this.hint.hidden = this.hint.textContent === "";
  }

  /** Shows all at a time of the program. @param {number} seconds */
  #follow(seconds) {
    this.view?.setTime(seconds);
    this.charts.setTime(seconds);
    const line = this.path ? lineAt(this.path, seconds) : 0;
    if (line > 0) this.#light(line);
  }

  /** Lights a line in the program. @param {number} line */
  #light(line) {
    if (line === this.line) return;
    this.line = line;
    this.online(line);
  }

  refresh() {
    if (this.view !== null) showLegend(this.legend, this.view);
  }

  /**
   * Shows the model of an answer.
   * @param {string | undefined} glb the file in base64
   * @param {unknown} body the request, for the tool
   */
  show(glb, body) {
    const model = glb === undefined ? NO_MODEL : readModel(bytesOf(glb));
    const { path } = model;
    this.draw(model, toolOf(body));
    this.charts.show(path, model.diagrams);
    // The program starts at its top, though the picture shows the end.
    this.path = null;
    this.player.load(path?.times.at(-1) ?? 0);
    this.path = path;
    this.line = 0;
    this.nAnswers += 1;
    this.sheet.hidden = true;
    const isEmpty = path === null && !model.solids.has("part") && !model.solids.has("stock");
    if (this.view !== null) this.reason = isEmpty ? TEXTS.noModel : "";
    this.#explain();
    this.refresh();
  }

  /** @param {Model} model @param {ToolData | null} tool */
  draw(model, tool) {
    const { view } = this;
    if (view === null) return;
    const stock = model.solids.get("stock");
    view.setPath(model.path);
    view.setPart(model.solids.get("part") ?? null);
    view.setTool(tool);
    view.setStock(stock === undefined ? null : boxOf(stock.positions), stock ?? null);
    this.toolbar?.offer(model.path, obstacles(model, tool, view), model.isStockAssumed);
  }

  /**
   * Shows the flat drawing of an answer, for browsers that draw nothing in three dimensions.
   * @param {Operation} operation
   * @param {unknown} body
   * @throws {Error} where the service does not answer it
   */
  async showSheet(operation, body) {
    if (!operation.forms.includes("image/svg+xml")) return;
    const { nAnswers } = this;
    const { blob } = await fileOf(operation.path, "svg", body);
    // A later answer has a sheet of its own.
    if (this.nAnswers !== nAnswers) return;
    URL.revokeObjectURL(this.sheet.src);
    this.sheet.src = URL.createObjectURL(blob);
    this.sheet.alt = TEXTS.sheet;
    this.sheet.hidden = false;
    this.hint.hidden = true;
  }

  /** Lights the moves of a line of the program, and goes to the end of the first. @param {number} line */
  highlight(line) {
    this.view?.highlight(line);
    this.line = line;
    const { path } = this;
    const seconds = path && timeOf(path, line);
    if (seconds === null) return;
    // Moves without a duration end at the same time: the chosen line stays lit.
    this.path = null;
    this.player.set(seconds);
    this.path = path;
  }

  /** @param {Hit | null} hit */
  tell(hit) {
    if (hit === null) {
      this.hover.textContent = "";
      return;
    }
    const place = hit.point.map((x, k) => `${"XYZ"[k]}${placeText(x)}`).join(" ");
    const feed = hit.feed > 0 ? `, ${digits(hit.feed)} mm/min` : "";
    this.hover.textContent = TEXTS.hit(hit.kind, `${place} mm`, feed, hit.block);
  }
}

/** @param {unknown} body @returns {ToolData | null} */
function toolOf(body) {
  const isTool = typeof valueAt(body, ["tool", "diameter_mm"]) === "number";
  return isTool ? /** @type {ToolData} */ (valueAt(body, ["tool"])) : null;
}

/** @param {Model} model @param {ToolData | null} tool @param {View} view that shows them @returns {Obstacles} */
function obstacles({ solids }, tool, view) {
  const { part, stock, tool: noTool } = TEXTS.obstacles;
  return {
    part: solids.has("part") ? null : part,
    stock: solids.has("stock") ? null : stock,
    tool: tool === null ? noTool : null,
    material: view.obstacle,
  };
}
