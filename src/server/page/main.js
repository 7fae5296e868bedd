// The page: a request on the left, the picture in the middle, the answer on the right.

/** @import { Contract, Operation } from "./contract.js" */
/** @import { Answer } from "./run.js" */

import { exampleOf, loadContract } from "./contract.js";
import { byId, label } from "./dom.js";
import { Downloads, saveFile } from "./downloads.js";
import { RequestForm } from "./form/form.js";
import { JsonText } from "./form/json.js";
import { valueAt } from "./form/value.js";
import { digits } from "./figures.js";
import { fragmentOf, requestOf } from "./link.js";
import { ProgramText } from "./nc.js";
import { opened, withText } from "./open.js";
import { Picture } from "./picture.js";
import { showReport } from "./report.js";
import { Problem, address, curl, detailOf, run } from "./run.js";
import { open as openTab, tabs } from "./tabs.js";
import { TEXTS } from "./texts.js";

/** Where request, picture and answer stand one below the other. */
const NARROW = "(max-width: 1000px)";
/** The file with a request that is too long for a command. */
const REQUEST_FILE = "request.json";
/** A larger file is not read, bytes: browsers hold no longer texts. */
const LARGEST_FILE = 400_000_000;

class Page {
  /** @param {Contract} contract */
  constructor(contract) {
    this.contract = contract;
    this.operations = byId("operation", HTMLSelectElement);
    this.examples = byId("example", HTMLSelectElement);
    /** Stands first among the examples. */
    this.ownOption = new Option("", "");
    this.runButton = byId("run", HTMLButtonElement);
    this.cancelButton = byId("cancel", HTMLButtonElement);
    this.progress = byId("progress", HTMLProgressElement);
    this.status = byId("status", HTMLParagraphElement);
    /** What was told at the end of the last run. */
    this.done = "";
    this.form = new RequestForm(byId("form", HTMLElement), contract, { onchange: (value) => this.changed(value, "form") });
    this.json = new JsonText(byId("json", HTMLTextAreaElement), { onchange: (value) => this.changed(value, "json") });
    this.program = new ProgramText(byId("nc-host", HTMLElement), byId("nc", HTMLElement), {
      online: (line) => this.picture.highlight(line),
    });
    this.picture = new Picture((line) => this.program.light(line));
    this.downloads = new Downloads((text) => this.tell(text));
    /** @type {unknown} */
    this.body = {};
    /** The requests that people made, by operation. @type {Map<Operation, unknown>} */
    this.own = new Map();
    /** @type {AbortController | null} */
    this.controller = null;
    this.hasAnswer = false;
    this.operation = this.fillOperations();
    /** The example that is fetched. @type {Promise<void>} */
    this.chosen = Promise.resolve();
  }

  fillOperations() {
    const { operations } = this.contract;
    for (const operation of operations) this.operations.add(new Option(operation.title, operation.path));
    // The operation with the most examples is the one that people know best.
    const [first] = [...operations].sort((a, b) => b.examples.size - a.examples.size);
    if (first === undefined) throw new Error(TEXTS.noContract);
    return first;
  }

  listen() {
    this.operations.addEventListener("change", () => this.chooseOperation(this.operations.value));
    this.examples.addEventListener("change", () => {
      const own = this.own.get(this.operation);
      if (this.examples.value !== "") this.chooseExample(this.examples.value);
      else if (own !== undefined) this.set(own);
    });
    addEventListener("hashchange", () => this.follow(location.hash));
    this.runButton.addEventListener("click", () => this.run());
    this.cancelButton.addEventListener("click", () => this.controller?.abort());
    byId("copy-curl", HTMLButtonElement).addEventListener("click", () => this.copyCurl());
    byId("copy-link", HTMLButtonElement).addEventListener("click", () => this.copyLink());
    byId("open", HTMLInputElement).addEventListener("change", (event) => {
      const input = /** @type {HTMLInputElement} */ (event.target);
      if (input.files?.[0]) this.take(input.files[0]).finally(() => (input.value = ""));
    });
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      const file = event.dataTransfer?.files[0];
      if (event.defaultPrevented || file === undefined) return;
      event.preventDefault();
      this.take(file);
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
    if (!asked) {
      this.tell(TEXTS.badLink);
      return false;
    }
    try {
      await this.chooseOperation(asked.path, linked.body);
    } catch {
      // A link may hold anything, such as a body that breaks the form.
      await this.chooseOperation(asked.path);
      this.tell(TEXTS.badLink);
    }
    return true;
  }

  /**
   * Shows an operation with a request; without one with the request that people made, or with the first example.
   * @param {string} path @param {unknown} [body]
   */
  async chooseOperation(path, body) {
    const operation = this.contract.operations.find((one) => one.path === path);
    if (operation === undefined) return;
    this.operation = operation;
    this.operations.value = path;
    byId("about", HTMLParagraphElement).textContent = operation.help;
    const names = [...operation.examples.keys()];
    this.examples.replaceChildren(this.ownOption, ...names.map((name) => new Option(name, name)));
    this.offerOwn();
    const shown = body ?? this.own.get(operation);
    if (shown === undefined) return this.chooseExample(names[0] ?? "");
    this.setOwn(shown);
  }

  /** Offers the request that people made for the operation, or tells that there is none. */
  offerOwn() {
    const isThere = this.own.has(this.operation);
    this.ownOption.disabled = !isThere;
    this.ownOption.text = isThere ? TEXTS.ownRequest : TEXTS.noOwnRequest;
  }

  /** Keeps a request that is no example. @param {unknown} body */
  keepOwn(body) {
    this.own.set(this.operation, body);
    this.offerOwn();
    this.examples.value = "";
  }

  /** @param {string} name */
  chooseExample(name) {
    const ask = byId("ask", HTMLElement);
    ask.setAttribute("aria-busy", "true");
    // The form still holds the request of what was chosen before.
    ask.inert = true;
    const chosen = this.fetchExample(name).finally(() => {
      if (this.chosen !== chosen) return;
      ask.removeAttribute("aria-busy");
      ask.inert = false;
    });
    this.chosen = chosen;
    return chosen;
  }

  /** @param {string} name */
  async fetchExample(name) {
    this.examples.value = name;
    const { operation } = this;
    // Another one may have been chosen meanwhile.
    const isChosen = () => this.operation === operation && this.examples.value === name;
    try {
      const body = name === "" ? {} : await exampleOf(operation, name);
      if (isChosen()) this.set(body);
    } catch (error) {
      if (!isChosen()) return;
      this.examples.value = "";
      this.set({});
      this.tell(TEXTS.noExample(name, detailOf(error)));
    }
  }

  /** Shows a request that is no example. @param {unknown} body */
  setOwn(body) {
    this.set(body);
    this.keepOwn(body);
  }

  /** Shows a request. @param {unknown} body */
  set(body) {
    this.body = body;
    this.markOld(true);
    this.form.show(this.operation, body);
    this.json.set(body);
  }

  /** @param {unknown} body @param {"form" | "json"} from */
  changed(body, from) {
    if (from === "form" && this.json.isBroken && !confirm(TEXTS.replaceJson)) {
      this.form.show(this.operation, this.body);
      return this.showBrokenJson();
    }
    this.body = body;
    this.keepOwn(body);
    this.markOld(true);
    if (from === "json") this.form.show(this.operation, body);
    else this.json.set(body);
  }

  /** Shows the text that is no JSON, and what is wrong with it. */
  showBrokenJson() {
    openTab(byId("tab-json", HTMLElement));
    byId("json", HTMLTextAreaElement).focus();
    this.tell(TEXTS.brokenJson);
  }

  /** Tells at picture, answer and status whether they belong to an earlier request. @param {boolean} isOld */
  markOld(isOld) {
    for (const id of ["old-picture", "old-answer"]) byId(id, HTMLElement).hidden = !isOld || !this.hasAnswer;
    if (isOld && this.status.textContent === this.done) this.tell(TEXTS.ready);
  }

  /** @param {string} text */
  tell(text) {
    // Screen readers would say the same text again.
    if (this.status.textContent !== text) this.status.textContent = text;
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
    if (this.json.isBroken) return this.showBrokenJson();
    this.controller?.abort();
    const controller = new AbortController();
    this.controller = controller;
    this.form.clearErrors();
    this.tell(TEXTS.running);
    this.cancelButton.disabled = false;
    this.progress.hidden = false;
    this.progress.removeAttribute("value");
    const { operation, body } = this;
    // Of two runs at once, the later one alone tells and shows something.
    const isLatest = () => this.controller === controller;
    const begun = performance.now();
    try {
      const answer = await run({
        path: operation.path, query: this.query(), body: JSON.stringify(body), signal: controller.signal,
        onprogress: ({ stage, fraction }) => {
          if (!isLatest()) return;
          this.progress.value = fraction;
          this.tell(TEXTS.stage(stage.replaceAll("_", " ")));
        },
      });
      if (!isLatest()) return;
      this.show(answer, operation, body);
      const seconds = digits(Math.round((performance.now() - begun) / 10) / 100);
      this.done = TEXTS.done(seconds, answer.warnings.length);
      this.tell(this.done);
    } catch (error) {
      if (isLatest()) this.fail(error, controller.signal.aborted, this.stillAsks(operation, body));
    } finally {
      if (isLatest()) {
        this.controller = null;
        this.cancelButton.disabled = true;
        this.progress.hidden = true;
      }
    }
  }

  /** Whether the form still holds a request. @param {Operation} operation @param {unknown} body */
  stillAsks(operation, body) {
    return this.operation === operation && this.body === body;
  }

  /** @param {unknown} error @param {boolean} isCancelled @param {boolean} isInForm  whether its fields are those of the form */
  fail(error, isCancelled, isInForm) {
    this.markOld(true);
    if (isCancelled) return this.tell(TEXTS.cancelled);
    if (error instanceof Problem && error.errors.length > 0 && isInForm) {
      openTab(byId("tab-form", HTMLElement));
      this.form.setErrors(error.errors);
      return this.tell(TEXTS.refused(error.errors.length));
    }
    this.tell(TEXTS.failed(detailOf(error)));
  }

  /** @param {Answer} answer @param {Operation} operation @param {unknown} body */
  show(answer, operation, body) {
    this.hasAnswer = true;
    if (matchMedia(NARROW).matches) byId("see", HTMLElement).scrollIntoView();
    this.picture.show(answer.glb, body);
    const text = answer.nc ?? ownProgram(body);
    this.program.set(text ?? TEXTS.noProgram);
    showReport(byId("report", HTMLElement), answer, this.picture.charts.element);
    const program = byId("tab-program", HTMLElement);
    if (text === undefined && program.getAttribute("aria-selected") === "true") openTab(byId("tab-report", HTMLElement));
    this.downloads.offer(text, operation, body);
    this.markOld(!this.stillAsks(operation, body));
    if (this.picture.view !== null) return;
    this.picture.showSheet(operation, body).catch((error) => this.tell(TEXTS.failed(detailOf(error))));
  }

  /** @param {string} wanted */
  find(wanted) {
    const line = this.program.find(wanted);
    if (line === 0) return this.tell(TEXTS.notFound);
    this.program.choose(line);
  }

  copyCurl() {
    const { path, forms } = this.operation;
    const form = forms.includes("text/x-gcode") ? "gcode" : "json";
    const body = JSON.stringify(this.body);
    const { command, needsFile } = curl(new URL(address(path, { format: form }), document.baseURI).href, body, REQUEST_FILE);
    if (needsFile) saveFile(new Blob([body], { type: "application/json" }), REQUEST_FILE);
    return this.copy(command, needsFile ? TEXTS.copiedWithFile(REQUEST_FILE) : TEXTS.copiedCurl);
  }

  async copyLink() {
    const fragment = await fragmentOf({ operation: this.operation.path, body: this.body });
    if (fragment === null) return this.tell(TEXTS.linkTooLong);
    history.replaceState(null, "", fragment);
    await this.copy(location.href, TEXTS.copied);
  }

  /** @param {string} text @param {string} told  where it is copied */
  async copy(text, told) {
    try {
      await navigator.clipboard.writeText(text);
      this.tell(told);
    } catch {
      this.tell(TEXTS.notCopied);
    }
  }

  /** Opens a file, or tells why it cannot be read: a folder can be dropped too. @param {File} file */
  take(file) {
    return this.openFile(file).catch((error) => this.tell(TEXTS.notRead(file.name, detailOf(error))));
  }

  /** A request as JSON, a program, a CL file, or rows of numbers. @param {File} file */
  async openFile(file) {
    if (file.size > LARGEST_FILE) return this.tell(TEXTS.fileTooLarge(file.name, LARGEST_FILE));
    const { kind, text, value } = opened(await file.text());
    if (kind === "unknown") return this.tell(TEXTS.notUnderstood(file.name));
    if (kind === "table") return this.openTable(file.name, text);
    if (kind === "json") {
      this.setOwn(value);
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
  const text = valueAt(body, ["nc"]);
  return typeof text === "string" ? text : undefined;
}

async function begin() {
  label(TEXTS);
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
