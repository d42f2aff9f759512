// Long computations that report their progress and can be cancelled: Monte Carlo runs and sweeps.

import { signal, type Signal } from "@preact/signals";

import { events, post, Refused, type Work } from "../api/client.ts";
import type { Edit, Problem } from "../api/types.ts";

export type Phase = "idle" | "running" | "done" | "cancelled" | "failed";

export interface Long {
  readonly phase: Signal<Phase>;
  readonly problems: Signal<readonly Problem[]>;
  /** Starts a computation of a scenario after edits, which are not applied to the current design. */
  start(path: string, work: Work, edits: readonly Edit[], on: (event: string, data: unknown) => void): Promise<void>;
  cancel(): void;
  /** Cancels it and forgets why it ended. */
  reset(): void;
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
  const reset = (): void => {
    cancel();
    [phase.value, problems.value] = ["idle", []];
  };
  const start: Long["start"] = async (path, work, edits, on) => {
    abort?.abort();
    const mine = (abort = new AbortController());
    problems.value = [];
    phase.value = "running";
    try {
      const { scenario } =
        edits.length > 0
          ? await post<{ scenario: string }>("edit", { scenario: work.scenario, edits }, mine.signal)
          : work;
      for await (const { event, data } of events(path, { ...work, scenario }, mine.signal)) {
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
  return { phase, problems, start, cancel, reset };
}
