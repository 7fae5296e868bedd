// A request in the fragment of a link. Nothing is stored anywhere, and a fragment is never sent to a server.

/** Longest link, in characters: longer ones are cut by mail and chat programs. */
const LONGEST = 30_000;

/** @typedef {{ operation: string, body: unknown }} Linked */

/** The fragment of a request; null where it is too long. @param {Linked} request @returns {Promise<string | null>} */
export async function fragmentOf(request) {
  const text = JSON.stringify(request);
  const packed = await new Response(new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"))).arrayBuffer();
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
    const text = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).text();
    const request = JSON.parse(text);
    return typeof request.operation === "string" ? request : null;
  } catch {
    return null;
  }
}
