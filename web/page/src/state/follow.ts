// Results that follow the design while they are visible. They are requested after a short time without changes, and
// cancelled if the design changes.

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

/** Requests `path` for a scenario (by default the current one), with the additional fields `more`. */
export function useFollowed<T>(
  path: string,
  more: object,
  restMs: number,
  scenario: string | null = text.value,
): Followed<T> {
  const state = useSignal<Followed<T>>({ value: null, problems: [], busy: true });
  const files = fileIds.value;
  const request = JSON.stringify([scenario, more, files]);
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
  }, [request]);
  return state.value;
}
