// What survives a reload, on this machine alone: the design in localStorage, dropped files in IndexedDB.

const DESIGN = "papilio.design";
const STORE = "files";

/** A small value under a name; null where there is none, or where the browser keeps nothing. */
export function recall<T>(key: string): T | null {
  try {
    const text = localStorage.getItem(key);
    return text === null ? null : (JSON.parse(text) as T);
  } catch {
    return null;
  }
}

export function remember(key: string, value: unknown): void {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch {
    // A browser that keeps nothing (private, full) still works; a reload then starts anew.
  }
}

export interface Kept {
  readonly text: string;
  readonly past: readonly string[];
  readonly pinned: string | null;
}

export const recallDesign = (): Kept | null => recall<Kept>(DESIGN);
export const rememberDesign = (kept: Kept): void => remember(DESIGN, kept);

function database(): Promise<IDBDatabase> {
  return new Promise((resolve, reject) => {
    const opening = indexedDB.open("papilio", 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore(STORE);
    opening.onsuccess = () => resolve(opening.result);
    opening.onerror = () => reject(opening.error ?? new Error("no database"));
  });
}

async function ask<T>(mode: IDBTransactionMode, request: (store: IDBObjectStore) => IDBRequest<T>): Promise<T | null> {
  try {
    const db = await database();
    return await new Promise<T>((resolve, reject) => {
      const asked = request(db.transaction(STORE, mode).objectStore(STORE));
      asked.onsuccess = () => resolve(asked.result);
      asked.onerror = () => reject(asked.error ?? new Error("not kept"));
    });
  } catch {
    return null;
  }
}

export const keepFile = (name: string, bytes: Blob): Promise<unknown> =>
  ask("readwrite", (store) => store.put(bytes, name));
export const keptFile = (name: string): Promise<Blob | null> =>
  ask("readonly", (store) => store.get(name) as IDBRequest<Blob>);
export const dropFile = (name: string): Promise<unknown> => ask("readwrite", (store) => store.delete(name));
export const keptNames = async (): Promise<string[]> =>
  ((await ask("readonly", (store) => store.getAllKeys())) ?? []).map(String);
