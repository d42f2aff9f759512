// The lines of the drive states in diagrams. Each has its own hue, as in crates/figures, and they can be distinguished
// without colour too: primaries are solid, secondaries dashed, black dotted.

export interface Stroke {
  readonly light: string;
  readonly dark: string;
  readonly dash: readonly number[];
}

const KNOWN: Record<string, Stroke> = {
  white: { light: "#777777", dark: "#c9ccd1", dash: [] },
  black: { light: "#111111", dark: "#8a9099", dash: [1.5, 3] },
  red: { light: "#c8321f", dark: "#ef6a57", dash: [] },
  green: { light: "#2c9a57", dark: "#4cc07c", dash: [] },
  blue: { light: "#2b5fc7", dark: "#6f9bf0", dash: [] },
  cyan: { light: "#25a3bb", dark: "#48c3da", dash: [7, 3] },
  magenta: { light: "#b5408f", dark: "#db72b9", dash: [7, 3] },
  yellow: { light: "#c79a0a", dark: "#dfb83a", dash: [7, 3] },
};
const OTHERS = ["#d9822b", "#7a5bc0", "#5f8a3a", "#8c564b", "#4c78a8"];

/** Returns the line of a state; `index` selects the hue for unknown names. */
export function stroke(name: string, index: number): Stroke {
  const other = OTHERS[index % OTHERS.length]!;
  return KNOWN[name] ?? { light: other, dark: other, dash: [9, 3, 2, 3] };
}
