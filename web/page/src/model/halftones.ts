// Halftones of the picture: their names, and the order in which they are shown.

import { valuesOf } from "./toml-set.ts";

export const HALFTONES: readonly (readonly [string, string])[] = [
  ["none", "none: exact colours"],
  ["refined-error-diffusion", "refined error diffusion"],
  ["direct-binary-search", "direct binary search"],
  ["error-diffusion", "error diffusion"],
  ["void-and-cluster", "void and cluster"],
  ["ordered", "ordered"],
];

/** The fast halftone of a scenario that names none. */
export const DEFAULT = "refined-error-diffusion";
/** The search: better, and slower. */
export const SEARCH = "direct-binary-search";

export const halftoneName = (id: string): string => HALFTONES.find(([known]) => known === id)?.[1] ?? id.replaceAll("-", " ");

/** Whether the text of a scenario names a halftone. */
export function isStated(text: string): boolean {
  try {
    return valuesOf(text).has("image.halftone");
  } catch {
    // A text that is being typed.
    return /^\s*halftone\s*=/m.test(text);
  }
}

/** What determines the halftones of a picture. */
export interface HalftoneOf {
  /** That which is chosen on the page. */
  readonly chosen: string | null;
  /** That of the scenario, with its defaults. */
  readonly own: string | undefined;
  /** Whether the size of the pixels is known, which the search needs. */
  readonly hasMatrix: boolean;
  readonly text: string;
}

/**
 * The halftones of a picture: each but the last is shown until the next one is computed. The default comes before the search, if the search was
 * chosen on the page or by the scenario, or if neither names a halftone.
 */
export function stepsOf({ chosen, own = DEFAULT, hasMatrix, text }: HalftoneOf): readonly string[] {
  const isOpen = chosen === null && own === DEFAULT && hasMatrix && !isStated(text);
  const named = chosen ?? (isOpen ? SEARCH : own);
  return named === SEARCH ? [DEFAULT, SEARCH] : [named];
}
