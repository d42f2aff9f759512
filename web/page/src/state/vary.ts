// The open tool to which fields of the design can be added: a sweep, a search, a tolerance analysis or a fit.

import { isSamePath } from "../model/json.ts";
import * as fit from "./fit.ts";
import { addVariable, isVaried as isInSearch } from "./optimize.ts";
import * as sweep from "./sweep.ts";
import { openTab } from "./tab.ts";
import { addKey, isVaried as isInTolerance } from "./tolerance.ts";

/** Values of the first axis of a sweep, and of further ones. */
const FINE = 21;
const COARSE = 11;
const MOST_AXES = 4;

export interface Varies {
  isVaried(path: string): boolean;
  add(path: string): void;
}

/** Returns what a field can be added to now; null if no such tool is open. */
export function variesNow(): Varies | null {
  if (openTab.value === "optimize") return { isVaried: isInSearch, add: addVariable };
  if (openTab.value === "tolerance") return { isVaried: isInTolerance, add: addKey };
  if (openTab.value === "fit")
    return {
      isVaried: (path) => fit.variables.value.some(({ key }) => isSamePath(key, path)),
      add: (path) => void (fit.own.value = [...fit.variables.value, fit.variableFor(path)]),
    };
  if (openTab.value === "sweep" && sweep.axes.value.length < MOST_AXES)
    return {
      isVaried: (path) => sweep.axes.value.flat().some((line) => isSamePath(line.path, path)),
      add: (path) => {
        const count = sweep.axes.value.length === 0 ? FINE : COARSE;
        sweep.own.value = [...sweep.axes.value, [sweep.lineFor(path, count)]];
      },
    };
  return null;
}
