// What the picture of the display shows besides its pixels: mirror images of lamps, the veil in the eye, and sub-pixels.

import { times, type Triple } from "../model/colour.ts";
import { discOverWhite, glareOf, POINT_DEG, radiusOf, veil, type Lamp } from "../model/glare.ts";
import { listAt, numberAt, type Json } from "../model/json.ts";
import { direction, type Camera } from "../model/perspective.ts";
import { mixed, shares, type Seen } from "../model/seen.ts";
import type { Mirror, SubPixels, Veil } from "../plots/seen.ts";

/** Luminance of a mirror image over that of its lamp, by state, for each directed lamp. */
export type Specular = ReadonlyMap<string, readonly number[]>;

/** Lamps whose mirror images the display shows: round ones, as the server computes them, and collimated ones. */
export function lamps(fields: Json, specular: Specular, seen: Seen, factors: readonly number[]): Lamp[] {
  const covered = [...shares(seen)];
  const factor = (name: string) => factors[seen.head.lights.findIndex(({ light }) => light === name)] ?? 1;
  const round = seen.head.lamps.map(({ light, towards: [x, y, z], radius_deg, XYZ }): Lamp => {
    const mean = mixed(
      XYZ as unknown as readonly Triple[],
      covered.map(([, share]) => share * factor(light)),
    );
    return { number: Number(/\d+$/.exec(light)?.[0] ?? 0), towards: [-x!, -y!, z!], radius_deg, image: mean };
  });
  return [...round, ...collimated(fields, specular, seen, covered, factor)];
}

/** Collimated lamps: each has a direction, but no luminance; their illuminance is drawn as that of a disc. */
function collimated(
  fields: Json,
  specular: Specular,
  seen: Seen,
  covered: readonly (readonly [string, number])[],
  factor: (name: string) => number,
): Lamp[] {
  return listAt(fields, "lighting.directed").flatMap((lamp, number) => {
    const name = `directed.${number}`;
    const white = seen.head.lights.find((one) => one.light === name)?.white as Triple | undefined;
    const ratio = covered.reduce((sum, [state, share]) => sum + share * (specular.get(state)?.[number] ?? 0), 0);
    if (numberAt(lamp, "radius_deg") !== undefined || !white || !(ratio > 0)) return [];
    const [theta, phi] = [numberAt(lamp, "theta_deg") ?? 0, numberAt(lamp, "phi_deg") ?? 0];
    const by = ratio * factor(name) * discOverWhite(POINT_DEG, theta);
    return [{ number, towards: direction(theta, phi), radius_deg: null, image: mixed([white], [by]) }];
  });
}

/** The mirror images as they are drawn. */
export const mirrors = (all: readonly Lamp[], matrix: readonly Triple[]): Mirror[] =>
  all.map((lamp) => ({
    towards: lamp.towards,
    cosine: Math.cos((radiusOf(lamp) * Math.PI) / 180),
    light: times(matrix, lamp.image),
  }));

/** The veils of the mirror images that lie on the display. */
export const veils = (all: readonly Lamp[], of: Camera, matrix: readonly Triple[]): Veil[] =>
  all.flatMap((lamp) => {
    const source = glareOf(lamp, of);
    return source ? [{ ...source, light: times(matrix, source.light) }] : [];
  });

/** The veil in the middle of the display, Y relative to a perfect white. */
export const veilInTheMiddle = (all: readonly Lamp[], of: Camera): number =>
  all.reduce((sum, lamp) => {
    const source = glareOf(lamp, of);
    return sum + (source ? veil(source, of.forward)[1] : 0);
  }, 0);

/** Light of the sub-pixels in each state, without what the layers make of it; null if their places or colours are not known. */
export function subPixelsOf(seen: Seen, matrix: readonly Triple[]): SubPixels | null {
  const { sub_pixels: all, colours, states } = seen.head;
  const black = colours[states.indexOf("black")];
  if (all.length === 0 || colours.length !== states.length || !black) return null;
  const windows = all.flatMap(({ window }, k) => window.map((one) => ({ k, one })));
  const area = all.map(({ window }) => window.reduce((sum, [x0, y0, x1, y1]) => sum + (x1! - x0!) * (y1! - y0!), 0));
  const only = all.map((_, k) => states.findIndex((_, s) => all.every(({ shown }, j) => shown[s] === (j === k ? 1 : 0))));
  if (only.some((state) => state < 0)) return null;
  const light = states.map((_, s) => {
    // What a page gains with one sub-pixel is concentrated in its area.
    const own = (k: number): Triple => {
      const factor = all[k]!.shown[s]! / Math.max(area[k]!, 1e-6);
      return black.map((dark, i) => dark! + factor * (colours[only[k]!]![i]! - dark!)) as unknown as Triple;
    };
    return [...windows.map(({ k }) => times(matrix, own(k))), times(matrix, black as unknown as Triple)];
  });
  return { states: seen.states, windows: windows.map(({ one }) => one as [number, number, number, number]), light };
}
