// The files of an answer to take along: the program, and the other forms that the service makes.

/** @import { Operation } from "./contract.js" */

import { button, byId, el } from "./dom.js";
import { valueAt } from "./form/value.js";
import { detailOf, fileOf } from "./run.js";
import { TEXTS } from "./texts.js";

/** Forms of an answer by their media types. */
const FORMS = /** @type {const} */ ([
  ["json", "application/json"], ["svg", "image/svg+xml"], ["glb", "model/gltf-binary"], ["stl", "model/stl"],
  ["html", "text/html"],
]);
/** Signs that some system forbids in names of files. */
const FORBIDDEN = /[^\p{L}\p{N} ._-]/gu;

export class Downloads {
  /** @param {(text: string) => void} tell */
  constructor(tell) {
    this.tell = tell;
    this.link = byId("download", HTMLAnchorElement);
    this.host = byId("downloads", HTMLParagraphElement);
    /** @type {string | null} */
    this.url = null;
  }

  /**
   * Offers the program and the other forms of an answer.
   * @param {string | undefined} text
   * @param {Operation} operation
   * @param {unknown} body
   */
  offer(text, operation, body) {
    if (this.url !== null) URL.revokeObjectURL(this.url);
    this.url = text === undefined ? null : URL.createObjectURL(new Blob([text], { type: "text/plain" }));
    this.link.setAttribute("aria-disabled", String(text === undefined));
    if (this.url === null) this.link.removeAttribute("href");
    else this.link.href = this.url;
    this.link.download = programName(body);
    this.host.replaceChildren(...FORMS.filter(([, type]) => operation.forms.includes(type))
      .map(([form]) => button(TEXTS.downloads[form], () => this.#fetch(operation, body, form))));
  }

  /** Saves another form of the answer. @param {Operation} operation @param {unknown} body @param {string} form */
  async #fetch({ path }, body, form) {
    this.tell(TEXTS.running);
    try {
      const { blob, name } = await fileOf(path, form, body);
      saveFile(blob, name);
      this.tell(TEXTS.saved(name));
    } catch (error) {
      this.tell(TEXTS.failed(detailOf(error)));
    }
  }
}

/** The name of the file of a program. @param {unknown} body of the request */
export function programName(body) {
  const name = valueAt(body, ["program", "name"]);
  // A leading dot would hide the file.
  const stem = typeof name === "string" ? name.replace(FORBIDDEN, "").replace(/^[. ]+/, "").trim() : "";
  return `${stem || "program"}.nc`;
}

/** @param {Blob} blob @param {string} name */
export function saveFile(blob, name) {
  const link = el("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
