// What the picture of the display shows besides its pixels: mirror images of lamps, the veil in the eye, and sub-pixels.

import { times, type Triple } from "../model/colour.ts";
import { glareOf, veil, type Lamp } from "../model/glare.ts";
import type { Camera } from "../model/perspective.ts";
import { mixed, type Seen } from "../model/seen.ts";
import type { Mirror, SubPixels, Veil } from "../plots/seen.ts";

/** Lamps whose mirror images the display shows, whatever its halftone. */
export function lamps({ head }: Seen, factors: readonly number[]): Lamp[] {
  const factor = (name: string) => factors[head.lights.findIndex(({ light }) => light === name)] ?? 1;
  return head.lamps.map(({ light, towards: [x, y, z], radius_deg, is_collimated: isCollimated, XYZ }): Lamp => {
    const by = factor(light);
    const image = mixed(
      XYZ as unknown as readonly Triple[],
      head.coverage.map((share) => share * by),
    );
    const ofStates = new Map(head.states.map((state, k) => [state, by * XYZ[k]![1]!]));
    const number = Number(/\d+$/.exec(light)?.[0] ?? 0);
    return { number, towards: [-x!, -y!, z!], radius_deg, isCollimated, image, ofStates };
  });
}

/** The mirror images as they are drawn. */
export const mirrors = (all: readonly Lamp[], matrix: readonly Triple[]): Mirror[] =>
  all.map((lamp) => ({
    towards: lamp.towards,
    cosine: Math.cos((lamp.radius_deg * Math.PI) / 180),
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
