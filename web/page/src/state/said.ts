// What was just done, for eyes and screen readers.

import { effect, signal } from "@preact/signals";

/** How long it is said, ms. */
const SAID_MS = 9000;

export const said = signal("");

effect(() => {
  if (said.value === "") return undefined;
  const silence = setTimeout(() => (said.value = ""), SAID_MS);
  return () => clearTimeout(silence);
});
