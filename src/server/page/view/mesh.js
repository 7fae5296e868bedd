// Draws shaded triangles: the part, the cutter and its holder.

import { bufferOf, point, Program } from "./gl.js";
/** @import { Color, Frame, GL } from "./gl.js" */
/** @import { MeshData } from "./types.js" */

/** GLSL: the light on a side whose normal is given in the camera's directions; both sides are lit. */
export const LIGHT_GLSL = `
vec3 lit(vec3 base, vec3 normal) {
  vec3 n = normalize(normal);
  n = n.z < 0.0 ? -n : n;
  float high = max(dot(n, vec3(0.36, 0.54, 0.76)), 0.0);
  float light = 0.42 + 0.5 * high + 0.16 * max(dot(n, vec3(-0.7, 0.1, 0.7)), 0.0);
  return base * light + 0.10 * pow(max(dot(n, vec3(0.2, 0.3, 0.93)), 0.0), 24.0);
}
`;

const VERTEX = `
layout(location = 0) in vec3 aPosition;
layout(location = 1) in vec3 aNormal;
uniform mat4 uView, uProjection, uModel;
out vec3 vNormal;
void main() {
  mat4 all = uView * uModel;
  vNormal = mat3(all) * aNormal;
  gl_Position = uProjection * (all * vec4(aPosition, 1.0));
}`;

const FRAGMENT = `${LIGHT_GLSL}
in vec3 vNormal;
uniform vec4 uColor;
out vec4 color;
void main() { color = vec4(lit(uColor.rgb, vNormal), uColor.a); }`;

const UPRIGHT = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

export class Mesh {
  #gl;
  #program;
  #array;
  #buffers;
  #count;

  /** @param {GL} gl @param {MeshData} data */
  constructor(gl, data) {
    this.#gl = gl;
    this.#program = new Program(gl, VERTEX, FRAGMENT);
    this.#array = gl.createVertexArray();
    gl.bindVertexArray(this.#array);
    const [positions, normals] = [bufferOf(gl, data.positions), bufferOf(gl, data.normals)];
    point(this.#program, "aPosition", positions, 3);
    point(this.#program, "aNormal", normals, 3);
    this.#buffers = [positions, normals, bufferOf(gl, data.indices, gl.ELEMENT_ARRAY_BUFFER)];
    gl.bindVertexArray(null);
    this.#count = data.indices.length;
  }

  /** Draws a range of the indices.
   * @param {Frame} frame @param {Color} color @param {number} [alpha] 0 to 1
   * @param {Float32Array} [model] matrix that places the mesh
   * @param {{first: number, count: number}} [range] all without it */
  draw(frame, color, alpha = 1, model = UPRIGHT, range = { first: 0, count: this.#count }) {
    const gl = this.#gl;
    this.#program.use().setFrame(frame).set({ uModel: model, uColor: [...color, alpha] });
    gl.bindVertexArray(this.#array);
    if (alpha < 1) {
      gl.enable(gl.BLEND);
      gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(false);
    }
    gl.drawElements(gl.TRIANGLES, range.count, gl.UNSIGNED_INT, 4 * range.first);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
    gl.bindVertexArray(null);
  }

  /** Draws the mesh with a program that reads `aPosition` at the place this mesh has it. */
  drawPlain() {
    this.#gl.bindVertexArray(this.#array);
    this.#gl.drawElements(this.#gl.TRIANGLES, this.#count, this.#gl.UNSIGNED_INT, 0);
    this.#gl.bindVertexArray(null);
  }

  dispose() {
    for (const buffer of this.#buffers) this.#gl.deleteBuffer(buffer);
    this.#gl.deleteVertexArray(this.#array);
    this.#gl.deleteProgram(this.#program.program);
  }
}
