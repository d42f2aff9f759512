// Links that contain a whole scenario: its compressed text in the fragment of the address, which is not sent to servers.

import { deflated, inflated, TooLong } from "../model/deflate.ts";

const KEY = "s=";
/** Maximum length of a text, because a small fragment can expand to a very large text. */
const LONGEST = 1 << 20;

/** Returns the fragment, without #, that contains a text. */
export async function packed(text: string): Promise<string> {
  const binary = Array.from(await deflated(new TextEncoder().encode(text)), (byte) => String.fromCharCode(byte)).join("");
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
  const text = await inflated(bytes, LONGEST).catch((why: unknown) => {
    throw why instanceof TooLong ? new Error("the link contains more than a scenario") : why;
  });
  return new TextDecoder("utf-8", { fatal: true }).decode(text);
}
