// The rooms whose pictures are shown, by the names of their presets, kept for the next visit.

import { signal } from "@preact/signals";

import { recall, remember } from "./keep.ts";

const KEY = "papilio.rooms";
/** The rooms of a first visit. */
const FIRST = ["indoor", "living-room", "office", "overcast", "sunny", "daylight"];

const known = recall<unknown>(KEY);
export const rooms = signal<readonly string[]>(
  Array.isArray(known) && known.every((one) => typeof one === "string") ? known : FIRST,
);

export function showRooms(names: readonly string[]): void {
  rooms.value = names;
  remember(KEY, names);
}
