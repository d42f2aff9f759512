// Undo and redo of the design, as signals.

import { computed, signal } from "@preact/signals";

import { begin, record, redo as forward, undo as back, type History } from "./history.ts";

export const history = signal<History>(begin(""));
export const canUndo = computed(() => history.value.past.length > 0);
export const canRedo = computed(() => history.value.future.length > 0);

/** Restores the steps of an earlier load of the page. */
export function resume(past: readonly string[], present: string, future: readonly string[]): void {
  history.value = { ...begin(present), past, future };
}

/** Records a text that the server has accepted, or that is replaced by another one; the first text is the oldest. */
export function accepted(text: string, gesture: string): void {
  const first = history.value.present === "";
  history.value = first ? begin(text) : record(history.value, text, gesture);
}

const stepped = (next: History): string | null => {
  if (next === history.value) return null;
  history.value = next;
  return next.present;
};

/** Returns the text of the previous step, or null. */
export const undone = (): string | null => stepped(back(history.value));
export const redone = (): string | null => stepped(forward(history.value));
