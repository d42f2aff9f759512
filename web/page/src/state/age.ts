// Ages of what is shown (revision.ts), and their words. Every panel marks its content with the same component (panels/aged.tsx).

import { computed } from "@preact/signals";

import { digits } from "../model/format.ts";
import { answer, draft, isViewKnown, opening, pending, problems, resultOf, text } from "./design.ts";
import { keptIds } from "./files.ts";
import { ageOf, revisionOf, type Age, type Present } from "./revision.ts";

export interface Mark {
  /** The words of the mark. */
  readonly words: string;
  readonly help: string;
  /** Whether the content is drawn faded. */
  readonly isFaded: boolean;
}

/** The marks of contents of a `thing`: a design, or a surface. */
export function markOf(age: Age, thing = "design"): Mark | null {
  switch (age) {
    case "current":
      return null;
    case "first":
      return {
        words: "first answer",
        help: "A coarse first answer with its error (of colours, the largest of Y over states and views); the exact one follows.",
        isFaded: false,
      };
    case "settings":
      return {
        words: "of the view or settings before; computing…",
        help: "What is shown belongs to this design, but to another view or other settings.",
        isFaded: true,
      };
    case "before":
      return {
        words: `of the ${thing} before; computing…`,
        help: `What is shown belongs to the ${thing} before the last change. That of the current one is being computed.`,
        isFaded: true,
      };
    case "refused":
      return {
        words: `of the last valid ${thing}`,
        help: "The last change cannot be computed; the errors are at its fields.",
        isFaded: true,
      };
    case "failed":
      return {
        words: `of the ${thing} before; the current one cannot be computed`,
        help: `What is shown belongs to the ${thing} before the last change. The errors say why that of the current one cannot be computed.`,
        isFaded: true,
      };
    case "earlier":
      return {
        words: `of an earlier ${thing}`,
        help: `The ${thing} has changed since this was computed. Run it again for the current one.`,
        isFaded: true,
      };
  }
}

/** Whether a content of this age is drawn faded. */
export const isFaded = (age: Age): boolean => markOf(age)?.isFaded ?? false;

/** The design of the page. */
export const present = computed((): Present => {
  const isWaiting = pending.value.length > 0 || draft.value !== null || opening.value !== "";
  return {
    revision: revisionOf(text.value, keptIds.value),
    isWaiting,
    isRefused: isWaiting && opening.value === "" && problems.value.length > 0,
  };
});

/** The age of the live result. */
export const liveAge = computed((): Age => {
  const age = ageOf(resultOf.value, present.value, problems.value.length > 0);
  if (age !== "current") return age;
  if (!isViewKnown()) return "settings";
  return answer.value?.is_final === false ? "first" : "current";
});

/** The error of a first answer as text. */
export const firstError = computed((): string =>
  liveAge.value === "first" ? ` \u00b1${digits(100 * answer.value!.relative_error, 2)} %` : "",
);
