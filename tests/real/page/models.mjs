// Checks the binary glTF file of every example: the validator of Khronos finds no error, three.js loads the file, and
// the lengths and boxes of its strips are those of the JSON answer.
// Usage: models.mjs ADDRESS

import { createRequire } from "node:module";
import { readFileSync } from "node:fs";

const require = createRequire(process.env.PAGE_TOOLS);
const validator = require("gltf-validator");
globalThis.self ??= globalThis;
const { GLTFLoader } = await import(require.resolve("three/examples/jsm/loaders/GLTFLoader.js"));
const { Box3, Vector3 } = await import(require.resolve("three").replace(/three\.cjs$/, "three.module.js"));

const address = process.argv[2];
/** Lengths and boxes may differ by this, mm, and lengths by this part. */
const NEAR = 1e-3;

const contract = JSON.parse(readFileSync("openapi/openapi.json", "utf8"));
let faults = 0;
let count = 0;

function fault(name, text) {
  faults += 1;
  console.log(`${name}: ${text}`);
}

async function ask(path, query, body) {
  return fetch(`${address}${path}?${query}`, {
    method: "POST", headers: { "content-type": "application/json", accept: "application/json" }, body: JSON.stringify(body),
  });
}

/** The strips of a loaded file as lists of places of the part, mm. */
function strips(scene) {
  const found = [];
  scene.traverse((part) => {
    if (!part.isLine) return;
    const position = part.geometry.getAttribute("position");
    const places = [];
    for (let k = 0; k < position.count; k++) {
      // In the scene y points up.
      const at = new Vector3().fromBufferAttribute(position, k).applyMatrix4(part.matrixWorld).multiplyScalar(1000);
      places.push(new Vector3(at.x, -at.z, at.y));
    }
    found.push({ places, kinds: part.geometry.getAttribute("_kind"), times: part.geometry.getAttribute("_time") });
  });
  return found;
}

async function check(name, path, body) {
  const response = await ask(path, "format=glb", body);
  if (!response.ok) return fault(name, `status ${response.status}`);
  const file = await response.arrayBuffer();
  const told = await validator.validateBytes(new Uint8Array(file));
  for (const { code, message, pointer } of told.issues.messages.filter((issue) => issue.severity === 0)) {
    fault(name, `${code} ${pointer}: ${message}`);
  }
  const { scene } = await new Promise((done, failed) => new GLTFLoader().parse(file, "", done, failed));
  scene.updateMatrixWorld(true);
  const answer = await (await ask(path, "toolpath=false", body)).json();
  if (answer.measures === undefined) return;
  const { cutting_length_mm, rapid_length_mm, total_time_s, bounds } = answer.measures;
  const box = new Box3();
  let [cutting, rapid, last] = [0, 0, 0];
  for (const { places, kinds, times } of strips(scene)) {
    places.forEach((place) => box.expandByPoint(place));
    for (let k = 1; k < places.length; k++) {
      const length = places[k].distanceTo(places[k - 1]);
      if (kinds.getX(k) === 0) rapid += length;
      else cutting += length;
    }
    if (times) last = Math.max(last, times.getX(times.count - 1));
  }
  const near = (a, b) => Math.abs(a - b) <= NEAR * Math.max(1, Math.abs(b));
  if (!near(cutting, cutting_length_mm)) fault(name, `cuts ${cutting} mm, the JSON ${cutting_length_mm} mm`);
  if (!near(rapid, rapid_length_mm)) fault(name, `rapids ${rapid} mm, the JSON ${rapid_length_mm} mm`);
  if (total_time_s !== undefined && !near(last, total_time_s)) fault(name, `ends after ${last} s, the JSON ${total_time_s} s`);
  for (const [own, theirs] of [[box.min, bounds.min], [box.max, bounds.max]]) {
    const off = Math.max(...["x", "y", "z"].map((axis, k) => Math.abs(own[axis] - theirs[k])));
    if (off > NEAR) fault(name, `the box differs by ${off} mm`);
  }
}

for (const [path, { post }] of Object.entries(contract.paths)) {
  if (post?.responses["200"]?.content["model/gltf-binary"] === undefined) continue;
  for (const [name, { value }] of Object.entries(post.requestBody.content["application/json"].examples ?? {})) {
    count += 1;
    await check(`${path} ${name}`, path, value);
  }
}
console.log(`${count} files of examples, ${faults} faults`);
process.exit(count > 30 && faults === 0 ? 0 : 1);
