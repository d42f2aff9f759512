// The tables of searches and of tolerance analyses: `[optimize]` and `[tolerance]`, as the page edits them.

import { isTable, listAt, tableAt, type Json, type Table } from "./json.ts";

/** Returns a value without keys that are not given. */
export function given(value: Json): Json {
  if (Array.isArray(value)) return value.map(given);
  if (!isTable(value)) return value;
  return Object.fromEntries(Object.entries(value).filter(([, one]) => one !== null).map(([key, one]) => [key, given(one)]));
}

/** Returns a table of the scenario, or null if it has none. */
export function tableOf(fields: Json, name: string): Table | null {
  const found = given(tableAt(fields, name));
  return isTable(found) && Object.keys(found).length > 0 ? found : null;
}

/** Returns the tables of a list. */
export const tablesAt = (of: Table, key: string): readonly Table[] => listAt(of, key).filter(isTable);

/** Returns the key of a variable: its first one. */
export const keyOf = (variable: Table): string => String(variable["key"] ?? listAt(variable, "keys")[0] ?? variable["name"] ?? "");

/** Returns all keys that a variable changes. */
export const keysOfVariable = (variable: Table): string[] =>
  [variable["key"], ...listAt(variable, "keys"), variable["compensated_by"]].filter((key) => typeof key === "string");

/** Returns the list with an entry replaced, or removed if it is null. */
export const replaced = (all: readonly Table[], index: number, to: Table | null): Table[] =>
  all.flatMap((one, i) => (i !== index ? [one] : to ? [to] : []));

/** Reads a number that is typed; null if it is none. */
export function numberFrom(typed: string): number | null {
  const value = Number(typed.replace(",", "."));
  return typed.trim() !== "" && Number.isFinite(value) ? value : null;
}

/** The aims of an objective, as the page offers them. */
export const AIMS = ["maximise", "minimise", "target"] as const;
export type Aim = (typeof AIMS)[number];

export const aimOf = ({ aim }: Table): Aim => (isTable(aim) ? "target" : aim === "minimise" ? "minimise" : "maximise");

/** The distributions that the page offers, with the key of their width. */
export const SPREADS: Readonly<Record<string, { readonly name: string; readonly width: string }>> = {
  normal: { name: "normal, standard deviation", width: "sigma" },
  uniform: { name: "uniform, plus or minus", width: "plus_minus" },
  triangular: { name: "triangular, plus or minus", width: "plus_minus" },
};

/** Returns the distribution of a toleranced key; null if the page cannot edit it. */
export function spreadOf(key: Table): { readonly kind: string; readonly width: number } | null {
  for (const [kind, { width }] of Object.entries(SPREADS)) {
    const found = key[kind];
    if (isTable(found) && typeof found[width] === "number" && Object.keys(found).length === 1)
      return { kind, width: found[width] };
  }
  return null;
}

/** Returns a toleranced key with another distribution. */
export function withSpread(key: Table, kind: string, width: number): Table {
  const rest = Object.fromEntries(Object.entries(key).filter(([name]) => !(name in SPREADS)));
  return { ...rest, [kind]: { [SPREADS[kind]!.width]: width } };
}
