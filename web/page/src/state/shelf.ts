// The lists of presets and examples.

import { signal } from "@preact/signals";

import { list } from "../api/client.ts";
import type { Named } from "../api/types.ts";

export const PRESETS = signal<readonly Named[]>([]);
export const EXAMPLES = signal<readonly Named[]>([]);

export async function fillShelf(): Promise<void> {
  [PRESETS.value, EXAMPLES.value] = await Promise.all([list("presets"), list("examples")]);
}
