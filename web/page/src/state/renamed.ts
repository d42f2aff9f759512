// Measured files whose states have other names here than on the disk, by the ids of their bytes; kept for the next visit.

import { signal } from "@preact/signals";

import { fileIds } from "./files.ts";
import { recall, remember } from "./keep.ts";

const KEY = "papilio.renamed";
/** The most ids that are kept. */
const MOST = 50;

const known = recall<unknown>(KEY);
const ids = signal<readonly string[]>(Array.isArray(known) ? known.filter((one) => typeof one === "string") : []);

/** Whether the states of a file are read with other names than those on the disk. */
export const isRenamed = (name: string): boolean => ids.value.includes(fileIds.value[name] ?? "");

/** Notes that a file was read with other names of its states. */
export function noteRenamed(name: string): void {
  const id = fileIds.value[name];
  if (id === undefined) return;
  ids.value = [...ids.value.filter((one) => one !== id), id].slice(-MOST);
  remember(KEY, ids.value);
}
