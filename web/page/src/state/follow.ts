// Answers that follow the design while someone looks at them: asked for when the text has rested for a
// moment, dropped when it changes.

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { post, Refused, type Work } from "../api/client.ts";
import type { Problem } from "../api/types.ts";
import { fileIds } from "./files.ts";
import { text } from "./design.ts";

export interface Followed<T> {
  readonly value: T | null;
  readonly problems: readonly Problem[];
  readonly busy: boolean;
}

/** The answer to `path` for a scenario (that on the bench, if none is given) and what else the request says. */
export function useFollowed<T>(
  path: string,
  more: object,
  restMs: number,
  scenario: string | null = text.value,
): Followed<T> {
  const state = useSignal<Followed<T>>({ value: null, problems: [], busy: true });
  const files = fileIds.value;
  const asked = JSON.stringify([scenario, more, files]);
  useEffect(() => {
    if (scenario === null) {
      state.value = { value: null, problems: [], busy: false };
      return;
    }
    const abort = new AbortController();
    state.value = { ...state.value, busy: true };
    const rest = setTimeout(async () => {
      try {
        const work: Work = { scenario, files };
        const value = await post<T>(path, { ...work, ...more }, abort.signal);
        state.value = { value, problems: [], busy: false };
      } catch (why) {
        if (abort.signal.aborted) return;
        state.value = {
          value: state.value.value,
          problems: why instanceof Refused ? why.problems : [{ message: String(why) }],
          busy: false,
        };
      }
    }, restMs);
    return () => {
      clearTimeout(rest);
      abort.abort();
    };
  }, [asked]);
  return state.value;
}
