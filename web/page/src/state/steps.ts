// The texts after each gesture: the undo steps of changes that are sent together.

import { post, Refused } from "../api/client.ts";
import { byGesture, editsOf, type Change } from "./edits.ts";
import { BUSY } from "./server.ts";

/** A text, and the gesture after which it is that of the design. */
export type Step = readonly [text: string, gesture: string];

export interface Steps {
  readonly steps: readonly Step[];
  /** Why a change cannot be applied, which is left out; null if all can. */
  readonly refusal: Refused | null;
}

/** Returns the text after each gesture. The server applies edits also to designs that cannot be computed. Throws if it does not respond. */
export async function stepsOf(text: string, changes: readonly Change[], signal?: AbortSignal): Promise<Steps> {
  const steps: Step[] = [];
  let refusal: Refused | null = null;
  for (const group of byGesture(changes)) {
    try {
      const work = { scenario: steps.at(-1)?.[0] ?? text, edits: editsOf(group) };
      const { scenario } = await post<{ scenario: string }>("edit", work, signal);
      steps.push([scenario, group[0]!.gesture ?? ""]);
    } catch (why) {
      if (!(why instanceof Refused) || why.status === 0 || why.status === BUSY) throw why;
      refusal = why;
    }
  }
  return { steps, refusal };
}
