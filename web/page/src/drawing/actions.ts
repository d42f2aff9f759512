// Actions on the parts of the drawing: add, remove, move up or down. A panel that the keys of the ordinary panel
// cannot describe is converted to an equivalent list of general layers.

import type { Edit } from "../api/types.ts";
import { CRYSTAL_KINDS, isCrystal, STACK } from "../model/crystal.ts";
import { at, listAt, numberAt, split, tableAt, textAt, type Json, type Table } from "../model/json.ts";
import { without } from "../model/shares.ts";
import { KINDS } from "../model/kinds.ts";
import { freed, freeing, layers, MODELS } from "../model/stack.ts";
import { fields, selected } from "../state/design.ts";
import { edit } from "../state/live.ts";

/** Returns the list and the index of a path that ends in a number. */
function entry(path: string): { list: string; index: number } | null {
  const [list, key] = split(path);
  return /^\d+$/.test(key) ? { list, index: Number(key) } : null;
}

/** The edits of an addition, and the path of what is added. */
export interface Addition {
  readonly edits: Edit[];
  readonly path: string;
  /** What it replaces, in words. */
  readonly instead?: string;
}

/** Returns the addition of a layer below the selected one; null for an unknown kind. */
export function layerAddition(kind: string): Addition | null {
  if (kind === PIXEL_FILM) return filmAddition();
  if (kind.startsWith(PIXEL_PART)) return crystalAddition(kind.slice(PIXEL_PART.length));
  const starter = KINDS[kind]?.starter;
  if (!starter) return null;
  const all = fields.value;
  const free = listAt(all, "display.layers");
  const here = entry(selected.value);
  if (free.length > 0) {
    const index = placeFor(kind, free as Table[], here?.list === "display.layers" ? here.index + 1 : free.length);
    return { edits: [{ op: "insert", path: "display.layers", index, value: starter }], path: `display.layers.${index}` };
  }
  if (KINDS[kind]?.isComponent) {
    const { kind: _, ...value } = starter;
    const index = here?.list === "display.front" ? here.index + 1 : listAt(all, "display.front").length;
    return { edits: [{ op: "insert", path: "display.front", index, value }], path: `display.front.${index}` };
  }
  if (kind === "diffuser" && at(all, "display.diffuser") === undefined) {
    const edits: Edit[] = [{ op: "set", path: "display.diffuser", value: MODELS["display.diffuser"]!["k-correlation"] }];
    // The lobe of a diffuser includes its surfaces.
    if (textAt(all, "display.glass.surface") === undefined) return { edits, path: "display.diffuser" };
    const bare: Edit = { op: "remove", path: "display.glass.surface" };
    return { edits: [bare, ...edits], path: "display.diffuser", instead: "the bare interface" };
  }
  const guides = at(all, "lighting.front_light") === undefined ? 0 : 1;
  const under = layers(all).findIndex((layer) => layer.path === selected.value) + 1 - guides;
  const list = freed(all);
  const tables = list.map(({ layer }) => layer);
  const place = placeFor(kind, tables, under > 0 ? under : list.length);
  const edits = freeing(all, [...list.slice(0, place), { from: null, layer: starter }, ...list.slice(place)]);
  return { edits, path: `display.layers.${place}` };
}

/** Adds a layer below the selected one, together with further edits. */
export function addLayer(kind: string, more: readonly Edit[] = []): void {
  const addition = layerAddition(kind);
  if (!addition) return;
  edit([...addition.edits, ...more]);
  selected.value = addition.path;
}

const MEDIA = ["medium", "slab"];

/** Returns the index of a new layer. An interface separates two media, so it is inserted above the last medium. */
function placeFor(kind: string, list: readonly Table[], wanted: number): number {
  const last = list.findLastIndex((layer) => MEDIA.includes(String(layer["kind"])));
  return MEDIA.includes(kind) || kind === "air gap" || last < 0 ? wanted : Math.min(wanted, last);
}

/** The name of a film of the pixel among the layers. */
export const PIXEL_FILM = "pixel film";

/** Returns the addition of a film below the selected one. */
function filmAddition(): Addition {
  const here = entry(selected.value);
  const index = here?.list === "display.pixel.film" ? here.index + 1 : 0;
  const edits: Edit[] = [{ op: "insert", path: "display.pixel.film", index, value: { material: "SiO2", thickness_nm: 20 } }];
  return { edits, path: `display.pixel.film.${index}` };
}

/** The beginning of the names of a liquid-crystal pixel's parts among the layers. */
export const PIXEL_PART = "pixel: ";

/** Returns the addition of a part below the selected one. A new cell has the states of the display. */
function crystalAddition(kind: string): Addition | null {
  const starter = CRYSTAL_KINDS[kind]?.starter;
  if (!starter) return null;
  const all = listAt(fields.value, STACK);
  const here = entry(selected.value);
  const index = here?.list === STACK ? here.index + 1 : 0;
  const names = all.map((one) => Object.keys(tableAt(one, "states"))).find((found) => found.length > 0) ?? [];
  const of = (k: number): Json => (kind === "cell" ? { tilt_deg: k === 0 ? 2 : 80 } : "planar");
  const hasStates = (kind === "cell" || kind === "cholesteric") && names.length > 0;
  const value = hasStates ? { ...starter, states: Object.fromEntries(names.map((name, k) => [name, of(k)])) } : starter;
  return { edits: [{ op: "insert", path: STACK, index, value }], path: `${STACK}.${index}` };
}

/** The fraction of the light that a new source has; the others are reduced in proportion. */
const NEW_SHARE = 0.2;

export function addLight(kind: string): void {
  const all = fields.value;
  if (kind === "front light") {
    edit([{ op: "set", path: "lighting.front_light", value: { illuminance_lx: 100 } }]);
    selected.value = "lighting.front_light";
    return;
  }
  const list = kind === "directed" ? "lighting.directed" : "lighting.environment";
  const index = listAt(all, list).length;
  const value =
    kind === "directed" ? { theta_deg: 30, share: NEW_SHARE } : { ...MODELS["environment"]![kind], share: NEW_SHARE };
  edit([...shrunk(1 - NEW_SHARE), { op: "insert", path: list, index, value }]);
  selected.value = `${list}.${index}`;
}

/** Returns the edits that multiply the fractions of all sources by a factor. */
function shrunk(factor: number): Edit[] {
  const all = fields.value;
  const rounded = (value: number) => Math.round(value * factor * 1e6) / 1e6;
  const edits: Edit[] = [];
  for (const kind of ["directed", "environment"]) {
    listAt(all, `lighting.${kind}`).forEach((_, i) => {
      for (const key of ["share", "sun_share"]) {
        const path = `lighting.${kind}.${i}.${key}`;
        const value = numberAt(all, path);
        if (value !== undefined) edits.push({ op: "set", path, value: rounded(value) });
      }
    });
  }
  const sum = edits.reduce((total, e) => total + (e.op === "set" ? Number(e.value) : 0), 0);
  return [{ op: "set", path: "lighting.diffuse", value: Math.round((factor - sum) * 1e6) / 1e6 }, ...edits];
}

export function canRemove(): boolean {
  const path = selected.value;
  const layer = layers(fields.value).find((one) => one.path === path);
  if (layer) return layer.removable;
  if (path.startsWith(`${STACK}.`)) return isCrystal(fields.value) && listAt(fields.value, STACK).length > 1;
  if (path.startsWith("display.pixel.film.")) return at(fields.value, `${path}.thickness_nm`) !== "gap";
  return /^lighting\.(directed|environment)\.\d+$/.test(path);
}

export function removeSelected(): void {
  if (!canRemove()) return;
  const path = selected.value;
  const light = /^lighting\.(directed|environment)\.\d+$/.test(path);
  edit(light ? without(fields.value, path) : [{ op: "remove", path }]);
  const here = entry(path);
  selected.value = light
    ? "lighting"
    : here && here.index > 0
      ? `${here.list}.${here.index - 1}`
      : (layers(fields.value)[0]?.path ?? "display.pixel");
}

export function canMove(by: number): boolean {
  const here = entry(selected.value);
  if (!here || here.list.startsWith("lighting")) return false;
  const to = here.index + by;
  return to >= 0 && to < listAt(fields.value, here.list).length;
}

export function moveSelected(by: number): void {
  const here = entry(selected.value);
  if (!here || !canMove(by)) return;
  edit([{ op: "move", path: here.list, from: here.index, to: here.index + by }]);
  selected.value = `${here.list}.${here.index + by}`;
}
