// A design that is kept beside the one on the bench, for comparison.

import { computed, signal } from "@preact/signals";

import { live } from "../api/client.ts";
import type { Result, View } from "../api/types.ts";
import { textAt, type Json } from "../model/json.ts";
import { answer, text, title, viewIndex } from "./design.ts";
import { fileIds } from "./files.ts";
import { ready } from "./ready.ts";

export interface Pinned {
  readonly title: string;
  readonly text: string;
  readonly result: Result;
}

export const pinned = signal<Pinned | null>(null);
export const pinnedView = computed<View | null>(
  () => pinned.value?.result.views[Math.min(viewIndex.value, pinned.value.result.views.length - 1)] ?? null,
);

/** Pins the design on the bench, once all changes are in it. */
export async function pin(): Promise<boolean> {
  const result = (await ready("pinned")) && answer.value?.result;
  if (!result) return false;
  pinned.value = { title: title.value, text: text.value, result };
  return true;
}

/** Pins the design of an earlier visit, computed anew. */
export async function repin(scenario: string): Promise<void> {
  try {
    const { fields, result } = await live({ scenario, files: fileIds.value }, [], new AbortController().signal);
    pinned.value = { title: textAt(fields as Json, "title") ?? "Untitled", text: scenario, result };
  } catch {
    // A design that no longer computes is not pinned.
  }
}

export const unpin = (): void => void (pinned.value = null);
