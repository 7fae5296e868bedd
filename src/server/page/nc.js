// The text of a program: numbered lines, of which only those that are seen are in the document.

import { TEXTS } from "./texts.js";

/** Texts with fewer lines stand in the document as a whole. */
const WHOLE_LINES = 4000;
/** Lines above and below those that are seen. */
const MARGIN_LINES = 60;
/** The tallest content that browsers scroll without rounding, pixels. */
const TALLEST = 8_000_000;

export class ProgramText {
  /**
   * @param {HTMLElement} host scrolls
   * @param {HTMLElement} text holds the lines and nothing else
   * @param {{ online: (line: number) => void }} events
   */
  constructor(host, text, { online }) {
    this.host = host;
    this.element = text;
    this.online = online;
    this.text = "";
    this.starts = new Uint32Array([0]);
    this.lit = 0;
    this.first = 0;
    /** The first and the last line that stand in the document. */
    this.shown = "";
    /** Parts of a line that the wheel has turned already. */
    this.turned = 0;
    this.spacer = document.createElement("div");
    this.gutter = document.createElement("div");
    this.bar = document.createElement("div");
    this.spacer.className = "nc-spacer";
    this.gutter.className = "nc-gutter";
    this.bar.className = "nc-lit";
    this.bar.hidden = true;
    this.gutter.setAttribute("aria-hidden", "true");
    /** Says the chosen line to screen readers. */
    this.told = document.createElement("p");
    this.told.className = "seen-not";
    this.told.setAttribute("aria-live", "polite");
    host.after(this.told);
    host.replaceChildren(this.spacer);
    this.spacer.append(this.bar, this.gutter, text);
    host.addEventListener("scroll", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(host);
    this.spacer.addEventListener("click", (event) => this.click(event));
    host.addEventListener("keydown", (event) => this.key(event));
    host.addEventListener("wheel", (event) => this.turn(event), { passive: false });
  }

  get nLines() {
    return this.starts.length - (this.text.endsWith("\n") ? 1 : 0);
  }

  /** @param {string} text */
  set(text) {
    this.text = text;
    this.starts = lineStarts(text);
    this.shown = "";
    this.lit = 0;
    this.host.scrollTop = 0;
    const digits = String(this.nLines).length;
    this.gutter.style.width = this.element.style.marginLeft = `${digits + 1}ch`;
    this.draw();
  }

  get lineHeight() {
    return parseFloat(getComputedStyle(this.host).lineHeight) || 18;
  }

  /** Pixels of scrolling per line: fewer than a line is high where the text is very long. */
  get pitch() {
    return Math.min(this.lineHeight, TALLEST / Math.max(1, this.nLines));
  }

  draw() {
    const { lineHeight, pitch, nLines } = this;
    // With the last lines at the lower edge the first one that is seen has to stand at its place.
    const rest = this.host.clientHeight * (1 - pitch / lineHeight);
    this.spacer.style.height = `${Math.max(1, nLines * pitch + rest)}px`;
    const isWhole = nLines <= WHOLE_LINES;
    const seen = Math.ceil(this.host.clientHeight / lineHeight) || 40;
    const top = Math.floor(this.host.scrollTop / pitch);
    this.first = isWhole ? 0 : Math.max(0, top - MARGIN_LINES);
    const end = isWhole ? nLines : Math.min(nLines, top + seen + MARGIN_LINES);
    this.#write(this.first, end);
    const offset = isWhole ? 0 : this.host.scrollTop - (this.host.scrollTop / pitch - this.first) * lineHeight;
    this.offset = offset;
    for (const part of [this.element, this.gutter]) part.style.transform = `translateY(${offset}px)`;
    this.bar.hidden = !(this.lit > this.first && this.lit <= end);
    this.bar.style.transform = `translateY(${offset + (this.lit - 1 - this.first) * lineHeight}px)`;
    this.bar.style.height = `${lineHeight}px`;
  }

  /** Puts lines and their numbers into the document, if others stand there. @param {number} first @param {number} end */
  #write(first, end) {
    const shown = `${first} ${end}`;
    if (this.shown === shown) return;
    this.shown = shown;
    this.element.textContent = this.text.slice(this.starts[first] ?? 0, this.starts[end] ?? this.text.length);
    this.gutter.textContent = Array.from({ length: end - first }, (_, k) => first + k + 1).join("\n");
  }

  /** Lights a line, counted from 1, and scrolls to it; 0 lights none. @param {number} line */
  light(line) {
    this.lit = line;
    if (line > 0) {
      const top = (line - 1) * this.pitch;
      const { scrollTop, clientHeight } = this.host;
      if (top < scrollTop || top > scrollTop + (clientHeight - 2 * this.lineHeight) * (this.pitch / this.lineHeight)) {
        this.host.scrollTop = top - (clientHeight / 3) * (this.pitch / this.lineHeight);
      }
    }
    this.draw();
  }

  /** The next line with a text behind the lit line, round the end; 0 where there is none. @param {string} wanted */
  find(wanted) {
    if (wanted === "") return 0;
    // A pattern needs no copy of the text in capitals.
    const pattern = new RegExp(wanted.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"), "gi");
    pattern.lastIndex = this.starts[this.lit] ?? 0;
    const found = pattern.exec(this.text) ?? pattern.exec(this.text);
    return found === null ? 0 : this.lineAt(found.index);
  }

  /** The line of a character, counted from 1. @param {number} at */
  lineAt(at) {
    let low = 0;
    let high = this.starts.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if ((this.starts[middle] ?? 0) <= at) low = middle;
      else high = middle;
    }
    return low + 1;
  }

  /** Moves the lines under the wheel as far as in a short text, where the scroll bar would skip many.
   * @param {WheelEvent} event */
  turn(event) {
    const { lineHeight, pitch } = this;
    if (pitch === lineHeight || event.ctrlKey || event.shiftKey || event.deltaY === 0) return;
    event.preventDefault();
    const inLines = [event.deltaY / lineHeight, event.deltaY, event.deltaY * (this.host.clientHeight / lineHeight)];
    this.turned += inLines[event.deltaMode] ?? 0;
    const lines = Math.trunc(this.turned);
    this.turned -= lines;
    this.host.scrollTop = (Math.round(this.host.scrollTop / pitch) + lines) * pitch;
  }

  /** @param {MouseEvent} event */
  click(event) {
    const y = event.clientY - this.spacer.getBoundingClientRect().top - (this.offset ?? 0);
    this.choose(this.first + Math.floor(y / this.lineHeight) + 1);
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 20, PageUp: -20 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    this.choose(Math.min(this.nLines, Math.max(1, this.lit + step)));
  }

  /** @param {number} line */
  choose(line) {
    if (line < 1 || line > this.nLines) return;
    this.light(line);
    this.told.textContent = TEXTS.lineTold(line, this.text.slice(this.starts[line - 1], this.starts[line]).trim());
    this.online(line);
  }
}

/** Where the lines of a text start. @param {string} text */
export function lineStarts(text) {
  let count = 1;
  for (let at = text.indexOf("\n"); at >= 0; at = text.indexOf("\n", at + 1)) count++;
  const starts = new Uint32Array(count);
  let line = 1;
  for (let at = text.indexOf("\n"); at >= 0; at = text.indexOf("\n", at + 1)) starts[line++] = at + 1;
  return starts;
}
