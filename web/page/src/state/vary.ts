// The open tool to which fields of the design can be added: a search or a tolerance analysis.

import { addVariable, isVaried as isInSearch } from "./optimize.ts";
import { openTab } from "./tab.ts";
import { addKey, isVaried as isInTolerance } from "./tolerance.ts";

export interface Varies {
  isVaried(path: string): boolean;
  add(path: string): void;
}

/** Returns what a field can be added to now; null if no such tool is open. */
export function variesNow(): Varies | null {
  if (openTab.value === "optimize") return { isVaried: isInSearch, add: addVariable };
  if (openTab.value === "tolerance") return { isVaried: isInTolerance, add: addKey };
  return null;
}
