// Sends a request to the service, tells its progress, and returns the answer or another form of it.

import { TEXTS } from "./texts.js";

/** Longest body, bytes, that a command can hold: Linux takes no longer argument than 128 KiB, and signs may be escaped. */
const LONGEST_ARGUMENT = 100_000;

/**
 * @typedef {{ stage: string, fraction: number, done: number, total: number }} Progress
 * @typedef {{ pointer: string, code: string, detail: string }} FieldError
 * @typedef {{ engine_version: string, warnings: { code: string, detail: string, pointer?: string }[],
 *   report: Record<string, unknown>, measures?: Record<string, unknown>, nc?: string, glb?: string,
 *   meta?: Record<string, string> }} Answer
 */

/** A refusal or a failure that the service told. */
export class Problem extends Error {
  /** @param {number} status @param {Record<string, unknown>} body */
  constructor(status, body) {
    super(String(body["detail"] ?? body["title"] ?? `status ${status}`));
    const errors = body["errors"];
    /** @type {FieldError[]} */
    this.errors = Array.isArray(errors) ? errors : [];
  }
}

/**
 * Runs a request. Events tell the progress; the last one is the answer.
 * @param {{ path: string, query: Record<string, string>, body: string, signal: AbortSignal,
 *   onprogress: (progress: Progress) => void }} request
 * @returns {Promise<Answer>}
 * @throws {Problem} where the service refuses
 */
export async function run({ path, query, body, signal, onprogress }) {
  const response = await send(path, query, body, { signal, accept: "text/event-stream" });
  const kind = response.headers.get("content-type") ?? "";
  if (!kind.startsWith("text/event-stream")) {
    const told = await response.json().catch(() => ({}));
    if (!response.ok) throw new Problem(response.status, told);
    return told;
  }
  for await (const { event, data } of events(response)) {
    if (event === "progress") onprogress(JSON.parse(data));
    else if (event === "result") return JSON.parse(data);
    else if (event === "problem") {
      const told = JSON.parse(data);
      throw new Problem(Number(told.status ?? response.status), told);
    }
  }
  throw new Problem(response.status, { detail: "" });
}

/**
 * Another form of an answer as a file.
 * @param {string} path @param {string} form @param {unknown} body
 * @returns {Promise<{ blob: Blob, name: string }>}
 * @throws {Problem} where the service refuses
 */
export async function fileOf(path, form, body) {
  const response = await send(path, { format: form }, JSON.stringify(body), {});
  if (!response.ok) throw new Problem(response.status, await response.json().catch(() => ({})));
  return { blob: await response.blob().catch(noAnswer), name: nameIn(response.headers) ?? `answer.${form}` };
}

/** The name of a file that the service told; null without one. @param {Headers} headers */
const nameIn = (headers) => /filename="([^"]+)"/.exec(headers.get("content-disposition") ?? "")?.[1] ?? null;

/**
 * @param {string} path @param {Record<string, string>} query @param {string} body
 * @param {{ signal?: AbortSignal, accept?: string }} options
 */
function send(path, query, body, { signal, accept = "*/*" }) {
  const headers = { "content-type": "application/json", accept };
  return fetch(address(path, query), { method: "POST", body, headers, ...(signal && { signal }) }).catch(noAnswer);
}

/** Where no answer comes, browsers throw a TypeError that tells people nothing. @param {unknown} error @returns {never} */
function noAnswer(error) {
  throw error instanceof TypeError ? new Error(TEXTS.noService) : error;
}

/** What an error tells people. @param {unknown} error */
export const detailOf = (error) => (error instanceof Error ? error.message : String(error)) || TEXTS.brokenOff;

/** The address of an operation, relative to the page. @param {string} path @param {Record<string, string>} query */
export function address(path, query) {
  const search = new URLSearchParams(query).toString();
  return path.replace(/^\//, "") + (search === "" ? "" : `?${search}`);
}

/**
 * The events of a response.
 * @param {Response} response
 * @returns {AsyncGenerator<{ event: string, data: string }>}
 */
async function* events(response) {
  if (response.body === null) return;
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  /** @type {string[]} */
  let parts = [];
  let event = "message";
  let data = "";
  try {
    for (;;) {
      const { value, done } = await reader.read().catch(noAnswer);
      if (done) return;
      // A line may come in very many parts, so they are joined once.
      const lines = value.split("\n");
      for (const [k, line] of lines.entries()) {
        parts.push(line);
        if (k === lines.length - 1) break;
        const whole = parts.join("");
        parts = [];
        if (whole.startsWith("event:")) event = whole.slice(6).trim();
        else if (whole.startsWith("data:")) data += whole.slice(5).trimStart();
        else if (whole.trim() === "" && data !== "") {
          yield { event, data };
          [event, data] = ["message", ""];
        }
      }
    }
  } finally {
    await reader.cancel().catch(() => {});
  }
}

/**
 * The command that sends the same request with curl. A body that no command can hold is read from a file.
 * @param {string} url @param {string} body @param {string} file  its name
 * @returns {{ command: string, needsFile: boolean }}
 */
export function curl(url, body, file) {
  const needsFile = new Blob([body]).size > LONGEST_ARGUMENT;
  // Double quotes are understood by all shells, but they leave signs in a body that shells replace.
  const sent = needsFile ? `@${file}` : `'${body.replaceAll("'", "'\\''")}'`;
  return { command: `curl -s "${url}" -H "Content-Type: application/json" --data-binary ${sent}`, needsFile };
}
