// Names of metrics, in groups, and their values in a view.

import type { Num, View } from "../api/types.ts";
import { isTable, type Json } from "./json.ts";

/** The name of the group of metrics that belong to no state. */
export const WHOLE = "Whole display";

/** Returns false for the error of a metric. */
export const isValue = (name: string): boolean => !/_(de|se)$/.test(name);

/** Returns the metrics of a view by name: those of the whole display, then those of each state. */
export function metricsOf(view: View): Map<string, Num> {
  const found = new Map<string, Num>();
  const take = (table: object, before: string) => {
    for (const [key, value] of Object.entries(table))
      if ((typeof value === "number" || value === null) && !/^(theta_deg|phi_deg)$/.test(key)) found.set(before + key, value);
  };
  take(view, "");
  for (const [state, values] of Object.entries(view.states)) take(values, `${state}.`);
  return found;
}

/** Returns the standard error of a metric in a view. */
export function errorOf(view: View, name: string): Num {
  const dot = name.lastIndexOf(".");
  const of = dot < 0 ? view : view.states[name.slice(0, dot)];
  const errors = (of as { standard_error?: Json } | undefined)?.standard_error;
  const value = errors && isTable(errors) ? errors[name.slice(dot + 1)] : null;
  return typeof value === "number" ? value : null;
}

/** Returns the state of a metric; `WHOLE` for those of the whole display. */
export const groupOf = (name: string): string => (name.includes(".") ? name.slice(0, name.lastIndexOf(".")) : WHOLE);

/** Returns the groups of metrics, in order. */
export function grouped(names: readonly string[]): Map<string, string[]> {
  const groups = new Map<string, string[]>();
  for (const name of names) {
    const group = groupOf(name);
    groups.set(group, [...(groups.get(group) ?? []), name]);
  }
  return groups;
}

/** Returns text in lower case without the marks that nobody types: "u′v′" is "uv", "L*" is "l". */
const plain = (text: string): string => text.toLowerCase().replace(/[′'*_.,()]/g, " ").replace(/²/g, "2");

/** Returns whether a text contains every word that is searched. */
export function matches(text: string, search: string): boolean {
  const words = plain(search).split(/\s+/).filter(Boolean);
  const of = plain(text);
  const joined = of.replace(/\s+/g, "");
  return words.every((word) => of.includes(word) || joined.includes(word));
}

/** A limit of a number: it must be at least or at most this. */
export interface Target {
  readonly kind: "at_least" | "at_most";
  readonly value: number;
}

/** Returns whether a value meets a target; null if it is undefined. */
export function meets(value: Num, target: Target): boolean | null {
  if (typeof value !== "number") return null;
  return target.kind === "at_least" ? value >= target.value : value <= target.value;
}

/** Returns the words of a target. */
export const inWords = ({ kind, value }: Target, unit = ""): string =>
  `${kind === "at_least" ? "at least" : "at most"} ${value}${unit && ` ${unit}`}`;
