// A sweep: that of the scenario's `[sweep]`, or axes that are chosen on the page; and the points that are computed so far.

import { computed, signal } from "@preact/signals";

import type { Edit, SweepDone, SweepPoint } from "../api/types.ts";
import { axesOf, spaced, written, type Axis, type Line } from "../model/axes.ts";
import { at, isSamePath, listAt, type Json } from "../model/json.ts";
import { leaves, numbers } from "../model/keys.ts";
import { fields, selected, states, text, view } from "./design.ts";
import { fileIds } from "./files.ts";
import { edit } from "./live.ts";
import { isOfPixels } from "./metrics.ts";
import { startJob } from "./jobs.ts";
import { ready } from "./ready.ts";
import { varied } from "./varied.ts";
import { long } from "./work.ts";

export const sweep = long();

/** Axes that are chosen on the page; null: those of the scenario. */
export const own = signal<readonly Axis[] | null>(null);
/** The axes of the scenario's `[sweep]`, or null. */
export const ofFile = computed(() => axesOf(fields.value));
/** The axes that the next run uses. */
export const axes = computed((): readonly Axis[] => own.value ?? ofFile.value ?? []);
/** Whether the sweep of the scenario is used unchanged. */
export const isOfFile = computed(() => own.value === null && ofFile.value !== null);

const chosenMetric = signal<string | null>(null);
export const showMetric = (name: string): void => void (chosenMetric.value = name);
/** The metrics that the scenario draws. */
const figures = computed(() => listAt(fields.value, "sweep.figures").filter((name) => typeof name === "string"));
/** The first metric that the design has: one without states of colours has no gamut. */
const usual = computed(() => (["gamut_percent_srgb", "contrast_ratio"] as const).find((name) => typeof view.value?.[name] === "number"));
const ofState = computed(() => `${states.value[0]?.[0] ?? "white"}.Y`);
export const metric = computed(() => chosenMetric.value ?? figures.value[0] ?? usual.value ?? ofState.value);

export const points = signal<readonly SweepPoint[]>([]);
export const done = signal<SweepDone | null>(null);
/** The axes and the design to which the points belong. */
export const swept = signal<readonly Axis[]>([]);
const sweptDesign = varied();
/** The age of the points. */
export const age = sweptDesign.age;
/** The index of the point that is selected in the plot. */
export const selectedPoint = signal<number | null>(null);

/** Keys that can be swept: those with a number first, then the others. */
export const keys = computed(() => {
  const all = leaves(fields.value).filter(([, value]) => value !== null && typeof value !== "object");
  const isNumber = (value: Json) => typeof value === "number";
  return [...all.filter(([, value]) => isNumber(value)), ...all.filter(([, value]) => !isNumber(value))].map(
    ([path]) => path,
  );
});

/** Returns the initial values of a key, around its current value. */
export function lineFor(path: string, count: number): Line {
  const found = at(fields.value, path) ?? 1;
  if (typeof found !== "number") return { path, spacing: "list", values: [found] };
  const isFraction = /haze|share|transmittance|reflectance|absorptance|albedo|fill_factor|diffuse$/.test(path);
  // The transmittance of a wide lobe cannot be increased much.
  const most = path.endsWith("ransmittance")
    ? found
    : isFraction
      ? Math.min(1.5 * found, (1 + found) / 2)
      : 1.5 * found;
  const around = found === 0 ? [0, isFraction ? 0.1 : 1] : [0.5 * found, most];
  const [from, to] = (path.endsWith("theta_deg") ? [-60, 60] : around) as [number, number];
  const values = spaced(Number(from.toPrecision(4)), Number(to.toPrecision(4)), count, false);
  return { path, spacing: "range", values };
}

/** Returns the key of the selected part that is most likely to be swept. */
export function nearKey(): string | undefined {
  const taken = axes.value.flat().map(({ path }) => path);
  const free = numbers(fields.value)
    .map(([path]) => path)
    .filter((path) => !taken.some((key) => isSamePath(key, path)));
  return free.find((path) => path.startsWith(selected.value) && !/regular|phi|fill/.test(path)) ?? free[0];
}

/** The metrics that the scenario's sweep names; none: all metrics of colours. */
const named = computed(() => listAt(fields.value, "sweep.metrics"));

/** Whether the scenario's own sweep computes the metric. */
const fileComputes = (): boolean =>
  named.value.length > 0 ? named.value.includes(metric.value) : !isOfPixels(metric.value);

/** Returns the edits that write the axes to a scenario, for `papilio sweep`. */
const asEdits = (): Edit[] => {
  const metrics = isOfPixels(metric.value) ? { metrics: [metric.value] } : {};
  return [{ op: "set", path: "sweep", value: { ...metrics, figures: [metric.value], axes: written(axes.value) } }];
};

/** Writes the sweep to the scenario. */
export function keep(): void {
  edit(asEdits());
  own.value = null;
}

export async function run(): Promise<void> {
  if (!(await ready("swept"))) return;
  swept.value = axes.value;
  sweptDesign.begin(axes.value.flat().map(({ path }) => path));
  points.value = [];
  done.value = null;
  selectedPoint.value = null;
  const edits = isOfFile.value && fileComputes() ? [] : asEdits();
  await sweep.start("sweep", { scenario: text.value, files: fileIds.value }, edits, (event, data) => {
    if (event === "point") points.value = [...points.value, data as SweepPoint];
    if (event === "done") done.value = data as SweepDone;
  });
}

/** Runs it as a job of the server. */
export const runAsJob = (): Promise<boolean> =>
  startJob({ command: "sweep", edits: isOfFile.value && fileComputes() ? [] : asEdits() });

/** Applies the values of a point to the design. */
export function apply(point: SweepPoint): void {
  edit(Object.entries(point.values).map(([path, value]): Edit => ({ op: "set", path, value })));
}
