// The pinned design, with which the current one is compared.

import { computed, signal } from "@preact/signals";

import { live } from "../api/client.ts";
import type { Result, View } from "../api/types.ts";
import { textAt, type Json } from "../model/json.ts";
import { answer, text, title, viewIndex } from "./design.ts";
import { fileIds } from "./files.ts";
import { exact } from "./live.ts";
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

/** Pins the current design after all changes are applied. */
export async function pin(): Promise<boolean> {
  const result = (await ready("pinned")) && (await exact()) && answer.value?.result;
  if (!result) return false;
  pinned.value = { title: title.value, text: text.value, result };
  return true;
}

/** Computes and pins the pinned design of an earlier visit. */
export async function repin(scenario: string): Promise<void> {
  try {
    const work = { scenario, files: fileIds.value };
    const { fields, result } = await live(work, [], "exact", null, new AbortController().signal);
    pinned.value = { title: textAt(fields as Json, "title") ?? "Untitled", text: scenario, result };
  } catch {
    // A design that can no longer be computed is not pinned.
  }
}

export const unpin = (): void => void (pinned.value = null);
