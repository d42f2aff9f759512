// The current design: its TOML, its fields, and its result.
//
// The text is the single source of truth. Edits are pending until the server has applied them to the text; `fields`
// includes them immediately, so that the controls respond without delay. Edits that the server refuses stay pending,
// with the error messages at their fields, until they are corrected or discarded.

import { computed, signal } from "@preact/signals";

import type { Edit, Live, Problem, Result } from "../api/types.ts";
import { isSamePath, textAt, type Json } from "../model/json.ts";
import type { Schema } from "../model/schema.ts";
import { edited, type Change } from "./edits.ts";
import type { Revision } from "./revision.ts";

/** The TOML to which the shown result belongs. */
export const text = signal("");
/** A whole text that will replace it when the server has accepted it: opened, undone or typed. */
export const draft = signal<string | null>(null);
/** The name of the draft's file, or "". */
export const draftName = signal("");
/** The name of an example or a file that is being opened, or "". */
export const opening = signal("");
/** Edits that are not in the text yet. */
export const pending = signal<readonly Change[]>([]);
/** The edit of a text box that still has the focus. It becomes pending when the focus or the page is lost. */
export const held = signal<Edit | null>(null);
/** The last response of the server. */
export const answer = signal<Live | null>(null);
/** The design to which it belongs. */
export const resultOf = signal<Revision>("");
/** The number of results so far. */
export const resultCount = signal(0);
/** The errors of the pending edits or of the draft. */
export const problems = signal<readonly Problem[]>([]);
/** The errors because of which the page could not start. */
export const startProblems = signal<readonly Problem[]>([]);
/** Whether a response takes so long that this is shown. */
export const busy = signal(false);
export const schema = signal<Schema | null>(null);

/** The fields of the scenario, with all defaults and with the pending edits. */
export const fields = computed<Json>(() => edited((answer.value?.fields ?? {}) as Json, pending.value));
export const result = computed<Result | null>(() => answer.value?.result ?? null);
export const title = computed(() => opening.value || (textAt(fields.value, "title") ?? "Untitled"));

/** The path of the part that is selected in the drawing, including "viewer" and "lighting". */
export const selected = signal("display.diffuser");
/** The index of the view that is shown. */
const wantedView = signal(0);
export const viewIndex = computed(() => Math.min(wantedView.value, (answer.value?.views.length ?? 1) - 1));
export const showView = (index: number): void => void (wantedView.value = index);
/** Whether the result contains the selected view: one of a single view may be that of another. */
export const isViewKnown = (): boolean => answer.value?.view == null || answer.value.view === viewIndex.value;
export const view = computed(() => result.value?.views[answer.value?.view == null ? viewIndex.value : 0] ?? null);

/** The states of the shown view, in the order of the result. */
export const states = computed(() => Object.entries(view.value?.states ?? {}));

const wantedState = signal("white");
export const showState = (name: string): void => void (wantedState.value = name);
/** The state in which the pixel is drawn: the selected state, if it exists. */
export const shownState = computed(() => {
  const names = states.value.map(([name]) => name);
  return [wantedState.value, "white"].find((name) => names.includes(name)) ?? names[0] ?? wantedState.value;
});

/** Returns the errors of a key. */
export function problemsAt(path: string): readonly Problem[] {
  return problems.value.filter((problem) => problem.path && isSamePath(problem.path, path));
}
