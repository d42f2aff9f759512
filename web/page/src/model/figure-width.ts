// How narrow a figure of the server may be drawn.

/** The largest width that a figure takes in a narrow column, px, and the part of its own width at which its words can be read. */
const MOST_PX = 620;
const READABLE = 0.7;

/** Returns the least width at which a figure can be read, px. */
export function leastWidth(svg: string): number {
  const own = Number(/<svg[^>]*\bwidth="([\d.]+)"/.exec(svg)?.[1] ?? /<svg[^>]*\bviewBox="0 0 ([\d.]+)/.exec(svg)?.[1]);
  return own > 0 ? Math.min(MOST_PX, Math.round(READABLE * own)) : MOST_PX;
}
