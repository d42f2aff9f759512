// Search in a list of named things.

/** Something with a name and a description. */
export interface Named {
  readonly name: string;
  readonly what: string;
}

const plain = (text: string): string => text.toLowerCase().replace(/aluminum/g, "aluminium");

/** Returns the entries whose name or description has all words, in any order; names that begin with them come first. */
export function matching<T extends Named>(all: readonly T[], search: string): T[] {
  const words = plain(search).split(/\s+/).filter(Boolean);
  const has = (entry: T) => words.every((word) => plain(`${entry.name} ${entry.what}`).includes(word));
  const begins = (entry: T) => Number(words.length > 0 && plain(entry.name).startsWith(words[0] ?? ""));
  return all.filter(has).sort((a, b) => begins(b) - begins(a));
}
