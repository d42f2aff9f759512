// Files dropped on the page: kept here, sent to the server, which audits them and says what they are good
// for. The server forgets them when it is restarted or full; then they are sent again.

import { computed, signal } from "@preact/signals";

import { Refused, upload } from "../api/client.ts";
import type { Problem, Upload } from "../api/types.ts";
import { said } from "./said.ts";
import { dropFormer, formerFiles, keepFile, keptFile } from "./keep.ts";

/** What the server takes at most, bytes. */
const LARGEST = 64 * 1024 * 1024;

export interface Dropped {
  readonly name: string;
  readonly bytes: number;
  /** By which it is kept and asked for; null for a file that was not read yet. */
  readonly id: string | null;
  /** The audit; null while it is awaited. */
  readonly audit: Upload | null;
  /** Why there is none. */
  readonly problems: readonly Problem[];
}

export const files = signal<readonly Dropped[]>([]);

/** Names and ids of all that is kept, of what the server has lost, too. */
export const keptIds = computed(() =>
  Object.fromEntries(files.value.flatMap(({ name, id }) => (id ? [[name, id] as const] : []))),
);

/** Names and ids, as requests carry them. */
export const fileIds = computed(() => {
  const known = files.value.flatMap(({ name, audit }) => (audit ? [[name, audit.id] as const] : []));
  return Object.fromEntries(known);
});

function put(file: Dropped): void {
  const others = files.value.filter(({ name }) => name !== file.name);
  files.value = [file, ...others];
  if (file.problems.length > 0) said.value = `${file.name} cannot be used: ${file.problems[0]!.message}`;
}

/** Files that the server has from its command line: named, without an audit here. */
export function adopt(ids: Record<string, string>): void {
  for (const [name, id] of Object.entries(ids))
    put({ name, bytes: 0, id, audit: { id, name, kind: "spectrum", words: [], figures: [], edits: [] }, problems: [] });
}

/** Sends a file; it is kept for the next visit once the server has read it. */
export async function add(name: string, bytes: Blob, id: string | null = null): Promise<void> {
  const file: Dropped = { name, bytes: bytes.size, id, audit: null, problems: [] };
  const limit = `${LARGEST / 1024 / 1024} MiB at most`;
  if (bytes.size > LARGEST)
    return put({ ...file, problems: [{ message: "This file is too large to be sent.", expected: limit }] });
  put(file);
  try {
    const audit = await upload<Upload>(name, bytes);
    if (audit.id !== id) await keepFile(audit.id, bytes);
    put({ ...file, id: audit.id, audit });
  } catch (why) {
    put({ ...file, problems: why instanceof Refused ? why.problems : [{ message: String(why) }] });
  }
}

/** A design that was open before may name it still: it stays in the browser for some days. */
export const forget = (name: string): void => void (files.value = files.value.filter((file) => file.name !== name));

/** Files of a design, by the ids of their names. */
export async function recallFiles(ids: Readonly<Record<string, string>>): Promise<void> {
  for (const [name, id] of Object.entries(ids)) {
    const bytes = await keptFile(id);
    if (bytes) await add(name, bytes, id);
  }
}

/** Files of a former version, which belong to this tab from now on. */
export async function recallFormer(): Promise<void> {
  for (const name of await formerFiles()) {
    const bytes = await keptFile(name);
    if (bytes) await add(name, bytes);
    await dropFormer(name);
  }
}

/** Whether a request was refused for files that the server no longer had, and they were sent again. */
export async function sendAgain(why: Refused): Promise<boolean> {
  if ((why.status !== 404 && why.status !== 410) || files.value.length === 0) return false;
  await recallFiles(keptIds.value);
  return true;
}
