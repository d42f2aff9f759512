// Replacing the whole text: open, undo, redo. Pending changes are not lost.

import { batch, computed, signal } from "@preact/signals";

import { draft, held, opening, pending, text } from "./design.ts";
import { discard, edit, isRefused, isTyped, kick, replace } from "./live.ts";
import { said } from "./said.ts";
import { stepsOf, type Steps } from "./steps.ts";
import { accepted, history, redone, undone } from "./undo.ts";

/** The text that was opened last in this visit, or null. */
const opened = signal<string | null>(null);

/** The design with which a changed one is compared: as it was opened, or before the last change. */
export const former = computed((): { readonly text: string; readonly words: string } | null => {
  const before = opened.value ?? history.value.past.at(-1);
  if (before === undefined || before === text.value || text.value === "") return null;
  return { text: before, words: opened.value === null ? "before the last change" : "as opened" };
});

/** Applies the pending edits to their text, which becomes the draft; each gesture is an undo step. Returns false without a server. */
async function write(): Promise<boolean> {
  const [base, sent] = [draft.value, pending.value];
  const whole = base ?? text.value;
  let found: Steps;
  try {
    found = await stepsOf(whole, sent);
  } catch {
    return false;
  }
  if (found.refusal) said.value = `A change that cannot be applied was discarded: ${found.refusal.message}`;
  // A response may have applied the edits in the meantime.
  if (draft.value !== base || (base === null && text.value !== whole)) return true;
  batch(() => {
    pending.value = pending.value.filter((edit) => !sent.includes(edit));
    draft.value = found.steps.at(-1)?.[0] ?? whole;
    if (base !== null) accepted(base, "");
    for (const [scenario, gesture] of found.steps) accepted(scenario, gesture);
  });
  return true;
}

/**
 * Makes an undo step of the pending changes, before another text replaces them. The server applies the edits to the
 * text, even if the result cannot be computed. Returns false if the server does not respond.
 */
async function leave(): Promise<boolean> {
  if (held.value !== null) edit([held.value]);
  while (pending.value.length > 0)
    if (!(await write())) {
      said.value = "Papilio does not respond, and the last change is still pending: no other design can be opened now.";
      return false;
    }
  if (isTyped()) accepted(draft.value!, "");
  return true;
}

/**
 * Opens a whole text. The current design, with all pending changes, becomes an undo step. `name` is shown until there is
 * a result.
 */
export async function open(whole: string, file = "", name = file): Promise<boolean> {
  if (!(await leave())) return false;
  opening.value = name;
  opened.value = whole;
  replace(whole, file);
  return true;
}

/** Applies all pending edits to the text, so that the text can be edited. */
export async function writeOut(): Promise<void> {
  if (pending.value.length > 0 && (await leave())) kick();
}

/** Whether there are changes that are not an undo step yet. */
export const isNew = computed(
  () => pending.value.length > 0 || (draft.value !== null && draft.value !== history.value.present),
);

/** Undoes one step; a refused change or a scenario that is being opened is discarded. */
export async function undo(): Promise<void> {
  const isOpening = isNew.value && pending.value.length === 0 && !isTyped();
  if (isRefused() || isOpening) return discard();
  if (await leave()) step(undone());
}

export function redo(): void {
  if (!isNew.value) step(redone());
}

/** Forgets which design was opened: another one takes its place. */
export const forgetOpened = (): void => void (opened.value = null);

const step = (whole: string | null): void => {
  if (whole !== null) replace(whole);
};
