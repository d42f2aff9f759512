// The parts of a liquid-crystal pixel: `display.pixel.stack`, from the glass down.

import { at, isTable, listAt, textAt, type Json, type Table } from "./json.ts";
import { plain } from "./format.ts";
import { material } from "./kinds.ts";

export const STACK = "display.pixel.stack";

export const isCrystal = (fields: Json): boolean => textAt(fields, "display.pixel.model") === "liquid-crystal";

export interface CrystalPart {
  readonly path: string;
  readonly index: number;
  readonly kind: string;
  readonly name: string;
  readonly note: string;
  /** Azimuth of its axis, degrees; null for a part without one. */
  readonly axis: number | null;
}

interface CrystalKind {
  readonly name: string;
  readonly note: (table: Table) => string;
  /** The key of its axis. */
  readonly axis?: string;
  /** The valid values of a new part. */
  readonly starter: Table;
}

const number = (table: Table, key: string, unit: string): string[] =>
  typeof table[key] === "number" ? [`${plain(table[key], 4)}${unit}`] : [];

/** In the order of the menu. */
export const CRYSTAL_KINDS: Readonly<Record<string, CrystalKind>> = {
  polariser: {
    name: "Polariser",
    note: (table) => number(table, "axis_deg", "°").join(),
    axis: "axis_deg",
    starter: { kind: "polariser", axis_deg: 0 },
  },
  retarder: {
    name: "Retarder",
    note: (table) => [...number(table, "retardance_nm", " nm"), ...number(table, "axis_deg", "°")].join(", "),
    axis: "axis_deg",
    starter: { kind: "retarder", axis_deg: 45, retardance_nm: 137.5 },
  },
  cell: {
    name: "Cell",
    note: (table) => [...number(table, "gap_um", " µm"), ...(table["twist_deg"] ? number(table, "twist_deg", "° twist") : [])].join(", "),
    axis: "rub_deg",
    starter: { kind: "cell", gap_um: 2.2, n_o: 1.48, n_e: 1.565, rub_deg: 45 },
  },
  cholesteric: {
    name: "Cholesteric layer",
    note: (table) => [...number(table, "pitch_nm", " nm"), ...(textAt(table, "handedness") ? [textAt(table, "handedness")!] : [])].join(", "),
    starter: { kind: "cholesteric", pitch_nm: 337, handedness: "left", n_o: 1.51, n_e: 1.69, thickness_um: 4 },
  },
  film: {
    name: "Film",
    note: (table) => [material(table["material"]), ...number(table, "thickness_nm", " nm")].join(", "),
    starter: { kind: "film", material: "SiO2", thickness_nm: 90 },
  },
  slab: {
    name: "Pane",
    note: (table) => [material(table["material"] ?? 1.5), ...number(table, "thickness_um", " µm")].join(", "),
    starter: { kind: "slab", material: 1.52, thickness_um: 500 },
  },
};

/** Returns the parts from the top to the bottom. */
export function crystalParts(fields: Json): CrystalPart[] {
  if (!isCrystal(fields)) return [];
  return listAt(fields, STACK).map((value, index) => {
    const table = isTable(value) ? value : {};
    const kind = textAt(table, "kind") ?? "";
    const of = CRYSTAL_KINDS[kind];
    const axis = of?.axis === undefined ? undefined : table[of.axis];
    return {
      path: `${STACK}.${index}`,
      index,
      kind,
      name: of?.name ?? kind,
      note: of?.note(table) ?? "",
      axis: typeof axis === "number" ? axis : kind === "cell" ? 0 : null,
    };
  });
}

/** What determines the director of a cell in a state. */
export type StateKind = "volts" | "angles" | "file";

export function stateKind(value: Json | undefined): StateKind {
  if (typeof value === "string") return "file";
  return typeof at(value, "volts") === "number" ? "volts" : "angles";
}
