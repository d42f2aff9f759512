// The age of a run that varies keys of the design: its result is of every design that differs in these keys alone, so that one point after
// the other can be applied.

import { computed, signal, type ReadonlySignal } from "@preact/signals";

import type { Edit } from "../api/types.ts";
import type { Json } from "../model/json.ts";
import { present } from "./age.ts";
import { fields, text } from "./design.ts";
import { edited } from "./edits.ts";
import { keptIds } from "./files.ts";
import { usedFiles, type Age } from "./revision.ts";

/** Tables that describe studies, not the display. */
const STUDIES = ["sweep", "optimize", "tolerance", "fit"];

/** Returns fields without studies and without the values of keys, as text. */
export function besides(of: Json, keys: readonly string[]): string {
  const gone = STUDIES.map((path): Edit => ({ op: "remove", path }));
  return JSON.stringify(edited(of, [...gone, ...keys.map((path): Edit => ({ op: "set", path, value: null }))]));
}

const files = (): string => JSON.stringify(usedFiles(text.value, keptIds.value));

export interface Varied {
  /** Begins a run on the present design. */
  begin(keys: readonly string[]): void;
  readonly age: ReadonlySignal<Age>;
}

export function varied(): Varied {
  const run = signal<{ readonly keys: readonly string[]; readonly rest: string; readonly files: string } | null>(null);
  return {
    begin: (keys) => void (run.value = { keys, rest: besides(fields.value, keys), files: files() }),
    age: computed((): Age => {
      const of = run.value;
      const isSame = of !== null && !present.value.isWaiting && of.files === files() && of.rest === besides(fields.value, of.keys);
      return isSame ? "current" : "earlier";
    }),
  };
}
