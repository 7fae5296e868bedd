// The canvas as a stage: the WebGL2 context, its size, smooth edges at rest, and how long a frame takes.

import { NoWebGL } from "./gl.js";
/** @import { Camera } from "./camera.js" */
/** @import { Frame, GL, Theme } from "./gl.js" */

/** Samples of a pixel at rest. */
const SAMPLES = 4;
/** A picture at rest that takes longer, in ms, is drawn without smooth edges; they cost about twice. */
const SMOOTH_MS = 250;
/** A picture that takes longer is drawn without smooth edges while the view moves: 30 frames a second. */
const MOVING_MS = 28;
/** A moving picture that takes longer, in ms, is drawn with half as many pixels each way; one that takes less
 * than the second time, in ms, with all of them again. */
const [HALF_MS, WHOLE_MS] = [24, 6];
/** More pixels of the screen in a CSS pixel than this are not drawn one by one. */
const MOST_RATIO = 2;
/** Lines come nearer by this share of the camera's distance, so that the part does not hide them. */
const BIAS = 0.0015;

export class Stage {
  ratio = 1;
  /** @type {{buffer: WebGLFramebuffer, parts: WebGLRenderbuffer[], key: string}|null} */
  #target = null;
  #isSmooth = true;
  /** Whether a picture at rest takes too long for moving. */
  isSlow = false;
  /** Pixels of a moving picture for a pixel of the canvas, each way. */
  #share = 1;
  #canvas;

  /** @param {HTMLCanvasElement} canvas @throws {NoWebGL} */
  constructor(canvas) {
    this.#canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: true, depth: true, stencil: false });
    if (!gl) throw new NoWebGL();
    /** @type {GL} */ this.gl = gl;
  }

  /** Fits the canvas to its size on the page. @param {Camera} camera @returns {boolean} whether it changed */
  resize(camera) {
    const canvas = this.#canvas;
    this.ratio = Math.min(devicePixelRatio || 1, MOST_RATIO);
    camera.width = Math.max(canvas.clientWidth, 1);
    camera.height = Math.max(canvas.clientHeight, 1);
    const [width, height] = [Math.round(camera.width * this.ratio), Math.round(camera.height * this.ratio)];
    if (canvas.width === width && canvas.height === height) return false;
    canvas.width = width;
    canvas.height = height;
    return true;
  }

  /** @param {Camera} camera @param {Theme} theme @param {boolean} coarse
   * @param {boolean} isMoving whether it may have fewer pixels @returns {Frame} */
  frame(camera, theme, coarse, isMoving) {
    const share = isMoving ? this.#share : 1;
    const { width, height } = this.#canvas;
    return {
      ...camera.matrices(), size: [Math.ceil(width * share), Math.ceil(height * share)],
      ratio: this.ratio * share, bias: camera.pose.distance * BIAS, coarse, theme,
    };
  }

  /** Draws a frame; `layers` draws what is on it.
   * @param {Frame} frame @param {() => void} layers
   * @param {boolean} [isKept] whether `drawOn` goes on with it */
  draw(frame, layers, isKept = false) {
    const gl = this.gl;
    const [width, height] = frame.size;
    const samples = isKept || frame.coarse ? 0 : SAMPLES;
    const isDirect = !isKept && width === this.#canvas.width && (frame.coarse || !this.#isSmooth);
    const target = isDirect ? null : this.#targetOf(width, height, samples);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.clearColor(...frame.theme.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    layers();
    if (target) this.#show(target, width, height);
  }

  /** Draws more on the picture that was kept. @param {Frame} frame @param {() => void} layers */
  drawOn(frame, layers) {
    const gl = this.gl;
    const [width, height] = frame.size;
    const target = this.#targetOf(width, height, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.viewport(0, 0, width, height);
    layers();
    this.#show(target, width, height);
  }

  /** @param {WebGLFramebuffer} target @param {number} width @param {number} height */
  #show(target, width, height) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    const { width: right, height: top } = this.#canvas;
    const filter = width === right ? gl.NEAREST : gl.LINEAR;
    gl.blitFramebuffer(0, 0, width, height, 0, 0, right, top, gl.COLOR_BUFFER_BIT, filter);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** @param {number} width @param {number} height @param {number} samples @returns {WebGLFramebuffer} */
  #targetOf(width, height, samples) {
    const key = `${width} ${height} ${samples}`;
    if (this.#target?.key === key) return this.#target.buffer;
    this.#dropTarget();
    const gl = this.gl;
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    const formats = /** @type {const} */ ([
      [gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]);
    const parts = formats.map(([format, place]) => {
      const part = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, part);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, part);
      return part;
    });
    this.#target = { buffer, parts, key };
    return buffer;
  }

  #dropTarget() {
    this.gl.deleteFramebuffer(this.#target?.buffer ?? null);
    for (const part of this.#target?.parts ?? []) this.gl.deleteRenderbuffer(part);
    this.#target = null;
  }

  /** Waits until the frame is drawn. */
  wait() {
    const gl = this.gl;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** Chooses smooth edges or not by what a picture took.
   * @param {boolean} coarse whether it had no smooth edges for moving @param {number} elapsed ms */
  learn(coarse, elapsed) {
    if (coarse) {
      this.#share = elapsed > HALF_MS ? 0.5 : elapsed < WHOLE_MS ? 1 : this.#share;
      return;
    }
    this.isSlow = elapsed > MOVING_MS;
    this.#isSmooth = elapsed * (this.#isSmooth ? 1 : 2) < SMOOTH_MS;
  }

  /** Forgets what was on a context that is lost. */
  forget() { this.#target = null; }

  dispose() {
    this.#dropTarget();
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
