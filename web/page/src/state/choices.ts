// What is chosen in tools that have no other state: their commands show it, and it stays while another tool is open.

import { signal } from "@preact/signals";

/** Azimuth of the plane of the angles, degrees. */
export const anglePhi = signal(0);
/** Medium of the angles of the pixel; "": that of the scenario. */
export const pixelMedium = signal("");
/** Whether the absorptance of the pixel's layers is shown. */
export const pixelAbsorbs = signal(false);
/** The command of the fine detail that is shown; null: not chosen. */
export const detailCommand = signal<string | null>(null);
/** The name of the measured panel with which the design is compared. */
export const comparedPanel = signal("");
/** The kind of a new display. */
export const newKind = signal("imod");
