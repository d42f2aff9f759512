// The colour theme: light or dark, as in the system or as chosen on the page.

import { computed, effect, signal } from "@preact/signals";

import { recall, remember } from "./keep.ts";

export type Theme = "system" | "light" | "dark";

const KEY = "papilio.theme";
const prefers = matchMedia("(prefers-color-scheme: dark)");
const system = signal(prefers.matches);

export const theme = signal<Theme>(recall<Theme>(KEY) ?? "system");
export const dark = computed(() => (theme.value === "system" ? system.value : theme.value === "dark"));

/** Applies the theme to the document, and stores the choice. */
export function followTheme(): void {
  prefers.addEventListener("change", () => (system.value = prefers.matches));
  effect(() => {
    document.documentElement.dataset["theme"] = dark.value ? "dark" : "light";
    if (recall<Theme>(KEY) !== theme.value) remember(KEY, theme.value);
  });
}
