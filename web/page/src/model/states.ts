// The lines of the drive states in diagrams. Each has its own hue, as in crates/figures, and its own dashes, because the curves of the page have
// no names at their ends: white is solid, black dotted.

export interface Stroke {
  readonly light: string;
  readonly dark: string;
  readonly dash: readonly number[];
}

const KNOWN: Record<string, Stroke> = {
  white: { light: "#777777", dark: "#c9ccd1", dash: [] },
  black: { light: "#111111", dark: "#8a9099", dash: [1.5, 3] },
  red: { light: "#c8321f", dark: "#ef6a57", dash: [14, 3] },
  green: { light: "#2c9a57", dark: "#4cc07c", dash: [7, 3] },
  blue: { light: "#2b5fc7", dark: "#6f9bf0", dash: [3.5, 2.5] },
  cyan: { light: "#25a3bb", dark: "#48c3da", dash: [14, 3, 2, 3] },
  magenta: { light: "#b5408f", dark: "#db72b9", dash: [7, 3, 2, 3] },
  yellow: { light: "#c79a0a", dark: "#dfb83a", dash: [7, 2, 1.5, 2, 1.5, 2] },
};
const OTHERS = ["#55606b", "#d9822b", "#7a5bc0", "#5f8a3a", "#8c564b", "#4c78a8"];
/** Dashes of the other states; not as many as hues, so that few pairs are the same. */
const DASHES: readonly (readonly number[])[] = [
  [10, 2, 4, 2],
  [5, 2, 1, 2],
  [14, 2, 1.5, 2, 1.5, 2],
  [1.5, 6],
  [10, 6],
  [3.5, 2, 3.5, 6],
  [7, 2, 1.5, 2, 1.5, 2, 1.5, 2],
];

/** Returns the line of a state; `index` selects hue and dashes of unknown names. */
export function stroke(name: string, index: number): Stroke {
  const other = OTHERS[index % OTHERS.length]!;
  return KNOWN[name] ?? { light: other, dark: other, dash: DASHES[index % DASHES.length]! };
}

/** Lines of designs side by side: hues that colour-blind readers distinguish (Okabe, Ito 2008), and dashes. */
const SIDE: readonly Stroke[] = [
  { light: "#111111", dark: "#e6e8eb", dash: [] },
  { light: "#0072b2", dark: "#56b4e9", dash: [10, 4] },
  { light: "#d55e00", dark: "#e69f00", dash: [4, 3] },
  { light: "#009e73", dark: "#2fc79a", dash: [12, 3, 2, 3] },
  { light: "#b0508c", dark: "#e39cc5", dash: [2, 3] },
  { light: "#7a5bc0", dark: "#b39bf0", dash: [8, 2, 2, 2, 2, 2] },
];

/** Returns the line of the design at an index. */
export const sideStroke = (index: number): Stroke => SIDE[index % SIDE.length]!;
