// The controls of the picture: views, projection, what is shown, and colours.

/** @import { View } from "./view/view.js" */
/** @import { ColorBy, LegendRow } from "./view/types.js" */

import { digits } from "./figures.js";
import { TEXTS } from "./texts.js";

/**
 * Fills the toolbar.
 * @param {HTMLElement} host
 * @param {View} view
 * @param {() => void} onchange after what is shown has changed
 */
export function fillToolbar(host, view, onchange) {
  const views = document.createElement("select");
  views.setAttribute("aria-label", TEXTS.picture);
  for (const [name, text] of Object.entries(TEXTS.views)) views.add(new Option(text, name));
  views.addEventListener("change", () => view.look(/** @type {Parameters<View["look"]>[0]} */ (views.value)));
  const fit = button(TEXTS.fit, () => view.fit());
  const perspective = check(TEXTS.perspective, true, (isOn) => view.setProjection(isOn ? "perspective" : "orthographic"));
  const shown = Object.entries(TEXTS.show).map(([name, text]) =>
    check(text, true, (isOn) => view.setVisible(name, isOn)));
  const material = check(TEXTS.material, false, (isOn) => {
    view.setMaterial(isOn);
    onchange();
  });
  const colors = document.createElement("select");
  for (const [name, text] of Object.entries(TEXTS.colors)) colors.add(new Option(text, name));
  colors.addEventListener("change", () => {
    view.setColor(/** @type {ColorBy} */ (colors.value));
    onchange();
  });
  const label = document.createElement("label");
  label.append(`${TEXTS.colorBy} `, colors);
  host.replaceChildren(views, fit, perspective, ...shown, material, label);
}

/** @param {string} text @param {() => void} onclick */
function button(text, onclick) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.addEventListener("click", onclick);
  return made;
}

/** @param {string} text @param {boolean} isOn @param {(isOn: boolean) => void} onchange */
function check(text, isOn, onchange) {
  const label = document.createElement("label");
  const box = document.createElement("input");
  box.type = "checkbox";
  box.checked = isOn;
  box.addEventListener("change", () => onchange(box.checked));
  label.append(box, ` ${text}`);
  return label;
}

/**
 * Shows the legend; its rows switch kinds of moves.
 * @param {HTMLElement} host
 * @param {View} view
 */
export function showLegend(host, view) {
  host.replaceChildren(...view.legend().map((row) => legendRow(row, view, () => showLegend(host, view))));
}

/** @param {LegendRow} row @param {View} view @param {() => void} onchange */
function legendRow(row, view, onchange) {
  const swatch = document.createElement("span");
  swatch.className = row.dashed ? "swatch dashed" : "swatch";
  swatch.style.background = row.colors.length > 1 ? `linear-gradient(to right, ${row.colors.join(", ")})` : row.colors[0] ?? "";
  const range = row.from === null || row.to === null ? "" : ` ${digits(row.from)} – ${digits(row.to)} ${row.unit}`;
  const { key } = row;
  if (key === null) {
    const line = document.createElement("p");
    line.append(swatch, ` ${row.label}${range}`);
    return line;
  }
  const line = check(`${row.label}${range}`, row.visible, (isOn) => {
    view.setVisible(key, isOn);
    onchange();
  });
  line.insertBefore(swatch, line.lastChild);
  return line;
}
