// The drive of each sub-pixel in a state: the fraction of its area that shows its own colour, or an analogue gap.

import { at, isTable, join, numberAt, tableAt, type Json } from "./json.ts";

export type Drive = number | { gap_nm: number };

const MIXED: Record<string, readonly string[]> = {
  white: ["red", "green", "blue"],
  black: [],
  red: ["red"],
  green: ["green"],
  blue: ["blue"],
  cyan: ["green", "blue"],
  magenta: ["red", "blue"],
  yellow: ["red", "green"],
};

export const subPixels = (fields: Json): string[] => {
  const names = Object.keys(tableAt(fields, "display.pixel.area"));
  const usual = ["red", "green", "blue"];
  const rank = (name: string) => (usual.includes(name) ? usual.indexOf(name) : usual.length);
  return names.sort((a, b) => rank(a) - rank(b));
};

/** Returns the drive of each sub-pixel in a state; sub-pixels that the state does not contain are dark. */
export function drives(fields: Json, state: string): Map<string, Drive> {
  const own = at(fields, join("display.pixel.states", state));
  return new Map(
    subPixels(fields).map((name): [string, Drive] => {
      const drive = isTable(own) ? own[name] : undefined;
      if (isTable(drive)) return [name, { gap_nm: Number(drive["gap_nm"]) }];
      if (typeof drive === "number") return [name, drive];
      return [name, !isTable(own) && MIXED[state]?.includes(name) ? 1 : 0];
    }),
  );
}

export const isDefaultState = (fields: Json, state: string): boolean =>
  state in MIXED && at(fields, join("display.pixel.states", state)) === undefined;

/** Returns the fractions of a sub-pixel's width with their gaps, nm. */
export function gaps(fields: Json, sub: string, drive: Drive): { part: number; gap: number }[] {
  const dark = numberAt(fields, "display.pixel.gap_nm.dark") ?? 0;
  const own = numberAt(fields, join("display.pixel.gap_nm", sub)) ?? dark;
  if (typeof drive !== "number") return [{ part: 1, gap: drive.gap_nm }];
  return [
    { part: drive, gap: own },
    { part: 1 - drive, gap: dark },
  ].filter(({ part }) => part > 0);
}
