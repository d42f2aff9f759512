// Marks a content that does not belong to the current design: with words in its corner, and faded.

import type { ComponentChildren } from "preact";

import { MARKS, type Age } from "../state/age.ts";

export function AgeMark({ age }: { age: Age }) {
  const mark = age === "current" ? null : MARKS[age];
  return (
    <span class="age-mark" role="status" data-age={age} title={mark?.help}>
      {mark?.words ?? ""}
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
