// Marks a content that does not belong to the current design: with words in its corner, and faded.

import { createContext, type ComponentChildren } from "preact";

import { isFaded, liveAge, markOf } from "../state/age.ts";
import { resultCount } from "../state/design.ts";
import type { Age } from "../state/revision.ts";

/** A content: its age, and what it belongs to. */
export interface Content {
  readonly age: Age;
  /** A design, unless given. */
  readonly thing?: string | undefined;
  /** The name of what it belongs to, for files; that of the design, unless given. */
  readonly name?: string | undefined;
  /** How many there were before it. */
  readonly count?: number;
}

/** The content around a component; what has none does not depend on the design. */
export const ContentContext = createContext<Content>({ age: "current" });

/** Marks of contents that are being computed come and go too fast to be read out. */
const QUIET: readonly Age[] = ["first", "settings", "before"];

/** `more` follows the words of the mark. */
export function AgeMark({ age, more = "", thing, count = 0 }: Content & { more?: string }) {
  const mark = markOf(age, thing);
  return (
    <span
      class={`age-mark turn-${count % 2}`}
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
  const of = `age-mark turn-${resultCount.value % 2}`;
  return mark && <span class={of} data-age={liveAge.value} title={mark.help}>{mark.words}</span>;
}

/**
 * The class of an element whose content has an age. It fades after a moment, which begins again with each content: `count` is its number, so
 * that what follows a drag stays clear.
 */
export const fadedClass = (age: Age, count: number): string => (isFaded(age) ? ` faded turn-${count % 2}` : "");

/** That of a part of the live result. */
export const liveClass = (): string => fadedClass(liveAge.value, resultCount.value);

export function Aged({ children, ...content }: Content & { children: ComponentChildren }) {
  const { age, count = 0 } = content;
  return (
    <div class="aged">
      <AgeMark {...content} />
      <div class={fadedClass(age, count).trim()} aria-busy={isFaded(age)}>
        <ContentContext.Provider value={content}>{children}</ContentContext.Provider>
      </div>
    </div>
  );
}
