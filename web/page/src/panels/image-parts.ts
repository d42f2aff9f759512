// What the picture of the display shows besides its pixels: mirror images of lamps, and sub-pixels.

import { times, type Triple } from "../model/colour.ts";
import { at, listAt, numberAt, type Json } from "../model/json.ts";
import { direction } from "../model/perspective.ts";
import type { Seen } from "../model/seen.ts";
import type { Lamp, SubPixels } from "../plots/seen.ts";

/** Angular radius of the image of a lamp that has none, degrees. */
const POINT_DEG = 0.5;

/** Lamps whose mirror images a flat face shows. */
export function lamps(fields: Json): Lamp[] {
  const faces = listAt(fields, "display.front").reduce<number>(
    (sum, one) => sum + (numberAt(one, "reflectance") ?? 0),
    0,
  );
  const isBare = !at(fields, "display.diffuser") && at(fields, "display.glass") && !at(fields, "display.glass.surface");
  if (!(faces > 0) && !isBare) return [];
  return listAt(fields, "lighting.directed").flatMap((lamp) => {
    if (!((numberAt(lamp, "share") ?? 0) > 0)) return [];
    const radius = Math.max(POINT_DEG, numberAt(lamp, "radius_deg") ?? 0);
    const towards = direction(numberAt(lamp, "theta_deg") ?? 0, numberAt(lamp, "phi_deg") ?? 0);
    return [{ towards, cosine: Math.cos((radius * Math.PI) / 180) }];
  });
}

/** What the sub-pixels of each state add to the colour of the whole pixel; their mean is 0. */
export function subPixelsOf(seen: Seen, matrix: readonly Triple[]): SubPixels | null {
  const { sub_pixels: all, colours, states } = seen.head;
  const black = colours[states.indexOf("black")];
  if (all.length === 0 || colours.length !== states.length || !black) return null;
  const windows = all.flatMap(({ window }, k) => window.map((one) => ({ k, one })));
  const area = all.map(({ window }) => window.reduce((sum, [x0, y0, x1, y1]) => sum + (x1! - x0!) * (y1! - y0!), 0));
  const only = all.map((_, k) => states.findIndex((_, s) => all.every(({ shown }, j) => shown[s] === (j === k ? 1 : 0))));
  if (only.some((state) => state < 0)) return null;
  const light = (xyz: readonly number[]) => times(matrix, xyz as unknown as Triple);
  const difference = (a: readonly number[], b: readonly number[], factor: number) =>
    a.map((value, i) => (value - b[i]!) * factor);
  const added = states.map((_, s) => {
    const whole = difference(colours[s]!, black, 1);
    const of = (k: number) => difference(colours[only[k]!]!, black, all[k]!.shown[s]! / Math.max(area[k]!, 1e-6));
    const between = light(whole.map((value) => -value));
    return [...windows.map(({ k }) => light(difference(of(k), whole, 1))), between];
  });
  return { states: seen.states, windows: windows.map(({ one }) => one as [number, number, number, number]), added };
}

