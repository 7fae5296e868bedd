// Makes elements of the document.

/** @typedef {string | number | boolean | ((event: any) => void)} Attribute  functions are listeners */

/**
 * Makes an element.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, Attribute>} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") node.addEventListener(name, value);
    else if (typeof value === "boolean") node.toggleAttribute(name, value);
    else node.setAttribute(name, String(value));
  }
  node.append(...children);
  return node;
}

/** The element of the page with an id. @template {HTMLElement} T @param {string} id @param {new () => T} kind @returns {T} */
export function byId(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`the page lacks ${id}`);
  return found;
}

/**
 * @param {string} text
 * @param {(event: Event) => void} press
 * @param {string} [name]  of the class
 * @returns {HTMLButtonElement}
 */
export function button(text, press, name) {
  return el("button", { type: "button", click: press, ...(name === undefined ? {} : { class: name }) }, text);
}

/**
 * A text whose parts in backticks are set as code.
 * @param {string} text
 * @returns {Node[]}
 */
export function rich(text) {
  return text.split("`").map((part, at) => (at % 2 ? el("code", {}, part) : document.createTextNode(part)));
}

/** Puts texts at the places that name them. @param {Record<string, unknown>} texts */
export function label(texts) {
  for (const part of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-text]"))) {
    part.textContent = String(texts[part.dataset["text"] ?? ""] ?? "");
  }
  for (const part of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-label]"))) {
    part.setAttribute("aria-label", String(texts[part.dataset["label"] ?? ""] ?? ""));
  }
}
