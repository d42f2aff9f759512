// Marks a content that does not belong to the current design: with words in its corner, and faded.

import type { ComponentChildren } from "preact";

import { MARKS, type Age } from "../state/age.ts";

/** `more` follows the words of the mark. First answers come and go too fast to be read out. */
export function AgeMark({ age, more = "" }: { age: Age; more?: string }) {
  const mark = age === "current" ? null : MARKS[age];
  return (
    <span
      class="age-mark"
      role="status"
      aria-live={age === "first" ? "off" : "polite"}
      data-age={age}
      title={mark?.help}
    >
      {mark ? mark.words + more : ""}
    </span>
  );
}

export function Aged({ age, children }: { age: Age; children: ComponentChildren }) {
  const isFaded = age !== "current" && MARKS[age].faded;
  return (
    <div class="aged">
      <AgeMark age={age} />
      <div class={isFaded ? "faded" : ""}>{children}</div>
    </div>
  );
}
