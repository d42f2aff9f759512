// From a movement to a new picture: one request is on its way, the newest value waits, nothing queues.
// A request that has become slow is dropped as soon as something newer waits; the server then stops its work.

import { batch } from "@preact/signals";

import * as api from "../api/client.ts";
import type { Edit } from "../api/types.ts";
import { answer, busy, draft, draftName, pending, problems, text } from "./design.ts";
import { merged } from "./edits.ts";
import { fileIds, sendAgain } from "./files.ts";
import { said } from "./said.ts";
import { accepted } from "./undo.ts";

/** A request older than this, and than twice what the last one took, gives way to a newer value, ms. */
const PATIENCE_MS = 250;
/** Waiting longer than this is shown, ms. */
const SHOWN_MS = 300;

/** All places are taken: the server asks to come again. */
const BUSY = 503;
/** It is asked again after so many ms. */
const AGAIN_MS = 700;
const pause = (): Promise<true> => new Promise((resolve) => setTimeout(() => resolve(true), AGAIN_MS));

let running = false;
let dirty = false;
let gesture = "";
let lastTook = 0;
/** The edits that were refused last. */
let refused: readonly Edit[] = [];
let flight: { abort: AbortController; since: number } | null = null;

/** Changes keys; `name` is the gesture that undo takes as one step. */
export function edit(edits: readonly Edit[], name = ""): void {
  pending.value = merged(pending.value, edits);
  gesture = name;
  kick();
}

export const set = (path: string, value: unknown, name = path): void => edit([{ op: "set", path, value }], name);

/** Puts a whole text in the place of the present one. */
export function replace(whole: string, name = "", file = ""): void {
  batch(() => {
    pending.value = [];
    draft.value = whole;
    draftName.value = file;
  });
  gesture = name;
  kick();
}

/**
 * Edits that were refused before and again with newer ones are given up for the newer ones, so that one
 * wrong value does not hold up everything after it; together they may have been right (two shares of one sum).
 */
function dropRefused(sent: readonly Edit[]): boolean {
  const newer = sent.filter((edit) => !refused.includes(edit));
  if (newer.length === 0 || newer.length === sent.length) return false;
  pending.value = pending.value.filter((edit) => !refused.includes(edit));
  said.value = "A change that does not compute was put back.";
  return true;
}

/** Drops what was refused. */
export function putBack(): void {
  batch(() => {
    pending.value = [];
    draft.value = null;
    problems.value = [];
  });
  kick();
}

/** Asks again, nothing having changed here: after a file came back, say. */
export function kick(): void {
  dirty = true;
  if (!running) void run();
  else if (flight && performance.now() - flight.since > patience()) flight.abort.abort();
}

const patience = (): number => Math.max(PATIENCE_MS, 2 * lastTook);

async function run(): Promise<void> {
  running = true;
  while (dirty) {
    dirty = false;
    await once();
  }
  running = false;
}

async function once(): Promise<void> {
  const sent = pending.value;
  const base = draft.value;
  const name = gesture;
  const abort = new AbortController();
  const since = performance.now();
  flight = { abort, since };
  const slow = setTimeout(() => (busy.value = true), SHOWN_MS);
  const impatient = setTimeout(() => dirty && abort.abort(), patience());
  try {
    const live = await api.live({ scenario: base ?? text.value, files: fileIds.value }, sent, abort.signal);
    lastTook = performance.now() - since;
    if (draft.value !== base) return;
    batch(() => {
      text.value = live.scenario;
      draft.value = null;
      answer.value = live;
      pending.value = pending.value.filter((edit) => !sent.includes(edit));
      problems.value = [];
      refused = [];
      accepted(live.scenario, name);
    });
  } catch (why) {
    if (abort.signal.aborted) return;
    const refusal = why instanceof api.Refused ? why : new api.Refused(0, [{ message: String(why) }]);
    if (refusal.status === BUSY) dirty = await pause();
    else if ((await sendAgain(refusal)) || dropRefused(sent)) dirty = true;
    else problems.value = refusal.problems;
    refused = dirty ? [] : sent;
  } finally {
    clearTimeout(slow);
    clearTimeout(impatient);
    flight = null;
    if (!dirty) busy.value = false;
  }
}
