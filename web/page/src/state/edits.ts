// Pending edits of a scenario: merging them, and applying them to its fields. The server applies them to the TOML and
// preserves comments and order.

import type { Edit } from "../api/types.ts";
import { at, child, isTable, isSamePath, keysOf, split, type Json } from "../model/json.ts";

/** An edit, and the gesture that made it (gesture.ts); "" for one that is an undo step of its own. */
export type Change = Edit & { readonly gesture?: string };

/** The edits of changes, as the server reads them. */
export const editsOf = (changes: readonly Change[]): Edit[] => changes.map(({ gesture: _, ...edit }) => edit as Edit);

/** The changes of each gesture, in order. */
export function byGesture(changes: readonly Change[]): Change[][] {
  const groups: Change[][] = [];
  for (const change of changes) {
    const last = groups.at(-1);
    if (last && last[0]!.gesture && last[0]!.gesture === change.gesture) last.push(change);
    else groups.push([change]);
  }
  return groups;
}

/**
 * Appends `more` to `edits`. If a key is set again by the same gesture, only the newer value is kept, unless entries were inserted, removed
 * or moved in between.
 */
export function merged(edits: readonly Change[], more: readonly Change[]): Change[] {
  const all = [...edits];
  for (const edit of more) {
    const barrier = all.findLastIndex((earlier) => earlier.op !== "set");
    const same =
      edit.op === "set" ? all.findIndex((e, i) => i > barrier && e.op === "set" && isSamePath(e.path, edit.path) && e.gesture === edit.gesture) : -1;
    if (same >= 0) all.splice(same, 1);
    all.push(edit);
  }
  return all;
}

/** Returns the fields after edits. */
export function edited(fields: Json, edits: readonly Edit[]): Json {
  if (edits.length === 0) return fields;
  const copy = structuredClone(fields);
  for (const edit of edits) apply(copy, edit);
  return copy;
}

function apply(root: Json, edit: Edit): void {
  if (edit.op === "set") {
    const [parent, key] = split(edit.path);
    put(reach(root, parent), key, edit.value as Json);
  } else if (edit.op === "remove") {
    const [parent, key] = split(edit.path);
    const holder = at(root, parent);
    if (Array.isArray(holder)) holder.splice(Number(key), 1);
    else if (isTable(holder)) delete holder[key];
  } else if (edit.op === "transfer") {
    const table = at(root, edit.path) ?? {};
    const [above, key] = split(edit.path);
    const holder = at(root, above);
    if (Array.isArray(holder)) holder.splice(Number(key), 1);
    else if (isTable(holder)) delete holder[key];
    apply(root, { op: "insert", path: edit.to, index: edit.index ?? null, value: table });
  } else {
    const list = at(root, edit.path);
    if (edit.op === "insert") {
      // Later edits change the copy, not the edit.
      if (Array.isArray(list)) list.splice(edit.index ?? list.length, 0, structuredClone(edit.value) as Json);
      else put(reach(root, split(edit.path)[0]), split(edit.path)[1], [edit.value as Json]);
    } else if (Array.isArray(list)) {
      list.splice(edit.to, 0, ...list.splice(edit.from, 1));
    }
  }
}

/** Returns the table or list at a path, which is created if necessary. */
function reach(root: Json, path: string): Json {
  let here = root;
  for (const key of keysOf(path)) {
    const next = child(here, key);
    if (next === undefined || next === null || typeof next !== "object") put(here, key, {});
    here = child(here, key) as Json;
  }
  return here;
}

function put(holder: Json, key: string, value: Json): void {
  const kept = structuredClone(value);
  if (Array.isArray(holder)) holder[Number(key)] = kept;
  else if (isTable(holder)) holder[key] = kept;
}
