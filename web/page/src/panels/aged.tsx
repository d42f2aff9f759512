// Marks a content that does not belong to the current design: with words in its corner, and faded.

import { createContext, type ComponentChildren } from "preact";

import { isFaded, liveAge, markOf } from "../state/age.ts";
import type { Age } from "../state/revision.ts";

/** A content: its age, and what it belongs to. */
export interface Content {
  readonly age: Age;
  /** A design, unless given. */
  readonly thing?: string | undefined;
  /** The name of what it belongs to, for files; that of the design, unless given. */
  readonly name?: string | undefined;
}

/** The content around a component; what has none does not depend on the design. */
export const ContentContext = createContext<Content>({ age: "current" });

/** Marks of contents that are being computed come and go too fast to be read out. */
const QUIET: readonly Age[] = ["first", "settings", "before"];

/** `more` follows the words of the mark. */
export function AgeMark({ age, more = "", thing }: { age: Age; more?: string; thing?: string | undefined }) {
  const mark = markOf(age, thing);
  return (
    <span
      class="age-mark"
      role="status"
      aria-live={QUIET.includes(age) ? "off" : "polite"}
      data-age={age}
      title={mark?.help}
    >
      {mark ? mark.words + more : ""}
    </span>
  );
}

/** The mark of a part of the live result, whose age is read out elsewhere. */
export function LiveMark() {
  const mark = isFaded(liveAge.value) ? markOf(liveAge.value) : null;
  return mark && <span class="age-mark" data-age={liveAge.value} title={mark.help}>{mark.words}</span>;
}

/** The class of an element whose content has an age. */
export const fadedClass = (age: Age): string => (isFaded(age) ? " faded" : "");

export function Aged({ children, ...content }: Content & { children: ComponentChildren }) {
  const { age, thing } = content;
  return (
    <div class="aged">
      <AgeMark age={age} thing={thing} />
      <div class={fadedClass(age).trim()} aria-busy={isFaded(age)}>
        <ContentContext.Provider value={content}>{children}</ContentContext.Provider>
      </div>
    </div>
  );
}
