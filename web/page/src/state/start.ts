// Opens a design when the page starts, and stores it from then on: every change is written immediately, whether the
// server has accepted it, has refused it or has not responded, and also while it is being typed.

import { batch, effect, signal } from "@preact/signals";

import * as api from "../api/client.ts";
import type { Start } from "../api/types.ts";
import { lastChange, titleOf } from "../model/about.ts";
import { followDesign, linked, opening } from "./address.ts";
import { draft, draftName, held, pending, text } from "./design.ts";
import { merged } from "./edits.ts";
import { adopt, files, keptIds, recallFiles, recallFormer, type Dropped } from "./files.ts";
import { gesture } from "./gesture.ts";
import { forgetUnused } from "./keep.ts";
import { isTyped, resume } from "./live.ts";
import { mirrored } from "./mirror.ts";
import { forgetOpened, open } from "./open.ts";
import { pinned, repin, unpin } from "./pin.ts";
import { said } from "./said.ts";
import { history, resume as resumeSteps } from "./undo.ts";
import { versions } from "./versions.ts";
import { EMPTY, keeper, STEPS, WORK, type Earlier, type Keeper, type Now, type Steps, type Work } from "./works.ts";

/** Returns a storage of the browser, or null if it is not available. */
function place(which: "localStorage" | "sessionStorage"): Storage | null {
  try {
    return window[which];
  } catch {
    return null;
  }
}

let works: Keeper;

/** Opens the storages of the browser. */
async function openWorks(): Promise<void> {
  const all = place("localStorage");
  const say = (words: string): void => void (said.value = words);
  works = keeper(place("sessionStorage"), all && (await mirrored(all, WORK, STEPS)), say);
}

/** The name of the scenario with which the server was started, as of this tab's last request. */
let started = "";
/** The scenario that the address or the command line has opened; it need not be stored. */
let given: string | null = null;
let isTouched = false;
/** Files of the scenario with which the server was started. */
let adopted: Readonly<Record<string, string>> = {};
/** The design as it was last written. */
let last: Work | null = null;

/** Earlier designs and designs of other tabs, newest first. */
export const earlier = signal<readonly Earlier[]>([]);
export const lookForEarlier = (): void => void (earlier.value = works.earlier());

/** The title of the design itself: that of its text, with the changes that wait. */
function ownTitle(): string {
  const changed = [...pending.value, ...(held.value === null ? [] : [held.value])].findLast(({ path }) => path === "title");
  const typed = changed?.op === "set" ? String(changed.value) : null;
  return typed || titleOf(draft.value ?? text.value) || "Untitled";
}

const now = (): Now => ({
  text: text.value,
  draft: draft.value,
  draftName: draftName.value,
  typed: isTyped(),
  pending: held.value === null ? pending.value : merged(pending.value, [{ ...held.value, gesture: gesture() }]),
  present: history.value.present === text.value ? null : history.value.present,
  pinned: pinned.value?.text ?? waitingPin.value,
  started,
  files: keptIds.value,
  title: ownTitle(),
  change: lastChange(history.value.past.at(-1), draft.value ?? text.value),
});

/** A pinned text that is being computed again. */
const waitingPin = signal<string | null>(null);

const isSame = (a: Now & Steps, b: Now & Steps): boolean =>
  a.text === b.text &&
  a.draft === b.draft &&
  a.present === b.present &&
  a.pinned === b.pinned &&
  a.past === b.past &&
  a.future === b.future &&
  JSON.stringify([a.pending, a.files]) === JSON.stringify([b.pending, b.files]);

/** Returns true if the design must be stored, because the user has changed it. */
function isChanged(work: Work): boolean {
  const waits = work.pending.length > 0 || (work.draft !== null && work.draft !== given);
  const hasFiles = Object.keys(work.files).some((name) => !(name in adopted));
  const isGiven = given !== null && (work.text === given || work.draft === given);
  isTouched ||= waits || hasFiles || work.pinned !== null || (!isGiven && work.past.length + work.future.length > 0);
  return isTouched;
}

/** Stores the design at every change from now on. */
function storeChanges(): void {
  effect(() => {
    const [all, { past, future }] = [now(), history.value];
    const work: Work = { ...all, past, future };
    if (work.text === "" && work.draft === null) return;
    if (last !== null && isSame(work, last)) return;
    last = work;
    works.keep(all, { past, future }, isChanged(work));
  });
}

/** Restores a stored design, including its pending changes. */
function restore(work: Work): void {
  batch(() => {
    unpin();
    waitingPin.value = work.pinned;
    forgetOpened();
    resumeSteps(work.past, work.present ?? work.text, work.future);
    resume(work);
    last = { ...work, ...now(), past: history.value.past, future: history.value.future, title: work.title };
  });
}

async function pinAgain(): Promise<void> {
  if (waitingPin.value !== null) await repin(waitingPin.value);
  waitingPin.value = null;
}

const BACK = "Undo restores the previous design.";

/** Opens the scenario in the address. */
async function follow(scenario: string): Promise<void> {
  const before = text.value;
  if (scenario === (draft.value ?? before)) return opening(scenario);
  given = isTouched ? null : scenario;
  if (!(await open(scenario))) return;
  opening(scenario);
  if (before !== "") said.value = `The scenario of the link is open. ${BACK}`;
}

/** Opens the scenario of a link, or that of the command line if it is new, or else the design of the last visit. */
export async function begin(): Promise<void> {
  const [link, first] = await Promise.all([linked(), api.get<Start>("start"), openWorks()]);
  const loaded = works.load();
  const isNew = loaded?.work.started !== first.name;
  started = first.name;
  adopted = first.files;
  adopt(adopted);
  await recallFormer();
  if (loaded !== null) {
    await recallFiles(loaded.work.files);
    // A new tab that opens another scenario does not replace the design of the last visit.
    if (!loaded.own && (link !== null || isNew)) works.part();
    restore(loaded.work);
  }
  storeChanges();
  if (link !== null) await follow(link);
  else if (isNew) {
    given = first.scenario;
    await open(first.scenario);
    if (loaded !== null) said.value = `${first.name} is open, because the program was started with it. ${BACK}`;
  }
  followDesign();
  watch();
  await pinAgain();
  const ofVersions = versions.value.flatMap((version) => Object.values(version.files));
  await forgetUnused(new Set([...works.files(), ...ofVersions, ...Object.values(keptIds.value)]));
}

/** Watches for links that are opened in this tab, and for designs that other tabs store or remove. */
function watch(): void {
  addEventListener(
    "hashchange",
    () => void linked().then((scenario) => (scenario === null ? undefined : follow(scenario))),
  );
  addEventListener("storage", ({ oldValue, newValue }) => (oldValue === null || newValue === null) && lookForEarlier());
  lookForEarlier();
}

/** Opens a design with other files; the previous design becomes an earlier one. */
export async function begun(scenario: string, compared: string | null, given_files: readonly Dropped[], change: string): Promise<void> {
  works.leave();
  batch(() => {
    files.value = given_files;
    restore({ ...EMPTY, text: scenario, pinned: compared, started, files: keptIds.value, change, past: [], future: [] });
  });
  given = null;
  isTouched = true;
  works.keep(now(), history.value, true);
  lookForEarlier();
  await pinAgain();
}

/** Opens an earlier design; the previous one becomes an earlier design. */
export async function takeUp(id: string): Promise<void> {
  const others = works.earlier().length;
  const work = works.take(id);
  if (work === null) return lookForEarlier();
  await recallFiles(work.files);
  restore(work);
  given = null;
  isTouched = false;
  // A reload opens it, too.
  works.keep(now(), history.value, false);
  lookForEarlier();
  const isThere = earlier.value.length === others;
  said.value = `“${work.title}” is open again${isThere ? "; the previous design is under Earlier" : ""}.`;
  await pinAgain();
}
