// Kinds of layers: what the page knows of each. A kind is one entry of KINDS.

import { at, isTable, listAt, textAt, type Json, type Table } from "./json.ts";
import { plain } from "./format.ts";
import { label } from "./schema.ts";

/** How a layer is drawn. */
export type Look = "component" | "diffuser" | "slab" | "medium" | "face" | "coating" | "rough" | "guide";

/** A material in a few letters. */
export function material(value: Json | undefined): string {
  if (typeof value === "number") return `n ${plain(value)}`;
  if (isTable(value))
    return `n ${plain(Number(value["n"] ?? 1))}${value["k"] ? ` k ${plain(Number(value["k"]))}` : ""}`;
  return typeof value === "string" ? (value.split("/").at(-1) ?? value) : "–";
}

const share = (value: Json | undefined): string => (typeof value === "number" ? plain(value, 4) : material(value));

/** A key's name and value, if it is given. */
const say = (table: Table, key: string, name = label(key).toLowerCase()): string[] =>
  table[key] === undefined ? [] : [`${name} ${share(table[key])}`];

const component = (table: Table): string =>
  [...say(table, "reflectance", "R"), ...say(table, "absorptance", "A")].join(", ");

const particles = (table: Table): string =>
  [...say(table, "optical_thickness", "τ"), ...say(table, "anisotropy", "g")].join(", ");

const medium = (table: Table): string =>
  [
    material(table["index"]),
    ...say(table, "internal_transmittance", "T"),
    ...(table["thickness_mm"] === undefined ? [] : [`${share(table["thickness_mm"])} mm`]),
  ].join(", ");

function coating(table: Table): string {
  const films = listAt(table, "film");
  const [first] = films;
  return films.length === 1
    ? `${material(at(first, "material"))}, ${plain(Number(at(first, "thickness_nm")), 5)} nm`
    : `${films.length} films`;
}

/** What is said of a model of a diffuser. */
function diffuser(table: Table): string {
  const model = textAt(table, "model");
  if (model === "slab") return particles(table);
  if (model === "measured") return material(table["file"]);
  if (!model) return medium(table);
  return [...say(table, "haze"), ...say(table, "width", "b"), ...say(table, "alpha", "α")].join(", ") || model;
}

export interface Kind {
  /** Its name in the drawing, and how it is drawn. */
  readonly name: string;
  readonly look: Look;
  /** Its name in the menu, if that is not its key. */
  readonly menu?: string;
  /** What is said of it beside its name. */
  readonly note: (table: Table) => string;
  /** A new one, with values that compute. */
  readonly starter: Table;
  /** True of what a front of screen is made of. */
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
    menu: "coating of films",
    note: coating,
    starter: { kind: "coating", film: [{ material: "MgF2", thickness_nm: 99.6 }] },
  },
  rough: {
    name: "Rough interface",
    look: "rough",
    menu: "rough interface",
    note: (table) => say(table, "alpha", "α").join(""),
    starter: { kind: "rough", alpha: 0.1 },
  },
  slab: {
    name: "Particles",
    look: "slab",
    menu: "particles",
    note: particles,
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
export const FRONT: Pick<Kind, "name" | "look"> = { name: "Front", look: "component" };

/** The kind that an entry of the front of screen is as a free layer. */
export const COMPONENT = Object.keys(KINDS).find((kind) => KINDS[kind]!.isComponent) ?? "";

/** What is said of a layer beside its name: of one with a kind, of an entry of the front, of a diffuser or glass. */
export function note(table: Table): string {
  const kind = KINDS[textAt(table, "kind") ?? ""];
  if (kind) return kind.note(table);
  return table["reflectance"] !== undefined || table["absorptance"] !== undefined ? component(table) : diffuser(table);
}
