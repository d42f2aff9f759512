// Waits until all changes are applied, before a design is saved, linked, exported, run or pinned.

import type { Edit } from "../api/types.ts";
import { at, type Json } from "../model/json.ts";
import { words } from "../model/words.ts";
import { answer, draft, draftName, pending, problems } from "./design.ts";
import { isUnanswered, settled } from "./live.ts";
import { said } from "./said.ts";

/** Time of waiting after which there is a message, ms. */
const SAID_MS = 400;
/** Maximum number of refused values in a message. */
const NAMED = 2;

/** Returns a value as a short text. */
const short = (value: unknown): string => {
  const text = JSON.stringify(value) ?? "nothing";
  return text.length > 40 ? `${text.slice(0, 39)}…` : text;
};

/** Returns an edit as text. */
export const wanted = (edit: Edit): string =>
  edit.op === "set" ? `${edit.path} = ${short(edit.value)}` : `a change of ${edit.path}`;

/** Returns the current value of an edit's key as text. */
function instead({ path }: Edit): string {
  const now = at((answer.value?.fields ?? null) as Json, path);
  return now === undefined ? `no ${path}` : `${path} = ${short(now)}`;
}

const sentence = (text: string): string => (/[.!?]$/.test(text) ? text : `${text}.`);

/** Returns the refused changes, the reason, and the current values. */
function refusal(): string {
  const why = sentence(problems.value[0] ? words(problems.value[0]) : "It cannot be computed");
  if (draft.value !== null) return `${draftName.value || "the typed text"} cannot be computed. ${why}`;
  const last = pending.value.slice(-NAMED);
  const current = last.map(instead).join(", ");
  return `${last.map(wanted).join(", ")} was refused. ${why} The design that is shown has ${current}.`;
}

/**
 * Waits until all changes are in the text and returns true. Otherwise it returns false, with a message that the design
 * was not `done` (saved, linked), and the reason.
 */
export async function ready(done: string): Promise<boolean> {
  const slow = setTimeout(() => (said.value = "Waiting for the last change, which is being computed…"), SAID_MS);
  const all = await settled();
  clearTimeout(slow);
  if (!all)
    said.value = isUnanswered()
      ? `Not ${done}: Papilio does not respond, and the last change is still pending. It is stored in the browser.`
      : `Not ${done}: ${refusal()} Correct or discard the change, then try again.`;
  return all;
}
