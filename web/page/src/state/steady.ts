// Computed values that stay the same object while their content is equal, so that what depends on them is not drawn again.

import { computed, type ReadonlySignal } from "@preact/signals";

/** Returns a computed value of numbers, texts, and lists or records of them. */
export function steady<T>(of: () => T): ReadonlySignal<T> {
  let kept: T;
  let words: string | undefined;
  return computed(() => {
    const now = of();
    const text = JSON.stringify(now) ?? "";
    if (text !== words) [kept, words] = [now, text];
    return kept;
  });
}
