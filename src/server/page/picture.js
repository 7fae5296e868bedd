// The picture of an answer: part, stock, tool and path in three dimensions, and the time in the program.

/** @import { Model } from "./glb.js" */
/** @import { Obstacles } from "./toolbar.js" */
/** @import { Hit, ToolData } from "./view/types.js" */

import { Charts } from "./charts/charts.js";
import { digits } from "./figures.js";
import { bytesOf, NO_MODEL, readModel } from "./glb.js";
import { Player } from "./player.js";
import { showLegend, Toolbar } from "./toolbar.js";
import { TEXTS } from "./texts.js";
import { boxOf } from "./view/math.js";
import { View } from "./view/view.js";

export class Picture {
  /** @param {(line: number) => void} online when a block is pointed at */
  constructor(online) {
    const part = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));
    this.hover = part("hover");
    this.legend = part("legend");
    this.charts = new Charts((seconds) => this.player.set(seconds));
    this.player = new Player({
      slider: /** @type {HTMLInputElement} */ (part("time")),
      button: /** @type {HTMLButtonElement} */ (part("play")),
      clock: part("clock"),
      speed: /** @type {HTMLSelectElement} */ (part("speed")),
    }, (seconds) => {
      this.view?.setTime(seconds);
      this.charts.setTime(seconds);
    });
    /** @type {View | null} */
    this.view = null;
    /** @type {Toolbar | null} */
    this.toolbar = null;
    try {
      this.view = new View(/** @type {HTMLCanvasElement} */ (part("picture")), {
        onhover: (hit) => this.tell(hit),
        onpick: (hit) => {
          this.player.set(hit.time);
          if (hit.block > 0) online(hit.block);
        },
      });
      this.toolbar = new Toolbar(part("tools"), this.view, () => this.refresh());
      this.toolbar.offer(null, obstacles(NO_MODEL, null, this.view), false);
    } catch {
      this.hover.textContent = TEXTS.noWebGL;
    }
  }

  refresh() {
    if (this.view !== null) showLegend(this.legend, this.view);
  }

  /**
   * Shows the model of an answer.
   * @param {string | undefined} glb the file in base64
   * @param {Record<string, unknown>} body the request, for the tool
   */
  show(glb, body) {
    const model = glb === undefined ? NO_MODEL : readModel(bytesOf(glb));
    const { path } = model;
    this.draw(model, toolOf(body));
    this.charts.show(path, model.diagrams);
    this.player.load(path?.times.at(-1) ?? 0);
    this.view?.fit();
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

  /** Lights the moves of a line of the program, and goes there. @param {number} line */
  highlight(line) {
    this.view?.highlight(line);
  }

  /** @param {Hit | null} hit */
  tell(hit) {
    if (hit === null) {
      this.hover.textContent = "";
      return;
    }
    const place = hit.point.map((x, k) => `${"XYZ"[k]}${digits(Number(x.toFixed(3)))}`).join(" ");
    const feed = hit.feed > 0 ? `, ${digits(hit.feed)} mm/min` : "";
    this.hover.textContent = TEXTS.hit(hit.kind, `${place} mm`, feed, hit.block);
  }
}

/** @param {Record<string, unknown>} body @returns {ToolData | null} */
function toolOf(body) {
  const { tool } = body;
  const isTool = typeof tool === "object" && tool !== null && "diameter_mm" in tool && typeof tool.diameter_mm === "number";
  return isTool ? /** @type {ToolData} */ (/** @type {unknown} */ (tool)) : null;
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
