// A request in the fragment of a link. Nothing is stored anywhere, and a fragment is never sent to a server.

/** Longest link, in characters: longer ones are cut by mail and chat programs. */
const LONGEST = 30_000;

/** Largest text of a link, bytes, and most values within values. What the page writes stays far below. */
const MOST_BYTES = 4_000_000;
const MOST_DEPTH = 64;

/** @typedef {{ operation: string, body: unknown }} Linked */

/** The fragment of a request; null where it is too long. @param {Linked} request @returns {Promise<string | null>} */
export async function fragmentOf(request) {
  const text = new Blob([JSON.stringify(request)]);
  if (text.size > MOST_BYTES || !isShallow(request)) return null;
  const packed = await new Response(text.stream().pipeThrough(new CompressionStream("deflate-raw"))).arrayBuffer();
  if (packed.byteLength * 1.4 > LONGEST) return null;
  const letters = btoa(String.fromCharCode(...new Uint8Array(packed)));
  return "#" + letters.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** The request of a fragment; null where it holds none. @param {string} fragment @returns {Promise<Linked | null>} */
export async function requestOf(fragment) {
  if (fragment.length < 2) return null;
  try {
    const letters = atob(fragment.slice(1).replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
    const request = JSON.parse(await unpacked(bytes));
    return typeof request.operation === "string" && isShallow(request) ? request : null;
  } catch {
    return null;
  }
}

/** The text in packed bytes. @param {Uint8Array<ArrayBuffer>} bytes @throws {Error} where it is too large */
async function unpacked(bytes) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const parts = [];
  let length = 0;
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return new Blob(parts).text();
    parts.push(value);
    length += value.length;
    if (length > MOST_BYTES) {
      await reader.cancel();
      throw new Error("the text of the link is too large");
    }
  }
}

/** Whether a value holds no more values within values than the form can show. @param {unknown} value */
function isShallow(value) {
  let inner = [value];
  for (let depth = 0; depth <= MOST_DEPTH && inner.length > 0; depth++) {
    inner = inner.flatMap((one) => (typeof one === "object" && one !== null ? Object.values(one) : []));
  }
  return inner.length === 0;
}
