// The JSON Schema of a scenario, for generating forms: the type, unit, range, default and help of the key at a path.
// If keys depend on `model` or `kind`, the values of the scenario select the alternative.

import { plain } from "./format.ts";
import { child, isTable, keysOf, type Json, type Table } from "./json.ts";

export interface Node {
  readonly $ref?: string;
  readonly type?: string;
  readonly const?: Json;
  readonly enum?: Json[];
  /** The label of the key, and its unit. */
  readonly title?: string;
  readonly "x-unit"?: string;
  readonly description?: string;
  readonly default?: Json;
  readonly minimum?: number;
  readonly maximum?: number;
  readonly exclusiveMinimum?: number;
  readonly exclusiveMaximum?: number;
  readonly items?: Node;
  readonly properties?: Record<string, Node>;
  readonly additionalProperties?: Node | boolean;
  readonly required?: string[];
  readonly oneOf?: Node[];
  readonly anyOf?: Node[];
  readonly $defs?: Record<string, Node>;
}

/** A node whose reference is resolved; `def` is the name of its type, which selects an editor. */
export interface Found {
  readonly node: Node;
  readonly def: string;
}

export class Schema {
  constructor(private readonly root: Node) {}

  /** Resolves the reference of a node; entries next to the reference have priority. */
  follow(node: Node): Found {
    if (!node.$ref) return { node, def: "" };
    const def = node.$ref.replace("#/$defs/", "");
    const { $ref: _, ...beside } = node;
    return { node: { ...this.root.$defs?.[def], ...beside }, def };
  }

  /** Returns all alternatives, including nested ones. */
  private alternatives(node: Node): Node[] {
    return (node.oneOf ?? [])
      .map((one) => this.follow(one).node)
      .flatMap((one) => (one.oneOf ? this.alternatives(one) : [one]));
  }

  /** Returns the alternative that the constants of a table select; the node itself if there is none. */
  chosen(node: Node, value: Json | undefined): Node {
    const table = isTable(value) ? value : {};
    const fits = (one: Node) =>
      Object.entries(one.properties ?? {}).every(
        ([key, { const: fixed }]) => fixed === undefined || fixed === table[key],
      );
    return this.alternatives(node).find(fits) ?? node;
  }

  /** Returns the key that selects an alternative, and its values: `kind`, or `model` if a kind has several models. */
  discriminator(node: Node, value: Json): { key: string; values: string[]; help: Map<string, string> } | null {
    const has = (key: string) => (one: Node) => one.properties?.[key]?.const !== undefined;
    const all = this.alternatives(node);
    const kind = isTable(value) ? value["kind"] : undefined;
    const ofKind = all.filter((one) => has("kind")(one) && one.properties!["kind"]!.const === kind);
    const [ones, key] = ofKind.some(has("model"))
      ? [ofKind, "model"]
      : all.some(has("kind"))
        ? [all, "kind"]
        : [all, "model"];
    const fixed = ones.filter(has(key));
    if (fixed.length === 0) return null;
    const help = new Map(fixed.map((one) => [String(one.properties![key]!.const), one.description ?? ""]));
    return { key, values: [...help.keys()], help };
  }

  /** Returns the node at a path; `values` select the alternatives. */
  find(path: string, values: Json): Found | null {
    let found: Found = { node: this.root, def: "" };
    let here: Json | undefined = values;
    for (const key of keysOf(path)) {
      const next = this.step(this.chosen(found.node, here), key);
      if (!next) return null;
      found = this.follow(next);
      here = child(here, key);
    }
    return found;
  }

  private step(node: Node, key: string): Node | null {
    if (node.items && /^\d+$/.test(key)) return node.items;
    const named = node.properties?.[key];
    if (named) return named;
    return typeof node.additionalProperties === "object" ? node.additionalProperties : null;
  }

  /** Returns the keys of a table in the order of a form: required keys, keys that are set, and the others. */
  keys(node: Node, value: Table): { shown: string[]; more: string[] } {
    const chosen = this.chosen(node, value);
    const all = Object.keys(chosen.properties ?? {}).filter((key) => chosen.properties![key]!.const === undefined);
    const needed = new Set(chosen.required ?? []);
    const there = (key: string) => needed.has(key) || value[key] !== undefined;
    // Keys with a default come after those without.
    const rank = (key: string) =>
      needed.has(key) ? 0 : this.follow(chosen.properties![key]!).node.default === undefined ? 1 : 2;
    return {
      shown: all.filter(there).sort((a, b) => rank(a) - rank(b)),
      more: all.filter((key) => !there(key)),
    };
  }
}

const UNITS: readonly (readonly [string, string])[] = [
  ["_cd_m2", "cd/m²"],
  ["_nm", "nm"],
  ["_mm", "mm"],
  ["_deg", "°"],
  ["_lx", "lx"],
  ["_um", "µm"],
  ["_m", "m"],
  ["_pt", "pt"],
  ["_K", "K"],
];

const NAMES: Record<string, string> = {
  theta_deg: "Inclination θ",
  phi_deg: "Azimuth φ",
  share: "Fraction of the light",
  diffuse: "Diffuse fraction",
  n: "n",
  k: "k",
  gap_nm: "Gap",
  area: "Area",
  index: "Index",
  field_deg: "Field of view",
  radius_deg: "Angular radius",
  led_nm: "LED peak",
  planck_K: "Black body",
  daylight_K: "Daylight",
  range_nm: "Range",
  step_nm: "Step",
};

export const unit = (key: string): string => UNITS.find(([end]) => key.endsWith(end))?.[1] ?? "";

/** Returns the unit of a key: that of its ending, or that of the schema. */
export const unitOf = (key: string, node: Node): string => unit(key) || (node["x-unit"] ?? "");

/** Returns the label of a key: "Total transmittance" for `total_transmittance`. */
export function label(key: string): string {
  const end = UNITS.find(([suffix]) => key.endsWith(suffix))?.[0] ?? "";
  const words = key.slice(0, key.length - end.length).replaceAll("_", " ");
  return NAMES[key] ?? words.charAt(0).toUpperCase() + words.slice(1);
}

/** Returns a label as it stands within a sentence: names and abbreviations keep their capitals. */
export const uncapitalised = (text: string): string => text.replace(/^[A-Z](?=[a-z])/, (first) => first.toLowerCase());

export interface Limits {
  readonly min: number;
  readonly max: number;
  /** Whether the limits themselves are excluded. */
  readonly open?: readonly [boolean, boolean];
}

export const limits = (node: Node): Limits => ({
  min: node.minimum ?? node.exclusiveMinimum ?? -Infinity,
  max: node.maximum ?? node.exclusiveMaximum ?? Infinity,
  ...(node.exclusiveMinimum === undefined && node.exclusiveMaximum === undefined
    ? {}
    : { open: [node.exclusiveMinimum !== undefined, node.exclusiveMaximum !== undefined] as const }),
});

/** Returns the help of a field as plain text, without back quotes; the range is added if the text does not contain it. */
export function help(node: Node): string {
  const words = (node.description ?? "").replaceAll("`", "");
  const { min, max } = limits(node);
  const hasRange = /\d to |between|above|at most|at least|or more/.test(words) || !Number.isFinite(max - min);
  return hasRange ? words : `${words} From ${plain(min)} to ${plain(max)}.`.trim();
}
