// A form in a fake document, and what tests look for in it.
import { readFileSync } from "node:fs";
import { contractOf } from "../contract.js";
import { RequestForm } from "../form/form.js";
import { FakeElement, useFakeDocument } from "./form-dom.mjs";

const file = new URL("../../../../openapi/openapi.json", import.meta.url);
export const contract = contractOf(JSON.parse(readFileSync(file, "utf8")));

/** A form in a fake document. */
export function formOf(operation, value) {
  useFakeDocument();
  const host = new FakeElement("div");
  const told = [];
  const form = new RequestForm(host, contract, { onchange: (next) => told.push(next) });
  form.show(operation, value);
  return { form, host, told };
}

export function example(path, name) {
  const operation = contract.operations.find((one) => one.path === path);
  return { operation, value: structuredClone(operation.examples.get(name)) };
}

/** The input whose label starts with a name, inside of the group with a legend. */
export function inputOf(host, label, legend = "") {
  const group = legend === "" ? host
    : host.all().find((node) => node.tag === "legend" && node.textContent.startsWith(legend)).parentElement;
  const found = group.all().find((node) => node.tag === "label" && node.textContent.startsWith(label));
  return found.querySelector("input") ?? host.all().find((node) => node.id === found.getAttribute("for"));
}

/** Opens all closed sections. */
export function openAll(host) {
  for (const node of host.all().filter(({ tag }) => tag === "details")) node.open = true;
}

/** Elements of a class. */
export function ofClass(host, name) {
  return host.all().filter((node) => node.getAttribute("class") === name);
}

/** The element with a label for screen readers. */
export function named(host, label) {
  return host.all().find((node) => node.getAttribute("aria-label") === label);
}
