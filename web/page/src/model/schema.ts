// The scenario's JSON Schema, read for forms: what stands at a path, its unit, range, default and help.
// Where keys depend on `model` or `kind`, the values say which alternative holds.

import { plain } from "./format.ts";
import { isTable, type Json, type Table } from "./json.ts";

export interface Node {
  readonly $ref?: string;
  readonly type?: string;
  readonly const?: Json;
  readonly enum?: Json[];
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

/** A node with its reference followed; `def` is the name it went by, which chooses an editor. */
export interface Found {
  readonly node: Node;
  readonly def: string;
}

export class Schema {
  constructor(private readonly root: Node) {}

  /** A node without its reference; what is said beside the reference goes first. */
  follow(node: Node): Found {
    if (!node.$ref) return { node, def: "" };
    const def = node.$ref.replace("#/$defs/", "");
    const { $ref: _, ...beside } = node;
    return { node: { ...this.root.$defs?.[def], ...beside }, def };
  }

  /** All alternatives, those of alternatives included. */
  private alternatives(node: Node): Node[] {
    return (node.oneOf ?? [])
      .map((one) => this.follow(one).node)
      .flatMap((one) => (one.oneOf ? this.alternatives(one) : [one]));
  }

  /** The alternative that a table's constants choose; the node itself where there is none. */
  chosen(node: Node, value: Json | undefined): Node {
    const table = isTable(value) ? value : {};
    const fits = (one: Node) =>
      Object.entries(one.properties ?? {}).every(
        ([key, { const: fixed }]) => fixed === undefined || fixed === table[key],
      );
    return this.alternatives(node).find(fits) ?? node;
  }

  /** The key and the values that choose between alternatives: `kind`, or `model` where a kind has several. */
  discriminator(node: Node, value: Json): { key: string; values: string[]; help: Map<string, string> } | null {
    const has = (key: string) => (one: Node) => one.properties?.[key]?.const !== undefined;
    const all = this.alternatives(node);
    const kind = isTable(value) ? value["kind"] : undefined;
    const alike = all.filter((one) => has("kind")(one) && one.properties!["kind"]!.const === kind);
    const [ones, key] = alike.some(has("model"))
      ? [alike, "model"]
      : all.some(has("kind"))
        ? [all, "kind"]
        : [all, "model"];
    const fixed = ones.filter(has(key));
    if (fixed.length === 0) return null;
    const help = new Map(fixed.map((one) => [String(one.properties![key]!.const), one.description ?? ""]));
    return { key, values: [...help.keys()], help };
  }

  /** What stands at a path, given the values on the way. */
  find(path: string, values: Json): Found | null {
    let found: Found = { node: this.root, def: "" };
    let here: Json | undefined = values;
    for (const key of path === "" ? [] : path.split(".")) {
      const next = this.step(this.chosen(found.node, here), key);
      if (!next) return null;
      found = this.follow(next);
      here = Array.isArray(here) ? here[Number(key)] : isTable(here) ? here[key] : undefined;
    }
    return found;
  }

  private step(node: Node, key: string): Node | null {
    if (node.items && /^\d+$/.test(key)) return node.items;
    const named = node.properties?.[key];
    if (named) return named;
    return typeof node.additionalProperties === "object" ? node.additionalProperties : null;
  }

  /** The keys of a table in the order of a form: required ones, those that are set, the others. */
  keys(node: Node, value: Table): { shown: string[]; more: string[] } {
    const chosen = this.chosen(node, value);
    const all = Object.keys(chosen.properties ?? {}).filter((key) => chosen.properties![key]!.const === undefined);
    const needed = new Set(chosen.required ?? []);
    const there = (key: string) => needed.has(key) || value[key] !== undefined;
    // Keys that have a default matter less than those that were given without one.
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
  ["_m", "m"],
  ["_K", "K"],
];

const NAMES: Record<string, string> = {
  theta_deg: "Inclination θ",
  phi_deg: "Azimuth φ",
  share: "Share of light",
  diffuse: "Diffuse share",
  n: "n",
  k: "k",
  gap_nm: "Gap",
  area: "Area",
  index: "Index",
  field_deg: "Field",
  radius_deg: "Angular radius",
  led_nm: "LED peak",
  planck_K: "Black body",
  daylight_K: "Daylight",
  range_nm: "Range",
  step_nm: "Step",
};

export const unit = (key: string): string => UNITS.find(([end]) => key.endsWith(end))?.[1] ?? "";

/** A key as a label: `total_transmittance` reads "Total transmittance". */
export function label(key: string): string {
  const end = UNITS.find(([suffix]) => key.endsWith(suffix))?.[0] ?? "";
  const words = key.slice(0, key.length - end.length).replaceAll("_", " ");
  return NAMES[key] ?? words.charAt(0).toUpperCase() + words.slice(1);
}

export interface Limits {
  readonly min: number;
  readonly max: number;
}

export const limits = (node: Node): Limits => ({
  min: node.minimum ?? node.exclusiveMinimum ?? -Infinity,
  max: node.maximum ?? node.exclusiveMaximum ?? Infinity,
});

/** The help of a field as plain sentences, no back quotes; a range that they do not tell is added. */
export function help(node: Node): string {
  const words = (node.description ?? "").replaceAll("`", "");
  const { min, max } = limits(node);
  const told = /\d to |between|above|at most|at least|or more/.test(words) || !Number.isFinite(max - min);
  return told ? words : `${words} From ${plain(min)} to ${plain(max)}.`.trim();
}
