// The pinned design, with which the current one is compared.

import { computed, signal } from "@preact/signals";

import { live } from "../api/client.ts";
import type { Result, View } from "../api/types.ts";
import { textAt, type Json } from "../model/json.ts";
import { present } from "./age.ts";
import { answer, text, title, viewIndex } from "./design.ts";
import { fileIds, sendFiles } from "./files.ts";
import { exact } from "./live.ts";
import { ready } from "./ready.ts";
import { revisionOf, type Revision } from "./revision.ts";
import { versions } from "./versions.ts";

export interface Pinned {
  readonly title: string;
  readonly text: string;
  /** The text with its files. */
  readonly revision: Revision;
  readonly result: Result;
}

export const pinned = signal<Pinned | null>(null);
export const pinnedView = computed<View | null>(
  () => pinned.value?.result.views[Math.min(viewIndex.value, pinned.value.result.views.length - 1)] ?? null,
);

/** The name of the pinned design: that of its version, or its title. */
export const pinnedName = computed(
  () =>
    versions.value.find(({ text, files }) => revisionOf(text, files) === pinned.value?.revision)?.name ?? pinned.value?.title ?? "",
);

/** Whether the current design is the pinned one. */
export const isPinned = computed(() => pinned.value?.revision === present.value.revision);

/** Pins the current design after all changes are applied. */
export async function pin(): Promise<boolean> {
  const result = (await ready("kept")) && (await exact()) && answer.value?.result;
  if (!result) return false;
  pinned.value = { title: title.value, text: text.value, revision: present.value.revision, result };
  return true;
}

/** Computes a design with its files, and pins it: a version, or the pinned design of an earlier visit. Returns whether it could be computed. */
export async function repin(scenario: string, ids: Readonly<Record<string, string>> = {}): Promise<boolean> {
  const files = { ...fileIds.value, ...ids };
  const compute = () => live({ scenario, files }, [], "exact", null, new AbortController().signal);
  try {
    const { fields, result } = await compute().catch(async (why: unknown) => {
      if (Object.keys(ids).length === 0) throw why;
      // The server may have lost the files.
      await sendFiles(ids);
      return compute();
    });
    pinned.value = { title: textAt(fields as Json, "title") ?? "Untitled", text: scenario, revision: revisionOf(scenario, files), result };
    return true;
  } catch {
    return false;
  }
}

export const unpin = (): void => void (pinned.value = null);
