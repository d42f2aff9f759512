// The design on the bench: its TOML, the fields that it means, and what the display shows.
//
// The text is the single source of truth. Edits wait here until the server has put them into it; meanwhile
// `fields` shows them already, so that a control never lags behind the hand. Edits that the server refuses
// stay, with its words at their fields, until they are mended or put back.

import { computed, signal } from "@preact/signals";

import type { Edit, Live, Problem, Result } from "../api/types.ts";
import { textAt, type Json } from "../model/json.ts";
import type { Schema } from "../model/schema.ts";
import { edited } from "./edits.ts";

/** The TOML that the picture shows. */
export const text = signal("");
/** A whole text that waits to take its place: opened, undone, typed. */
export const draft = signal<string | null>(null);
/** The file that the draft came from, or "". */
export const draftName = signal("");
/** Edits that are not in the text yet. */
export const pending = signal<readonly Edit[]>([]);
/** What stands in a box and is not entered yet: an edit of its own as soon as the box is left, or the page is lost. */
export const held = signal<Edit | null>(null);
/** The latest answer of the server. */
export const answer = signal<Live | null>(null);
/** Why the pending edits or the draft were refused. */
export const problems = signal<readonly Problem[]>([]);
/** Why the page could not start. */
export const startProblems = signal<readonly Problem[]>([]);
/** Whether an answer has been awaited for long enough to say so. */
export const busy = signal(false);
export const schema = signal<Schema | null>(null);

/** The scenario as it is read, defaults filled in, pending edits included. */
export const fields = computed<Json>(() => edited((answer.value?.fields ?? {}) as Json, pending.value));
export const result = computed<Result | null>(() => answer.value?.result ?? null);
export const title = computed(() => textAt(fields.value, "title") ?? "Untitled");

/** What is selected in the drawing, by its path; "viewer" and "lighting" among them. */
export const selected = signal("display.diffuser");
/** The view that is shown, where there are several. */
const wantedView = signal(0);
export const viewIndex = computed(() => Math.min(wantedView.value, (result.value?.views.length ?? 1) - 1));
export const showView = (index: number): void => void (wantedView.value = index);
export const view = computed(() => result.value?.views[viewIndex.value] ?? null);

/** The states of the view that is shown, in the order of the result. */
export const states = computed(() => Object.entries(view.value?.states ?? {}));

const wantedState = signal("white");
export const showState = (name: string): void => void (wantedState.value = name);
/** The state in which the pixel is drawn: the one that was chosen, as long as there is one of that name. */
export const shownState = computed(() => {
  const names = states.value.map(([name]) => name);
  return [wantedState.value, "white"].find((name) => names.includes(name)) ?? names[0] ?? wantedState.value;
});

/** Problems that concern a key or what is below it. */
export function problemsAt(path: string): readonly Problem[] {
  return problems.value.filter((problem) => problem.path === path);
}
