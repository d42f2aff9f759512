// The live result of the current design. One request is in progress at a time, and only the newest values wait for it. A
// slow request is cancelled as soon as newer values wait; the server then stops its computation.
//
// A change is answered in steps: with a first answer of the view that is shown, which is coarse and has its error; with the
// exact one of this view as soon as nothing has changed for a moment; and then with all views. A new change cancels the
// later ones. The server answers exactly at once if that takes little work.

import { batch, effect, signal, untracked } from "@preact/signals";

import * as api from "../api/client.ts";
import type { Edit, Live } from "../api/types.ts";
import { answer, busy, draft, draftName, held, isViewKnown, opening, pending, problems, resultCount, resultOf, showView, text, viewIndex } from "./design.ts";
import { byGesture, editsOf, merged, type Change } from "./edits.ts";
import { fileIds, keptIds, sendAgain } from "./files.ts";
import { revisionOf, type Ids } from "./revision.ts";
import { said } from "./said.ts";
import { gesture } from "./gesture.ts";
import { awaitServer, BUSY, gone } from "./server.ts";
import { stepsOf, type Step as TextStep } from "./steps.ts";
import { accepted, undone } from "./undo.ts";
import type { Work as Kept } from "./works.ts";

/** A request older than this, and older than twice the time of the last one, is cancelled for newer values, ms. */
const PATIENCE_MS = 250;
/** Time of waiting after which it is shown, ms. */
const SHOWN_MS = 300;
/** Time without changes after which the exact answer is requested, ms. */
const REST_MS = 100;

/** Time after which the request is repeated, ms. */
const AGAIN_MS = 700;
const pause = (): Promise<true> => new Promise((resolve) => setTimeout(() => resolve(true), AGAIN_MS));

/** The sequence of requests in progress, or null. */
let running: Promise<void> | null = null;
let dirty = false;
let lastTook = 0;
export const isUnanswered = (): boolean => gone.value;
/** The edits of the last refused request. */
let refused: readonly Change[] = [];
/** The answers to a change, in turn: the view that is shown, coarsely and exactly; all views, exactly. */
type Step = "first" | "exact" | "all";
let flight: { abort: AbortController; since: number; step: Step } | null = null;
/** The timer of the request for the next answer. */
let rest: ReturnType<typeof setTimeout> | undefined;

/**
 * Whether the first numbers of a change are awaited. Pictures are drawn after them: where the processor draws, a picture takes as long as
 * the numbers. A display whose numbers take long is drawn before them.
 */
export const awaitsNumbers = signal(false);
/** The longest time for which pictures wait after a change, and after another design was opened, ms. */
const [WAIT_MS, OPENING_MS] = [150, 1000];
let waited: ReturnType<typeof setTimeout> | undefined;

function awaitNumbers(are: boolean): void {
  clearTimeout(waited);
  awaitsNumbers.value = are;
  if (are) waited = setTimeout(() => (awaitsNumbers.value = false), opening.value === "" ? WAIT_MS : OPENING_MS);
}

/** Changes keys. All changes of a gesture are one undo step. */
export function edit(edits: readonly Edit[]): void {
  const of = gesture();
  batch(() => {
    pending.value = merged(
      pending.value,
      edits.map((one) => ({ ...one, gesture: of })),
    );
    held.value = null;
  });
  kick();
}

export const set = (path: string, value: unknown): void => edit([{ op: "set", path, value }]);

/** Whether the draft is being typed, and therefore exists nowhere else. */
let typed = false;
/** The gesture that made it. */
let draftGesture = "";
export const isTyped = (): boolean => draft.value !== null && typed;

/** Replaces the whole text while it is being typed. */
export function retype(whole: string): void {
  // What was typed before is a step, also if the server has not answered it.
  if (isTyped() && draftGesture !== gesture()) accepted(draft.value!, draftGesture);
  replace(whole, "", gesture());
}

/** Replaces the current text and all pending edits by a whole text; `by` is the gesture in which it is typed. */
export function replace(whole: string, file = "", by = ""): void {
  typed = by !== "";
  draftGesture = by;
  batch(() => {
    pending.value = [];
    draft.value = whole;
    draftName.value = file;
  });
  kick();
}

/**
 * Discards edits that were refused before and again together with newer ones, so that a wrong value does not block all
 * later changes. They are sent together first, because they may be valid together (two fractions of one sum).
 */
function dropRefused(sent: readonly Change[]): boolean {
  const newer = sent.filter((edit) => !refused.includes(edit));
  if (newer.length === 0 || newer.length === sent.length) return false;
  pending.value = pending.value.filter((edit) => !refused.includes(edit));
  said.value = "A change that cannot be computed was discarded.";
  return true;
}

/** Returns true if there are pending edits that were refused. */
export const isRefused = (): boolean => pending.value.length > 0 && !running && problems.value.length > 0;

/** Discards refused edits and the draft; a typed draft can be restored with redo. */
export function discard(): void {
  let before: string | null = null;
  if (isTyped()) {
    accepted(draft.value!, "");
    before = undone();
  }
  batch(() => {
    pending.value = [];
    held.value = null;
    draft.value = null;
    problems.value = [];
  });
  flight?.abort.abort();
  // What was typed before may have no answer yet.
  if (before !== null && before !== text.value) replace(before);
  else kick();
}

/** Waits until all changes are in the text; returns false if they were refused or the server does not respond. */
export async function settled(): Promise<boolean> {
  if (isWaiting() && !running) kick();
  while (running) await running;
  return !isWaiting();
}

const isWaiting = (): boolean => pending.value.length > 0 || draft.value !== null;

/** Restores the design of a tab or of an earlier visit. */
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
  draftGesture = "";
  refused = [];
  kick();
}

/** Requests the result again, for example after a file was sent again. */
export function kick(): void {
  dirty = true;
  clearTimeout(rest);
  if (!running) running = run("first");
  else if (flight && isLate(flight)) flight.abort.abort();
}

/** Shows another view, and computes it if it is not known. */
export function chooseView(index: number): void {
  showView(index);
  if (!isViewKnown()) kick();
}

const patience = (): number => Math.max(PATIENCE_MS, 2 * lastTook);

/** Whether a request is cancelled for newer values: an exact answer of older values is of no use. */
const isLate = ({ since, step }: { since: number; step: Step }): boolean =>
  step !== "first" || performance.now() - since > patience();

async function run(step: Step): Promise<void> {
  try {
    do {
      dirty = false;
      await once(step);
      step = "first";
    } while (dirty);
  } finally {
    running = null;
    if (next() && problems.value.length === 0) rest = setTimeout(refine, REST_MS);
  }
}

/** Returns the next answer of the design that is shown; null if all is known. */
function next(): Step | null {
  if (!answer.value || isWaiting()) return null;
  if (!answer.value.is_final) return "exact";
  return answer.value.view === null ? null : "all";
}

/** Requests the next answer. */
function refine(step = next()): void {
  clearTimeout(rest);
  if (!running && step) running = run(step);
}

/** Waits until all is exact, before it is saved or pinned; returns false if it cannot be computed. */
export async function exact(): Promise<boolean> {
  if (!(await settled())) return false;
  if (next()) refine("all");
  while (running) await running;
  return next() === null;
}

/** Takes over a result, whose text contains the edits that were sent, and which was computed with files; `steps` led to it. */
export function adopt(live: Live, sent: readonly Change[], files: Ids, steps: readonly TextStep[]): void {
  batch(() => {
    text.value = live.scenario;
    resultOf.value = revisionOf(live.scenario, files);
    resultCount.value += 1;
    draft.value = null;
    answer.value = live;
    pending.value = pending.value.filter((edit) => !sent.includes(edit));
    problems.value = [];
    refused = [];
    for (const [before, of] of steps) accepted(before, of);
    accepted(live.scenario, sent.at(-1)?.gesture ?? draftGesture);
  });
}

awaitServer(() => kick());

// A file that the design uses was replaced or removed.
effect(() => {
  const files = keptIds.value;
  untracked(() => resultOf.value !== "" && resultOf.value !== revisionOf(text.value, files) && kick());
});

/** The steps before the last one of changes that were sent together: a whole text, and the gestures. */
async function stepsTo(base: string | null, sent: readonly Change[]): Promise<readonly TextStep[]> {
  const first: TextStep[] = base !== null && sent.length > 0 ? [[base, draftGesture]] : [];
  const groups = byGesture(sent);
  if (groups.length < 2) return first;
  try {
    return [...first, ...(await stepsOf(base ?? text.value, groups.slice(0, -1).flat())).steps];
  } catch {
    return first;
  }
}

/** Shows the design without a refused change, which a reload has kept: the refusal is at its field, as before the reload. */
async function showWithout(files: Ids, signal: AbortSignal): Promise<void> {
  const work = { scenario: text.value, files: fileIds.value };
  const live = await api.live(work, [], "first", viewIndex.value, signal).catch(() => null);
  if (live === null || answer.value !== null) return;
  batch(() => {
    text.value = live.scenario;
    resultOf.value = revisionOf(live.scenario, files);
    resultCount.value += 1;
    answer.value = live;
  });
}

async function once(step: Step): Promise<void> {
  const sent = pending.value;
  const base = draft.value;
  const files = keptIds.value;
  const abort = new AbortController();
  const since = performance.now();
  flight = { abort, since, step };
  if (step === "first") awaitNumbers(true);
  // The view that is shown does not wait for the others.
  const slow = setTimeout(() => (busy.value = step !== "all"), SHOWN_MS);
  const impatient = setTimeout(() => dirty && abort.abort(), patience());
  try {
    const work = { scenario: base ?? text.value, files: fileIds.value };
    const [accuracy, view] = [step === "first" ? step : "exact", step === "all" ? null : viewIndex.value] as const;
    const live = await api.live(work, editsOf(sent), accuracy, view, abort.signal);
    if (step === "first") lastTook = performance.now() - since;
    gone.value = false;
    const steps = await stepsTo(base, sent);
    if (draft.value === base) adopt(live, sent, files, steps);
  } catch (why) {
    if (abort.signal.aborted) return;
    const refusal = why instanceof api.Refused ? why : new api.Refused(0, [{ message: String(why) }]);
    gone.value = refusal.status === 0;
    if (refusal.status === BUSY) dirty = await pause();
    else if ((await sendAgain(refusal)) || (!gone.value && dropRefused(sent))) dirty = true;
    else {
      problems.value = refusal.problems;
      if (answer.value === null && base === null && sent.length > 0) await showWithout(files, abort.signal);
    }
    // What got no answer is not refused.
    refused = dirty || gone.value ? [] : sent;
  } finally {
    clearTimeout(slow);
    clearTimeout(impatient);
    awaitNumbers(false);
    flight = null;
    if (!dirty) busy.value = false;
    if (!dirty || draft.value === null) opening.value = "";
  }
}
