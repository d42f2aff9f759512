// The progress of a Monte Carlo run.

import type { WalkProgress } from "../api/types.ts";

/** The fraction of a run that is done, from one report: the error falls with the root of the number of paths. */
export function fractionOf(now: Pick<WalkProgress, "views_done" | "views" | "relative_error">, target: number): number {
  const ofView = now.views_done < now.views ? Math.min(0.99, (target / Math.max(now.relative_error, 1e-12)) ** 2) : 0;
  return (now.views_done + ofView) / Math.max(now.views, 1);
}
