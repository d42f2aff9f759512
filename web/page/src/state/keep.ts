// What survives a reload, on this machine alone, beside the designs: small values in localStorage, dropped files
// in IndexedDB, by the SHA-256 of their bytes, so that tabs may have different files of one name.

const STORE = "files";
/** A file that no design names any more is kept for so long, ms. */
const UNUSED_MS = 7 * 24 * 3600 * 1000;

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

export const keepFile = (id: string, bytes: Blob): Promise<unknown> =>
  ask("readwrite", (store) => store.put(new File([bytes], id, { lastModified: Date.now() }), id));
export const keptFile = (id: string): Promise<Blob | null> =>
  ask("readonly", (store) => store.get(id) as IDBRequest<Blob>);
const dropFile = (id: string): Promise<unknown> => ask("readwrite", (store) => store.delete(id));
const keptIds = async (): Promise<string[]> =>
  ((await ask("readonly", (store) => store.getAllKeys())) ?? []).map(String);

/** Files that a former version kept by their names, for all tabs together. */
export const formerFiles = async (): Promise<string[]> => (await keptIds()).filter((id) => !/^[0-9a-f]{64}$/.test(id));
export const dropFormer = dropFile;

/** Forgets files that no design has named for some days. */
export async function forgetUnused(named: ReadonlySet<string>): Promise<void> {
  for (const id of await keptIds()) {
    const file = named.has(id) ? null : await keptFile(id);
    if (file instanceof File && Date.now() - file.lastModified > UNUSED_MS) await dropFile(id);
  }
}
