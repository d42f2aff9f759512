// The examples in groups: by kind of display, and by question; and the colours of their states.

import PATCHES from "./patches.json";

export type Icon = "film" | "inks" | "face" | "lamp" | "cell" | "sheet" | "eye" | "search" | "meter" | "grid";

export interface Group {
  readonly name: string;
  readonly icon: Icon;
  readonly examples: readonly string[];
}

export const GROUPS: readonly Group[] = [
  { name: "Interferometric displays", icon: "film", examples: ["indoor", "sunny", "overcast", "reference-pixel", "nanochannels", "table-pixel"] },
  { name: "Electronic paper", icon: "inks", examples: ["epaper", "six-ink", "printed-filter", "reader", "laminated-text", "epaper-measured", "epaper-reading", "paper"] },
  { name: "Liquid crystals and polarised light", icon: "cell", examples: ["mip-lcd", "mip-lcd-haze", "mip-lcd-colour", "mip-lcd-cover", "lcd-voltage", "stn", "lcd-sunglasses", "cholesteric", "circular-polariser", "polarised-sky", "sunglasses", "rayleigh-film"] },
  { name: "How does it look?", icon: "eye", examples: ["page", "halftone", "display-white", "readability", "readability-age", "angle-scan", "double-image"] },
  { name: "Which room, which lamp?", icon: "lamp", examples: ["lamps", "front-light", "front-light-sweep", "downlight", "luminaire", "ring", "sky", "map", "map-regions", "spectral-map", "own-lamp", "metrics"] },
  { name: "Which face, which glass?", icon: "face", examples: ["antiglare", "etched-face", "rough-glass", "cover-glass", "hazy-face", "two-diffusers", "slab", "ward", "reflecting-diffuser"] },
  { name: "How sharp, how many pixels?", icon: "grid", examples: ["matrix", "laminate-thickness"] },
  { name: "Which design is best?", icon: "search", examples: ["optimize", "optimize-front", "optimize-sun", "sweep", "tolerance", "fit"] },
  { name: "Measured samples and data of one's own", icon: "meter", examples: ["measured-h65", "measured-h78", "measured-bare", "measured-diffused", "measured-truth", "etched-grades", "clear-glass", "polished-metals", "ptfe", "spectralon", "microspheres", "own-files", "own-material", "azimuth-pixel", "virtual-instrument"] },
  { name: "Which solver, how exactly?", icon: "sheet", examples: ["auto", "sampling", "single-pass", "target"] },
];

/** Returns the groups with the examples that exist; what is in no group is in the last one. */
export function galleryOf(names: readonly string[]): readonly Group[] {
  const grouped = new Set(GROUPS.flatMap(({ examples }) => examples));
  const others = names.filter((name) => !grouped.has(name));
  return GROUPS.map((group, i) => ({
    ...group,
    examples: [...group.examples.filter((name) => names.includes(name)), ...(i === GROUPS.length - 1 ? others : [])],
  })).filter(({ examples }) => examples.length > 0);
}

/** Returns the colours of an example's states in its first view, as the page shows them; none for an unknown one. */
export const patchesOf = (example: string): readonly string[] => (PATCHES as Readonly<Record<string, readonly string[]>>)[example] ?? [];
