// Links that contain a whole scenario: its compressed text in the fragment of the address, which is not sent to servers.

const KEY = "s=";
/** Maximum length of a text, because a small fragment can expand to a very large text. */
const LONGEST = 1 << 20;

async function through(bytes: Uint8Array, stream: GenericTransformStream, longest: number): Promise<Uint8Array> {
  const parts: Uint8Array[] = [];
  let length = 0;
  const reader = new Blob([bytes as BlobPart]).stream().pipeThrough(stream).getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += (value as Uint8Array).length;
    if (length > longest) throw new Error("the link contains more than a scenario");
    parts.push(value as Uint8Array);
  }
  const whole = new Uint8Array(length);
  parts.reduce((at, part) => (whole.set(part, at), at + part.length), 0);
  return whole;
}

/** Returns the fragment, without #, that contains a text. */
export async function packed(text: string): Promise<string> {
  const deflated = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"), Infinity);
  const binary = Array.from(deflated, (byte) => String.fromCharCode(byte)).join("");
  return KEY + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** Returns the text in a fragment, or null if it contains none. */
export async function unpacked(fragment: string): Promise<string | null> {
  const held = fragment
    .replace(/^#/, "")
    .split("&")
    .find((part) => part.startsWith(KEY));
  if (held === undefined) return null;
  const binary = atob(held.slice(KEY.length).replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const text = await through(bytes, new DecompressionStream("deflate-raw"), LONGEST);
  return new TextDecoder("utf-8", { fatal: true }).decode(text);
}
