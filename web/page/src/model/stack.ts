// The display as a list of layers from top to bottom, for an ordinary panel and for general layers.

import type { Edit } from "../api/types.ts";
import { at, isTable, join, listAt, tableAt, textAt, type Json, type Table } from "./json.ts";
import { plain } from "./format.ts";
import { COMPONENT, FRONT, KINDS, material, note, type Look } from "./kinds.ts";

export interface Layer {
  readonly path: string;
  readonly look: Look;
  readonly name: string;
  readonly note: string;
  /** The path of its list, and its index there; null for a layer that is not in a list. */
  readonly list: string | null;
  readonly index: number;
  readonly removable: boolean;
}

export interface Film {
  readonly path: string;
  readonly material: string;
  /** Thickness, nm; null for the gap. */
  readonly thickness: number | null;
}

/** The name of a diffuser by its model. */
const nameOf = ({ model }: Table): string =>
  model === "slab" ? "Scattering slab" : model === "microgeometry" ? "Surface" : "Diffuser";

function entry(list: string, index: number, value: Json): Layer {
  const table = isTable(value) ? value : {};
  const { name, look } = KINDS[textAt(table, "kind") ?? ""] ?? FRONT;
  const air = textAt(table, "kind") === "medium" && table["index"] === "air";
  return {
    path: join(list, index),
    look,
    name: air ? "Air gap" : textAt(table, "model") === "microgeometry" ? nameOf(table) : name,
    note: air ? "" : note(table),
    list,
    index,
    removable: true,
  };
}

const own = (path: string, look: Look, name: string, words: string, removable: boolean): Layer => ({
  path,
  look,
  name,
  note: words,
  list: null,
  index: 0,
  removable,
});

/** Returns the layers above the pixel, from top to bottom. */
export function layers(fields: Json): Layer[] {
  const guide = at(fields, "lighting.front_light");
  const guides = isTable(guide)
    ? [own("lighting.front_light", "guide", "Front light", `${plain(Number(guide["illuminance_lx"]))} lx`, true)]
    : [];
  const free = listAt(fields, "display.layers");
  if (free.length > 0) return [...guides, ...free.map((value, i) => entry("display.layers", i, value))];
  const fronts = listAt(fields, "display.front").map((value, i) => entry("display.front", i, value));
  const glass = tableAt(fields, "display.glass");
  const diffuser = at(fields, "display.diffuser");
  const top = isTable(diffuser)
    ? own(
        "display.diffuser",
        diffuser["model"] === "slab" ? "slab" : "diffuser",
        nameOf(diffuser),
        note(diffuser),
        true,
      )
    : own(
        "display.glass.surface",
        "face",
        glass["surface"] === "fresnel" ? "Bare interface" : "Ideal antireflection",
        "",
        false,
      );
  return [...fronts, ...guides, top, own("display.glass", "medium", "Glass", note(glass), false)];
}

export function films(fields: Json): Film[] {
  return listAt(fields, "display.pixel.film").map((value, i) => {
    const thickness = at(value, "thickness_nm");
    return {
      path: `display.pixel.film.${i}`,
      material: material(at(value, "material")),
      thickness: typeof thickness === "number" ? thickness : null,
    };
  });
}

/** A general layer, and the table of the ordinary panel that it replaces; null for a layer that is new. */
export interface Freed {
  readonly from: string | null;
  readonly layer: Table;
  /** Keys of a component of the front that the layer does not have. */
  readonly gone?: readonly string[];
}

/** Converts an ordinary panel to an equivalent list of general layers. */
export function freed(fields: Json): Freed[] {
  // Each table leaves the list: the next one is the first.
  const fronts = listAt(fields, "display.front").flatMap((value): Freed[] => {
    const { gap_mm, ...component } = value as Table;
    const air: Freed[] = typeof gap_mm === "number" && gap_mm > 0 ? [{ from: null, layer: { kind: "medium", index: 1, thickness_mm: gap_mm } }] : [];
    return [{ from: "display.front.0", layer: { kind: COMPONENT, ...component }, ...(gap_mm == null ? {} : { gone: ["gap_mm"] }) }, ...air];
  });
  const { surface, ...glass } = tableAt(fields, "display.glass");
  const diffuser = at(fields, "display.diffuser");
  const { model, ...rest } = isTable(diffuser) ? diffuser : {};
  const of = "display.diffuser";
  const top: Freed[] = !isTable(diffuser)
    ? [{ from: null, layer: { kind: surface ?? "ideal-ar" } }]
    : model === "slab"
      ? [{ from: null, layer: { kind: "fresnel" } }, { from: of, layer: { kind: "slab", ...rest } }]
      : [{ from: of, layer: { kind: "diffuser", model: model!, ...rest } }];
  return [
    ...fronts,
    ...top,
    { from: "display.glass", layer: { kind: "medium", index: 1.5, ...glass } },
  ];
}

/** Returns the edits that convert the panel to general layers: their tables move with their comments. */
export function freeing(fields: Json, list: readonly Freed[]): Edit[] {
  return list.flatMap(({ from, layer, gone = [] }, index): Edit[] => {
    if (from === null) return [{ op: "insert", path: "display.layers", index, value: layer }];
    const path = `display.layers.${index}`;
    // All tables of the front have the path of the first one.
    const former = from.startsWith("display.front") ? gone : Object.keys(tableAt(fields, from));
    const keys = Object.entries(layer);
    return [
      { op: "transfer", path: from, to: "display.layers", index },
      ...former.filter((key) => !(key in layer)).map((key): Edit => ({ op: "remove", path: join(path, key) })),
      ...keys.map(([key, value]): Edit => ({ op: "set", path: join(path, key), value })),
    ];
  });
}

/** A surface by its geometry. Few rays: they are followed while the scenario is read. */
const FACE: Table = { model: "microgeometry", surface: "../surfaces/etched.toml", rays: 20_000 };

/** The models of a diffuser, a pixel or an environment, each with valid values. */
export const MODELS: Record<string, Record<string, Table>> = {
  "display.diffuser": {
    "k-correlation": { model: "k-correlation", haze: 0.5, total_transmittance: 0.9 },
    lambertian: { model: "lambertian", total_transmittance: 0.5 },
    ward: { model: "ward", alpha: 0.1, total_transmittance: 0.9 },
    slab: { model: "slab", optical_thickness: 2, anisotropy: 0.8 },
    microgeometry: FACE,
  },
  "display.pixel": {
    film: {
      model: "film",
      substrate: "Al",
      fill_factor: 0.873,
      area: { red: 0.493, green: 0.381, blue: 0.126 },
      gap_nm: { red: 275.9, green: 192.3, blue: 137.8, dark: 20 },
      film: [
        { material: "Si3N4", thickness_nm: 55.9 },
        { material: "Cr:Johnson", thickness_nm: 12.15 },
        { material: "SiO2", thickness_nm: 38.6 },
        { material: "AlOx", thickness_nm: 9 },
        { material: "air", thickness_nm: "gap" },
      ],
    },
    uniform: { model: "uniform", kind: "lambertian", reflectance: { white: 0.5, black: 0.02 } },
  },
  layers: {
    "k-correlation": { model: "k-correlation", haze: 0.5, total_transmittance: 0.9 },
    lambertian: { model: "lambertian", total_transmittance: 0.5 },
    ward: { model: "ward", alpha: 0.1, total_transmittance: 0.9 },
    microgeometry: FACE,
  },
  environment: {
    ring: { model: "ring", theta_deg: 35, width_deg: 10 },
    cap: { model: "cap", from_deg: 0, to_deg: 30 },
    sky: { model: "sky", number: 1 },
  },
};
