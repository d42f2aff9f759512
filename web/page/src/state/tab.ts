// The open tool, and the step of the page to which it belongs.

import { computed, signal } from "@preact/signals";

import { stepOf } from "../model/tools.ts";
import { part } from "./compact.ts";

export const openTab = signal("stage");
export const openStep = computed(() => stepOf(openTab.value));

/** The tool of each step that was open last. */
const last = new Map<string, string>();

/** Opens a tool and brings it into view. */
export function showTab(id: string): void {
  openTab.value = id;
  last.set(stepOf(id).id, id);
  part.value = "details";
  requestAnimationFrame(() => document.getElementById(`tab-${id}`)?.scrollIntoView({ block: "nearest" }));
}

/** Opens a step: the tool of it that was open last, or its first one. */
export function showStep(id: string, first: string): void {
  showTab(last.get(id) ?? first);
}
