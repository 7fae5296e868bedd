// Runs every example of every operation on the page, in Chromium, and breaks requests on purpose.
// Usage: browser.mjs ADDRESS [NAME ...]     NAME: only examples whose "PATH NAME" contains it; "checks": only the checks behind
// With SHOTS=FOLDER in the environment it saves pictures of the page there.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import {
  accessible, agreement, cancelling, corrected, failingExample, following, keyboard, oldAnswers, ownRequests, pasting, pictures,
  randomEdits, steady, twoRuns, upright, wrongFields,
} from "./checks.mjs";
import { differences, otherMaterials } from "./material.mjs";
import { keepAnswers, kindsDrawn, missing } from "./pixels.mjs";

const require = createRequire(process.env.PAGE_TOOLS);
const { chromium } = require("playwright-core");

const [address, ...only] = process.argv.slice(2);
const MOST_BYTES = 150_000;
/** A picture has at least as many pixels that are no background. */
const LEAST_PIXELS = 500;
/** So many examples state a stock, or have one assumed. */
const LEAST_MATERIALS = 24;
/** The operations whose examples show how an upright tool cuts the material. */
const CUTTING = ["/v1/surfaces/mill", "/v1/pockets/plan"];
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

await page.addInitScript(keepAnswers);

async function open() {
  await page.goto(`${address}/`);
  await page.waitForFunction(() => !document.querySelector("#run").disabled);
}

/** Chooses an operation, and one of its examples or its first, and waits for the request. */
async function choose(path, name) {
  await page.selectOption("#operation", path);
  if (name !== undefined) await page.selectOption("#example", name);
  await page.waitForSelector("#ask:not([aria-busy])");
}

/** Runs the request that stands on the page. Returns the status text at the end. */
async function run() {
  await page.click("#run");
  await page.waitForFunction(() => document.querySelector("#cancel").disabled, null, { timeout: 120_000 });
  return page.textContent("#status");
}

await open();
await page.waitForTimeout(300);
if (transferred > MOST_BYTES) fault(`/ transfers ${transferred} bytes`);
console.log(`/ transfers ${transferred} bytes`);

const contract = await (await fetch(`${address}/openapi.json`)).json();
const operations = await page.$$eval("#operation option", (options) => options.map((one) => one.value));
let count = 0;
let materials = 0;
for (const path of operations) {
  await choose(path);
  const examples = await page.$$eval("#example option", (options) => options.map((one) => one.value));
  const isMeant = (name) => only.length === 0 || only.some((part) => `${path} ${name}`.includes(part));
  for (const name of examples.filter((name) => name !== "" && isMeant(name))) {
    count += 1;
    await choose(path, name);
    const status = await run();
    if (!status.startsWith("Done")) {
      fault(`${path} ${name}: ${status}`);
      continue;
    }
    await compare(path, name);
    const kinds = await kindsDrawn(page);
    if (kinds === null) fault(`${path} ${name}: the answer has no model`);
    for (const what of await missing(page, LEAST_PIXELS, kinds ?? [])) fault(`${path} ${name}: ${what}`);
    if (CUTTING.includes(path)) await compareMaterial(path, name);
  }
}
console.log(`${count} examples on the page, and the material of ${materials}`);
if (only.length === 0 && materials < LEAST_MATERIALS) fault(`the material of ${materials} examples is compared`);

/** The bytes of the file that the page saves; null where it offers none. */
async function saved() {
  if (await page.getAttribute("#download", "href") === null) return null;
  const press = () => document.querySelector("#download").click();
  const [file] = await Promise.all([page.waitForEvent("download"), page.evaluate(press)]);
  return readFileSync(await file.path());
}

/** The program that belongs to an example: of the answer, else of the request; null without any. */
async function programOf(path, name) {
  const { post } = contract.paths[path];
  const example = post.requestBody.content["application/json"].examples[name].value;
  if (post.responses["200"].content["text/x-gcode"] === undefined) return example.nc ? Buffer.from(example.nc) : null;
  const response = await fetch(`${address}${path}?format=gcode`, {
    method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(example),
  });
  if (!response.ok) fault(`${path} ${name}: curl gets status ${response.status}`);
  return Buffer.from(await response.arrayBuffer());
}

/** The material on the page after the whole path is that which the cutter leaves. */
async function compareMaterial(path, name) {
  const { value } = contract.paths[path].post.requestBody.content["application/json"].examples[name];
  const differs = await differences(page, address, path, value);
  if (differs !== null) materials += 1;
  for (const what of differs ?? []) fault(`${path} ${name}: ${what}`);
}

/** The program on the page is that of the service, byte for byte. */
async function compare(path, name) {
  const own = await saved();
  const theirs = await programOf(path, name);
  if (theirs === null || own === null) {
    if (theirs !== own) fault(`${path} ${name}: ${own === null ? "no" : "a"} program is offered`);
    return;
  }
  if (!own.equals(theirs)) fault(`${path} ${name}: another program than curl gets`);
  const text = theirs.toString();
  const isWhole = text.split("\n").length < 3000;
  if (isWhole && await page.textContent("#nc") !== text) fault(`${path} ${name}: another text in the page`);
}

const bench = { page, address, fault, open, choose, run };
const checks = [
  wrongFields, cancelling, twoRuns, failingExample, oldAnswers, following, agreement, randomEdits, accessible, steady, pasting,
  corrected, keyboard, upright, ownRequests, otherMaterials,
];
for (const check of only.length === 0 || only.includes("checks") ? checks : []) await check(bench);
if (process.env.SHOTS) await pictures(bench, process.env.SHOTS);
await browser.close();
console.log(`${faults} faults`);
process.exit(faults === 0 ? 0 : 1);
