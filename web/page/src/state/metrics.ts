// Metrics that no run computes: sharpness, crosstalk, sparkle and gloss. A sweep computes them only if it names them.

import { computed, signal } from "@preact/signals";

import { get } from "../api/client.ts";
import type { MetricEntry } from "../api/types.ts";
import { at, isTable } from "../model/json.ts";
import { fields, states } from "./design.ts";

const entries = signal<readonly MetricEntry[]>([]);
let isRequested = false;

function load(): void {
  if (isRequested) return;
  isRequested = true;
  void get<MetricEntry[]>("metrics").then(
    (all) => void (entries.value = all.filter(({ command }) => command !== null)),
    () => void (isRequested = false),
  );
}

/** True for a metric of pixels: `f50_x_per_mm`, `white.f50_x_per_mm`. */
export const isOfPixels = (name: string): boolean => entries.value.some((one) => one.name === name.split(".").at(-1));

/** The table that a scenario needs for the metrics of a command. */
const TABLES: Readonly<Record<string, string>> = {
  mtf: "display.matrix",
  crosstalk: "display.matrix",
  sparkle: "sparkle",
  gloss: "display",
};

const known = computed(() => {
  const offered = entries.value.filter(({ command }) => isTable(at(fields.value, TABLES[command!] ?? "")));
  return offered.flatMap(({ name, of_state }) => (of_state ? states.value.map(([state]) => `${state}.${name}`) : [name]));
});

/** Returns the metrics of pixels of the current scenario; they are loaded when first needed. */
export function ofPixels(): readonly string[] {
  load();
  return known.value;
}
