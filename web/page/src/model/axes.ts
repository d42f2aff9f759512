// The axes of a sweep: keys that change together, each with its values. Values are entered as a range, as a logarithmic
// range, or as a list.

import { isTable, listAt, type Json, type Table } from "./json.ts";

export type Spacing = "range" | "log" | "list";

/** A key of an axis and its values. */
export interface Line {
  readonly path: string;
  readonly spacing: Spacing;
  readonly values: readonly Json[];
}

/** The lines of an axis have the same number of values. */
export type Axis = readonly Line[];

export const lengthOf = (axis: Axis): number => axis[0]?.values.length ?? 0;
export const pointsOf = (axes: readonly Axis[]): number => axes.reduce((product, axis) => product * lengthOf(axis), 1);

const rounded = (value: number): number => Number(value.toPrecision(8));

/** Returns values with equal differences, or with equal ratios if `isLog`; both ends are included. */
export function spaced(from: number, to: number, count: number, isLog: boolean): number[] {
  const at = (t: number) => (isLog ? from * (to / from) ** t : from + (to - from) * t);
  return Array.from({ length: count }, (_, i) => rounded(at(i / Math.max(1, count - 1))));
}

/** Returns the spacing of values: a range if their differences are equal. */
export function spacingOf(values: readonly Json[]): Spacing {
  const numbers = values.filter((value): value is number => typeof value === "number");
  const [first, last] = [numbers[0], numbers.at(-1)];
  if (numbers.length < values.length || numbers.length < 3 || first === undefined || last === undefined) return "list";
  const is = (isLog: boolean) =>
    spaced(first, last, numbers.length, isLog).every(
      (value, i) => Math.abs(value - numbers[i]!) <= 1e-6 * Math.max(Math.abs(first), Math.abs(last)),
    );
  if (is(false)) return "range";
  return first > 0 && last > 0 && is(true) ? "log" : "list";
}

/** Returns the axes of a scenario's `[sweep]`, or null if it has none. */
export function axesOf(fields: Json): Axis[] | null {
  const axes = listAt(fields, "sweep.axes").filter(isTable);
  const line = ([path, values]: [string, Json]): Line => {
    const list = Array.isArray(values) ? values : [];
    return { path, values: list, spacing: spacingOf(list) };
  };
  const read = axes.map((axis) => Object.entries(axis as Table).map(line));
  return read.length > 0 && read.every((axis) => lengthOf(axis) > 0) ? read : null;
}

/** Returns the axes as in a scenario. */
export const written = (axes: readonly Axis[]): Table[] =>
  axes.map((axis) => Object.fromEntries(axis.map(({ path, values }): [string, Json] => [path, [...values]])));

/** Returns a list as it is typed: numbers, words, true and false, separated by commas; null if it is empty. */
export function listFrom(typed: string): Json[] | null {
  const parts = typed
    .split(/[,;]/)
    .map((part) => part.trim())
    .filter(Boolean);
  const value = (part: string): Json => {
    if (part === "true" || part === "false") return part === "true";
    return /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/.test(part) ? Number(part) : part.replace(/^"(.*)"$/, "$1");
  };
  return parts.length > 0 ? parts.map(value) : null;
}

/** Formats a swept value. */
export const shown = (value: Json | undefined): string =>
  typeof value === "string" ? value : value === undefined ? "" : JSON.stringify(value);

/** Returns the place of a point on each axis; the last axis varies fastest. */
export function placeOf(lengths: readonly number[], point: number): number[] {
  let rest = point;
  const place = [...lengths].reverse().map((length) => {
    const at = rest % Math.max(1, length);
    rest = Math.floor(rest / Math.max(1, length));
    return at;
  });
  return place.reverse();
}

/** Returns the index of the point at a place. */
export const pointAt = (lengths: readonly number[], place: readonly number[]): number =>
  lengths.reduce((index, length, i) => index * length + (place[i] ?? 0), 0);
