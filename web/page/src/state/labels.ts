// Labels of metrics and of keys: the quantity in words and its unit, from the program's one table. They are requested when
// they are first shown; until then, the words of the name are shown.

import { signal } from "@preact/signals";

import { post } from "../api/client.ts";
import type { Label } from "../api/types.ts";
import { split } from "../model/json.ts";
import { label as wordsOf, unit } from "../model/schema.ts";

const known = signal<Readonly<Record<string, Label>>>({});
const wanted = new Set<string>();

async function request(): Promise<void> {
  const names = [...wanted].filter((name) => !(name in known.peek()));
  if (names.length === 0) return;
  try {
    known.value = { ...known.peek(), ...(await post<Record<string, Label>>("labels", { names })) };
  } catch {
    // Without labels, the words of the names are shown; the next name asks again.
    names.forEach((name) => wanted.delete(name));
  }
}

/** Returns the label of a metric (`white.Y`) or of a key (`display.pixel.film.1.thickness_nm`). */
export function labelOf(name: string): Label {
  const found = known.value[name];
  if (found) return found;
  if (!wanted.has(name)) {
    if (wanted.size === Object.keys(known.peek()).length) queueMicrotask(() => void request());
    wanted.add(name);
  }
  const [, key] = split(name);
  const quantity = wordsOf(key);
  return { quantity, unit: unit(key), text: unit(key) ? `${quantity} (${unit(key)})` : quantity };
}

/** Returns the quantity and its unit: "Gamut area, u′v′ (% of sRGB)". */
export const labelText = (name: string): string => labelOf(name).text;
