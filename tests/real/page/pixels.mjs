// What the canvas of the page shows: how many pixels, and of which kinds of moves.

import { createRequire } from "node:module";
import { TEXTS, VIEW_TEXTS } from "../../../src/server/page/texts.js";
import { KIND_COLORS, rgb } from "../../../src/server/page/view/colors.js";
import { KINDS } from "../../../src/server/page/view/types.js";

const { PNG } = createRequire(process.env.PAGE_TOOLS)("pngjs");

/** Moves of a kind have to be seen where they are longer than this share of the path's box. */
const SEEN = 0.01;
/** How far a channel of a pixel may be from the colour of its kind. */
const NEAR = 6;
/** Alone on the canvas, a thin line mixes with the ground: the least share of its colour, and how far a channel may be off. */
const SHARE = 0.2;
const OFF = 24;
/** Where lines of other kinds cross, so many pixels may have the colour of a kind. */
const MIXED = 20;
/** The picture may turn and be refined for so long after an answer, ms. */
const PATIENCE = 4000;
/** A kind of move without material between its ends, and the only one as grey as parts and tools. */
const RAPID = 0;

/** The pixels of the canvas, four bytes each. @param {import("playwright-core").Page} page */
async function pixelsOf(page) {
  await page.evaluate(showLabels, false);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const file = await page.locator("#picture").screenshot();
  await page.evaluate(showLabels, true);
  return PNG.sync.read(file).data;
}

/** Shows or hides what stands over the canvas: the legend has the colours too. In the page. @param {boolean} isShown */
function showLabels(isShown) {
  for (const part of document.querySelectorAll("#stage > :not(canvas), .view-labels")) {
    part.style.visibility = isShown ? "" : "hidden";
  }
}

/** The number of pixels that differ from the most frequent colour. @param {Uint8Array} data */
function drawnPixels(data) {
  const counts = new Map();
  for (let k = 0; k < data.length; k += 4) {
    const color = (data[k] << 16) | (data[k + 1] << 8) | data[k + 2];
    counts.set(color, (counts.get(color) ?? 0) + 1);
  }
  return data.length / 4 - Math.max(...counts.values());
}

/**
 * The number of pixels of a colour that were others before.
 * @param {Uint8Array} data
 * @param {Uint8Array} before
 * @param {string} hex
 */
function colored(data, before, hex) {
  const color = rgb(hex).map((x) => 255 * x);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) {
    const isNear = color.every((x, channel) => Math.abs(data[k + channel] - x) <= NEAR);
    if (isNear && color.some((_, channel) => data[k + channel] !== before[k + channel])) count += 1;
  }
  return count;
}

/** Whether a pixel changed towards a colour. @param {Uint8Array} data @param {Uint8Array} before @param {string} hex */
function hasLine(data, before, hex) {
  const color = rgb(hex).map((x) => 255 * x);
  for (let k = 0; k < data.length; k += 4) {
    if (data[k] === before[k] && data[k + 1] === before[k + 1] && data[k + 2] === before[k + 2]) continue;
    const change = color.map((_, channel) => data[k + channel] - before[k + channel]);
    const whole = color.map((x, channel) => x - before[k + channel]);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const share = dot(change, whole) / dot(whole, whole);
    if (share > SHARE && change.every((x, channel) => Math.abs(x - share * whole[channel]) < OFF)) return true;
  }
  return false;
}

/** Keeps the text of each answer with a model, for `kindsDrawn`. In the page, before its scripts. */
export function keepAnswers() {
  const { fetch } = globalThis;
  globalThis.fetch = async (...request) => {
    const response = await fetch(...request);
    if (String(request[0]).includes("glb=true")) globalThis.answer = response.clone().text().catch(() => "");
    return response;
  };
}

/**
 * The numbers of the kinds whose moves are long enough to be seen; null where the last answer has no model.
 * @param {import("playwright-core").Page} page
 */
export async function kindsDrawn(page) {
  const lengths = await page.evaluate(lengthsOfKinds, KINDS.length);
  return lengths && lengths.moves.flatMap((length, kind) => (length > SEEN * lengths.size ? [kind] : []));
}

/** The lengths of all moves of each kind, and the size of the path. In the page. @param {number} nKinds */
async function lengthsOfKinds(nKinds) {
  const glb = /"glb": ?"([^"]*)"/.exec(await globalThis.answer)?.[1];
  if (glb === undefined) return null;
  const { bytesOf, readModel } = await import("/page/glb.js");
  const { path } = readModel(bytesOf(glb));
  if (path === null) return { moves: [], size: 0 };
  const { positions, kinds, strips } = path;
  // Nothing is drawn between the end of a strip and the start of the next.
  const starts = new Set(strips.map(({ first }) => first));
  const moves = Array.from({ length: nKinds }, () => 0);
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < kinds.length; k++) {
    let square = 0;
    for (const axis of [0, 1, 2]) {
      const x = positions[3 * k + axis];
      min[axis] = Math.min(min[axis], x);
      max[axis] = Math.max(max[axis], x);
      if (!starts.has(k)) square += (x - positions[3 * k - 3 + axis]) ** 2;
    }
    moves[kinds[k]] += Math.sqrt(square);
  }
  return { moves, size: Math.hypot(...max.map((x, axis) => x - min[axis])) };
}

/**
 * Waits until the canvas shows enough pixels and each kind of move.
 * @param {import("playwright-core").Page} page
 * @param {number} least pixels
 * @param {number[]} kinds
 * @returns {Promise<string[]>} what is missing
 */
export async function missing(page, least, kinds) {
  const end = Date.now() + PATIENCE;
  for (;;) {
    const data = await pixelsOf(page);
    const isEmpty = drawnPixels(data) < least;
    const hidden = isEmpty ? [] : await absent(page, data, kinds);
    const told = isEmpty ? ["the canvas shows nothing"] : hidden.map((kind) => `no pixel of ${KINDS[kind]}`);
    if (told.length === 0 || Date.now() > end) return told;
  }
}

/**
 * The kinds that are not seen, neither between all else nor alone. Grid and cross have such colours too, so that only
 * pixels count that are others without the moves.
 * @param {import("playwright-core").Page} page
 * @param {Uint8Array} data the canvas with all that is shown
 * @param {number[]} kinds
 */
async function absent(page, data, kinds) {
  if (kinds.length === 0) return [];
  const always = [TEXTS.perspective, TEXTS.material];
  const turned = await page.evaluate(showOnly, always);
  const bare = await pixelsOf(page);
  const left = [];
  for (const kind of kinds) {
    if (kind !== RAPID && colored(data, bare, KIND_COLORS[kind]) > MIXED) continue;
    const name = VIEW_TEXTS.kinds[KINDS[kind]];
    await page.evaluate(turnOn, [name]);
    if (!hasLine(await pixelsOf(page), bare, KIND_COLORS[kind])) left.push(kind);
    await page.evaluate(showOnly, always);
  }
  await page.evaluate(turnOn, turned);
  return left;
}

/** Turns off all that is shown but what is kept. Returns the names of what was turned off. In the page. @param {string[]} kept */
function showOnly(kept) {
  const names = [];
  // The legend is made anew when the material is shown or hidden.
  for (;;) {
    const boxes = [...document.querySelectorAll("#legend input, #tools input")];
    const shown = boxes.find((box) => box.checked && !box.disabled && !kept.includes(box.parentElement.textContent.trim()));
    if (shown === undefined) return names;
    names.push(shown.parentElement.textContent.trim());
    shown.click();
  }
}

/** Turns on what was turned off. In the page. @param {string[]} names */
function turnOn(names) {
  for (const name of names) {
    const boxes = [...document.querySelectorAll("#legend input, #tools input")];
    boxes.find((box) => !box.checked && box.parentElement.textContent.trim() === name)?.click();
  }
}
