// A study of the design that is set up on the page, or that of the scenario: `[optimize]` or `[tolerance]`.

import { computed, signal, type ReadonlySignal, type Signal } from "@preact/signals";

import type { Edit } from "../api/types.ts";
import { tableOf, tablesAt } from "../model/study.ts";
import type { Table } from "../model/json.ts";
import { fields } from "./design.ts";
import { edit } from "./live.ts";

export interface OwnStudy {
  /** The table that is set up on the page; null: that of the scenario. */
  readonly own: Signal<Table | null>;
  readonly ofFile: ReadonlySignal<Table | null>;
  readonly table: ReadonlySignal<Table>;
  /** Whether the table of the scenario is used unchanged. */
  readonly isOfFile: ReadonlySignal<boolean>;
  /** Returns the tables of a list. */
  list(key: string): readonly Table[];
  /** Changes a key of the table. */
  put(key: string, value: Table[string]): void;
  /** Returns the edits that write the table to a scenario. */
  asEdits(): Edit[];
  /** Writes the table to the scenario. */
  keep(): void;
}

export function ownStudy(name: string, first: () => Table): OwnStudy {
  const own = signal<Table | null>(null);
  const ofFile = computed(() => tableOf(fields.value, name));
  const table = computed(() => own.value ?? ofFile.value ?? first());
  const isOfFile = computed(() => own.value === null && ofFile.value !== null);
  const asEdits = (): Edit[] => [{ op: "set", path: name, value: table.value }];
  return {
    own,
    ofFile,
    table,
    isOfFile,
    list: (key) => tablesAt(table.value, key),
    put: (key, value) => void (own.value = { ...table.value, [key]: value }),
    asEdits,
    keep() {
      edit(asEdits());
      own.value = null;
    },
  };
}
