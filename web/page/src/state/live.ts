// From a movement to a new picture: one request is on its way, the newest value waits, nothing queues.
// A request that has become slow is dropped as soon as something newer waits; the server then stops its work.

import { batch } from "@preact/signals";

import * as api from "../api/client.ts";
import type { Edit } from "../api/types.ts";
import { answer, busy, draft, draftName, held, pending, problems, text } from "./design.ts";
import { merged } from "./edits.ts";
import { fileIds, sendAgain } from "./files.ts";
import { said } from "./said.ts";
import { accepted, undone } from "./undo.ts";
import type { Work as Kept } from "./works.ts";

/** A request older than this, and than twice what the last one took, gives way to a newer value, ms. */
const PATIENCE_MS = 250;
/** Waiting longer than this is shown, ms. */
const SHOWN_MS = 300;

/** All places are taken: the server asks to come again. */
export const BUSY = 503;
/** It is asked again after so many ms. */
const AGAIN_MS = 700;
const pause = (): Promise<true> => new Promise((resolve) => setTimeout(() => resolve(true), AGAIN_MS));

/** The requests that are on their way, one after the other, or null. */
let running: Promise<void> | null = null;
let dirty = false;
let gesture = "";
let lastTook = 0;
/** Whether the server gave no answer at all, last. */
let isGone = false;
export const isUnanswered = (): boolean => isGone;
/** The edits that were refused last. */
let refused: readonly Edit[] = [];
let flight: { abort: AbortController; since: number } | null = null;

/** Changes keys; `name` is the gesture that undo takes as one step. */
export function edit(edits: readonly Edit[], name = ""): void {
  batch(() => {
    pending.value = merged(pending.value, edits);
    held.value = null;
  });
  gesture = name;
  kick();
}

export const set = (path: string, value: unknown, name = path): void => edit([{ op: "set", path, value }], name);

/** Whether the draft is typed here, and is nowhere else. */
let typed = false;
export const isTyped = (): boolean => draft.value !== null && typed;

/** A whole text that is being typed. */
export const retype = (whole: string): void => replace(whole, "source", "", true);

/** Puts a whole text in the place of the present one, and of all that waits. */
export function replace(whole: string, name = "", file = "", isTyped = false): void {
  typed = isTyped;
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

/** Whether edits wait because they were refused. */
export const isRefused = (): boolean => pending.value.length > 0 && !running && problems.value.length > 0;

/** Drops what was refused; a text that was typed comes back with redo. */
export function putBack(): void {
  if (isTyped()) {
    accepted(draft.value!, "");
    undone();
  }
  batch(() => {
    pending.value = [];
    held.value = null;
    draft.value = null;
    problems.value = [];
  });
  flight?.abort.abort();
  kick();
}

/** Whether all changes are in the text; false if what waits was refused, or the server is gone. */
export async function settled(): Promise<boolean> {
  if (isWaiting() && !running) kick();
  while (running) await running;
  return !isWaiting();
}

const isWaiting = (): boolean => pending.value.length > 0 || draft.value !== null;

/** Goes on where a tab, or an earlier visit, ended. */
export function resume(work: Kept): void {
  typed = work.typed;
  batch(() => {
    text.value = work.text;
    draft.value = work.draft;
    draftName.value = work.draftName;
    pending.value = work.pending;
    held.value = null;
    problems.value = [];
  });
  gesture = "";
  refused = [];
  kick();
}

/** Asks again, nothing having changed here: after a file came back, say. */
export function kick(): void {
  dirty = true;
  if (!running) running = run();
  else if (flight && performance.now() - flight.since > patience()) flight.abort.abort();
}

const patience = (): number => Math.max(PATIENCE_MS, 2 * lastTook);

async function run(): Promise<void> {
  try {
    while (dirty) {
      dirty = false;
      await once();
    }
  } finally {
    running = null;
  }
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
    isGone = false;
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
    isGone = refusal.status === 0;
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
