// Surfaces by their geometry (`[microgeometry]`): their kinds, the verdict about a measurement, and their places in a display.

import type { Edit } from "../api/types.ts";
import { count, digits } from "./format.ts";
import { at, isTable, listAt, textAt, type Json, type Table } from "./json.ts";

/** A kind of surface, with the valid values of a new one. */
interface SurfaceKind {
  readonly name: string;
  readonly starter: Table;
  /** The kind of uploaded files that it needs. */
  readonly file?: "heights" | "mesh";
}

/** In the order of the menu, by the values of `surface`. */
export const SURFACES: Record<string, SurfaceKind> = {
  caps: {
    name: "bumps (spherical caps)",
    starter: { pitch_um: 4.5, radius_um: 2.25, aperture_radius_um: 2.25, lattice: "square" },
  },
  gaussian: { name: "random, Gaussian correlation", starter: { rms_nm: 500, correlation_um: 10 } },
  exponential: {
    name: "random, exponential correlation",
    starter: { rms_nm: 300, correlation_um: 5, cutoff_um: 1, road: "waves" },
  },
  psd: { name: "random, by its spectral density", starter: { abc: [0.02, 15, 3], cutoff_um: 1.5 } },
  "height-map": { name: "heights of a file", starter: {}, file: "heights" },
  mesh: { name: "triangles of a file", starter: {}, file: "mesh" },
  volume: {
    name: "spheres or fibres in a slab",
    starter: { radius_um: 4, index: 1.43, volume_fraction: 0.1, thickness_um: 100, matrix_index: 1.49 },
  },
  flat: { name: "flat", starter: {} },
};

/** Keys that have the same meaning for all kinds. */
const COMMON = ["index_above", "index_below", "incidence_deg", "wavelength_nm", "rays", "seed"];

/** Returns the keys of a kind in the order of the form: those of a new surface, its others, and those that all kinds have. */
export function ordered(kind: string, keys: readonly string[]): string[] {
  const own = Object.keys(SURFACES[kind]?.starter ?? {});
  const rank = (key: string) => (own.includes(key) ? own.indexOf(key) : own.length + 1 + COMMON.indexOf(key));
  return [...keys].sort((a, b) => rank(a) - rank(b));
}

const NOT_OF_VOLUMES = ["index_above", "index_below", "wavelength_nm"];

/** Returns a surface of another kind. Keys with the same meaning stay as they are, if they are not defaults. */
export function ofKind(kind: string, now: Table, written: (key: string) => boolean, file = ""): Table {
  const starter: Table = SURFACES[kind]?.starter ?? {};
  const kept = Object.entries(now).filter(
    ([key]) => written(key) && (COMMON.includes(key) || (key in starter && !Array.isArray(starter[key]))),
  );
  const fits = ([key]: [string, Json]) => kind !== "volume" || !NOT_OF_VOLUMES.includes(key);
  const own = { surface: kind, ...starter, ...Object.fromEntries(kept.filter(fits)) };
  return file ? { ...own, file } : own;
}

/** The content of audit.json, as far as it is shown. */
export interface SurfaceAudit {
  readonly rays?: number;
  readonly dropped_rays?: number;
  readonly energy_z?: readonly number[];
  readonly reciprocity_z?: number;
  readonly moved_by_symmetry?: number;
  readonly moved_by_balance?: number;
  readonly relative_error?: number;
  readonly haze_by_rays: number | null;
  readonly haze_by_rays_error: number | null;
  readonly waves: readonly WaveRow[];
  readonly heights: Heights | null;
}

/** Light of an inclination from a side; the numbers of transmitted light are null beyond the critical angle. */
export interface WaveRow {
  readonly from: "above" | "below";
  readonly theta_deg: number;
  readonly wavelength_nm: number;
  readonly g: number;
  readonly straight: number;
  readonly mirror: number;
  readonly haze: number;
  readonly haze_closed_form: number | null;
  readonly straight_error: number;
  readonly mirror_error: number;
  readonly haze_error: number;
}

interface Heights {
  readonly rms_um: number;
  readonly slope_rms_x: number;
  readonly slope_rms_y: number;
  readonly correlation_um: number | null;
  readonly skewness: number;
  readonly kurtosis: number;
}

/** Standard errors up to which rays agree with the laws; about 1 is expected, and above 3 is refused by the program. */
const AGREES = 2;

const rms = (values: readonly number[]): number =>
  Math.sqrt(values.reduce((sum, value) => sum + value * value, 0) / Math.max(1, values.length));

/** Returns whether the rays agree with reciprocity and the conservation of energy, in a line; null without rays. */
export function verdict(audit: SurfaceAudit): { agrees: boolean; words: string } | null {
  if (audit.rays === undefined) return null;
  const [reciprocity, energy] = [audit.reciprocity_z ?? 0, rms(audit.energy_z ?? [])];
  const agrees = reciprocity <= AGREES && energy <= AGREES;
  const moved = 100 * ((audit.moved_by_symmetry ?? 0) + (audit.moved_by_balance ?? 0));
  const lost = audit.dropped_rays ? `${count(audit.dropped_rays)} lost` : "none lost";
  const laws =
    `${agrees ? "Rays obey" : "Rays miss"} reciprocity by ${digits(reciprocity, 2)} and conservation of energy by ${digits(energy, 2)} ` +
    "standard errors (1 is expected)";
  return {
    agrees,
    words:
      `${laws}; ${digits(moved, 2)} % of the light moved to obey both. ${count(audit.rays)} rays, ${lost}; mean error of the kernel ` +
      `${digits(100 * (audit.relative_error ?? 0), 2)} %.`,
  };
}

/** A layer of a display that is a surface. */
export interface Face {
  readonly path: string;
  /** Name of the file of the surface, or of its kernel. */
  readonly file: string;
  /** Whether it is a kernel that was measured before; its surface is not known then. */
  readonly isKernel: boolean;
}

/** Returns the name of a layer by its path. Keys count from 0, names from 1. */
const numbered = (path: string): string => {
  const index = /\.(\d+)$/.exec(path)?.[1];
  return index === undefined ? "the diffuser" : `layer ${Number(index) + 1}`;
};

export const faceName = ({ path, file }: Face): string => `${file.split("/").at(-1)} (${numbered(path)})`;

/** Returns the layers of a display that are surfaces, from top to bottom. */
export function facesOf(fields: Json): Face[] {
  const all: [string, Json | undefined][] = [
    ["display.diffuser", at(fields, "display.diffuser")],
    ...listAt(fields, "display.layers").map((layer, i): [string, Json] => [`display.layers.${i}`, layer]),
  ];
  return all.flatMap(([path, layer]) => {
    if (!isTable(layer) || layer["model"] !== "microgeometry") return [];
    const surface = textAt(layer, "surface");
    return [{ path, file: surface ?? textAt(layer, "file") ?? "", isKernel: surface === undefined }];
  });
}

/** A place of a display that a surface can take. */
export interface Place {
  readonly name: string;
  /** The edits that put the surface of a file there. */
  readonly edits: (file: string) => Edit[];
}

/** Rays of each band of directions while a scenario is read: a mean error of 6 %. */
const RAYS = 20_000;

/** Layers between two media, which a surface can replace. */
const REPLACED: Record<string, string> = {
  diffuser: "the diffuser",
  rough: "the rough interface",
  fresnel: "the bare interface",
  "ideal-ar": "the ideal antireflection",
  coating: "the coating",
};

/** Returns the places that a surface can take: those of surfaces, of interfaces, or of the diffuser on the glass. */
export function placesOf(fields: Json): Place[] {
  const value = (file: string): Table => ({ model: "microgeometry", surface: file, rays: RAYS });
  const layers = listAt(fields, "display.layers");
  if (layers.length === 0) {
    const edits = (file: string): Edit[] => [
      { op: "remove", path: "display.glass.surface" },
      { op: "set", path: "display.diffuser", value: value(file) },
    ];
    const there = at(fields, "display.diffuser");
    return [{ name: there ? "On the glass, in place of the diffuser" : "On the glass", edits }];
  }
  return layers.flatMap((layer, i) => {
    const what = REPLACED[textAt(layer, "kind") ?? ""];
    if (!what) return [];
    const path = `display.layers.${i}`;
    const edits = (file: string): Edit[] => [{ op: "set", path, value: { kind: "diffuser", ...value(file) } }];
    return [
      {
        name: `In place of ${textAt(layer, "model") === "microgeometry" ? "the surface" : what}, layer ${i + 1}`,
        edits,
      },
    ];
  });
}
