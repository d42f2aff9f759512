// A second copy of the designs of localStorage, in IndexedDB. Chromium writes localStorage to the disk 5 s after a
// change, and then once a minute; if the browser is killed, later changes are lost. IndexedDB passes a transaction to
// the operating system within some milliseconds.

import type { Place } from "./works.ts";

const NAME = "papilio.designs";
const STORE = "records";

function opened(): Promise<IDBDatabase | null> {
  return new Promise((resolve) => {
    try {
      const opening = indexedDB.open(NAME, 1);
      opening.onupgradeneeded = () => opening.result.createObjectStore(STORE);
      opening.onsuccess = () => resolve(opening.result);
      opening.onerror = () => resolve(null);
    } catch {
      resolve(null);
    }
  });
}

/** Returns all records with their keys. */
function recorded(db: IDBDatabase): Promise<[string, string][]> {
  return new Promise((resolve) => {
    const all: [string, string][] = [];
    const cursor = db.transaction(STORE).objectStore(STORE).openCursor();
    cursor.onerror = () => resolve(all);
    cursor.onsuccess = () => {
      if (!cursor.result) return resolve(all);
      all.push([String(cursor.result.key), String(cursor.result.value)]);
      cursor.result.continue();
    };
  });
}

/** Writes changes in one transaction at a time; changes during a transaction are written together in the next one. */
function writer(db: IDBDatabase): (key: string, value: string | null) => void {
  const waiting = new Map<string, string | null>();
  let writing = false;
  const write = (): void => {
    if (writing || waiting.size === 0) return;
    writing = true;
    const changes = [...waiting];
    waiting.clear();
    const done = (): void => {
      writing = false;
      write();
    };
    try {
      const transaction = db.transaction(STORE, "readwrite");
      const store = transaction.objectStore(STORE);
      for (const [key, value] of changes) value === null ? store.delete(key) : store.put(value, key);
      transaction.oncomplete = transaction.onabort = done;
    } catch {
      // A database that the user has cleared is needed only at the next load.
      writing = false;
    }
  };
  return (key, value) => {
    waiting.set(key, value);
    write();
  };
}

/** Returns the number of times a record was written, which is stored in it. */
function countOf(record: string | null): number {
  try {
    return (JSON.parse(record ?? "{}") as { count?: number }).count ?? 0;
  } catch {
    return 0;
  }
}

/**
 * Returns a storage whose records under `heads` (each with its `tails`) have a second copy. Records of which the storage
 * has lost the latest version are restored first.
 */
export async function mirrored(place: Place, heads: string, tails: string): Promise<Place> {
  const db = await opened();
  if (db === null) return place;
  const copies = new Map(await recorded(db));
  for (const [key, copy] of copies) {
    if (!key.startsWith(heads) || countOf(copy) <= countOf(place.getItem(key))) continue;
    const tail = tails + key.slice(heads.length);
    try {
      if (copies.has(tail)) place.setItem(tail, copies.get(tail)!);
      place.setItem(key, copy);
    } catch {
      // The storage is full; the newest version is written again at the next change.
    }
  }
  const write = writer(db);
  const isOurs = (key: string): boolean => key.startsWith(heads) || key.startsWith(tails);
  return {
    get length() {
      return place.length;
    },
    key: (index) => place.key(index),
    getItem: (key) => place.getItem(key),
    setItem(key, value) {
      place.setItem(key, value);
      if (isOurs(key)) write(key, value);
    },
    removeItem(key) {
      place.removeItem(key);
      if (isOurs(key)) write(key, null);
    },
  };
}
