// What each sub-pixel does in a state: the share of its area at its own colour, or an analogue gap.

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

/** How a state drives each sub-pixel; those that it does not name are dark. */
export function drives(fields: Json, state: string): Map<string, Drive> {
  const own = at(fields, join("display.pixel.states", state));
  return new Map(
    subPixels(fields).map((name): [string, Drive] => {
      const said = isTable(own) ? own[name] : undefined;
      if (isTable(said)) return [name, { gap_nm: Number(said["gap_nm"]) }];
      if (typeof said === "number") return [name, said];
      return [name, !isTable(own) && MIXED[state]?.includes(name) ? 1 : 0];
    }),
  );
}

export const isDefaultState = (fields: Json, state: string): boolean =>
  state in MIXED && at(fields, join("display.pixel.states", state)) === undefined;

/** Parts of a sub-pixel's width with their gaps, nm. */
export function gaps(fields: Json, sub: string, drive: Drive): { part: number; gap: number }[] {
  const dark = numberAt(fields, "display.pixel.gap_nm.dark") ?? 0;
  const own = numberAt(fields, join("display.pixel.gap_nm", sub)) ?? dark;
  if (typeof drive !== "number") return [{ part: 1, gap: drive.gap_nm }];
  return [
    { part: drive, gap: own },
    { part: 1 - drive, gap: dark },
  ].filter(({ part }) => part > 0);
}
