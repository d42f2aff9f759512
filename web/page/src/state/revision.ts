// Which design a content belongs to. Every number, plot and picture is stored with the revision of the design for which it was computed: the
// text and the files of this design. It is current only while the page has this revision and no change waits. There is no other rule.

/** Text and files of a design, or another request that determines a content. */
export type Revision = string;

/** Files by name, as in requests. */
export type Ids = Readonly<Record<string, string>>;

/**
 * Returns the files that a text may use: those that it names and, if one of these is a text that may name others, all. Files of other
 * designs, or a photograph that was dropped, change no result.
 */
export function usedFiles(text: string, ids: Ids): Ids {
  const names = Object.keys(ids).filter((name) => text.includes(name));
  const all = names.some((name) => name.endsWith(".toml")) ? Object.keys(ids) : names;
  return Object.fromEntries(all.sort().map((name) => [name, ids[name]!]));
}

/** The revision of a text with files. */
export const revisionOf = (text: string, ids: Ids): Revision => JSON.stringify([text, usedFiles(text, ids)]);

/**
 * The age of a content. "first": a first answer of the current design. "settings": of this design, for example in another view. "before": of
 * the design before; "refused": of the last design that could be computed, while a change is refused; "failed": of the design before, while the
 * current one cannot be computed; "earlier": of a run that is not repeated by itself.
 */
export type Age = "current" | "first" | "settings" | "before" | "refused" | "failed" | "earlier";

/** What the page has. */
export interface Present {
  readonly revision: Revision;
  /** Whether a change waits that is not in the revision yet. */
  readonly isWaiting: boolean;
  /** Whether the change that waits is refused. */
  readonly isRefused: boolean;
}

/** The age of a content of revision `of`; `hasFailed` if the content of the present revision could not be computed. */
export function ageOf(of: Revision, now: Present, hasFailed = false): Age {
  if (of !== now.revision) return hasFailed && !now.isWaiting ? "failed" : "before";
  if (!now.isWaiting) return "current";
  return now.isRefused ? "refused" : "before";
}

/** The age of a content that is computed only on request. */
export const ageOfRun = (of: Revision, now: Present): Age => (ageOf(of, now) === "current" ? "current" : "earlier");
