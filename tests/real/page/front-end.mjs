// Runs the page of docs/front-end.md from another origin, and one whose origin is not listed.
// Usage: front-end.mjs ADDRESS PORT     PORT: of the origin that the service lists

import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { dirname, join, normalize } from "node:path";

const require = createRequire(process.env.PAGE_TOOLS);
const { chromium } = require("playwright-core");
const { PNG } = require("pngjs");

const [address, port] = process.argv.slice(2);
const three = dirname(dirname(require.resolve("three")));
const text = readFileSync("docs/front-end.md", "utf8").split("```html\n")[1]?.split("```")[0] ?? "";
const page = text.replace("http://127.0.0.1:8080", address);
/** A picture has at least as many pixels that are no background. */
const LEAST_PIXELS = 5000;

const server = createServer((request, response) => {
  const path = normalize(new URL(request.url ?? "/", "http://here").pathname);
  if (path === "/") return response.setHeader("content-type", "text/html").end(page);
  try {
    const file = readFileSync(join(three, path.replace(/^\/three\//, "")));
    response.setHeader("content-type", "text/javascript").end(file);
  } catch {
    response.writeHead(404).end();
  }
});

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});

/** What the page logs, and how many pixels of its canvas are not white. @param {number} at */
async function show(at) {
  await new Promise((resolve) => server.listen(at, "127.0.0.1", () => resolve(null)));
  const tab = await browser.newPage({ viewport: { width: 600, height: 400 } });
  const told = [];
  tab.on("console", (message) => message.type() === "error" && told.push(`${message.text()} ${message.location().url}`));
  tab.on("pageerror", (error) => told.push(error.message));
  await tab.goto(`http://127.0.0.1:${server.address().port}/`);
  await tab.waitForSelector("canvas", { timeout: 30_000 }).catch(() => null);
  await tab.waitForTimeout(500);
  const { data } = PNG.sync.read(await tab.screenshot());
  let pixels = 0;
  for (let k = 0; k < data.length; k += 4) pixels += Number(data[k] + data[k + 1] + data[k + 2] < 750);
  await tab.close();
  server.closeAllConnections();
  await new Promise((resolve) => server.close(resolve));
  return { told, pixels };
}

const faults = [];
const listed = await show(Number(port));
faults.push(...listed.told.filter((line) => !line.includes("favicon")));
if (listed.pixels < LEAST_PIXELS) faults.push(`the page of a listed origin shows ${listed.pixels} pixels`);
const unlisted = await show(0);
if (!unlisted.told.some((line) => line.includes("CORS"))) faults.push(`an origin that is not listed is let in: ${unlisted.told}`);
await browser.close();
for (const fault of faults) console.log(`FAULT: ${fault}`);
console.log(`the page of docs/front-end.md draws ${listed.pixels} pixels from another origin: ${faults.length} faults`);
process.exit(faults.length === 0 ? 0 : 1);
