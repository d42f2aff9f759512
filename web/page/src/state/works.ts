// The designs that are stored in the browser, so that none is lost. Each tab has its own record, with a copy for other
// tabs and later visits.
//
// The record of a tab is in its sessionStorage, which survives a reload and a crash of the tab, and is copied if the tab
// is duplicated. The copy is in localStorage. Every load of the page creates a new id. At the first change, it writes a
// record under this id and removes the record from which it started, unless another tab has written that record in the
// meantime. Thus two tabs have two designs, and a reload leaves no second record.

import { chained, unchained } from "../model/delta.ts";
import type { Change } from "../state/edits.ts";

/** The data of a design without its undo steps. */
export interface Now {
  /** The last text that the server has accepted. */
  readonly text: string;
  /** The draft, which will replace the text, its file name, and whether it is being typed. */
  readonly draft: string | null;
  readonly draftName: string;
  readonly typed: boolean;
  /** Pending edits, including those that are being typed. */
  readonly pending: readonly Change[];
  /** The text at the current position of undo and redo, if it is not `text`. */
  readonly present: string | null;
  readonly pinned: string | null;
  /** The scenario with which `papilio serve` was started. */
  readonly started: string;
  /** Ids of the uploaded files by their names. */
  readonly files: Readonly<Record<string, string>>;
  readonly title: string;
  /** What was changed last, as text. */
  readonly change: string;
}

export interface Steps {
  readonly past: readonly string[];
  readonly future: readonly string[];
}

export interface Work extends Now, Steps {}

/** A design of another tab, open or closed, or of an earlier visit. */
export interface Earlier {
  readonly id: string;
  readonly title: string;
  readonly change: string;
  /** Time of the last write, ms. */
  readonly at: number;
}

interface Stamp {
  readonly id: string;
  readonly at: number;
  /** Number of writes. */
  readonly count: number;
}

type StoredDesign = Now & Stamp;

/** The functions of the browser's storage that are used. */
export type Place = Pick<Storage, "getItem" | "setItem" | "removeItem" | "key" | "length">;

const OWN = "papilio.tab";
const OWN_STEPS = "papilio.tab.steps";
export const WORK = "papilio.work.";
export const STEPS = "papilio.steps.";
/** The key of a former version, whose tabs shared one record. */
const FORMER = "papilio.design";

/** Maximum number of designs; a further one replaces the oldest. */
export const MOST = 24;

export interface Keeper {
  /** Returns the design of this tab, or, in a new tab, the design that was changed last in this browser. */
  load(): { readonly work: Work; readonly own: boolean } | null;
  /** Stores a design immediately; `changed` tells whether the user has changed it. */
  keep(now: Now, steps: Steps, changed: boolean): void;
  /** From now on, the design of this tab does not replace the design that was loaded. */
  part(): void;
  /** From now on, the design of this tab is a new one; what was open stays stored as it is. */
  leave(): void;
  /** Returns the other designs, newest first. */
  earlier(): Earlier[];
  /** Returns the ids of all files that a stored design uses. */
  files(): Set<string>;
  /** Opens another design; the design that was open stays stored. */
  take(id: string): Work | null;
}

export const EMPTY: Now = {
  text: "",
  draft: null,
  draftName: "",
  typed: false,
  pending: [],
  present: null,
  pinned: null,
  started: "",
  files: {},
  title: "",
  change: "",
};

function read(place: Place | null, key: string): unknown {
  try {
    return JSON.parse(place?.getItem(key) ?? "null") as unknown;
  } catch {
    return null;
  }
}

function write(place: Place, key: string, value: unknown): boolean {
  try {
    place.setItem(key, typeof value === "string" ? value : JSON.stringify(value));
    return true;
  } catch {
    return false;
  }
}

function keys(place: Place, prefix: string): string[] {
  const all = Array.from({ length: place.length }, (_, i) => place.key(i) ?? "");
  return all.filter((key) => key.startsWith(prefix));
}

function record(found: unknown): StoredDesign | null {
  const kept = found as Partial<StoredDesign> | null;
  if (typeof kept !== "object" || kept === null || typeof kept.text !== "string" || !kept.id) return null;
  return { ...EMPTY, at: 0, count: 0, ...kept } as StoredDesign;
}

const stepsOf = (found: unknown): Steps => {
  const { past, future } = (found ?? {}) as { past?: unknown; future?: unknown };
  return { past: unchained(past), future: unchained(future) };
};

const written = ({ past, future }: Steps) => ({ past: chained(past), future: chained(future) });

/** Returns the newer half of the undo steps. */
const newer = ({ past, future }: Steps): Steps => ({
  past: past.slice(Math.ceil(past.length / 2)),
  future: past.length > 0 ? future : future.slice(0, Math.floor(future.length / 2)),
});

/** Stores designs in the storage of a tab and in that of all tabs. Either may be missing or full, which `say` reports. */
export function keeper(tab: Place | null, all: Place | null, say: (words: string) => void, clock = Date.now): Keeper {
  const fresh = (): string => `${clock().toString(36)}-${Math.random().toString(36).slice(2, 10)}`;
  let id = fresh();
  let count = 0;
  let steps: Steps | null = null;
  let shared: Steps | null = null;
  /** The record from which this tab started, as it was then. */
  let origin: { readonly stamp: Stamp; readonly raw: string } | null = null;
  const reported = new Set<string>();
  const report = (words: string): void => {
    if (!reported.has(words)) say(words);
    reported.add(words);
  };

  const heads = (): StoredDesign[] =>
    (all === null ? [] : keys(all, WORK).map((key) => record(read(all, key))))
      .filter((kept): kept is StoredDesign => kept !== null)
      .sort((a, b) => b.at - a.at);

  const rawOf = (of: string): string => all?.getItem(WORK + of) ?? "";
  const drop = (of: string): void => {
    all?.removeItem(WORK + of);
    all?.removeItem(STEPS + of);
  };

  /** Continues a record: later writes replace it, under a new id. */
  const begin = (kept: StoredDesign, of: Steps): Work => {
    origin = { stamp: { id: kept.id, at: kept.at, count: kept.count }, raw: rawOf(kept.id) };
    id = fresh();
    count = kept.count;
    steps = shared = null;
    return { ...kept, ...of };
  };

  /** Returns the design of this tab, or its copy if that is newer: a browser that was killed may have written only one. */
  const own = (): Work | null => {
    const mine = record(read(tab, OWN));
    if (mine === null) return null;
    const copy = record(read(all, WORK + mine.id));
    return copy !== null && copy.count > mine.count
      ? begin(copy, stepsOf(read(all, STEPS + copy.id)))
      : begin(mine, stepsOf(read(tab, OWN_STEPS)));
  };

  const former = (): Work | null => {
    const old = read(all, FORMER) as { text?: unknown; past?: unknown; pinned?: unknown } | null;
    if (typeof old?.text !== "string") return null;
    const past = Array.isArray(old.past) ? old.past.filter((one) => typeof one === "string") : [];
    const pinned = typeof old.pinned === "string" ? old.pinned : null;
    return { ...EMPTY, text: old.text, pinned, started: String(read(all, "papilio.started") ?? ""), past, future: [] };
  };

  /** Frees storage: removes the undo steps, or with `whole` all data, of the oldest design that is not open here. */
  const room = (whole: boolean): boolean => {
    const last =
      all === null
        ? undefined
        : heads().findLast((kept) => kept.id !== id && (whole || all.getItem(STEPS + kept.id) !== null));
    if (!last) return false;
    if (whole) drop(last.id);
    else all!.removeItem(STEPS + last.id);
    report(
      whole
        ? `The browser's storage is full: the oldest design, “${last.title}”, was removed.`
        : "The browser's storage is full: the undo steps of earlier designs were removed.",
    );
    return true;
  };

  /** Writes both parts, the steps first: after a crash between them, a step exists twice, but none is missing. */
  const put = (
    place: Place,
    [head, tail]: readonly [string, string],
    now: StoredDesign,
    of: Steps,
    before: Steps | null,
  ): void => {
    let left = of;
    // Another tab may have removed the steps, together with a record that it has continued.
    let same = before?.past === of.past && before.future === of.future && place.getItem(tail) !== null;
    for (;;) {
      if ((same || write(place, tail, written(left))) && write(place, head, now)) return;
      same = false;
      if (place === all && room(false)) continue;
      if (left.past.length + left.future.length > 0) {
        left = newer(left);
        report("The browser's storage is full: the oldest undo steps will not survive a reload.");
        continue;
      }
      if (place === all && room(true)) continue;
      return report("The browser stores nothing (its storage is full, or the window is private). Save your designs.");
    }
  };

  const keep: Keeper["keep"] = (now, of, changed) => {
    count += 1;
    const kept: StoredDesign = { ...now, id, at: clock(), count };
    // Until the first change, the record of the tab is that of the loaded design.
    const own = changed || origin === null ? kept : { ...kept, ...origin.stamp };
    if (tab !== null) put(tab, [OWN, OWN_STEPS], own, of, steps);
    steps = of;
    if (all === null || !changed) {
      if (tab === null && all === null)
        report("The browser stores nothing: a reload will lose all changes. Save your designs.");
      return;
    }
    put(all, [WORK + id, STEPS + id], kept, of, shared);
    if (shared === null) tidy();
    shared = of;
  };

  /** After the first change: removes the record from which this tab started, and the oldest records. */
  const tidy = (): void => {
    if (origin !== null && rawOf(origin.stamp.id) === origin.raw) drop(origin.stamp.id);
    origin = null;
    all?.removeItem(FORMER);
    for (const old of heads().slice(MOST)) {
      drop(old.id);
      report(`At most ${MOST} designs are stored: the oldest one, “${old.title}”, was removed.`);
    }
  };

  return {
    load() {
      const mine = own();
      if (mine !== null) return { work: mine, own: true };
      const [last] = heads();
      const work = last ? begin(last, stepsOf(read(all, STEPS + last.id))) : former();
      return work && { work, own: false };
    },
    keep,
    part: () => void (origin = null),
    leave() {
      [origin, id, count, steps, shared] = [null, fresh(), 0, null, null];
    },
    earlier: () =>
      heads()
        .filter((kept) => kept.id !== id && kept.id !== origin?.stamp.id)
        .map(({ id, title, change, at }) => ({ id, title, change, at })),
    files: () => new Set(heads().flatMap((kept) => Object.values(kept.files))),
    take(of) {
      const kept = record(read(all, WORK + of));
      return kept && begin(kept, stepsOf(read(all, STEPS + of)));
    },
  };
}
