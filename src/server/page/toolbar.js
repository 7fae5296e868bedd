// The controls of the picture: views, projection, what is shown, and colours.

/** @import { View } from "./view/view.js" */
/** @import { ColorBy, LegendRow, PathData } from "./view/types.js" */

import { button, el } from "./dom.js";
import { digits } from "./figures.js";
import { TEXTS } from "./texts.js";

/**
 * Why a body cannot be shown; null where it can.
 * @typedef {Record<"part" | "stock" | "tool" | "material", string | null>} Obstacles
 */

export class Toolbar {
  /** @param {HTMLElement} host @param {View} view @param {() => void} onchange after what is shown has changed */
  constructor(host, view, onchange) {
    this.view = view;
    this.onchange = onchange;
    this.colors = el("select", { change: () => this.#color() });
    const views = el("select", { "aria-label": TEXTS.view, change: () => view.look(views.value) },
      el("option", { value: "", disabled: true, hidden: true }, TEXTS.ownView),
      ...Object.entries(TEXTS.views).map(([name, text]) => new Option(text, name)));
    views.value = "iso";
    // Once the picture is turned by hand, each view can be chosen, the last one too.
    view.onsteer = () => { views.value = ""; };
    const perspective = check(TEXTS.perspective, true, (isOn) => view.setProjection(isOn ? "perspective" : "orthographic"));
    this.shown = {
      part: check(TEXTS.show.part, true, (isOn) => view.setVisible("part", isOn)),
      stock: check(TEXTS.show.stock, true, (isOn) => view.setVisible("stock", isOn)),
      tool: check(TEXTS.show.tool, true, (isOn) => view.setVisible("tool", isOn)),
      material: check(TEXTS.material, false, (isOn) => {
        view.setMaterial(isOn);
        onchange();
      }),
    };
    host.replaceChildren(views, button(TEXTS.fit, () => view.fit()), perspective.label,
      ...Object.values(this.shown).map(({ label }) => label), el("label", {}, `${TEXTS.colorBy} `, this.colors));
  }

  /**
   * Offers what there is to show of an answer.
   * @param {PathData | null} path @param {Obstacles} obstacles @param {boolean} isStockAssumed by the service
   */
  offer(path, obstacles, isStockAssumed) {
    for (const name of /** @type {(keyof Obstacles)[]} */ (Object.keys(obstacles))) {
      const { label, box, reason } = this.shown[name];
      const obstacle = obstacles[name];
      box.disabled = obstacle !== null;
      label.title = obstacle ?? (name === "stock" && isStockAssumed ? TEXTS.assumedStock : "");
      reason.textContent = label.title === "" ? "" : `: ${label.title}`;
    }
    const chosen = this.colors.value;
    const names = colorings(path);
    this.colors.replaceChildren(...names.map((name) => new Option(TEXTS.colors[name], name)));
    this.colors.value = names.find((name) => name === chosen) ?? "kind";
    if (this.colors.value !== chosen) this.#color();
  }

  #color() {
    this.view.setColor(/** @type {ColorBy} */ (this.colors.value));
    this.onchange();
  }
}

/** What the moves of a path differ in. @param {PathData | null} path @returns {ColorBy[]} */
function colorings(path) {
  const strips = path?.strips ?? [];
  return [
    "kind", "feed",
    ...(path?.deviations ? /** @type {const} */ (["deviation"]) : []),
    ...(strips.some(({ level }) => level !== null) ? /** @type {const} */ (["level"]) : []),
    ...(strips.length > 1 ? /** @type {const} */ (["pass"]) : []),
  ];
}

/**
 * A box to check. `reason` is read by screen readers only.
 * @param {string} text @param {boolean} isOn @param {(isOn: boolean) => void} onchange
 */
function check(text, isOn, onchange) {
  const box = el("input", { type: "checkbox", change: () => onchange(box.checked) });
  box.checked = isOn;
  const reason = el("span", { class: "seen-not" });
  return { label: el("label", {}, box, ` ${text}`, reason), box, reason };
}

/**
 * Shows the legend; its rows switch kinds of moves.
 * @param {HTMLElement} host
 * @param {View} view
 */
export function showLegend(host, view) {
  host.replaceChildren(...view.legend().map((row) => legendRow(row, view)));
}

/** @param {LegendRow} row @param {View} view */
function legendRow(row, view) {
  const swatch = el("span", { class: row.dashed ? "swatch dashed" : "swatch", hidden: row.colors.length === 0 });
  swatch.style.background = row.colors.length > 1 ? `linear-gradient(to right, ${row.colors.join(", ")})` : row.colors[0] ?? "";
  const range = row.from === null || row.to === null ? "" : ` ${digits(row.from)} – ${digits(row.to)} ${row.unit}`;
  const { key } = row;
  if (key === null) return el("p", {}, swatch, ` ${row.label}${range}`);
  const { label, box } = check(`${row.label}${range}`, row.visible, (isOn) => view.setVisible(key, isOn));
  box.after(swatch);
  return label;
}
