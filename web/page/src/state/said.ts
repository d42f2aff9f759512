// The message about the last action, which screen readers announce.

import { effect, signal } from "@preact/signals";

/** Time for which a message is shown, ms. */
const SAID_MS = 9000;

export const said = signal("");

effect(() => {
  if (said.value === "") return undefined;
  const silence = setTimeout(() => (said.value = ""), SAID_MS);
  return () => clearTimeout(silence);
});
