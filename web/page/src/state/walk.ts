// The Monte Carlo walk of the design on the bench: its progress, and how it agrees with the live answer.

import { computed, signal } from "@preact/signals";

import type { WalkProgress } from "../api/types.ts";
import { fileIds } from "./files.ts";
import { text } from "./design.ts";
import { long } from "./work.ts";

export const walk = long();
/** The scenario that was walked. */
export const walked = signal("");
export const progress = signal<WalkProgress | null>(null);
/** Paths and relative error so far, for the curve. */
export const course = signal<readonly (readonly [number, number])[]>([]);
/** Whether the design has changed since. */
export const stale = computed(() => walked.value !== "" && walked.value !== text.value);

export function run(): void {
  walked.value = text.value;
  progress.value = null;
  course.value = [];
  void walk.start("walk", { scenario: text.value, files: fileIds.value }, (event, data) => {
    if (event !== "progress" && event !== "done") return;
    const now = data as WalkProgress;
    if (!now.states) return;
    progress.value = now;
    course.value = [...course.value, [now.paths, now.relative_error]];
  });
}
