// Which layers can be added to the design: each is tried by the server while the menu is open, and what it refuses has its reason.

import { computed, signal } from "@preact/signals";

import { live, Refused } from "../api/client.ts";
import { words } from "../model/words.ts";
import { layerAddition } from "../drawing/actions.ts";
import { draft, pending, selected, text, viewIndex } from "./design.ts";
import { fileIds } from "./files.ts";
import { BUSY } from "./server.ts";

/** Time for which a layer is tried, ms. One that takes longer is offered. */
const PATIENCE_MS = 2000;

const place = computed(() => JSON.stringify([text.value, fileIds.value, selected.value]));

interface Tried {
  readonly place: string;
  readonly refused: ReadonlyMap<string, string>;
}
const tried = signal<Tried>({ place: "", refused: new Map() });
/** Reasons by the kinds of layers that cannot be added at the selected place. */
export const refusedLayers = computed(() => (tried.value.place === place.value ? tried.value.refused : new Map<string, string>()));

/** What was tried last, so that it is not tried again. */
let last = "";

async function reasonOf(kind: string): Promise<string | null> {
  const addition = layerAddition(kind);
  if (!addition) return null;
  try {
    const work = { scenario: text.value, files: fileIds.value };
    await live(work, addition.edits, "first", viewIndex.value, AbortSignal.timeout(PATIENCE_MS));
    return null;
  } catch (why) {
    // What only adding refuses, the Monte Carlo solver computes.
    const isRefused = why instanceof Refused && why.status !== 0 && why.status !== BUSY && !why.problems.some((one) => one.monte_carlo);
    return isRefused && why.problems[0] ? words(why.problems[0]) : null;
  }
}

/** Tries all kinds, one after the other. */
export async function tryLayers(kinds: readonly string[]): Promise<void> {
  if (pending.value.length > 0 || draft.value !== null) return;
  const here = place.value;
  if (last === here) return;
  last = here;
  tried.value = { place: here, refused: new Map() };
  for (const kind of kinds) {
    if (place.value !== here) return;
    const why = await reasonOf(kind);
    if (why !== null) tried.value = { place: here, refused: new Map([...tried.value.refused, [kind, why]]) };
  }
}
