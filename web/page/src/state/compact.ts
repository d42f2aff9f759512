// The compact layout: one column with sections to choose from, for phones, and larger targets in the drawing.

import { signal } from "@preact/signals";

/** The same condition as in style/compact.css. */
const query = matchMedia("(max-width: 700px), (max-height: 480px)");

export const compact = signal(query.matches);
query.addEventListener("change", () => (compact.value = query.matches));

export type Part = "design" | "plots" | "details";

/** The section that is shown in the compact layout. */
export const part = signal<Part>("details");
