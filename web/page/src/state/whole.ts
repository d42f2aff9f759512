// The text of the design with all changes, for saving and linking. It does not need the server: the page has the text.

import { withValue } from "../model/toml-set.ts";
import { draft, held, pending, text } from "./design.ts";
import { editsOf, merged, type Change } from "./edits.ts";
import { keptIds } from "./files.ts";
import { isUnanswered, settled } from "./live.ts";
import { ready, wanted } from "./ready.ts";
import { stepsOf } from "./steps.ts";

/** Time to wait for a change that is being computed, and then for its text alone, ms. */
const PATIENCE_MS = 5000;
const TEXT_MS = 2000;

export interface Whole {
  readonly text: string;
  /** Changes that only the server can write into the text, and which it has as a comment instead. */
  readonly left: readonly Change[];
}

/** Applies changes in the page; those that it cannot are listed in a comment. */
export function withoutServer(whole: string, changes: readonly Change[]): Whole {
  const left: Change[] = [];
  let now = whole;
  for (const change of changes) {
    const next = change.op === "set" ? withValue(now, change.path, change.value) : null;
    if (next === null) left.push(change);
    else now = next;
  }
  if (left.length === 0) return { text: now, left };
  const lines = left.map((change) => `#   ${change.op === "set" ? `${change.path} = ${JSON.stringify(change.value)}` : JSON.stringify(editsOf([change])[0])}`);
  return { text: `# Changes that were not applied, because Papilio did not respond:\n${lines.join("\n")}\n\n${now}`, left };
}

/** Returns the text with all changes; null if a change was refused, with a message that the design was not `done`. */
export async function wholeText(done: string): Promise<Whole | null> {
  const slow = new Promise<"slow">((resolve) => setTimeout(() => resolve("slow"), PATIENCE_MS));
  const answer = await Promise.race([settled(), slow]);
  if (answer === true && held.value === null) return { text: text.value, left: [] };
  if (answer === false && !isUnanswered()) return (await ready(done)) ? { text: text.value, left: [] } : null;
  const whole = draft.value ?? text.value;
  const changes = held.value === null ? pending.value : merged(pending.value, [held.value]);
  try {
    const { steps } = await stepsOf(whole, changes, AbortSignal.timeout(TEXT_MS));
    return { text: steps.at(-1)?.[0] ?? whole, left: [] };
  } catch {
    return withoutServer(whole, changes);
  }
}

/** Says which changes are missing in a text, as an end of a sentence; "" for none. */
export const missing = ({ left }: Whole): string =>
  left.length === 0 ? "" : `. Papilio does not respond: ${left.map(wanted).join(", ")} is in it as a comment only`;

/** Returns the uploaded files that a scenario uses and that are not part of its text, as an end of a sentence. */
export function withoutFiles(scenario: string): string {
  const left = Object.keys(keptIds.value).filter((name) => scenario.includes(JSON.stringify(name)));
  return left.length > 0 ? `, but not its files: ${left.join(", ")}` : "";
}
