// Files dropped on the page: kept here, sent to the server, which audits them and says what they are good
// for. The server forgets them when it is restarted or full; then they are sent again.

import { computed, signal } from "@preact/signals";

import { Refused, upload } from "../api/client.ts";
import type { Problem, Upload } from "../api/types.ts";
import { said } from "./said.ts";
import { dropFile, keepFile, keptFile, keptNames } from "./keep.ts";

/** What the server takes at most, bytes. */
const LARGEST = 64 * 1024 * 1024;

export interface Dropped {
  readonly name: string;
  readonly bytes: number;
  /** The audit; null while it is awaited. */
  readonly audit: Upload | null;
  /** Why there is none. */
  readonly problems: readonly Problem[];
}

export const files = signal<readonly Dropped[]>([]);

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
    put({ name, bytes: 0, audit: { id, name, kind: "spectrum", words: [], figures: [], edits: [] }, problems: [] });
}

/** Sends a file; it is kept for the next visit once the server has read it. */
export async function add(name: string, bytes: Blob): Promise<void> {
  const file: Dropped = { name, bytes: bytes.size, audit: null, problems: [] };
  const limit = `${LARGEST / 1024 / 1024} MiB at most`;
  if (bytes.size > LARGEST)
    return put({ ...file, problems: [{ message: "This file is too large to be sent.", expected: limit }] });
  put(file);
  try {
    put({ ...file, audit: await upload<Upload>(name, bytes) });
    await keepFile(name, bytes);
  } catch (why) {
    put({ ...file, problems: why instanceof Refused ? why.problems : [{ message: String(why) }] });
  }
}

export async function forget(name: string): Promise<void> {
  files.value = files.value.filter((file) => file.name !== name);
  await dropFile(name);
}

/** Files of the last visit. */
export async function recallFiles(): Promise<void> {
  for (const name of await keptNames()) {
    const bytes = await keptFile(name);
    if (bytes) await add(name, bytes);
  }
}

/** Whether a request was refused for files that the server no longer had, and they were sent again. */
export async function sendAgain(why: Refused): Promise<boolean> {
  if ((why.status !== 404 && why.status !== 410) || files.value.length === 0) return false;
  await recallFiles();
  return true;
}
