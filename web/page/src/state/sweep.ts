// A sweep over one or two keys: its axes, and the points that are computed so far.

import { computed, signal } from "@preact/signals";

import type { Edit, SweepPoint } from "../api/types.ts";
import { numbers } from "../model/keys.ts";
import { fields, text } from "./design.ts";
import { fileIds } from "./files.ts";
import { ready } from "./ready.ts";
import { long } from "./work.ts";

export interface Axis {
  readonly path: string;
  readonly from: number;
  readonly to: number;
  readonly count: number;
}

export const sweep = long();
export const axes = signal<readonly Axis[]>([]);
export const metric = signal("gamut_percent_srgb");
export const points = signal<readonly SweepPoint[]>([]);
/** The axes to which the points belong. */
export const swept = signal<readonly Axis[]>([]);
export const keys = computed(() => numbers(fields.value).map(([path]) => path));

/** Returns the uniformly spaced values on an axis. */
export const valuesOf = ({ from, to, count }: Axis): number[] =>
  Array.from({ length: count }, (_, i) => Number((from + ((to - from) * i) / Math.max(1, count - 1)).toPrecision(8)));

/** Returns the initial axis for a key, around its current value. */
export function axisFor(path: string, count: number): Axis {
  const value = numbers(fields.value).find(([key]) => key === path)?.[1] ?? 1;
  const isFraction = /haze|share|transmittance|reflectance|absorptance|albedo|fill_factor|diffuse$/.test(path);
  // The transmittance of a wide lobe cannot be increased much.
  const most = path.endsWith("ransmittance")
    ? value
    : isFraction
      ? Math.min(1.5 * value, (1 + value) / 2)
      : 1.5 * value;
  const around = value === 0 ? [0, isFraction ? 0.1 : 1] : [0.5 * value, most];
  const [from, to] = (path.endsWith("theta_deg") ? [-60, 60] : around) as [number, number];
  return { path, from: Number(from.toPrecision(4)), to: Number(to.toPrecision(4)), count };
}

/** Returns the edits that write the sweep to a scenario, for `papilio sweep`. */
export function asEdits(): Edit[] {
  const entries = axes.value.map((axis) => ({ [axis.path]: valuesOf(axis) }));
  return [{ op: "set", path: "sweep", value: { figures: [metric.value], axes: entries } }];
}

export async function run(): Promise<void> {
  if (!(await ready("swept"))) return;
  swept.value = axes.value;
  points.value = [];
  await sweep.start("sweep", { scenario: text.value, files: fileIds.value }, asEdits(), (event, data) => {
    if (event === "point") points.value = [...points.value, data as SweepPoint];
  });
}
