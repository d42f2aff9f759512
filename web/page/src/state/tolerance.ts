// A tolerance analysis: that of the scenario's `[tolerance]`, or one that is set up on the page; and its result.

import { computed, signal } from "@preact/signals";

import type { ToleranceDone, ToleranceProgress } from "../api/types.ts";
import { isSamePath, keysOf, type Table } from "../model/json.ts";
import { numbers } from "../model/keys.ts";
import { keyOf } from "../model/study.ts";
import { present } from "./age.ts";
import { fields, selected, text } from "./design.ts";
import { fileIds } from "./files.ts";
import { chosen } from "./numbers.ts";
import { study as search } from "./optimize.ts";
import { ownStudy } from "./own-study.ts";
import { ready } from "./ready.ts";
import { ageOfRun, type Revision } from "./revision.ts";
import { long } from "./work.ts";

export const analysis = long();

export const study = ownStudy("tolerance", () => ({ samples: 1024, keys: [], limits: [] }));

/** Keys that can be toleranced. */
export const keys = computed(() => numbers(fields.value).map(([path]) => path));

/** Returns a key with a normal distribution of 2 % of its value. */
export function keyFor(key: string): Table {
  return { name: keysOf(key).slice(-2).join(" "), key, relative: true, normal: { sigma: 0.02 } };
}

export const isVaried = (key: string): boolean => study.list("keys").some((one) => isSamePath(keyOf(one), key));

/** Adds a key; without one, that of the part that is selected in the drawing. */
export function addKey(key?: string): void {
  const free = keys.value.filter((one) => !isVaried(one));
  const near = key ?? free.find((one) => one.startsWith(selected.value) && !/regular|phi|fill/.test(one)) ?? free[0];
  if (near && !isVaried(near)) study.put("keys", [...study.list("keys"), keyFor(near)]);
}

const SHOWN: Readonly<Record<string, number>> = { "white.Y": 100 };

/** Takes the targets of the chosen numbers as limits. */
export function addTargets(): void {
  const limits = chosen.value.flatMap(({ metric, target }): Table[] =>
    target ? [{ metric, [target.kind]: target.value / (SHOWN[metric] ?? 1) }] : [],
  );
  const others = study.list("limits").filter((one) => !limits.some((limit) => limit["metric"] === one["metric"]));
  study.put("limits", [...others, ...limits]);
}

/** Variables and constraints of the search that is set up or in the scenario, as keys and limits; `isNew` if the analysis lacks any. */
export const ofSearch = computed(() => {
  const all = search.list("variables").map(keyOf).filter((key) => keys.value.includes(key) && !isVaried(key));
  const known = study.list("limits").map((one) => one["metric"]);
  const limits = search.list("constraints").filter((one) => !known.includes(one["metric"] ?? null));
  return { keys: all, limits, isNew: all.length + limits.length > 0 };
});

export function addOfSearch(): void {
  const { keys: all, limits } = ofSearch.value;
  study.put("keys", [...study.list("keys"), ...all.map(keyFor)]);
  study.put("limits", [...study.list("limits"), ...limits]);
}

export const progress = signal<ToleranceProgress | null>(null);
export const done = signal<ToleranceDone | null>(null);
const analysedOf = signal<Revision>("");
/** The age of the result. */
export const age = computed(() => ageOfRun(analysedOf.value, present.value));

export async function run(): Promise<void> {
  if (!(await ready("analysed"))) return;
  analysedOf.value = present.value.revision;
  [progress.value, done.value] = [null, null];
  const work = { scenario: text.value, files: fileIds.value };
  await analysis.start("tolerance", work, study.isOfFile.value ? [] : study.asEdits(), (event, data) => {
    if (event === "progress") progress.value = data as ToleranceProgress;
    if (event === "done") done.value = data as ToleranceDone;
  });
}
