// The state under the pointer, which is highlighted everywhere: patches, diagrams and tables.

import { computed, signal } from "@preact/signals";

import { shownState } from "./design.ts";

/** The state at the pointer or with the keyboard focus; null without one. */
export const hovered = signal<string | null>(null);

/** The state that is highlighted: the one at the pointer, or else the selected one. */
export const highlighted = computed(() => hovered.value ?? shownState.value);

/** Event handlers of an element that stands for a state. */
export const pointsAt = (state: string) => ({
  onPointerEnter: (event: PointerEvent) => {
    if (event.pointerType !== "touch") hovered.value = state;
  },
  onPointerLeave: () => {
    if (hovered.value === state) hovered.value = null;
  },
});

/** The class of an element that stands for a state. */
export const hoverClass = (state: string): string => (hovered.value === state ? " hovered" : "");
