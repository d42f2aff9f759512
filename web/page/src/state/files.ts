// Uploaded files. The browser stores them and sends them to the server, which audits them and offers uses. The server
// loses them when it is restarted or full; they are then sent again.

import { computed, signal } from "@preact/signals";

import { Refused, upload } from "../api/client.ts";
import type { Problem, Upload } from "../api/types.ts";
import { said } from "./said.ts";
import { dropFormer, formerFiles, keepFile, keptFile } from "./keep.ts";

/** Maximum size of a file that the server accepts, bytes. */
const LARGEST = 64 * 1024 * 1024;

export interface Dropped {
  readonly name: string;
  readonly bytes: number;
  /** The id under which it is stored and requested; null for a file that was not read yet. */
  readonly id: string | null;
  /** The audit; null before the response. */
  readonly audit: Upload | null;
  /** The errors because of which there is no audit. */
  readonly problems: readonly Problem[];
  /** Whether it is being read. Until then, the design keeps the file of this name that it had. */
  readonly isReading: boolean;
}

export const files = signal<readonly Dropped[]>([]);

/** Ids of all stored files by name, including files that the server has lost. */
export const keptIds = computed(() =>
  Object.fromEntries(files.value.flatMap(({ name, id }) => (id ? [[name, id] as const] : []))),
);

/** Ids of the files by name, as in requests. */
export const fileIds = computed(() => {
  const known = files.value.flatMap(({ name, audit }) => (audit ? [[name, audit.id] as const] : []));
  return Object.fromEntries(known);
});

function put(file: Dropped): void {
  const others = files.value.filter(({ name }) => name !== file.name);
  files.value = [file, ...others];
  if (file.problems.length > 0) said.value = `${file.name} cannot be used: ${file.problems[0]!.message}`;
}

/** Adds the files of the scenario with which the server was started, without audits. */
export function adopt(ids: Record<string, string>): void {
  for (const [name, id] of Object.entries(ids))
    put({ name, bytes: 0, id, audit: { id, name, kind: "spectrum", words: [], figures: [], edits: [] }, problems: [], isReading: false });
}

/** Uploads a file. It is stored in the browser for the next visit after the server has read it. Returns whether it was read. */
export async function add(name: string, bytes: Blob, id: string | null = null): Promise<boolean> {
  const file: Dropped = { name, bytes: bytes.size, id, audit: null, problems: [], isReading: false };
  const limit = `${LARGEST / 1024 / 1024} MiB at most`;
  if (bytes.size > LARGEST) {
    put({ ...file, problems: [{ message: "This file is too large.", expected: limit }] });
    return false;
  }
  const former = files.value.find((one) => one.name === name);
  put({ ...file, id: id ?? former?.id ?? null, audit: former?.audit ?? null, isReading: true });
  try {
    const audit = await upload<Upload>(name.split("/").at(-1)!, bytes);
    if (audit.id !== id) await keepFile(audit.id, bytes);
    put({ ...file, id: audit.id, audit });
    return true;
  } catch (why) {
    put({ ...file, problems: why instanceof Refused ? why.problems : [{ message: String(why) }] });
    return false;
  }
}

/** Removes a file from the list. It stays in the browser for some days, because other designs may use it. */
export const forget = (name: string): void => void (files.value = files.value.filter((file) => file.name !== name));

/** Uploads the stored files of a design again; `ids` has their ids by name. */
export async function recallFiles(ids: Readonly<Record<string, string>>): Promise<void> {
  for (const [name, id] of Object.entries(ids)) {
    const bytes = await keptFile(id);
    if (bytes) await add(name, bytes, id);
  }
}

/** Sends stored files that the server has lost, without listing them: those of designs that are not open. */
export async function sendFiles(ids: Readonly<Record<string, string>>): Promise<void> {
  for (const [name, id] of Object.entries(ids)) {
    const bytes = await keptFile(id);
    if (bytes) await upload<Upload>(name.split("/").at(-1)!, bytes);
  }
}

/** Takes over the files that a former version stored. */
export async function recallFormer(): Promise<void> {
  for (const name of await formerFiles()) {
    const bytes = await keptFile(name);
    if (bytes) await add(name, bytes);
    await dropFormer(name);
  }
}

/** Sends the files again if a request failed because the server no longer stores them; returns true if it did. */
export async function sendAgain(why: Refused): Promise<boolean> {
  if ((why.status !== 404 && why.status !== 410) || files.value.length === 0) return false;
  await recallFiles(keptIds.value);
  return true;
}
