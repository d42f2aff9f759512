// The numbers that the user chose, and their targets, kept for the next visit.

import { signal } from "@preact/signals";

import type { Target } from "../model/metrics.ts";
import { recall, remember } from "./keep.ts";

const KEY = "papilio.numbers";

export interface Chosen {
  readonly metric: string;
  /** The limit, in the unit that is shown. */
  readonly target: Target | null;
}

/** The numbers of a first visit. */
const FIRST = [
  "white.Y",
  "contrast_ratio",
  "gamut_percent_srgb",
  "gamut_percent_ebu",
  "white.luminance_cd_m2",
  "text_contrast",
];

const isChosen = (one: unknown): one is Chosen => typeof (one as Chosen | null)?.metric === "string";
const known = recall<unknown>(KEY);
export const chosen = signal<readonly Chosen[]>(
  Array.isArray(known) && known.every(isChosen) ? known : FIRST.map((metric) => ({ metric, target: null })),
);

function put(all: readonly Chosen[]): void {
  chosen.value = all;
  remember(KEY, all);
}

export function addNumber(metric: string): void {
  if (!chosen.value.some((one) => one.metric === metric)) put([...chosen.value, { metric, target: null }]);
}

export const removeNumber = (metric: string): void => put(chosen.value.filter((one) => one.metric !== metric));

/** Shows the numbers of another bench with their targets, and then the others that were shown. */
export const putFirst = (given: readonly Chosen[]): void =>
  put([...given, ...chosen.value.filter(({ metric }) => !given.some((one) => one.metric === metric))]);

export const setTarget = (metric: string, target: Target | null): void =>
  put(chosen.value.map((one) => (one.metric === metric ? { ...one, target } : one)));
