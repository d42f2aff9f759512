// Compact storage of a list of similar texts: the first one is stored whole, the others as differences from the text
// before. Two hundred undo steps take some kilobytes instead of a megabyte.

/** The difference from the text before: how many characters stay at the start and the end, and the text between. */
type Change = readonly [start: number, end: number, between: string];

export type Chain = readonly (string | Change)[];

function change(from: string, to: string): Change {
  const most = Math.min(from.length, to.length);
  let start = 0;
  while (start < most && from[start] === to[start]) start++;
  let end = 0;
  while (end < most - start && from[from.length - 1 - end] === to[to.length - 1 - end]) end++;
  return [start, end, to.slice(start, to.length - end)];
}

export const chained = (texts: readonly string[]): Chain =>
  texts.map((text, i) => (i === 0 ? text : change(texts[i - 1]!, text)));

/** Returns the texts of a chain; an empty list for an invalid chain. */
export function unchained(chain: unknown): string[] {
  const texts: string[] = [];
  for (const link of Array.isArray(chain) ? (chain as Chain) : []) {
    const before = texts.at(-1) ?? "";
    if (typeof link === "string") texts.push(link);
    else if (Array.isArray(link)) {
      const [start, end, between] = link as Change;
      texts.push(before.slice(0, start) + between + before.slice(before.length - end));
    } else return [];
  }
  return texts;
}
