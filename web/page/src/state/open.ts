// Whole texts that take the place of the present one: opened, undone, redone. Nothing that waits is lost by it.

import { batch, computed } from "@preact/signals";

import * as api from "../api/client.ts";
import { draft, held, pending, text } from "./design.ts";
import { BUSY, edit, isRefused, isTyped, kick, putBack, replace } from "./live.ts";
import { said } from "./said.ts";
import { accepted, history, redone, undone } from "./undo.ts";

/** Puts edits into the text that they are of, which is then the draft and a step of undo; false without a server. */
async function write(): Promise<boolean> {
  const [base, sent] = [draft.value, pending.value];
  const whole = base ?? text.value;
  let scenario = whole;
  try {
    ({ scenario } = await api.post<{ scenario: string }>("edit", { scenario: whole, edits: sent }));
  } catch (why) {
    if (!(why instanceof api.Refused) || why.status === 0 || why.status === BUSY) return false;
    said.value = `A change that does not fit was put back: ${why.message}`;
  }
  // An answer may have taken the edits meanwhile.
  if (draft.value !== base || (base === null && text.value !== whole)) return true;
  batch(() => {
    pending.value = pending.value.filter((edit) => !sent.includes(edit));
    draft.value = scenario;
    accepted(scenario, "");
  });
  return true;
}

/**
 * Makes a step of undo of what waits, before another text takes its place: edits are put into the text by the
 * server, whether or not it computes then. False if there is no server to do it.
 */
async function leave(): Promise<boolean> {
  if (held.value !== null) edit([held.value]);
  while (pending.value.length > 0)
    if (!(await write())) {
      said.value = "The last change waits for Papilio, which does not answer: nothing else is opened before.";
      return false;
    }
  if (isTyped()) accepted(draft.value!, "");
  return true;
}

/** Opens a whole text in the place of the present one, which becomes a step of undo with all that waits. */
export async function open(whole: string, file = ""): Promise<boolean> {
  if (!(await leave())) return false;
  replace(whole, "", file);
  return true;
}

/** Puts all that waits into the text, so that it can be edited as such. */
export async function writeOut(): Promise<void> {
  if (pending.value.length > 0 && (await leave())) kick();
}

/** Whether something waits that is no step of undo yet. */
export const isNew = computed(
  () => pending.value.length > 0 || (draft.value !== null && draft.value !== history.value.present),
);

/** One step back; from what was refused, or is being opened, to the design that computes. */
export async function undo(): Promise<void> {
  const isOpening = isNew.value && pending.value.length === 0 && !isTyped();
  if (isRefused() || isOpening) return putBack();
  if (await leave()) step(undone());
}

export function redo(): void {
  if (!isNew.value) step(redone());
}

const step = (whole: string | null): void => {
  if (whole !== null) replace(whole);
};
