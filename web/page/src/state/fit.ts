// A fit: that of the scenario's `[fit]`, or variables that are chosen on the page; the measured files; and the result.

import { computed, signal } from "@preact/signals";

import type { Edit, FitDone, FitProgress } from "../api/types.ts";
import { OF_METER, variablesOf, written, type FitVariable } from "../model/fit.ts";
import { isSamePath } from "../model/json.ts";
import { numbers } from "../model/keys.ts";
import { keysOfVariable } from "../model/study.ts";
import { fields, selected, text } from "./design.ts";
import { fileIds, files } from "./files.ts";
import { edit } from "./live.ts";
import { startJob } from "./jobs.ts";
import { ready } from "./ready.ts";
import { lineFor } from "./sweep.ts";
import { showTab } from "./tab.ts";
import { varied } from "./varied.ts";
import { long } from "./work.ts";

export const fit = long();

/** Variables that are chosen on the page; null: those of the scenario. */
export const own = signal<readonly FitVariable[] | null>(null);
/** The variables of the scenario's `[fit]`, or null. */
export const ofFile = computed(() => variablesOf(fields.value));
/** The variables that the next fit uses. */
export const variables = computed((): readonly FitVariable[] => own.value ?? ofFile.value ?? []);
/** Whether the fit of the scenario is used unchanged. */
export const isOfFile = computed(() => own.value === null && ofFile.value !== null);

/** Keys that can be fitted: numbers of the scenario, then those of the meter. */
export const keys = computed(() => [...numbers(fields.value).map(([path]) => path), ...Object.keys(OF_METER)]);

/** Whether a file is used, where that was chosen. */
const chosen = signal<Readonly<Record<string, boolean>>>({});
/** The kinds of files that may be measurements of a panel; of these, panels are used unless it was chosen otherwise. */
const KINDS = ["panel", "spectrum", "material"];
/** Files that may be measurements, with whether they are used. */
export const measured = computed(() =>
  files.value.flatMap(({ name, audit }) =>
    audit && KINDS.includes(audit.kind) ? [{ name, isUsed: chosen.value[name] ?? audit.kind === "panel" }] : [],
  ),
);
/** The names of the measured files that the next fit uses. */
export const used = computed(() => measured.value.flatMap(({ name, isUsed }) => (isUsed ? [name] : [])));
export const use = (name: string, isUsed: boolean): void => void (chosen.value = { ...chosen.value, [name]: isUsed });

/** Opens the fit with a measured file. */
export function fitTo(name: string): void {
  use(name, true);
  showTab("fit");
}

/** Returns a variable with bounds around the current value of its key. */
export function variableFor(key: string): FitVariable {
  const ends = lineFor(key, 2).values as [number, number];
  return { key, bounds: OF_METER[key] ?? [ends[0], ends.at(-1)!], more: {} };
}

/** Adds a variable: a key of the part that is selected in the drawing, if it has one. */
export function addVariable(): void {
  const taken = variables.value.map(({ key }) => key);
  const free = keys.value.filter((key) => !taken.some((one) => isSamePath(one, key)));
  const near = free.find((key) => key.startsWith(selected.value) && !/regular|phi|fill/.test(key)) ?? free[0];
  if (near) own.value = [...variables.value, variableFor(near)];
}

export const progress = signal<FitProgress | null>(null);
export const done = signal<FitDone | null>(null);
const fitted = varied();
/** The age of the result. */
export const age = fitted.age;
/** The names of the measured files of the result. */
export const fittedTo = signal<readonly string[]>([]);

/** Returns the edits that write the variables to a scenario, for `papilio fit`. */
const asEdits = (): Edit[] => {
  const value = written(variables.value);
  return [ofFile.value === null ? { op: "set", path: "fit", value: { variables: value } } : { op: "set", path: "fit.variables", value }];
};

/** Writes the variables to the scenario. */
export function keep(): void {
  edit(asEdits());
  own.value = null;
}

/** What determines a fit, besides the design. */
const inputs = computed(() => JSON.stringify([used.value.map((name) => fileIds.value[name]), variables.value]));
const ranWith = signal("");
/** Whether the last fit was one of the current files and variables. */
export const isOfInputs = computed(() => ranWith.value === inputs.value);

export async function run(): Promise<void> {
  if (!(await ready("fitted"))) return;
  fitted.begin(variables.value.flatMap(({ key, more }) => keysOfVariable({ ...more, key })));
  fittedTo.value = used.value;
  ranWith.value = inputs.value;
  [progress.value, done.value] = [null, null];
  const ids = used.value.map((name) => fileIds.value[name]!);
  const work = { scenario: text.value, files: fileIds.value, measured: ids };
  await fit.start("fit", work, isOfFile.value ? [] : asEdits(), (event, data) => {
    if (event === "progress") progress.value = data as FitProgress;
    if (event === "done") done.value = data as FitDone;
  });
}

/** Runs it as a job of the server. */
export const runAsJob = (): Promise<boolean> =>
  startJob({ command: "fit", inputs: used.value, edits: isOfFile.value ? [] : asEdits() });

/** Gives the design the fitted values. */
export function take(): void {
  if (done.value) edit(done.value.edits);
}
