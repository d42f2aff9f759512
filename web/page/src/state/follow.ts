// Results that follow the design while they are visible. They are requested after a short time without changes, and
// cancelled if the design changes.

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { events, post, Refused, type Work } from "../api/client.ts";
import type { Problem } from "../api/types.ts";
import { present } from "./age.ts";
import { text } from "./design.ts";
import { fileIds, keptIds, sendAgain } from "./files.ts";
import { BUSY } from "./server.ts";
import { ageOf, revisionOf, type Age, type Revision } from "./revision.ts";

/** Time after which a request to a busy server is repeated, ms. */
const AGAIN_MS = 1000;

export interface Followed<T> {
  /** The last result, whose age is `age`; null if there is none, or the current design has none. */
  readonly value: T | null;
  readonly age: Age;
  /** Why there is no result of the current design. */
  readonly problems: readonly Problem[];
  /** The number of results so far. */
  readonly count: number;
  /** Whether `value` is a first answer, with large errors. */
  readonly isFirst: boolean;
  /** Fraction of the work in progress; null if none is, or if it does not tell. */
  readonly fraction: number | null;
  /** Whether the work for the current design was cancelled. */
  readonly isCancelled: boolean;
  cancel(): void;
  /** Starts it again after a cancellation. */
  restart(): void;
}

/** How a result is requested. */
interface How {
  /** Whether the server sends events: progress, then the result. */
  readonly streams?: boolean;
}

/** Returns the last event of a computation; `first` is called with a first answer. */
async function streamed<T>(
  path: string,
  body: unknown,
  signal: AbortSignal,
  on: (fraction: number) => void,
  first: (value: T) => void,
): Promise<T> {
  for await (const { event, data } of events(path, body, signal)) {
    if (event === "progress") on((data as { fraction: number }).fraction);
    if (event === "first") first(data as T);
    if (event === "failed") throw new Refused(422, (data as { errors: Problem[] }).errors);
    if (event === "done") return data as T;
  }
  throw new Refused(0, [{ message: "Papilio does not respond." }]);
}

/** A result or a refusal, with the design and the settings for which it was requested. */
interface Kept<T> {
  readonly value: T;
  readonly design: Revision;
  readonly settings: string;
  readonly count: number;
  readonly isFirst?: boolean;
}

/** Requests `path` for a scenario (by default the current one), with the additional fields `more`. */
export function useFollowed<T>(path: string, more: object, restMs: number, other?: string | null, { streams = false }: How = {}): Followed<T> {
  const found = useSignal<Kept<T> | null>(null);
  const refused = useSignal<Kept<readonly Problem[]> | null>(null);
  const scenario = other === undefined ? text.value : other;
  const files = keptIds.value;
  const [design, settings] = [scenario === null ? "" : revisionOf(scenario, files), JSON.stringify(more)];
  const fraction = useSignal<number | null>(null);
  const cancelled = useSignal("");
  const wanted = JSON.stringify([design, settings]);
  const isCancelled = cancelled.value === wanted;
  useEffect(() => {
    if (scenario === null || isCancelled) return;
    const abort = new AbortController();
    fraction.value = null;
    let isSent = false;
    let rest = setTimeout(async function request() {
      try {
        const work: Work = { scenario, files: fileIds.value };
        const body = { ...work, ...more };
        const keep = (value: T, isFirst: boolean): void =>
          void (found.value = { value, design, settings, count: (found.value?.count ?? 0) + 1, isFirst });
        const value = streams
          ? await streamed<T>(path, body, abort.signal, (done) => (fraction.value = done), (one) => keep(one, true))
          : await post<T>(path, body, abort.signal);
        keep(value, false);
      } catch (why) {
        if (abort.signal.aborted) return;
        // All places of the server are in use, for example by the same request for the pinned design; or it has lost the files.
        const isBusy = why instanceof Refused && why.status === BUSY;
        if (isBusy || (why instanceof Refused && !isSent && (isSent = await sendAgain(why)))) {
          if (!abort.signal.aborted) rest = setTimeout(request, AGAIN_MS);
          return;
        }
        const value = why instanceof Refused ? why.problems : [{ message: String(why) }];
        refused.value = { value, design, settings, count: 0 };
      }
    }, restMs);
    return () => {
      clearTimeout(rest);
      abort.abort();
    };
  }, [design, settings, isCancelled]);
  const isOf = (kept: Kept<unknown> | null): boolean => kept?.design === design && kept.settings === settings;
  const hasFailed = isOf(refused.value) && !isOf(found.value);
  const now = other === undefined ? present.value : { revision: design, isWaiting: false, isRefused: false };
  const age = ageOf(found.value?.design ?? "", now);
  const isFirst = found.value?.isFirst === true;
  const ofDesign: Age = found.value?.settings !== settings ? "settings" : isFirst ? "first" : age;
  return {
    value: scenario === null || hasFailed ? null : (found.value?.value ?? null),
    age: age === "current" ? ofDesign : age,
    isFirst,
    count: found.value?.count ?? 0,
    problems: hasFailed ? refused.value!.value : [],
    fraction: fraction.value,
    isCancelled,
    cancel: () => void (cancelled.value = wanted),
    restart: () => void (cancelled.value = ""),
  };
}
