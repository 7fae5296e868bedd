// The page: a request on the left, the picture in the middle, the answer on the right.

/** @import { Contract, Operation } from "./contract.js" */
/** @import { Answer } from "./run.js" */

import { exampleOf, loadContract } from "./contract.js";
import { button, el } from "./dom.js";
import { RequestForm } from "./form/form.js";
import { JsonText } from "./form/json.js";
import { digits } from "./figures.js";
import { fragmentOf, requestOf } from "./link.js";
import { ProgramText } from "./nc.js";
import { opened, withText } from "./open.js";
import { Picture } from "./picture.js";
import { showReport } from "./report.js";
import { Problem, address, curl, run } from "./run.js";
import { open as openTab, tabs } from "./tabs.js";
import { TEXTS } from "./texts.js";

/** Forms of an answer to take along, by their media types. */
const FORMS = /** @type {const} */ ([
  ["json", "application/json"], ["svg", "image/svg+xml"], ["glb", "model/gltf-binary"], ["html", "text/html"],
]);

/** Where request, picture and answer stand one below the other. */
const NARROW = "(max-width: 1000px)";
/** The operation that reads programs. */
const READING = "/v1/programs/read";
/** A larger file is not read, bytes: browsers hold no longer texts. */
const LARGEST_FILE = 400_000_000;

/** @template {HTMLElement} T @param {string} id @param {new () => T} kind @returns {T} */
function byId(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`the page lacks ${id}`);
  return found;
}

class Page {
  /** @param {Contract} contract */
  constructor(contract) {
    this.contract = contract;
    this.operations = byId("operation", HTMLSelectElement);
    this.examples = byId("example", HTMLSelectElement);
    this.runButton = byId("run", HTMLButtonElement);
    this.cancelButton = byId("cancel", HTMLButtonElement);
    this.progress = byId("progress", HTMLProgressElement);
    this.status = byId("status", HTMLParagraphElement);
    this.form = new RequestForm(byId("form", HTMLElement), contract, { onchange: (value) => this.changed(value, "form") });
    this.json = new JsonText(byId("json", HTMLTextAreaElement), { onchange: (value) => this.changed(value, "json") });
    this.program = new ProgramText(byId("nc-host", HTMLElement), byId("nc", HTMLElement), {
      online: (line) => this.picture.highlight(line),
    });
    this.picture = new Picture((line) => this.program.light(line));
    /** @type {unknown} */
    this.body = {};
    /** @type {AbortController | null} */
    this.controller = null;
    /** @type {string | null} */
    this.fileUrl = null;
    this.operation = this.fillOperations();
    /** The example that is fetched. @type {Promise<void>} */
    this.chosen = Promise.resolve();
  }

  fillOperations() {
    const { operations } = this.contract;
    for (const operation of operations) this.operations.add(new Option(operation.title, operation.path));
    const first = operations.find((one) => one.path === "/v1/pockets/plan") ?? operations[0];
    if (first === undefined) throw new Error(TEXTS.noContract);
    return first;
  }

  listen() {
    this.operations.addEventListener("change", () => this.chooseOperation(this.operations.value));
    this.examples.addEventListener("change", () => {
      if (this.examples.value !== "") this.chooseExample(this.examples.value);
    });
    addEventListener("hashchange", () => this.follow(location.hash));
    this.runButton.addEventListener("click", () => this.run());
    this.cancelButton.addEventListener("click", () => this.controller?.abort());
    byId("copy-curl", HTMLButtonElement).addEventListener("click", () => this.copyCurl());
    byId("copy-link", HTMLButtonElement).addEventListener("click", () => this.copyLink());
    byId("open", HTMLInputElement).addEventListener("change", (event) => {
      const input = /** @type {HTMLInputElement} */ (event.target);
      if (input.files?.[0]) this.openFile(input.files[0]).finally(() => (input.value = ""));
    });
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      const file = event.dataTransfer?.files[0];
      if (event.defaultPrevented || file === undefined) return;
      event.preventDefault();
      this.openFile(file);
    });
    byId("find", HTMLFormElement).addEventListener("submit", (event) => {
      event.preventDefault();
      this.find(byId("find-text", HTMLInputElement).value);
    });
    byId("go", HTMLInputElement).addEventListener("change", (event) => {
      this.program.choose(Number(/** @type {HTMLInputElement} */ (event.target).value));
    });
    document.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) this.run();
    });
  }

  async start() {
    this.listen();
    if (!(await this.follow(location.hash))) await this.chooseOperation(this.operation.path);
    this.runButton.disabled = false;
    document.body.classList.remove("not-yet");
    if (this.status.textContent === TEXTS.loading) this.tell(TEXTS.ready);
  }

  /** Shows the request of a link. Returns whether there is one. @param {string} fragment */
  async follow(fragment) {
    if (fragment.length < 2) return false;
    const linked = await requestOf(fragment);
    const asked = linked && this.contract.operations.find((one) => one.path === linked.operation);
    if (!asked) this.tell(TEXTS.badLink);
    else await this.chooseOperation(asked.path, linked.body);
    return Boolean(asked);
  }

  /** Shows an operation with a request, or with its first example. @param {string} path @param {unknown} [body] */
  async chooseOperation(path, body) {
    const operation = this.contract.operations.find((one) => one.path === path);
    if (operation === undefined) return;
    this.operation = operation;
    this.operations.value = path;
    byId("about", HTMLParagraphElement).textContent = operation.help;
    const names = [...operation.examples.keys()];
    this.examples.replaceChildren(new Option(TEXTS.ownRequest, ""), ...names.map((name) => new Option(name, name)));
    if (body === undefined) return this.chooseExample(names[0] ?? "");
    this.examples.value = "";
    this.set(body);
  }

  /** @param {string} name */
  chooseExample(name) {
    const ask = byId("ask", HTMLElement);
    ask.setAttribute("aria-busy", "true");
    const chosen = this.fetchExample(name).catch((error) => this.fail(error, false)).finally(() => {
      if (this.chosen === chosen) ask.removeAttribute("aria-busy");
    });
    this.chosen = chosen;
    return chosen;
  }

  /** @param {string} name */
  async fetchExample(name) {
    this.examples.value = name;
    const { operation } = this;
    const body = name === "" ? {} : await exampleOf(operation, name);
    // Another one may have been chosen meanwhile.
    if (this.operation === operation && this.examples.value === name) this.set(body);
  }

  /** Shows a request. @param {unknown} body */
  set(body) {
    this.body = body;
    this.form.clearErrors();
    this.form.show(this.operation, body);
    this.json.set(body);
  }

  /** @param {unknown} body @param {"form" | "json"} from */
  changed(body, from) {
    this.body = body;
    this.examples.value = "";
    if (from === "json") this.form.show(this.operation, body);
    else this.json.set(body);
  }

  /** @param {string} text */
  tell(text) {
    this.status.textContent = text;
  }

  /** The query for an answer with all that the page shows. @returns {Record<string, string>} */
  query() {
    const names = new Set(this.operation.params.map((param) => param.name));
    /** @type {Record<string, string>} */
    const query = {};
    if (names.has("nc")) query["nc"] = "true";
    if (names.has("glb")) query["glb"] = "true";
    if (names.has("toolpath")) query["toolpath"] = "false";
    return query;
  }

  async run() {
    // A request that is still fetched is the one that people mean.
    await this.chosen;
    this.controller?.abort();
    const controller = new AbortController();
    this.controller = controller;
    this.form.clearErrors();
    this.tell(TEXTS.running);
    this.cancelButton.disabled = false;
    this.progress.hidden = false;
    this.progress.removeAttribute("value");
    const { operation, body } = this;
    const begun = performance.now();
    try {
      const answer = await run({
        path: operation.path, query: this.query(), body: JSON.stringify(body), signal: controller.signal,
        onprogress: ({ stage, fraction }) => {
          this.progress.value = fraction;
          this.tell(TEXTS.stage(stage.replaceAll("_", " "), Math.round(100 * fraction)));
        },
      }).catch((error) => {
        // Where no answer comes, browsers throw a TypeError.
        throw error instanceof TypeError ? new Error(TEXTS.noService) : error;
      });
      this.show(answer, operation, body);
      const seconds = digits((performance.now() - begun) / 1000);
      this.tell(TEXTS.done(seconds, answer.warnings.length));
    } catch (error) {
      this.fail(error, controller.signal.aborted);
    } finally {
      if (this.controller === controller) {
        this.controller = null;
        this.cancelButton.disabled = true;
        this.progress.hidden = true;
      }
    }
  }

  /** @param {unknown} error @param {boolean} isCancelled */
  fail(error, isCancelled) {
    if (isCancelled) return this.tell(TEXTS.cancelled);
    if (error instanceof Problem && error.errors.length > 0) {
      openTab(byId("tab-form", HTMLElement));
      this.form.setErrors(error.errors);
      return this.tell(TEXTS.refused(error.errors.length));
    }
    const detail = error instanceof Error ? error.message : String(error);
    this.tell(TEXTS.failed(detail || TEXTS.brokenOff));
  }

  /** @param {Answer} answer @param {Operation} operation @param {unknown} body */
  show(answer, operation, body) {
    byId("hint", HTMLParagraphElement).hidden = true;
    if (matchMedia(NARROW).matches) byId("see", HTMLElement).scrollIntoView();
    this.picture.show(answer.glb, /** @type {Record<string, unknown>} */ (body));
    const text = answer.nc ?? (operation.path === READING ? ownProgram(body) : undefined);
    this.program.set(text ?? TEXTS.noProgram);
    showReport(byId("report", HTMLElement), answer, this.picture.charts.element);
    openTab(byId(text === undefined ? "tab-report" : "tab-program", HTMLElement));
    this.offer(text, operation, body);
    if (this.picture.view === null) this.showSheet(operation, body);
  }

  /**
   * Shows the flat drawing of an answer, where the browser has no picture in three dimensions.
   * @param {Operation} operation
   * @param {unknown} body
   */
  async showSheet(operation, body) {
    const sheet = byId("sheet", HTMLImageElement);
    if (!operation.forms.includes("image/svg+xml")) return void (sheet.hidden = true);
    const response = await this.ask(operation, body, "svg");
    if (!response.ok) return;
    URL.revokeObjectURL(sheet.src);
    sheet.src = URL.createObjectURL(await response.blob());
    sheet.alt = TEXTS.sheet;
    sheet.hidden = false;
  }

  /** Asks for another form of an answer. @param {Operation} operation @param {unknown} body @param {string} form */
  ask(operation, body, form) {
    return fetch(address(operation.path, { format: form }), {
      method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" },
    });
  }

  /**
   * Offers the program and the other forms of the answer as files.
   * @param {string | undefined} text
   * @param {Operation} operation
   * @param {unknown} body
   */
  offer(text, operation, body) {
    const link = byId("download", HTMLAnchorElement);
    if (this.fileUrl !== null) URL.revokeObjectURL(this.fileUrl);
    this.fileUrl = text === undefined ? null : URL.createObjectURL(new Blob([text], { type: "text/plain" }));
    link.setAttribute("aria-disabled", String(text === undefined));
    if (this.fileUrl === null) link.removeAttribute("href");
    else link.href = this.fileUrl;
    link.download = "program.nc";
    const forms = FORMS.filter(([, type]) => operation.forms.includes(type))
      .map(([form]) => button(TEXTS.downloads[form], () => this.download(operation, body, form)));
    byId("downloads", HTMLParagraphElement).replaceChildren(...forms);
  }

  /** Saves another form of the answer. @param {Operation} operation @param {unknown} body @param {string} form */
  async download(operation, body, form) {
    this.tell(TEXTS.running);
    const response = await this.ask(operation, body, form);
    if (!response.ok) return this.tell(TEXTS.failed(`${response.status}`));
    const link = el("a", { href: URL.createObjectURL(await response.blob()), download: `answer.${form}` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    this.tell(TEXTS.ready);
  }

  /** @param {string} wanted */
  find(wanted) {
    const line = this.program.find(wanted);
    if (line === 0) return this.tell(TEXTS.notFound);
    this.program.choose(line);
  }

  copyCurl() {
    const form = this.operation.forms.includes("text/x-gcode") ? "gcode" : "json";
    this.copy(curl(this.operation.path, { format: form }, JSON.stringify(this.body)));
  }

  async copyLink() {
    const fragment = await fragmentOf({ operation: this.operation.path, body: this.body });
    if (fragment === null) return this.tell(TEXTS.linkTooLong);
    history.replaceState(null, "", fragment);
    await this.copy(location.href);
  }

  /** @param {string} text */
  async copy(text) {
    try {
      await navigator.clipboard.writeText(text);
      this.tell(TEXTS.copied);
    } catch {
      this.tell(TEXTS.notCopied);
    }
  }

  /** A request as JSON, a program, a CL file, or rows of numbers. @param {File} file */
  async openFile(file) {
    if (file.size > LARGEST_FILE) return this.tell(TEXTS.fileTooLarge(file.name));
    const { kind, text, value } = opened(await file.text());
    if (kind === "unknown") return this.tell(TEXTS.notUnderstood(file.name));
    if (kind === "table") return this.openTable(file.name, text);
    if (kind === "json") {
      this.examples.value = "";
      this.set(value);
      return this.tell(TEXTS.openedRequest(file.name, this.operation.title));
    }
    const request = withText(this.contract, this.operation, this.body, kind, text);
    if (request === null) return this.tell(TEXTS.notUnderstood(file.name));
    await this.chooseOperation(request.operation.path, request.body);
    this.tell(TEXTS.openedProgram(file.name, request.operation.title));
  }

  /** Puts the rows of a file into the form. @param {string} name @param {string} text */
  openTable(name, text) {
    const taken = this.form.takePoints(text);
    if (taken === null) {
      const titles = this.form.withTables().slice(0, 3).map((title) => `“${title}”`).join(", ");
      return this.tell(TEXTS.noTable(name, titles));
    }
    openTab(byId("tab-form", HTMLElement));
    this.tell(TEXTS.openedTable(name, taken.label, taken.columns.join(", "), taken.note));
    taken.show();
  }
}

/** The program in a request. @param {unknown} body @returns {string | undefined} */
function ownProgram(body) {
  const text = typeof body === "object" && body !== null && "nc" in body ? body.nc : undefined;
  return typeof text === "string" ? text : undefined;
}

/** Puts the texts at their places. */
function label() {
  const texts = /** @type {Record<string, unknown>} */ (TEXTS);
  for (const part of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-text]"))) {
    part.textContent = String(texts[part.dataset["text"] ?? ""] ?? "");
  }
}

async function begin() {
  label();
  for (const id of ["ask-tabs", "read-tabs"]) tabs(byId(id, HTMLElement));
  const status = byId("status", HTMLParagraphElement);
  status.textContent = TEXTS.loading;
  try {
    await new Page(await loadContract("page/contract.json")).start();
  } catch (error) {
    status.textContent = `${TEXTS.noContract}: ${error instanceof Error ? error.message : error}`;
  }
}

begin();
