// The numbers of a scenario that a sweep can vary, by path, and the differences between two scenarios.

import { isTable, join, type Json } from "./json.ts";

const skipped = /^(solver|inputs|sweep|optimize|tolerance|fit|measure|spectrum)(\.|$)/;

/** Returns all leaves of a value with their paths. */
export function leaves(value: Json, path = ""): [string, Json][] {
  if (skipped.test(path)) return [];
  if (Array.isArray(value)) return value.flatMap((one, i) => leaves(one, join(path, i)));
  if (isTable(value)) return Object.entries(value).flatMap(([key, one]) => leaves(one, join(path, key)));
  return [[path, value]];
}

export const numbers = (fields: Json): [string, number][] =>
  leaves(fields).filter((leaf): leaf is [string, number] => typeof leaf[1] === "number");

/** Returns the keys whose values differ, with both values. */
export function differences(
  before: Json,
  now: Json,
): { path: string; before: Json | undefined; now: Json | undefined }[] {
  const [old, fresh] = [new Map(leaves(before)), new Map(leaves(now))];
  return [...new Set([...old.keys(), ...fresh.keys()])]
    .filter((path) => old.get(path) !== fresh.get(path))
    .map((path) => ({ path, before: old.get(path), now: fresh.get(path) }));
}

const PARTS =
  /^(display\.(?:front|layers)\.\d+|display\.pixel\.(?:film\.\d+|states)|display\.\w+|lighting\.(?:directed|environment)\.\d+|lighting\.front_light|lighting|viewer)/;

/** Returns the part of the drawing, or the group of fields, to which a key belongs. */
export const partOf = (path: string): string => PARTS.exec(path)?.[0] ?? "computing";
