// Versions of designs that the user keeps: each with a name, a thumbnail and key numbers, in the browser's storage for all tabs.

import { signal } from "@preact/signals";

import { recall, remember } from "./keep.ts";

const KEY = "papilio.versions";
/** Maximum number of versions; a further one replaces the oldest. */
export const MOST = 24;

export interface Version {
  readonly id: string;
  readonly name: string;
  readonly text: string;
  /** Ids of the uploaded files by their names. */
  readonly files: Readonly<Record<string, string>>;
  /** Time when it was kept, ms. */
  readonly at: number;
  /** The picture of it, as an address of data; "" for none. */
  readonly thumbnail: string;
  /** Its chosen numbers. */
  readonly numbers: Readonly<Record<string, number>>;
}

const isVersion = (one: unknown): one is Version => typeof (one as Version | null)?.text === "string";

function stored(): readonly Version[] {
  const found = recall<unknown>(KEY);
  return Array.isArray(found) ? found.filter(isVersion) : [];
}

export const versions = signal<readonly Version[]>(stored());

// Another tab has kept or removed one.
addEventListener("storage", ({ key }) => key === KEY && (versions.value = stored()));

function put(change: (all: readonly Version[]) => readonly Version[]): void {
  // The storage is that of all tabs.
  versions.value = change(stored());
  remember(KEY, versions.value);
}

export function keepVersion(version: Omit<Version, "id" | "at">): Version {
  const at = Date.now();
  const kept = { ...version, at, id: `${at.toString(36)}-${Math.random().toString(36).slice(2, 8)}` };
  put((all) => [kept, ...all].slice(0, MOST));
  return kept;
}

/** Adds versions of another bench, the newest first; those that exist already are left out. Returns how many are new. */
export function addVersions(given: readonly Omit<Version, "id">[]): number {
  const fresh = newOf(given);
  put((all) => [...fresh.map((one, i) => ({ ...one, id: `${Date.now().toString(36)}-${i}` })), ...all].slice(0, MOST));
  return fresh.length;
}

/** Returns the versions that are not stored yet. */
export function newOf(given: readonly Omit<Version, "id">[]): readonly Omit<Version, "id">[] {
  const known = stored();
  const isSame = (one: Omit<Version, "id">, { name, text, files }: Version): boolean =>
    name === one.name && text === one.text && Object.entries(one.files).every(([file, id]) => files[file] === id);
  return given.filter((one) => !known.some((other) => isSame(one, other)));
}

export const renameVersion = (id: string, name: string): void =>
  put((all) => all.map((one) => (one.id === id && name.trim() !== "" ? { ...one, name: name.trim() } : one)));

export const dropVersion = (id: string): void => put((all) => all.filter((one) => one.id !== id));
