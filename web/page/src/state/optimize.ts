// A search for better designs: that of the scenario's `[optimize]`, or one that is set up on the page; its progress, and its result.

import { computed, signal } from "@preact/signals";

import type { Edit, FoundDesign, OptimizeDone, OptimizeProgress } from "../api/types.ts";
import { isSamePath, type Table } from "../model/json.ts";
import { numbers } from "../model/keys.ts";
import { keyOf, keysOfVariable } from "../model/study.ts";
import { fields, selected, text } from "./design.ts";
import { fileIds } from "./files.ts";
import { edit } from "./live.ts";
import { chosen } from "./numbers.ts";
import { ownStudy } from "./own-study.ts";
import { ready } from "./ready.ts";
import { lineFor } from "./sweep.ts";
import { varied } from "./varied.ts";
import { long } from "./work.ts";

export const search = long();

/** A search with effort for a first look. */
export const study = ownStudy("optimize", () => ({ starts: 4, evaluations: 600, variables: [], objectives: [], constraints: [] }));

/** Keys that can be varied. */
export const keys = computed(() => numbers(fields.value).map(([path]) => path));

/** Returns a variable with bounds around the current value of its key. */
export function variableFor(key: string): Table {
  const ends = lineFor(key, 2).values as [number, number];
  return { key, bounds: [ends[0], ends.at(-1)!] };
}

export const isVaried = (key: string): boolean => study.list("variables").some((one) => isSamePath(keyOf(one), key));

/** Adds a variable; without a key, one of the part that is selected in the drawing. */
export function addVariable(key?: string): void {
  const free = keys.value.filter((one) => !isVaried(one));
  const near = key ?? free.find((one) => one.startsWith(selected.value) && !/regular|phi|fill/.test(one)) ?? free[0];
  if (near && !isVaried(near)) study.put("variables", [...study.list("variables"), variableFor(near)]);
}

export function addObjective(metric: string, aim = "maximise"): void {
  const others = study.list("objectives").filter((one) => one["metric"] !== metric);
  study.put("objectives", [...others, { metric, aim }]);
}

/** Numbers that are shown times this are stored without it. */
const SHOWN: Readonly<Record<string, number>> = { "white.Y": 100 };

/** Takes the targets of the chosen numbers as constraints. */
export function addTargets(): void {
  const limits = chosen.value.flatMap(({ metric, target }): Table[] =>
    target ? [{ metric, [target.kind]: target.value / (SHOWN[metric] ?? 1) }] : [],
  );
  const others = study.list("constraints").filter((one) => !limits.some((limit) => limit["metric"] === one["metric"]));
  study.put("constraints", [...others, ...limits]);
}

export const hasTargets = computed(() => chosen.value.some(({ target }) => target !== null));

export const progress = signal<OptimizeProgress | null>(null);
/** The best designs of the searches so far. */
export const found = signal<readonly FoundDesign[]>([]);
export const done = signal<OptimizeDone | null>(null);
const searched = varied();
/** The age of the result. */
export const age = searched.age;
/** The index of the design that is selected in the result. */
export const selectedDesign = signal(0);

export async function run(): Promise<void> {
  if (!(await ready("optimised"))) return;
  searched.begin(study.list("variables").flatMap(keysOfVariable));
  [progress.value, done.value, found.value, selectedDesign.value] = [null, null, [], 0];
  const work = { scenario: text.value, files: fileIds.value };
  await search.start("optimize", work, study.isOfFile.value ? [] : study.asEdits(), (event, data) => {
    if (event === "progress") progress.value = data as OptimizeProgress;
    if (event === "found") found.value = [...found.value, data as FoundDesign];
    if (event === "done") done.value = data as OptimizeDone;
  });
}

/** Gives the design the values of a design of the result. */
export function take(index: number): void {
  const design = done.value?.report.designs[index];
  if (design) edit(Object.entries(design.set).map(([path, value]): Edit => ({ op: "set", path, value })));
}
