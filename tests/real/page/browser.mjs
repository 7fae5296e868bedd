// Runs every example of every operation on the page, in Chromium, and breaks requests on purpose.
// Usage: browser.mjs ADDRESS [NAME ...]     NAME: only examples whose "PATH NAME" contains it

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(process.env.PAGE_TOOLS);
const { chromium } = require("playwright-core");
const { PNG } = require("pngjs");
const axeText = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const [address, ...only] = process.argv.slice(2);
const MOST_BYTES = 150_000;
/** A picture has at least as many pixels that are no background. */
const LEAST_PIXELS = 500;
let faults = 0;

function fault(text) {
  faults += 1;
  console.log(`FAULT: ${text}`);
}

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "light" });
const page = await context.newPage();
let transferred = 0;
page.on("console", (message) => {
  if (message.type() === "error" && !message.text().includes("status of 422")) fault(`console: ${message.text()}`);
});
page.on("pageerror", (error) => fault(`script: ${error.message}`));
page.on("request", (request) => {
  const url = request.url();
  if (!url.startsWith(address) && !/^(blob|data):/.test(url)) fault(`a request to ${url}`);
});
page.on("response", async (response) => {
  const sizes = await response.request().sizes().catch(() => null);
  if (sizes !== null) transferred += sizes.responseBodySize;
});

async function open() {
  await page.goto(`${address}/`);
  await page.waitForFunction(() => !document.querySelector("#run").disabled);
}

/** Runs the request that stands on the page. Returns the status text at the end. */
async function run() {
  await page.click("#run");
  await page.waitForFunction(() => document.querySelector("#cancel").disabled, null, { timeout: 120_000 });
  return page.textContent("#status");
}

/** The number of pixels of the canvas that differ from its most frequent colour. */
async function drawn() {
  await page.waitForTimeout(200);
  const { data } = PNG.sync.read(await page.locator("#picture").screenshot());
  const counts = new Map();
  for (let k = 0; k < data.length; k += 4) {
    const color = (data[k] << 16) | (data[k + 1] << 8) | data[k + 2];
    counts.set(color, (counts.get(color) ?? 0) + 1);
  }
  return data.length / 4 - Math.max(...counts.values());
}

await open();
await page.waitForTimeout(300);
if (transferred > MOST_BYTES) fault(`/ transfers ${transferred} bytes`);
console.log(`/ transfers ${transferred} bytes`);

const contract = await (await fetch(`${address}/openapi.json`)).json();
const operations = await page.$$eval("#operation option", (options) => options.map((one) => one.value));
let count = 0;
for (const path of operations) {
  await page.selectOption("#operation", path);
  const examples = await page.$$eval("#example option", (options) => options.map((one) => one.value).filter((name) => name !== ""));
  for (const name of examples.filter((name) => only.length === 0 || only.some((part) => `${path} ${name}`.includes(part)))) {
    count += 1;
    await page.selectOption("#example", name);
    const status = await run();
    if (!status.startsWith("done")) {
      fault(`${path} ${name}: ${status}`);
      continue;
    }
    await compare(path, name);
    const pixels = await drawn();
    if (pixels < LEAST_PIXELS) fault(`${path} ${name}: the canvas shows nothing`);
  }
}
console.log(`${count} examples on the page`);

/** The text of the file that the page saves; null where it offers none. */
async function saved() {
  if (await page.getAttribute("#download", "href") === null) return null;
  const [file] = await Promise.all([page.waitForEvent("download"), page.evaluate(() => document.querySelector("#download").click())]);
  return readFileSync(await file.path(), "latin1");
}

/** The program on the page is that of the service, byte for byte. */
async function compare(path, name) {
  const text = await saved();
  const { post } = contract.paths[path];
  if (post.responses["200"].content["text/x-gcode"] === undefined) return;
  const example = post.requestBody.content["application/json"].examples[name].value;
  const response = await fetch(`${address}${path}?format=gcode`, {
    method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(example),
  });
  const theirs = await response.text();
  if (response.ok && text !== theirs) fault(`${path} ${name}: another program than curl gets`);
  const shown = await page.textContent("#nc");
  if (response.ok && theirs.split("\n").length < 3000 && shown !== theirs) fault(`${path} ${name}: another text in the page`);
}

/** Three wrong fields are told at their places. */
async function wrongFields() {
  await page.selectOption("#operation", "/v1/pockets/plan");
  await page.selectOption("#example", "island");
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
async function cancelling() {
  await page.selectOption("#operation", "/v1/pockets/plan");
  await page.selectOption("#example", "hundred-islands");
  await page.click("#run");
  await page.waitForTimeout(300);
  await page.click("#cancel");
  await page.waitForFunction(() => document.querySelector("#cancel").disabled);
  const status = await page.textContent("#status");
  if (status !== "cancelled") fault(`cancel: ${status}`);
  for (let k = 0; k < 50; k++) {
    const metrics = await (await fetch(`${address}/metrics`)).text();
    if (/running[^\n]* 0(\.0)?\n/.test(metrics)) return;
    await page.waitForTimeout(100);
  }
  fault("the computation goes on after cancel");
}

/** The form and the JSON agree after an edit of either. */
async function agreement() {
  await page.selectOption("#operation", "/v1/pockets/plan");
  await page.selectOption("#example", "circle");
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

/** axe finds nothing, in light and dark, wide and on a phone. */
async function accessible() {
  for (const [colorScheme, viewport] of [["light", { width: 1280, height: 800 }], ["dark", { width: 1280, height: 800 }],
    ["light", { width: 390, height: 844 }], ["dark", { width: 844, height: 390 }]]) {
    await page.emulateMedia({ colorScheme });
    await page.setViewportSize(viewport);
    await page.evaluate(axeText);
    const { violations } = await page.evaluate(() => globalThis.axe.run());
    for (const { id, nodes } of violations) fault(`axe, ${colorScheme}, ${viewport.width}: ${id} at ${nodes[0].target}`);
  }
}

for (const check of [wrongFields, cancelling, agreement, accessible]) await check();
await browser.close();
console.log(`${faults} faults`);
process.exit(faults === 0 ? 0 : 1);
