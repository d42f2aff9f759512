// Results that follow the design while they are visible. They are requested after a short time without changes, and
// cancelled if the design changes.

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { post, Refused, type Work } from "../api/client.ts";
import type { Problem } from "../api/types.ts";
import { fileIds } from "./files.ts";
import { text } from "./design.ts";
import { BUSY } from "./live.ts";

/** Time after which a request to a busy server is repeated, ms. */
const AGAIN_MS = 1000;

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
    let rest = setTimeout(async function request() {
      try {
        const work: Work = { scenario, files };
        const value = await post<T>(path, { ...work, ...more }, abort.signal);
        state.value = { value, problems: [], busy: false };
      } catch (why) {
        if (abort.signal.aborted) return;
        if (why instanceof Refused && why.status === BUSY) {
          // All places of the server are in use, for example by the same request for the pinned design.
          rest = setTimeout(request, AGAIN_MS);
          return;
        }
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
