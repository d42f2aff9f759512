// Labels of metrics and of keys: the quantity in words and its unit, from the program's one table. They are requested when
// they are first shown; until then, the words of the name are shown.

import { signal } from "@preact/signals";

import { post } from "../api/client.ts";
import type { Label } from "../api/types.ts";
import { split } from "../model/json.ts";
import { label as wordsOf, unit } from "../model/schema.ts";

const known = signal<Readonly<Record<string, Label>>>({});
const wanted = new Set<string>();
const requested = new Set<string>();

let isRequesting = false;

/** Requests the labels of all names that are wanted, also of those that are wanted while a request is in progress. */
async function request(): Promise<void> {
  if (isRequesting) return;
  isRequesting = true;
  try {
    for (;;) {
      const names = [...wanted].filter((name) => !requested.has(name));
      if (names.length === 0) break;
      names.forEach((name) => requested.add(name));
      try {
        known.value = { ...known.peek(), ...(await post<Record<string, Label>>("labels", { names })) };
      } catch {
        // Without labels, the words of the names are shown; the next time that they are shown, they are requested again.
        names.forEach((name) => [wanted, requested].forEach((all) => all.delete(name)));
      }
    }
  } finally {
    isRequesting = false;
  }
}

/** Returns the label of a metric (`white.Y`) or of a key (`display.pixel.film.1.thickness_nm`). */
export function labelOf(name: string): Label {
  const found = known.value[name];
  if (found) return found;
  if (!wanted.has(name)) {
    wanted.add(name);
    queueMicrotask(() => void request());
  }
  const [, key] = split(name);
  const quantity = wordsOf(key);
  return { quantity, unit: unit(key), text: unit(key) ? `${quantity} (${unit(key)})` : quantity };
}

/** Returns the quantity and its unit: "Gamut area, u′v′ (% of sRGB)". */
export const labelText = (name: string): string => labelOf(name).text;
