// Long work that reports as it goes and ends at once when it is cancelled: walks and sweeps.

import { signal, type Signal } from "@preact/signals";

import { events, Refused } from "../api/client.ts";
import type { Problem } from "../api/types.ts";

export type Phase = "idle" | "running" | "done" | "cancelled" | "failed";

export interface Long {
  readonly phase: Signal<Phase>;
  readonly problems: Signal<readonly Problem[]>;
  start(path: string, body: unknown, on: (event: string, data: unknown) => void): Promise<void>;
  cancel(): void;
}

export function long(): Long {
  const phase = signal<Phase>("idle");
  const problems = signal<readonly Problem[]>([]);
  let abort: AbortController | null = null;
  const cancel = (): void => {
    if (phase.value !== "running") return;
    phase.value = "cancelled";
    abort?.abort();
  };
  const start: Long["start"] = async (path, body, on) => {
    abort?.abort();
    const mine = (abort = new AbortController());
    problems.value = [];
    phase.value = "running";
    try {
      for await (const { event, data } of events(path, body, mine.signal)) {
        if (event === "failed") throw new Refused(422, (data as { errors: Problem[] }).errors);
        on(event, data);
      }
      if (!mine.signal.aborted) phase.value = "done";
    } catch (why) {
      if (mine.signal.aborted) return;
      problems.value = why instanceof Refused ? why.problems : [{ message: String(why) }];
      phase.value = "failed";
    }
  };
  return { phase, problems, start, cancel };
}
