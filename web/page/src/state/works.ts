// The designs that this browser keeps, so that none is lost: each tab has a record of its own, and a copy of it
// lies where other tabs, and a later visit, find it.
//
// A tab's own record is in its sessionStorage, which survives a reload and a crash of the tab and is copied when
// the tab is duplicated; the copy is in localStorage. Every load of the page takes a new id. When it first
// changes something it writes a record under it and takes away the one that it began from, unless another tab has
// written that one since: two tabs then hold two designs, and a reload leaves no second one behind.

import { chained, unchained } from "../model/delta.ts";
import type { Edit } from "../api/types.ts";

/** Everything of a design that is not a step of undo. */
export interface Now {
  /** The text that the server took last. */
  readonly text: string;
  /** A whole text that waits to take its place, the file that it is of, and whether it is typed. */
  readonly draft: string | null;
  readonly draftName: string;
  readonly typed: boolean;
  /** Edits that wait, those that are being typed among them. */
  readonly pending: readonly Edit[];
  /** Where undo and redo stand, if not at the text. */
  readonly present: string | null;
  readonly pinned: string | null;
  /** The scenario that `papilio serve` was started with. */
  readonly started: string;
  /** Ids of the dropped files by their names. */
  readonly files: Readonly<Record<string, string>>;
  readonly title: string;
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
  /** When it was written last, ms. */
  readonly at: number;
}

interface Stamp {
  readonly id: string;
  readonly at: number;
  /** How many times it has been written. */
  readonly count: number;
}

type Kept = Now & Stamp;

/** What is used of the browser's storage. */
export type Place = Pick<Storage, "getItem" | "setItem" | "removeItem" | "key" | "length">;

const OWN = "papilio.tab";
const OWN_STEPS = "papilio.tab.steps";
export const WORK = "papilio.work.";
export const STEPS = "papilio.steps.";
/** Where all tabs had one record together. */
const FORMER = "papilio.design";

/** So many designs are kept; with one more the oldest goes. */
export const MOST = 24;

export interface Keeper {
  /** What this tab had open; or, in a new tab, what was changed last in this browser. */
  load(): { readonly work: Work; readonly own: boolean } | null;
  /** Keeps a design at once; `changed` says whether there is anything to lose. */
  keep(now: Now, steps: Steps, changed: boolean): void;
  /** Whatever is open from here on stands beside what was loaded, and not in its place. */
  part(): void;
  earlier(): Earlier[];
  /** Ids of all files that a design here names. */
  files(): Set<string>;
  /** Goes on with another design; the one that was open stays where it was. */
  take(id: string): Work | null;
}

const EMPTY: Now = {
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

function record(found: unknown): Kept | null {
  const kept = found as Partial<Kept> | null;
  if (typeof kept !== "object" || kept === null || typeof kept.text !== "string" || !kept.id) return null;
  return { ...EMPTY, at: 0, count: 0, ...kept } as Kept;
}

const stepsOf = (found: unknown): Steps => {
  const { past, future } = (found ?? {}) as { past?: unknown; future?: unknown };
  return { past: unchained(past), future: unchained(future) };
};

const written = ({ past, future }: Steps) => ({ past: chained(past), future: chained(future) });

/** The half of the steps of undo that is newer. */
const newer = ({ past, future }: Steps): Steps => ({
  past: past.slice(Math.ceil(past.length / 2)),
  future: past.length > 0 ? future : future.slice(0, Math.floor(future.length / 2)),
});

/** Keeps designs in a tab's storage and in the one of all tabs; either may be missing or full, and `say` tells it. */
export function keeper(tab: Place | null, all: Place | null, say: (words: string) => void, clock = Date.now): Keeper {
  const fresh = (): string => `${clock().toString(36)}-${Math.random().toString(36).slice(2, 10)}`;
  let id = fresh();
  let count = 0;
  let steps: Steps | null = null;
  let shared: Steps | null = null;
  /** The record that this tab began from, as it was then. */
  let origin: { readonly stamp: Stamp; readonly raw: string } | null = null;
  const told = new Set<string>();
  const tell = (words: string): void => {
    if (!told.has(words)) say(words);
    told.add(words);
  };

  const heads = (): Kept[] =>
    (all === null ? [] : keys(all, WORK).map((key) => record(read(all, key))))
      .filter((kept): kept is Kept => kept !== null)
      .sort((a, b) => b.at - a.at);

  const rawOf = (of: string): string => all?.getItem(WORK + of) ?? "";
  const drop = (of: string): void => {
    all?.removeItem(WORK + of);
    all?.removeItem(STEPS + of);
  };

  /** Goes on with a record: what is written from here on takes its place, in the name of a new id. */
  const begin = (kept: Kept, of: Steps): Work => {
    origin = { stamp: { id: kept.id, at: kept.at, count: kept.count }, raw: rawOf(kept.id) };
    id = fresh();
    count = kept.count;
    steps = shared = null;
    return { ...kept, ...of };
  };

  /** A copy in localStorage may be newer: a browser that was killed has written one or the other. */
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

  /** Room for what is new: the oldest steps of designs that are not open here go first. */
  const room = (whole: boolean): boolean => {
    const last =
      all === null
        ? undefined
        : heads().findLast((kept) => kept.id !== id && (whole || all.getItem(STEPS + kept.id) !== null));
    if (!last) return false;
    if (whole) drop(last.id);
    else all!.removeItem(STEPS + last.id);
    tell(
      whole
        ? `This browser has no more room: the design “${last.title}”, the oldest, is no longer kept.`
        : "This browser has no more room: steps of undo of earlier designs are no longer kept.",
    );
    return true;
  };

  /** Writes both parts, the steps first: where a crash parts them, a step stands twice and none is missing. */
  const put = (
    place: Place,
    [head, tail]: readonly [string, string],
    now: Kept,
    of: Steps,
    before: Steps | null,
  ): void => {
    let left = of;
    // Another tab may have taken the steps away with a record that it went on from.
    let same = before?.past === of.past && before.future === of.future && place.getItem(tail) !== null;
    for (;;) {
      if ((same || write(place, tail, written(left))) && write(place, head, now)) return;
      same = false;
      if (place === all && room(false)) continue;
      if (left.past.length + left.future.length > 0) {
        left = newer(left);
        tell("This browser has no more room: the oldest steps of undo will not survive a reload.");
        continue;
      }
      if (place === all && room(true)) continue;
      return tell("This browser keeps nothing (it is full, or private): save what you want to keep.");
    }
  };

  const keep: Keeper["keep"] = (now, of, changed) => {
    count += 1;
    const kept: Kept = { ...now, id, at: clock(), count };
    // As long as nothing was changed, the tab's record is that of the design that was loaded.
    const own = changed || origin === null ? kept : { ...kept, ...origin.stamp };
    if (tab !== null) put(tab, [OWN, OWN_STEPS], own, of, steps);
    steps = of;
    if (all === null || !changed) {
      if (tab === null && all === null)
        tell("This browser keeps nothing: a reload begins anew. Save what you want to keep.");
      return;
    }
    put(all, [WORK + id, STEPS + id], kept, of, shared);
    if (shared === null) tidy();
    shared = of;
  };

  /** After the first change: the record that this one began from, and what is too old. */
  const tidy = (): void => {
    if (origin !== null && rawOf(origin.stamp.id) === origin.raw) drop(origin.stamp.id);
    origin = null;
    all?.removeItem(FORMER);
    for (const old of heads().slice(MOST)) {
      drop(old.id);
      tell(`${MOST} designs are kept: “${old.title}”, the oldest, is no longer among them.`);
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
    earlier: () =>
      heads()
        .filter((kept) => kept.id !== id && kept.id !== origin?.stamp.id)
        .map(({ id, title, at }) => ({ id, title, at })),
    files: () => new Set(heads().flatMap((kept) => Object.values(kept.files))),
    take(of) {
      const kept = record(read(all, WORK + of));
      return kept && begin(kept, stepsOf(read(all, STEPS + of)));
    },
  };
}
