// How people use the page: wrong fields, cancelling, form and JSON, keyboard, phone, pasting, speed.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { TEXTS } from "../../../src/server/page/texts.js";
import { missing } from "./pixels.mjs";

const axeText = readFileSync(createRequire(process.env.PAGE_TOOLS).resolve("axe-core/axe.min.js"), "utf8");
/** The operations whose form and JSON are compared after edits, and the number of edits of each. */
const EDITED = ["/v1/pockets/plan", "/v1/surfaces/mill", "/v1/five-axis/smooth", "/v1/arcs/fit", "/v1/curves/interpolate"];
const N_EDITS = 6;
const MOST_SHIFT = 0.1;

/**
 * @typedef {object} Bench
 * @property {import("playwright-core").Page} page
 * @property {string} address
 * @property {(text: string) => void} fault
 * @property {() => Promise<void>} open
 * @property {(path: string, example?: string) => Promise<void>} choose
 * @property {() => Promise<string>} run answers the status at the end
 */

/** Three wrong fields are told at their places. */
export async function wrongFields({ page, fault, choose, run }) {
  await choose("/v1/pockets/plan", "island");
  await page.click("#tab-json");
  const body = JSON.parse(await page.inputValue("#json"));
  body.stepover_mm = -1;
  body.stepdown_max_mm = -2;
  body.tool.diameter_mm = -3;
  await page.fill("#json", JSON.stringify(body));
  const status = await run();
  if (!status.includes("3 fields")) fault(`three wrong fields: ${status}`);
  const told = await page.$$eval("[aria-invalid=true]", (fields) => fields.length);
  if (told !== 3) fault(`${told} fields are marked`);
}

/** A cancelled computation ends, and its place is free. */
export async function cancelling({ page, address, fault, choose }) {
  await choose("/v1/pockets/plan", "hundred-islands");
  await page.click("#run");
  await page.waitForTimeout(300);
  await page.click("#cancel");
  await page.waitForFunction(() => document.querySelector("#cancel").disabled);
  const status = await page.textContent("#status");
  if (!status.startsWith("Cancelled")) fault(`cancel: ${status}`);
  for (let k = 0; k < 50; k++) {
    const metrics = await (await fetch(`${address}/metrics`)).text();
    if (/running[^\n]* 0(\.0)?\n/.test(metrics)) return;
    await page.waitForTimeout(100);
  }
  fault("the computation goes on after cancel");
}

/** The form and the JSON agree after an edit of either. */
export async function agreement({ page, fault, choose }) {
  await choose("/v1/pockets/plan", "circle");
  await page.click("#tab-json");
  const body = JSON.parse(await page.inputValue("#json"));
  body.stepover_mm = 2.125;
  await page.fill("#json", JSON.stringify(body, null, 2));
  await page.click("#tab-form");
  const shown = await page.$$eval("#form input", (inputs) => inputs.map((input) => input.value));
  if (!shown.includes("2.125")) fault("the form does not follow the JSON");
  const inputs = page.locator("#form input");
  for (let k = 0; k < await inputs.count(); k++) {
    if (await inputs.nth(k).inputValue() === "2.125") {
      await inputs.nth(k).fill("2,25");
      break;
    }
  }
  const after = JSON.parse(await page.inputValue("#json"));
  if (after.stepover_mm !== 2.25) fault(`the JSON does not follow the form: ${after.stepover_mm}`);
}

/** axe finds nothing, in light and dark, wide and on a phone; on each tab, and after a refusal. */
export async function accessible({ page, fault, choose, run }) {
  await page.evaluate(axeText);
  const tabs = await page.$$eval("[role=tab]", (all) => all.map(({ id }) => id));
  for (const [colorScheme, viewport] of [["light", { width: 1280, height: 800 }], ["dark", { width: 1280, height: 800 }],
    ["light", { width: 390, height: 844 }], ["dark", { width: 844, height: 390 }]]) {
    await page.emulateMedia({ colorScheme });
    await page.setViewportSize(viewport);
    const check = async (when) => {
      const { violations } = await page.evaluate(() => globalThis.axe.run());
      const place = `${colorScheme}, ${viewport.width}, ${when}`;
      for (const { id, nodes } of violations) fault(`axe, ${place}: ${id} at ${nodes[0].target}`);
    };
    await choose("/v1/pockets/plan", "circle");
    await run();
    for (const tab of tabs) {
      await page.click(`#${tab}`);
      await check(tab);
    }
    await edit(page, (body) => { body.stepover_mm = -1; });
    await run();
    await check("after a refusal");
  }
}

/** Changes the request in the tab JSON. @param {(body: any) => void} change */
async function edit(page, change) {
  await page.click("#tab-json");
  const body = JSON.parse(await page.inputValue("#json"));
  change(body);
  await page.fill("#json", JSON.stringify(body));
}

/** Of two runs at once the later one alone is told and shown. */
export async function twoRuns({ page, fault, choose, run }) {
  await choose("/v1/pockets/plan", "hundred-islands");
  await page.click("#run");
  await page.waitForTimeout(300);
  await page.click("#run");
  await page.waitForTimeout(300);
  const status = await page.textContent("#status");
  if (!status.startsWith("Running") || await page.isDisabled("#cancel")) fault(`a second run: ${status}`);
  await choose("/v1/pockets/plan", "circle");
  const end = await run();
  await page.waitForTimeout(500);
  const later = await page.textContent("#status");
  if (!end.startsWith("Done") || later !== end) fault(`a third run: ${end}, then ${later}`);
}

/** An example that is not answered leaves an empty request of its operation, and is told. */
export async function failingExample({ page, fault, choose, run }) {
  await choose("/v1/pockets/plan", "circle");
  // The console tells statuses; this one is expected there.
  await page.route("**/page/examples/**", (route) => route.fulfill({ status: 422 }));
  await choose("/v1/arcs/fit");
  await page.unroute("**/page/examples/**");
  const status = await page.textContent("#status");
  if (!status.startsWith("The example")) fault(`an example without an answer: ${status}`);
  if (await page.inputValue("#json") !== "{}") fault("an example without an answer leaves the request of another operation");
  const refused = await run();
  if (!refused.startsWith("Refused")) fault(`an empty request: ${refused}`);
  await choose("/v1/arcs/fit", "contour");
  const done = await run();
  if (!done.startsWith("Done")) fault(`the example after one without an answer: ${done}`);
}

/** An answer is marked where the request is another one, and a text that is no JSON is neither run nor lost. */
export async function oldAnswers({ page, fault, choose, run }) {
  const marks = async (when, wanted) => {
    for (const id of ["old-picture", "old-answer"]) {
      if (await page.isVisible(`#${id}`) !== wanted) fault(`${when}: ${id} is ${wanted ? "hidden" : "shown"}`);
    }
  };
  await choose("/v1/pockets/plan", "circle");
  await run();
  await marks("after a run", false);
  await edit(page, (body) => { body.stepover_mm = 2.5; });
  await marks("after an edit", true);
  const status = await page.textContent("#status");
  if (status !== TEXTS.ready) fault(`after an edit the status is ${status}`);
  await run();
  await marks("after the next run", false);
  await page.fill("#json", "{");
  const refused = await run();
  if (refused.startsWith("Done")) fault("a text that is no JSON was run");
  await page.click("#tab-form");
  // The question whether to replace the text is answered with no.
  await page.locator("#form .form-number-input:visible").first().fill("7");
  if (await page.inputValue("#json") !== "{") fault("an edit in the form overwrites a text that is no JSON");
  await choose("/v1/pockets/plan", "island");
  await marks("after another example", true);
}

/** The time follows the chosen line, and the lit line the time. */
export async function following({ page, fault, choose, run }) {
  await choose("/v1/pockets/plan", "circle");
  await run();
  await page.click("#tab-program");
  const time = () => page.$eval("#time", (slider) => slider.value / slider.max);
  const lit = () => page.$eval(".nc-lit", (bar) => (bar.hidden ? "" : bar.style.transform));
  await page.fill("#find-text", "G1 ");
  await page.press("#find-text", "Enter");
  const [share, line] = [await time(), await lit()];
  if (!(share < 1)) fault("the time does not follow the chosen line");
  await page.$eval("#time", (slider) => {
    slider.value = slider.max * 0.6;
    slider.dispatchEvent(new Event("input"));
  });
  const next = await lit();
  if (line === "" || next === "" || next === line) fault(`the lit line does not follow the time: ${line}, then ${next}`);
}

/** The request that somebody made is there again when its operation is chosen again, until the page is left. */
export async function ownRequests({ page, fault, open, choose }) {
  await open();
  const check = async (when, stepover, isOwn) => {
    const body = JSON.parse(await page.inputValue("#json"));
    if (body.stepover_mm !== stepover) fault(`${when}: the stepover is ${body.stepover_mm}, not ${stepover}`);
    const told = await page.$eval("#example", ({ options: [own], value }) => ({ text: own.text, isThere: !own.disabled, value }));
    const text = isOwn ? TEXTS.ownRequest : TEXTS.noOwnRequest;
    if (told.text !== text || told.isThere !== isOwn) fault(`${when}: the list of examples tells ${JSON.stringify(told)}`);
    return told.value;
  };
  await choose("/v1/pockets/plan", "circle");
  const { stepover_mm } = JSON.parse(await page.inputValue("#json"));
  await check("an example", stepover_mm, false);
  await edit(page, (body) => { body.stepover_mm = 2.125; });
  if (await check("after an edit", 2.125, true) !== "") fault("an edited example is told as the example");
  await choose("/v1/arcs/fit");
  if (await check("another operation", undefined, false) === "") fault("an operation without an own request shows one");
  await choose("/v1/pockets/plan");
  if (await check("the operation again", 2.125, true) !== "") fault("the own request is told as an example");
  await choose("/v1/pockets/plan", "circle");
  if (await check("the example again", stepover_mm, true) !== "circle") fault("the example is not told");
  await page.selectOption("#example", "");
  await check("the own request again", 2.125, true);
}

/** Numbers from 0 to 1 that are the same in each run. @param {number} seed */
function dice(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** All numbers of a value with their paths. @returns {[string, number][]} */
function numbersOf(value, path = "") {
  if (typeof value === "number") return [[path, value]];
  if (typeof value !== "object" || value === null) return [];
  return Object.entries(value).flatMap(([name, part]) => numbersOf(part, `${path}/${name}`));
}

/** A number that is typed into the form changes this number of the JSON and nothing else, and the other way round. */
export async function randomEdits({ page, fault, choose }) {
  const random = dice(7);
  const json = async () => JSON.parse(await page.inputValue("#json"));
  for (const path of EDITED) {
    await choose(path);
    for (let k = 0; k < N_EDITS; k++) {
      await page.click("#tab-form");
      const before = new Map(numbersOf(await json()));
      const inputs = page.locator("#form .form-number-input:visible");
      const texts = await inputs.evaluateAll((all) => all.map((one) => one.value));
      const filled = texts.flatMap((text, at) => (text === "" ? [] : [at]));
      const typed = Math.round(1e6 * random()) / 1e5;
      await inputs.nth(filled[Math.floor(random() * filled.length)]).fill(String(typed));
      const after = numbersOf(await json());
      const changed = after.filter(([place, number]) => before.get(place) !== number);
      if (changed.length !== 1 || changed[0][1] !== typed || after.length !== before.size) {
        fault(`${path}: ${typed} in the form changes ${JSON.stringify(changed)} in the JSON`);
      }
      await page.click("#tab-json");
      const body = await json();
      const places = numbersOf(body);
      const [place] = places[Math.floor(random() * places.length)];
      const steps = place.split("/").slice(1);
      const name = steps.pop();
      const wanted = 5000 + Math.round(1e6 * random()) / 1e4;
      steps.reduce((part, step) => part[step], body)[name] = wanted;
      await page.fill("#json", JSON.stringify(body));
      // Entries of long lists, and those of closed sections, are in the document only when they are opened.
      const inForm = await page.$$eval("#form input", (all) => all.map((one) => Number(one.value)));
      if (steps.length === 0 && !inForm.includes(wanted)) fault(`${path}: ${wanted} at ${place} of the JSON is not in the form`);
    }
  }
}

/** Nothing moves while the page is read and run. Also tells how soon it is there on a second visit. */
export async function steady({ page, fault, open, run }) {
  await page.addInitScript(() => {
    globalThis.shift = 0;
    new PerformanceObserver((list) => {
      for (const entry of list.getEntries()) if (!entry.hadRecentInput) globalThis.shift += entry.value;
    }).observe({ type: "layout-shift", buffered: true });
  });
  await open();
  const painted = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Infinity);
  console.log(`first paint of a second visit after ${Math.round(painted)} ms`);
  await run();
  const shift = await page.evaluate(() => globalThis.shift);
  console.log(`layout shift ${shift.toFixed(4)}`);
  if (shift > MOST_SHIFT) fault(`the layout shifts by ${shift}`);
}

/** Rows of a spreadsheet that are pasted into the form run and are drawn. */
export async function pasting({ page, fault, open, choose, run }) {
  await open();
  await choose("/v1/arcs/fit");
  const rows = Array.from({ length: 60 }, (_, k) => [20 * Math.cos(k / 12), 20 * Math.sin(k / 12)]);
  const text = ["x;y", "", ...rows.map((row) => row.map((x) => x.toFixed(3).replace(".", ",")).join(";"))].join("\n");
  const box = page.locator("#form .form-paste").first();
  await box.locator("summary").click();
  await box.locator("textarea").fill(text);
  const told = await page.textContent("#form");
  const wanted = "60 rows of 2 numbers, separated by semicolons, decimal comma; header: x, y";
  if (!told.includes(wanted)) fault("the form does not tell what was pasted");
  const body = JSON.parse(await page.inputValue("#json"));
  if (body.polyline.length !== 60 || body.polyline[0][0] !== 20) fault("the pasted rows are not in the request");
  const status = await run();
  if (!status.startsWith("Done")) fault(`pasted rows: ${status}`);
  for (const what of await missing(page, 200, [])) fault(`pasted rows: ${what}`);
}

/** A table whose rows were refused is still there when other rows take their place. */
export async function corrected({ page, fault, open, choose, run }) {
  await open();
  await choose("/v1/pockets/plan", "rectangle");
  const box = page.locator("#form .form-paste").first();
  await box.locator("summary").click();
  const paste = (rows) => box.locator("textarea").fill(rows.map((row) => row.join(" ")).join("\n"));
  await paste([[0, 0], [80, 0], [0, 40], [80, 40]]);
  const refused = await run();
  if (!refused.startsWith("Refused")) fault(`an outline that crosses itself: ${refused}`);
  await paste([[0, 0], [80, 0], [80, 40], [0, 40]]);
  const size = await page.locator("#form .form-table").first().boundingBox();
  if (!(size?.height > 50)) fault("the corrected table is not seen");
  const done = await run();
  if (!done.startsWith("Done")) fault(`a corrected outline: ${done}`);
}

/** Tab and Enter are enough to run the first request. */
export async function keyboard({ page, fault, open }) {
  await open();
  for (let k = 0; k < 12; k++) {
    await page.keyboard.press("Tab");
    if (await page.evaluate(() => document.activeElement?.id === "run")) break;
  }
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelector("#cancel").disabled
    && !/^(Ready|Running)/.test(document.querySelector("#status").textContent));
  const status = await page.textContent("#status");
  if (!status.startsWith("Done")) fault(`by keyboard: ${status}`);
}

/** An upright phone scrolls up and down only. */
export async function upright({ page, fault, open, run }) {
  await page.setViewportSize({ width: 390, height: 844 });
  await open();
  const check = async (when) => {
    const wide = await page.evaluate(() => [document.scrollingElement.scrollWidth, innerWidth]);
    if (wide[0] > wide[1]) fault(`phone, ${when}: ${wide[0]} pixels are wider than ${wide[1]}`);
  };
  await check("at first");
  await run();
  for (const tab of ["program", "report", "take"]) {
    await page.click(`#tab-${tab}`);
    await check(tab);
  }
  await page.click("#tab-json");
  await check("json");
  await page.click("#tab-form");
  await page.setViewportSize({ width: 1280, height: 800 });
}

/** Saves pictures of the page for people to look at. @param {Bench} bench @param {string} folder */
export async function pictures({ page, open, choose, run }, folder) {
  const shown = [["pocket", "/v1/pockets/plan"], ["surface", "/v1/surfaces/mill"], ["five-axis", "/v1/five-axis/smooth"]];
  const sizes = [["wide", { width: 1440, height: 900 }], ["phone", { width: 390, height: 844 }]];
  for (const colorScheme of ["light", "dark"]) {
    for (const [size, viewport] of sizes) {
      await page.emulateMedia({ colorScheme });
      await page.setViewportSize(viewport);
      await open();
      for (const [name, path] of shown) {
        await choose(path);
        await run();
        await page.waitForTimeout(800);
        await page.screenshot({ path: `${folder}/${name}-${colorScheme}-${size}.png`, fullPage: size === "phone" });
      }
    }
  }
}
