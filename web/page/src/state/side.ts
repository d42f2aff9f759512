// Designs side by side: the current one and versions, each with its result and its picture. Which ones they are is kept for the
// next visit.

import { computed, effect, signal } from "@preact/signals";

import { live, postForBytes, Refused } from "../api/client.ts";
import type { Result, View } from "../api/types.ts";
import { tiltOf, type Tilt } from "../model/perspective.ts";
import { unpacked, type Seen } from "../model/seen.ts";
import { text, title, viewIndex } from "./design.ts";
import { keptIds, sendFiles } from "./files.ts";
import { recall, remember } from "./keep.ts";
import { revisionOf, usedFiles, type Ids } from "./revision.ts";
import { BUSY, gone } from "./server.ts";
import { versions } from "./versions.ts";

const KEY = "papilio.side";
const AGAIN_MS = 700;
/** Time without changes after which the current design is computed, ms. */
const REST_MS = 250;
/** Number of answers that are held. */
const MOST = 32;
/** Number of columns, unless others are chosen. */
const FIRST = 4;
/** The id of the current design, which is always shown. */
export const CURRENT = "current";

interface Choice {
  readonly ids: readonly string[] | null;
  readonly base: string;
}

function stored(): Choice {
  const found = recall<Partial<Choice>>(KEY);
  const ids = Array.isArray(found?.ids) ? found.ids.filter((id) => typeof id === "string") : null;
  return { ids, base: typeof found?.base === "string" ? found.base : "" };
}

const choice = signal<Choice>(stored());

function choose(next: Partial<Choice>): void {
  choice.value = { ...choice.value, ...next };
  remember(KEY, choice.value);
}

export interface Column {
  readonly id: string;
  readonly name: string;
  readonly text: string;
  readonly files: Ids;
  /** What determines its answer. */
  readonly revision: string;
}

const column = (id: string, name: string, text: string, files: Ids): Column => ({
  id,
  name,
  text,
  files: usedFiles(text, files),
  revision: revisionOf(text, files),
});

/** The columns: the current design, and the chosen versions. */
export const columns = computed<readonly Column[]>(() => {
  const { ids } = choice.value;
  const chosen = versions.value.filter(({ id }, i) => (ids ? ids.includes(id) : i < FIRST - 1));
  return [
    column(CURRENT, title.value, text.value, keptIds.value),
    ...chosen.map(({ id, name, text, files }) => column(id, name, text, files)),
  ];
});

/** The column from which differences are counted: the chosen one, or the oldest version. */
export const base = computed<Column>(
  () => columns.value.find(({ id }) => id === choice.value.base) ?? columns.value.at(-1)!,
);
export const setBase = (id: string): void => choose({ base: id });

export function toggle(id: string): void {
  const shown = columns.value.map((one) => one.id).filter((one) => one !== CURRENT);
  choose({ ids: shown.includes(id) ? shown.filter((one) => one !== id) : [...shown, id] });
}

export interface Answer {
  readonly result: Result | null;
  readonly view: View | null;
  readonly seen: Seen | null;
  readonly tilt: Tilt;
  /** Why there is no result or no picture; "" if there are both. */
  readonly words: string;
}

const answers = signal<ReadonlyMap<string, Answer>>(new Map());
const keyOf = ({ revision }: Column): string => JSON.stringify([revision, viewIndex.value]);
export const answerOf = (of: Column): Answer | undefined => answers.value.get(keyOf(of));

const put = (key: string, answer: Answer): void =>
  void (answers.value = new Map([...[...answers.value].filter(([one]) => one !== key), [key, answer] as const].slice(-MOST)));

/** Requests something; files that the server has lost are sent again, and a busy server is asked again. */
async function insisting<T>(files: Ids, request: () => Promise<T>, signal: AbortSignal): Promise<T> {
  let wasSent = false;
  for (;;) {
    try {
      return await request();
    } catch (why) {
      if (signal.aborted || !(why instanceof Refused)) throw why;
      const isLost: boolean = (why.status === 404 || why.status === 410) && !wasSent;
      if (isLost) await sendFiles(files);
      else if (why.status === BUSY) await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
      else throw why;
      wasSent ||= isLost;
    }
  }
}

const reason = (why: unknown): string => (why instanceof Error ? why.message : String(why));

async function compute(of: Column, signal: AbortSignal): Promise<void> {
  const [key, work] = [keyOf(of), { scenario: of.text, files: of.files }];
  let result: Result;
  try {
    ({ result } = await insisting(of.files, () => live(work, [], "exact", null, signal), signal));
  } catch (why) {
    if (!signal.aborted && !(why instanceof Refused && why.status === 0))
      put(key, { result: null, view: null, seen: null, tilt: [0, 0], words: reason(why) });
    return;
  }
  const view = result.views[Math.min(viewIndex.value, result.views.length - 1)]!;
  const { theta_deg, phi_deg } = view;
  const answer: Answer = { result, view, seen: null, tilt: tiltOf(theta_deg, phi_deg), words: "" };
  put(key, answer);
  try {
    const request = { ...work, picture: null, halftone: null, theta_deg, phi_deg };
    const seen = unpacked(await insisting(of.files, () => postForBytes("image", request, signal), signal));
    put(key, { ...answer, seen });
  } catch (why) {
    if (!signal.aborted) put(key, { ...answer, words: reason(why) });
  }
}

/** Computes all columns, one after the other, as long as they are shown. Returns a function that ends it. */
export function followSide(): () => void {
  let abort = new AbortController();
  const end = effect(() => {
    const wanted = columns.value.map((one) => [keyOf(one), one] as const);
    if (gone.value || text.value === "") return;
    abort.abort();
    const mine = (abort = new AbortController());
    const all = async () => {
      for (const [key, one] of wanted) {
        const known = answers.peek().get(key);
        if (known && (known.seen || known.words)) continue;
        await compute(one, mine.signal);
        if (mine.signal.aborted) return;
      }
    };
    const rest = setTimeout(() => void all(), REST_MS);
    mine.signal.addEventListener("abort", () => clearTimeout(rest));
  });
  return () => {
    end();
    abort.abort();
  };
}
