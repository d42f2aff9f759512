// Edits that add what a refusal misses: lengths of layers, the matrix of pixels, the face of sparkle, the size of a lamp.

import type { Edit, Problem } from "../api/types.ts";
import type { Json } from "./json.ts";

/** A key that may be missing: where it is, a usual value, and what that is in words. */
const USUAL: readonly (readonly [path: RegExp, value: Json, words: string])[] = [
  [/^display\.(glass|layers\.\d+)\.thickness_mm$/, 0.5, "0.5 mm of glass"],
  [/^display\.front\.\d+\.thickness_mm$/, 0.1, "a thickness of 0.1 mm"],
  [/\.gap_mm$/, 0, "no gap below the front"],
  [/^display\.matrix$/, { ppi: 300 }, "pixels at 300 ppi"],
  [/^lighting\.directed\.\d+\.radius_deg$/, 2, "the size of a lamp, 2°"],
];

/** The table that has no place in the text yet. */
const FACE = { words: "a face of 10 % haze", edit: { op: "set", path: "sparkle", value: { haze: 0.1, correlation_um: 20 } } } as const;

/** Returns the edits that add all that is missing, with their words; null if something else is wrong. */
export function mendOf(problems: readonly Problem[]): { readonly words: string; readonly edits: readonly Edit[] } | null {
  const found = problems.map(({ path, message }) => {
    if (!/\bis missing\b/.test(message)) return null;
    if (!path) return message.includes("[sparkle]") ? FACE : null;
    const usual = USUAL.find(([pattern]) => pattern.test(path));
    return usual ? { words: usual[2], edit: { op: "set", path, value: usual[1] } as const } : null;
  });
  if (found.length === 0 || found.some((one) => one === null)) return null;
  const all = found as { words: string; edit: Edit }[];
  return { words: [...new Set(all.map(({ words }) => words))].join(", "), edits: all.map(({ edit }) => edit) };
}
