// As much of a document as the form needs, for tests without a browser.

class FakeNode {
  constructor() {
    /** @type {FakeElement | null} */
    this.parentElement = null;
  }

  remove() {
    const { parentElement } = this;
    if (parentElement) parentElement.childNodes = parentElement.childNodes.filter((node) => node !== this);
    this.parentElement = null;
  }
}

class FakeText extends FakeNode {
  constructor(text) {
    super();
    this.textContent = text;
  }
}

export class FakeElement extends FakeNode {
  constructor(tag) {
    super();
    this.tag = tag;
    this.attributes = new Map();
    this.listeners = new Map();
    this.childNodes = [];
    this.style = {};
    this.typed = "";
    this.scrollTop = 0;
    this.offsetHeight = 30;
    this.classList = { add() {}, remove() {} };
  }

  get children() {
    return this.childNodes.filter((node) => node instanceof FakeElement);
  }

  /** All elements inside, in the order of the document. */
  all() {
    return this.children.flatMap((child) => [child, ...child.all()]);
  }

  get childElementCount() {
    return this.children.length;
  }

  get textContent() {
    return this.childNodes.map((node) => node.textContent).join("");
  }

  set textContent(text) {
    this.replaceChildren(...(text === "" ? [] : [text]));
  }

  get value() {
    if (this.tag === "option") return this.getAttribute("value") ?? this.textContent;
    if (this.tag !== "select") return this.typed;
    const values = this.children.map((option) => option.value);
    return values.includes(this.typed) ? this.typed : values[0] ?? "";
  }

  set value(text) {
    this.typed = text;
  }

  append(...nodes) {
    for (const each of nodes) {
      const node = typeof each === "string" ? new FakeText(each) : each;
      node.remove();
      node.parentElement = this;
      this.childNodes.push(node);
    }
  }

  after(...nodes) {
    const { parentElement } = this;
    if (!parentElement) return;
    const at = parentElement.childNodes.indexOf(this) + 1;
    for (const node of nodes) node.parentElement = parentElement;
    parentElement.childNodes.splice(at, 0, ...nodes);
  }

  replaceChildren(...nodes) {
    for (const node of this.childNodes) node.parentElement = null;
    this.childNodes = [];
    this.append(...nodes);
  }

  contains(other) {
    for (let node = other; node; node = node.parentElement) if (node === this) return true;
    return false;
  }

  getAttribute(name) {
    return this.attributes.get(name) ?? null;
  }

  setAttribute(name, value) {
    this.attributes.set(name, String(value));
  }

  removeAttribute(name) {
    this.attributes.delete(name);
  }

  toggleAttribute(name, isOn) {
    if (isOn) this.attributes.set(name, "");
    else this.attributes.delete(name);
  }

  addEventListener(name, listener) {
    this.listeners.set(name, [...(this.listeners.get(name) ?? []), listener]);
  }

  /** Tells the listeners of the element and of all around it. */
  dispatch(name, details = {}) {
    const event = { target: this, preventDefault() {}, stopPropagation() {}, ...details };
    for (let node = this; node; node = node.parentElement) {
      for (const listener of node.listeners.get(name) ?? []) listener(event);
    }
  }

  /** Types a text over the value. */
  type(text) {
    this.focus();
    this.value = text;
    this.dispatch(this.tag === "select" ? "change" : "input");
  }

  focus() {
    document.activeElement = this;
    this.dispatch("focusin");
  }

  select() {}

  scrollIntoView() {}

  querySelector(selector) {
    return this.querySelectorAll(selector)[0] ?? null;
  }

  querySelectorAll(selector) {
    const [, name, value] = /^\[([\w-]+)(?:="(.*)")?\]$/.exec(selector) ?? [];
    return this.all().filter((node) => (name
      ? node.attributes.has(name) && (value === undefined || node.getAttribute(name) === value)
      : node.tag === selector));
  }
}

for (const name of ["id", "title", "placeholder"]) {
  Object.defineProperty(FakeElement.prototype, name, {
    get() { return this.getAttribute(name) ?? ""; },
    set(value) { this.setAttribute(name, value); },
  });
}
for (const name of ["hidden", "disabled", "readOnly", "open"]) {
  Object.defineProperty(FakeElement.prototype, name, {
    get() { return this.attributes.has(name); },
    set(value) {
      this.toggleAttribute(name, value);
      const listeners = name === "open" ? this.listeners.get("toggle") : undefined;
      for (const listener of listeners ?? []) listener({ target: this });
    },
  });
}

/** Puts the document in place of the browser's. */
export function useFakeDocument() {
  globalThis.document = {
    activeElement: null,
    createElement: (tag) => new FakeElement(tag),
    createElementNS: (_, tag) => new FakeElement(tag),
    createTextNode: (text) => new FakeText(text),
  };
}
