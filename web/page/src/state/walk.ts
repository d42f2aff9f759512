// The Monte Carlo run of the current design: its progress, and its comparison with the live result of adding.

import { computed, signal } from "@preact/signals";

import type { Edit, WalkProgress } from "../api/types.ts";
import { numberAt } from "../model/json.ts";
import { fractionOf } from "../model/progress.ts";
import { present } from "./age.ts";
import { fields, text } from "./design.ts";
import { fileIds } from "./files.ts";
import { ready } from "./ready.ts";
import { ageOfRun, type Revision } from "./revision.ts";
import { long } from "./work.ts";

export const walk = long();
/** The design of the run. */
const runOf = signal<Revision>("");
export const progress = signal<WalkProgress | null>(null);
/** Paths and relative error so far, for the curve. */
export const course = signal<readonly (readonly [number, number])[]>([]);
/** The age of the run. */
export const age = computed(() => ageOfRun(runOf.value, present.value));

/** The relative error at which the run ends; null: that of the scenario. */
export const aim = signal<number | null>(null);

/** The relative error at which a run of the current design ends. */
export const target = computed(() => aim.value ?? numberAt(fields.value, "solver.relative_error") ?? 0.001);

/** The fraction of the run that is done, over all views; it never decreases. */
export const fraction = signal(0);

export async function run(): Promise<void> {
  if (!(await ready("run"))) return;
  fraction.value = 0;
  runOf.value = present.value.revision;
  progress.value = null;
  course.value = [];
  const edits: Edit[] = aim.value === null ? [] : [{ op: "set", path: "solver.relative_error", value: aim.value }];
  await walk.start("walk", { scenario: text.value, files: fileIds.value }, edits, (event, data) => {
    if (event !== "progress" && event !== "done") return;
    const now = data as WalkProgress;
    if (!now.states) return;
    if (event === "progress") fraction.value = Math.max(fraction.value, fractionOf(now, target.value));
    progress.value = now;
    course.value = [...course.value, [now.paths, now.relative_error]];
  });
}
