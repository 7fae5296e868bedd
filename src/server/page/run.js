// Sends a request to the service, tells its progress, and returns the answer.

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
    this.status = status;
    this.title = String(body["title"] ?? "");
    this.code = String(body["code"] ?? "");
    const errors = body["errors"];
    /** @type {FieldError[]} */
    this.errors = Array.isArray(errors) ? errors : [];
  }
}

/**
 * Runs a request. Events tell the progress; the last one is the answer.
 * @param {{ path: string, query: Record<string, string>, body: string, type?: string, signal: AbortSignal,
 *   onprogress: (progress: Progress) => void }} request
 * @returns {Promise<Answer>}
 * @throws {Problem} where the service refuses
 */
export async function run({ path, query, body, type = "application/json", signal, onprogress }) {
  const response = await fetch(address(path, query), {
    method: "POST", body, signal, headers: { "content-type": type, accept: "text/event-stream" },
  });
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
      const { value, done } = await reader.read();
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
 * The command that sends the same request with curl.
 * @param {string} path @param {Record<string, string>} query @param {string} body
 */
export function curl(path, query, body) {
  const url = new URL(address(path, query), document.baseURI).href;
  const quoted = (/** @type {string} */ text) => `'${text.replaceAll("'", "'\\''")}'`;
  return `curl -s ${quoted(url)} -H 'Content-Type: application/json' --data-binary ${quoted(body)}`;
}
