// Whether what is shown belongs to the current design. Every panel marks its content with the same component
// (panels/aged.tsx), which reads the words from here.

import { computed } from "@preact/signals";

import { digits } from "../model/format.ts";
import { answer, busy, draft, opening, pending, problems } from "./design.ts";

/** The age of a content; "current" has no mark. "first": a first answer of the current design. */
export type Age = "current" | "first" | "computing" | "earlier" | "refused";

export interface Mark {
  /** The words of the mark. */
  readonly words: string;
  readonly help: string;
  /** Whether the content is drawn faded. */
  readonly faded: boolean;
}

export const MARKS: Record<Exclude<Age, "current">, Mark> = {
  first: {
    words: "first answer",
    help: "A first answer with coarse discretisation; the exact one follows. The error is the largest of Y over states and views.",
    faded: false,
  },
  computing: { words: "computing…", help: "The result of the current design is being computed.", faded: true },
  earlier: {
    words: "of an earlier design",
    help: "The design has changed since this was computed. Run it again for the current design.",
    faded: true,
  },
  refused: {
    words: "of the last valid design",
    help: "The last change cannot be computed; the errors are at its fields.",
    faded: false,
  },
};

/** The age of the live result. */
export const liveAge = computed((): Age => {
  if (opening.value !== "") return "computing";
  if (problems.value.length > 0 && (pending.value.length > 0 || draft.value !== null)) return "refused";
  if (busy.value && answer.value?.is_final !== false) return "computing";
  return answer.value?.is_final === false ? "first" : "current";
});

/** The error of a first answer as text. */
export const firstError = computed((): string =>
  liveAge.value === "first" ? ` \u00b1${digits(100 * answer.value!.relative_error, 2)} %` : "",
);
