// The picture of an answer: part, stock, tool and path in three dimensions, and the time in the program.

/** @import { Hit, PathData, ToolData, Vec3 } from "./view/types.js" */

import { digits } from "./figures.js";
import { bytesOf, readModel } from "./glb.js";
import { Player } from "./player.js";
import { fillToolbar, showLegend } from "./toolbar.js";
import { TEXTS } from "./texts.js";
import { View } from "./view/view.js";

/** The number of rapids among the kinds. */
const RAPID = 0;

export class Picture {
  /** @param {(line: number) => void} online when a block is pointed at */
  constructor(online) {
    const part = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));
    this.hover = part("hover");
    this.legend = part("legend");
    this.player = new Player({
      slider: /** @type {HTMLInputElement} */ (part("time")),
      button: /** @type {HTMLButtonElement} */ (part("play")),
      clock: part("clock"),
      speed: /** @type {HTMLSelectElement} */ (part("speed")),
    }, (seconds) => this.view?.setTime(seconds));
    /** @type {View | null} */
    this.view = null;
    try {
      this.view = new View(/** @type {HTMLCanvasElement} */ (part("picture")), {
        onhover: (hit) => this.tell(hit),
        onpick: (hit) => {
          this.player.set(hit.time);
          if (hit.block > 0) online(hit.block);
        },
      });
      fillToolbar(part("tools"), this.view, () => this.refresh());
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
   * @param {Record<string, unknown>} body the request, for tool and stock
   */
  show(glb, body) {
    const { view } = this;
    if (view === null) return;
    const { path, solids } = glb === undefined ? { path: null, solids: new Map() } : readModel(bytesOf(glb));
    const tool = toolOf(body);
    view.setPath(path);
    view.setPart(solids.get("part") ?? null);
    view.setTool(tool);
    view.setStock(path === null ? null : stockOf(path, body, tool === null ? 0 : 0.5 * tool.diameter_mm));
    this.player.load(path === null ? 0 : path.times[path.times.length - 1] ?? 0);
    view.fit();
    this.refresh();
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

/** The box in which material is cut. @param {PathData} path @param {Record<string, unknown>} body @param {number} radius_mm */
function stockOf(path, body, radius_mm) {
  /** @type {Vec3} */
  const min = [Infinity, Infinity, Infinity];
  /** @type {Vec3} */
  const max = [-Infinity, -Infinity, -Infinity];
  const { positions, kinds } = path;
  for (let k = 1; k < kinds.length; k++) {
    if (kinds[k] === RAPID) continue;
    for (const axis of /** @type {const} */ ([0, 1, 2])) {
      const x = positions[3 * k + axis] ?? 0;
      min[axis] = Math.min(min[axis], x);
      max[axis] = Math.max(max[axis], x);
    }
  }
  if (!Number.isFinite(min[0])) return null;
  const top = topOf(body) ?? max[2];
  const room = 1.2 * radius_mm;
  const below = 0.1 * Math.max(1, top - min[2]);
  return {
    min: /** @type {Vec3} */ ([min[0] - room, min[1] - room, min[2] - below]),
    max: /** @type {Vec3} */ ([max[0] + room, max[1] + room, Math.max(top, min[2])]),
  };
}

/** The top of the stock that a request states, mm. @param {Record<string, unknown>} body */
function topOf(body) {
  const stock = body["stock"];
  const own = typeof stock === "object" && stock !== null && "top_z_mm" in stock ? stock.top_z_mm : undefined;
  const top = own ?? body["top_z_mm"] ?? (body["floor_z_mm"] === undefined ? undefined : 0);
  return typeof top === "number" ? top : undefined;
}
