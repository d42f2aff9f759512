// The kinds of layers, each an entry of KINDS.

import { at, isTable, listAt, textAt, type Json, type Table } from "./json.ts";
import { plain } from "./format.ts";
import { label } from "./schema.ts";

/** The appearance of a layer in the drawing. */
export type Look = "component" | "diffuser" | "slab" | "medium" | "face" | "coating" | "rough" | "guide";

/** Returns a short description of a material. */
export function material(value: Json | undefined): string {
  if (typeof value === "number") return `n ${plain(value)}`;
  if (isTable(value) && typeof value["material"] === "string") return material(value["material"]);
  if (isTable(value) && typeof value["model"] === "string") return `${value["model"]} model`;
  if (isTable(value))
    return `n ${plain(Number(value["n"] ?? 1))}${value["k"] ? ` k ${plain(Number(value["k"]))}` : ""}`;
  return typeof value === "string" ? (value.split("/").at(-1) ?? value) : "–";
}

const valueText = (value: Json | undefined): string => (typeof value === "number" ? plain(value, 4) : material(value));

/** Returns the name and the value of a key, if it is set. */
const entryText = (table: Table, key: string, name = label(key).toLowerCase()): string[] =>
  table[key] === undefined ? [] : [`${name} ${valueText(table[key])}`];

const component = (table: Table): string =>
  [...entryText(table, "reflectance", "R"), ...entryText(table, "absorptance", "A")].join(", ");

const slab = (table: Table): string =>
  [...entryText(table, "optical_thickness", "τ"), ...entryText(table, "anisotropy", "g")].join(", ");

const medium = (table: Table): string =>
  [
    material(table["index"]),
    ...entryText(table, "internal_transmittance", "T"),
    ...(table["thickness_mm"] === undefined ? [] : [`${valueText(table["thickness_mm"])} mm`]),
  ].join(", ");

function coating(table: Table): string {
  const films = listAt(table, "film");
  const [first] = films;
  return films.length === 1
    ? `${material(at(first, "material"))}, ${plain(Number(at(first, "thickness_nm")), 5)} nm`
    : `${films.length} films`;
}

/** Returns a short description of a surface by its geometry: its file, and the keys that replace those of the file. */
const surface = (table: Table): string =>
  [
    material(table["surface"] ?? table["file"]),
    ...["pitch_um", "radius_um", "aperture_radius_um", "rms_nm", "correlation_um"].flatMap((key) => {
      const [, words, unit] = /^(.*)_(um|nm)$/.exec(key)!;
      return typeof table[key] === "number"
        ? [`${words!.replaceAll("_", " ")} ${plain(table[key], 4)} ${unit === "um" ? "µm" : unit}`]
        : [];
    }),
  ].join(", ");

/** Returns a short description of a diffuser. */
function diffuser(table: Table): string {
  const model = textAt(table, "model");
  if (model === "slab") return slab(table);
  if (model === "measured") return material(table["file"]);
  if (model === "microgeometry") return surface(table);
  if (!model) return medium(table);
  const reflection = isTable(table["reflection"]) ? table["reflection"] : {};
  const entries = [
    ...entryText(table, "haze"),
    ...entryText(table, "width", "b"),
    ...entryText(table, "alpha", "α"),
    ...entryText(reflection, "total_reflectance", "R"),
    ...entryText(reflection, "reflectance", "R"),
  ];
  return entries.join(", ") || model;
}

export interface Kind {
  /** Its name and its appearance in the drawing. */
  readonly name: string;
  readonly look: Look;
  /** Its name in the menu, if it differs from its key. */
  readonly menu?: string;
  /** The description next to its name. */
  readonly note: (table: Table) => string;
  /** The valid values of a new layer. */
  readonly starter: Table;
  /** True for a component of the front of screen. */
  readonly isComponent?: boolean;
}

/** In the order of the menu. */
export const KINDS: Record<string, Kind> = {
  component: {
    name: "Component",
    look: "component",
    menu: "front component",
    note: component,
    starter: { kind: "component", reflectance: 0.005, absorptance: 0.01 },
    isComponent: true,
  },
  diffuser: {
    name: "Diffuser",
    look: "diffuser",
    note: diffuser,
    starter: { kind: "diffuser", model: "k-correlation", haze: 0.5, total_transmittance: 0.9 },
  },
  medium: {
    name: "Medium",
    look: "medium",
    menu: "clear medium",
    note: medium,
    starter: { kind: "medium", index: 1.5 },
  },
  "air gap": { name: "Air gap", look: "medium", note: () => "", starter: { kind: "medium", index: "air" } },
  coating: {
    name: "Coating",
    look: "coating",
    menu: "coating (thin films)",
    note: coating,
    starter: { kind: "coating", film: [{ material: "MgF2", thickness_nm: 99.6 }] },
  },
  rough: {
    name: "Rough interface",
    look: "rough",
    menu: "rough interface",
    note: (table) => entryText(table, "alpha", "α").join(""),
    starter: { kind: "rough", alpha: 0.1 },
  },
  slab: {
    name: "Scattering slab",
    look: "slab",
    menu: "scattering slab",
    note: slab,
    starter: { kind: "slab", optical_thickness: 2, anisotropy: 0.8, index: 1.5 },
  },
  "ideal-ar": {
    name: "Ideal antireflection",
    look: "face",
    menu: "ideal antireflection",
    note: medium,
    starter: { kind: "ideal-ar" },
  },
  fresnel: { name: "Bare interface", look: "face", menu: "bare interface", note: medium, starter: { kind: "fresnel" } },
};

/** An entry of the front of screen, which has no kind. */
export const FRONT: Pick<Kind, "name" | "look"> = { name: "Front component", look: "component" };

/** The kind of a general layer that is equivalent to an entry of the front of screen. */
export const COMPONENT = Object.keys(KINDS).find((kind) => KINDS[kind]!.isComponent) ?? "";

/** Returns the description of a layer: one with a kind, an entry of the front of screen, a diffuser, or the glass. */
export function note(table: Table): string {
  const kind = KINDS[textAt(table, "kind") ?? ""];
  if (kind) return kind.note(table);
  return table["reflectance"] !== undefined || table["absorptance"] !== undefined ? component(table) : diffuser(table);
}
