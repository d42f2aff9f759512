// A design that is kept beside the one on the bench, for comparison.

import { computed, signal } from "@preact/signals";

import type { Result, View } from "../api/types.ts";
import { answer, text, title, viewIndex } from "./design.ts";

export interface Pinned {
  readonly title: string;
  readonly text: string;
  readonly result: Result;
}

export const pinned = signal<Pinned | null>(null);
export const pinnedView = computed<View | null>(() => pinned.value?.result.views[Math.min(viewIndex.value, pinned.value.result.views.length - 1)] ?? null);

export function pin(): void {
  const result = answer.value?.result;
  if (result) pinned.value = { title: title.value, text: text.value, result };
}

export const unpin = (): void => void (pinned.value = null);
