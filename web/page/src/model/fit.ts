// The variables of a fit: keys with their bounds, as in a scenario's `[fit]`.

import { isTable, listAt, type Json, type Table } from "./json.ts";

/** A number that the data are to determine. */
export interface FitVariable {
  /** Its first key. */
  readonly key: string;
  readonly bounds: readonly [number, number];
  /** What else the scenario says of it: further keys, a prior. */
  readonly more: Table;
}

/** Numbers of the meter: their usual bounds. */
export const OF_METER: Readonly<Record<string, readonly [number, number]>> = {
  "meter.scale": [0.95, 1.05],
  "meter.wavelength_offset_nm": [-3, 3],
};

/** Returns a table without what is not given. */
const given = (table: Table): Table =>
  Object.fromEntries(Object.entries(table).filter(([, value]) => value !== null));

/** Returns the variables of a scenario's `[fit]`, or null if it has none. */
export function variablesOf(fields: Json): FitVariable[] | null {
  const read = listAt(fields, "fit.variables").filter(isTable).map((one): FitVariable | null => {
    const { key = null, bounds = null, ...more } = one;
    const keys = Array.isArray(more["keys"]) ? more["keys"] : [];
    const name = key ?? keys[0];
    const [from, to] = Array.isArray(bounds) ? bounds : [];
    return typeof name === "string" && typeof from === "number" && typeof to === "number"
      ? { key: name, bounds: [from, to], more: given(more) }
      : null;
  });
  return read.length > 0 && read.every((one) => one !== null) ? (read as FitVariable[]) : null;
}

/** Returns the variables as in a scenario. */
export const written = (variables: readonly FitVariable[]): Table[] =>
  variables.map(({ key, bounds, more }) => ({ ...("keys" in more ? {} : { key }), ...more, bounds: [...bounds] }));

/** Returns the number of decimals that shows two digits of an error. */
export const decimalsOf = (error: number): number =>
  error > 0 ? Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(error)))) : 5;

/** Returns the pairs of variables whose correlation is at least `least`, the largest first. */
export function correlated(
  correlations: readonly (readonly (number | null)[])[],
  least: number,
): { readonly pair: readonly [number, number]; readonly value: number }[] {
  const all = correlations.flatMap((row, i) =>
    row.slice(0, i).flatMap((value, k) => (value !== null && Math.abs(value) >= least ? [{ pair: [k, i] as const, value }] : [])),
  );
  return all.sort((a, b) => Math.abs(b.value) - Math.abs(a.value));
}
