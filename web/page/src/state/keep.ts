// Data other than designs that survive a reload, only on this machine: small values in localStorage, and uploaded files
// in IndexedDB by the SHA-256 of their bytes, so that tabs may have different files with the same name.

const STORE = "files";
/** Time for which a file that no design uses is stored, ms. */
const UNUSED_MS = 7 * 24 * 3600 * 1000;

/** Returns a stored value; null if there is none, or if the browser stores nothing. */
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
    // Without storage (private window, full), the page works, but a reload starts with the default.
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
      asked.onerror = () => reject(asked.error ?? new Error("not stored"));
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

/** Returns the names of files that a former version stored by name, for all tabs. */
export const formerFiles = async (): Promise<string[]> => (await keptIds()).filter((id) => !/^[0-9a-f]{64}$/.test(id));
export const dropFormer = dropFile;

/** Removes files that no design has used for some days. */
export async function forgetUnused(named: ReadonlySet<string>): Promise<void> {
  for (const id of await keptIds()) {
    const file = named.has(id) ? null : await keptFile(id);
    if (file instanceof File && Date.now() - file.lastModified > UNUSED_MS) await dropFile(id);
  }
}
