// Fractions (keys `share`, `area`) whose sum is 1: if one of them changes, the others are scaled in proportion.

import type { Edit } from "../api/types.ts";
import { isTable, join, listAt, numberAt, tableAt, type Json } from "./json.ts";

const DECIMALS = 1e6;
const rounded = (value: number): number => Math.round(value * DECIMALS) / DECIMALS;

/** Returns the fractions of the light, by path; a missing `diffuse` is the remainder. */
export function lightShares(fields: Json): Map<string, number> {
  const shares = new Map<string, number>();
  for (const kind of ["directed", "environment"]) {
    listAt(fields, `lighting.${kind}`).forEach((source, i) => {
      for (const key of ["share", "sun_share"]) {
        const value = isTable(source) ? source[key] : undefined;
        if (typeof value === "number") shares.set(join("lighting", kind, i, key), value);
      }
    });
  }
  const rest = 1 - [...shares.values()].reduce((sum, share) => sum + share, 0);
  shares.set("lighting.diffuse", numberAt(fields, "lighting.diffuse") ?? Math.max(0, rounded(rest)));
  return shares;
}

/** Returns the areas of the sub-pixels, by path. */
export const areaShares = (fields: Json): Map<string, number> =>
  new Map(
    Object.entries(tableAt(fields, "display.pixel.area")).map(([name, area]) => [
      join("display.pixel.area", name),
      Number(area),
    ]),
  );

/** Returns the group of fractions to which a path belongs, or null. */
export function groupOf(fields: Json, path: string): Map<string, number> | null {
  for (const group of [lightShares(fields), areaShares(fields)]) if (group.has(path)) return group;
  return null;
}

/** Returns the edits that set one fraction and keep the sum at 1. */
export function balanced(group: ReadonlyMap<string, number>, path: string, value: number): Edit[] {
  const moved = rounded(value);
  const others = [...group].filter(([other]) => other !== path);
  const before = others.reduce((sum, [, share]) => sum + share, 0);
  const rest = rounded(1 - moved);
  const scaled = others.map(([other, share], i) => {
    const part =
      before > 0
        ? share / before
        : other === "lighting.diffuse" || (i === others.length - 1 && !group.has("lighting.diffuse"))
          ? 1
          : 0;
    return [other, rounded(rest * part)] as const;
  });
  const off = rounded(rest - scaled.reduce((sum, [, share]) => sum + share, 0));
  const largest = scaled.reduce((best, [, share], i) => (share > (scaled[best]?.[1] ?? -1) ? i : best), 0);
  const all = scaled.map(([other, share], i) => [other, i === largest ? rounded(share + off) : share] as const);
  return [[path, moved] as const, ...all].map(([at, share]) => ({ op: "set", path: at, value: share }));
}

/** Returns the edits that remove a source and distribute its fraction to the others. */
export function without(fields: Json, source: string): Edit[] {
  const group = lightShares(fields);
  const kept = new Map([...group].filter(([path]) => !path.startsWith(`${source}.`)));
  const first = [...kept.keys()].at(-1)!;
  const sum = [...kept.values()].reduce((total, share) => total + share, 0);
  const value = sum > 0 ? rounded(kept.get(first)! / sum) : 1;
  return [...balanced(kept, first, value), { op: "remove", path: source }];
}
