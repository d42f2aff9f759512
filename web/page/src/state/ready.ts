// Before a design leaves the page (saved, linked, exported, walked, pinned), all changes must be in it.

import type { Edit } from "../api/types.ts";
import { at, type Json } from "../model/json.ts";
import { words } from "../model/words.ts";
import { answer, draft, draftName, pending, problems } from "./design.ts";
import { isUnanswered, settled } from "./live.ts";
import { said } from "./said.ts";

/** Waiting longer than this is said, ms. */
const SAID_MS = 400;
/** So many refused values are named. */
const NAMED = 2;

/** A value in a few letters. */
const short = (value: unknown): string => {
  const text = JSON.stringify(value) ?? "nothing";
  return text.length > 40 ? `${text.slice(0, 39)}…` : text;
};

/** What an edit wants. */
const wanted = (edit: Edit): string =>
  edit.op === "set" ? `${edit.path} = ${short(edit.value)}` : `a change of ${edit.path}`;

/** What the design holds instead of what an edit wants. */
function instead({ path }: Edit): string {
  const now = at((answer.value?.fields ?? null) as Json, path);
  return now === undefined ? `no ${path}` : `${path} = ${short(now)}`;
}

const sentence = (text: string): string => (/[.!?]$/.test(text) ? text : `${text}.`);

/** What was refused and why, and what the design holds instead. */
function refusal(): string {
  const why = sentence(problems.value[0] ? words(problems.value[0]) : "It does not compute");
  if (draft.value !== null) return `${draftName.value || "the text as it was typed"} does not compute. ${why}`;
  const last = pending.value.slice(-NAMED);
  const holds = last.map(instead).join(", ");
  return `${last.map(wanted).join(", ")} was refused. ${why} The design that is shown holds ${holds}.`;
}

/**
 * Waits until everything that was changed is in the text; otherwise says why it is not, and that nothing was
 * `done` (saved, linked).
 */
export async function ready(done: string): Promise<boolean> {
  const slow = setTimeout(() => (said.value = "Waiting for the last change, which is being computed…"), SAID_MS);
  const all = await settled();
  clearTimeout(slow);
  if (!all)
    said.value = isUnanswered()
      ? `Not ${done}: Papilio does not answer, and the last change waits for it. It is kept here.`
      : `Not ${done}: ${refusal()} Mend it or put it back, then try again.`;
  return all;
}
