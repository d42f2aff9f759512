// A second copy of what localStorage holds of the designs, in IndexedDB. Chromium writes localStorage to the disk
// 5 s after a change, and then once a minute; a browser that is killed loses what came after. A transaction of
// IndexedDB is with the system some milliseconds after the change.

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

/** All records and their keys. */
function recorded(db: IDBDatabase): Promise<[string, string][]> {
  return new Promise((resolve) => {
    const all: [string, string][] = [];
    const walk = db.transaction(STORE).objectStore(STORE).openCursor();
    walk.onerror = () => resolve(all);
    walk.onsuccess = () => {
      if (!walk.result) return resolve(all);
      all.push([String(walk.result.key), String(walk.result.value)]);
      walk.result.continue();
    };
  });
}

/** Writes changes one transaction at a time; what changes meanwhile goes together with the next. */
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
      // A database that is gone (cleared by the user) is missed at the next load only.
      writing = false;
    }
  };
  return (key, value) => {
    waiting.set(key, value);
    write();
  };
}

/** How often a record was written, as it says itself. */
function countOf(record: string | null): number {
  try {
    return (JSON.parse(record ?? "{}") as { count?: number }).count ?? 0;
  } catch {
    return 0;
  }
}

/**
 * A storage whose records under `heads` (each with its `tails`) have a second copy; those of which the storage has
 * lost the latest are put back first.
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
      // A full storage: what is newest is written again with the next change.
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
