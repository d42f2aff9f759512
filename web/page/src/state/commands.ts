// The commands of the program that do the same as the tools, with what is chosen in them.

import { at, numberAt, tableAt, textAt } from "../model/json.ts";
import { argument, commandFor, toolOf } from "../model/tools.ts";
import { anglePhi, comparedPanel, detailCommand, newKind, pixelAbsorbs, pixelMedium } from "./choices.ts";
import { fields } from "./design.ts";
import { files } from "./files.ts";
import { used } from "./fit.ts";
import { halftone, OWN_SOURCES, pictureName } from "./image.ts";
import { rooms } from "./rooms.ts";
import { PRESETS } from "./shelf.ts";
import { name as surface } from "./surface.ts";
import { aim } from "./walk.ts";

const set = (key: string, value: string): string => `--set ${argument(`${key}=${value}`)}`;

/** The picture as an argument; "" if the scenario names one. */
function picture(): string {
  if (pictureName.value !== null) return argument(pictureName.value);
  return OWN_SOURCES.some((key) => typeof at(fields.value, `image.${key}`) === "string") ? "" : "PICTURE.png";
}

/** Measured files as arguments, or a name in their place. */
const measured = (names: readonly string[]): string => names.map(argument).join(" ") || "MEASURED.csv";

const OPTIONS: Readonly<Record<string, () => readonly string[]>> = {
  new: () => [`--display ${newKind.value}`, "--light PRESET", `${newKind.value}.toml`],
  surface: () => [argument(`${surface.value || "surface"}.toml`)],
  image: () => [picture(), halftone.value === null ? "" : set("image.halftone", JSON.stringify(halftone.value))],
  rooms: () => {
    const shown = rooms.value.filter((room) => PRESETS.value.some(({ name }) => name === room));
    return [picture(), shown.length > 0 ? `--rooms ${shown.join(",")}` : ""];
  },
  angles: () => [anglePhi.value === (numberAt(fields.value, "viewer.phi_deg") ?? 0) ? "" : set("viewer.phi_deg", String(anglePhi.value))],
  pixel: () => [pixelMedium.value && `--angles ${pixelMedium.value}`, pixelAbsorbs.value && textAt(fields.value, "display.pixel.model") === "film" ? "--absorption" : ""],
  walk: () => [aim.value === null ? "" : set("solver.relative_error", String(aim.value))],
  compare: () => [measured(panelNow() ? [panelNow()] : [])],
  fit: () => [measured(used.value)],
};

/** The names of the measured panels that were dropped. */
export const panels = (): string[] => files.value.filter(({ audit }) => audit?.kind === "panel").map(({ name }) => name);

/** The name of the measured panel that is compared; "" if there is none. */
export const panelNow = (): string => (panels().includes(comparedPanel.value) ? comparedPanel.value : (panels()[0] ?? ""));

/** The effect of fine detail that is shown: sparkle, if the scenario describes a face. */
export const detailNow = (): string => detailCommand.value ?? (Object.keys(tableAt(fields.value, "sparkle")).length > 0 ? "sparkle" : "mtf");

/** Returns the command of a tool for a scenario file of this name; null if it has none. */
export function commandNow(id: string, file: string): string | null {
  const { command } = toolOf(id);
  if (command === null) return null;
  const base = id === "detail" ? command.replace("mtf", detailNow()) : command;
  return [commandFor(base, file), ...(OPTIONS[id]?.() ?? [])].filter(Boolean).join(" ");
}
