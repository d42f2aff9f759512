// The open tab below the plots.

import { signal } from "@preact/signals";

import { part } from "./compact.ts";

export const openTab = signal("image");

/** Opens a tab and brings it into view. */
export function showTab(id: string): void {
  openTab.value = id;
  part.value = "details";
  requestAnimationFrame(() => document.getElementById(`tab-${id}`)?.scrollIntoView({ block: "nearest" }));
}
