// Which layers can be added to the design: each is tried by the server while the menu is open. What it refuses has its reason, and where only
// a key is missing that has a usual value, that is added, too.

import { computed, signal } from "@preact/signals";

import { live, Refused } from "../api/client.ts";
import type { Edit } from "../api/types.ts";
import { mendOf } from "../model/mends.ts";
import { words } from "../model/words.ts";
import { layerAddition } from "../drawing/actions.ts";
import { draft, pending, selected, text, viewIndex } from "./design.ts";
import { fileIds } from "./files.ts";
import { settled } from "./live.ts";
import { BUSY } from "./server.ts";

/** Time for which a layer is tried, ms. One that takes longer is offered. */
const PATIENCE_MS = 2000;

const place = computed(() => JSON.stringify([text.value, fileIds.value, selected.value]));

interface Tried {
  readonly place: string;
  readonly refused: ReadonlyMap<string, string>;
  readonly helped: ReadonlyMap<string, Help>;
}

/** What must be added together with a layer, and its words. */
export type Help = NonNullable<ReturnType<typeof mendOf>>;

const NOTHING: ReadonlyMap<string, never> = new Map<string, never>();
const tried = signal<Tried>({ place: "", refused: NOTHING, helped: NOTHING });
/** Reasons by the kinds of layers that cannot be added at the selected place. */
export const refusedLayers = computed(() => (tried.value.place === place.value ? tried.value.refused : NOTHING));
/** What is added together with layers, by their kinds. */
export const helpedLayers = computed((): ReadonlyMap<string, Help> => (tried.value.place === place.value ? tried.value.helped : NOTHING));

/** What was tried last, so that it is not tried again. */
let last = "";

/** Tries edits; returns why they are refused, or null. */
async function refusalOf(edits: readonly Edit[]): Promise<Refused | null> {
  try {
    const work = { scenario: text.value, files: fileIds.value };
    await live(work, [...edits], "first", viewIndex.value, AbortSignal.timeout(PATIENCE_MS));
    return null;
  } catch (why) {
    // What only adding refuses, the Monte Carlo solver computes.
    const isRefused = why instanceof Refused && why.status !== 0 && why.status !== BUSY && !why.problems.some((one) => one.monte_carlo);
    return isRefused && why.problems[0] ? why : null;
  }
}

/** Tries a kind; returns why it is refused, or what must be added with it. */
async function tryLayer(kind: string): Promise<{ why?: string; help?: Help }> {
  const addition = layerAddition(kind);
  if (!addition) return {};
  const { edits, instead } = addition;
  const first = await refusalOf(edits);
  if (!first) return instead === undefined ? {} : { help: { words: `in place of ${instead}`, edits: [] } };
  const mend = mendOf(first.problems);
  if (mend && (await refusalOf([...edits, ...mend.edits])) === null) return { help: { ...mend, words: `with ${mend.words}` } };
  return { why: words(first.problems[0]!) };
}

/** Tries all kinds, one after the other. */
export async function tryLayers(kinds: readonly string[]): Promise<void> {
  // The layers are tried on the design with its last change.
  if (!(await settled()) || pending.value.length > 0 || draft.value !== null) return;
  const here = place.value;
  if (last === here) return;
  last = here;
  tried.value = { place: here, refused: NOTHING, helped: NOTHING };
  for (const kind of kinds) {
    if (place.value !== here) return;
    const { why, help } = await tryLayer(kind);
    const { refused, helped } = tried.value;
    if (why !== undefined) tried.value = { place: here, refused: new Map([...refused, [kind, why]]), helped };
    if (help) tried.value = { place: here, refused, helped: new Map([...helped, [kind, help]]) };
  }
}
