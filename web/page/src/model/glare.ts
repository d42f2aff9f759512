// Mirror images of lamps in the flat face of the display, and the veil that they spread in the eye.
//
// Mirror image: a lamp far away is seen by reflection where the mirrored line of sight meets it. It is as wide as the lamp itself. A disc of
// angular radius r at inclination t that lights a plane with E has the luminance E / (pi sin^2 r cos t); a perfect white in that light has
// E / pi. The image has the fraction of it that `papilio run` states as `specular`.
//
// Veil: the general glare function of CIE 146:2002, for 0.1 to 100 degrees. It gives the luminance that scatters over the picture, relative
// to the illuminance at the eye. All light of an image comes from the middle of its visible part, and within its radius the veil is uniform:
// twice the radius from the middle, a disc's own veil is 15 % higher.

import type { Triple } from "./colour.ts";
import type { Camera } from "./perspective.ts";

/** Age of the reader of the veil, years. */
export const AGE = 25;
/** Pigmentation of the eye: 0 black, 0.5 brown, 1 light, 1.2 very light blue. */
export const PIGMENT = 0.5;
/** Angles of the glare function, degrees. */
export const LEAST_DEG = 0.1;
export const MOST_DEG = 100;

/** Places of a disc, each with the same solid angle, for its visible part. */
const PARTS = 19;

const RADIANS = Math.PI / 180;

/** A lamp whose mirror image may be visible. */
export interface Lamp {
  /** Its number, from 0. */
  readonly number: number;
  /** The direction towards it. */
  readonly towards: Triple;
  /** Its angular radius, degrees. */
  readonly radius_deg: number;
  /** Whether its light is collimated: it has no luminance, and is drawn as a small disc. */
  readonly isCollimated: boolean;
  /** Luminance of its mirror image, the mean over the picture, as X, Y, Z relative to a perfect white. */
  readonly image: Triple;
  /** Y of its mirror image on each state. */
  readonly ofStates: ReadonlyMap<string, number>;
}

/** Luminance of the veil over the illuminance at the eye, 1/sr, at an angle in degrees from the line of sight. */
export function glareFunction(theta: number, age = AGE, pigment = PIGMENT): number {
  const t = Math.min(MOST_DEG, Math.max(LEAST_DEG, theta));
  // Powers are products: pictures compute it for each of their pixels.
  const older = (age / 62.5) * (age / 62.5);
  return 10 / (t * t * t) + (5 / (t * t) + (0.1 * pigment) / t) * (1 + older * older) + 0.0025 * pigment;
}

/** Directions from the eye to parts of the mirror image of a lamp that lie on the display. */
function visibleParts(lamp: Lamp, { place, height }: Camera): Triple[] {
  const [x, y, z] = lamp.towards;
  // Two unit vectors across the direction of the lamp.
  const flat = Math.hypot(x, y);
  const one: Triple = flat > 0 ? [-y / flat, x / flat, 0] : [1, 0, 0];
  const other: Triple = [y * one[2] - z * one[1], z * one[0] - x * one[2], x * one[1] - y * one[0]];
  const least = Math.cos(lamp.radius_deg * RADIANS);
  const parts: Triple[] = [];
  for (let k = 0; k < PARTS; k++) {
    const cosine = 1 - ((k + 0.5) / PARTS) * (1 - least);
    const [sine, turn] = [Math.sqrt(1 - cosine * cosine), k * Math.PI * (3 - Math.sqrt(5))];
    const at = (i: 0 | 1 | 2) => cosine * lamp.towards[i] + sine * (Math.cos(turn) * one[i] + Math.sin(turn) * other[i]);
    // The line of sight is mirrored at the display.
    const sight: Triple = [at(0), at(1), -at(2)];
    if (sight[2] >= 0) continue;
    const far = place[2] / -sight[2];
    const [u, v] = [place[0] + far * sight[0], place[1] + far * sight[1]];
    if (Math.abs(u) <= 0.5 && Math.abs(v) <= height / 2) parts.push(sight);
  }
  return parts;
}

/** Light that reaches the eye from the visible part of a mirror image. */
export interface GlareSource {
  /** The direction from the eye. */
  readonly from: Triple;
  /** Illuminance at the eye, X, Y, Z, over the luminance of a perfect white, sr. */
  readonly light: Triple;
  /** Angular radius of the image: within it, the veil is that of its border. */
  readonly radius_deg: number;
}

/** The light of a mirror image on the display, from the middle of its visible part; null if no part of it is visible. */
export function glareOf(lamp: Lamp, of: Camera): GlareSource | null {
  const parts = visibleParts(lamp, of);
  if (parts.length === 0) return null;
  const [x, y, z] = lamp.towards;
  const middle: Triple[] = parts.length === PARTS ? [[x, y, -z]] : parts;
  const sum = (k: 0 | 1 | 2) => middle.reduce((total, part) => total + part[k], 0);
  const length = Math.hypot(sum(0), sum(1), sum(2));
  const solid = (2 * Math.PI * (1 - Math.cos(lamp.radius_deg * RADIANS)) * parts.length) / PARTS;
  return {
    from: [sum(0) / length, sum(1) / length, sum(2) / length],
    light: lamp.image.map((value) => value * solid) as unknown as Triple,
    radius_deg: lamp.radius_deg,
  };
}

/** The veil in a direction of sight, X, Y, Z relative to a perfect white. */
export function veil(source: GlareSource, sight: Triple): Triple {
  const cosine = source.from[0] * sight[0] + source.from[1] * sight[1] + source.from[2] * sight[2];
  const apart = Math.hypot(source.from[0] - sight[0], source.from[1] - sight[1], source.from[2] - sight[2]);
  const by = Math.max(0, cosine) * glareFunction(Math.max(source.radius_deg, (2 * Math.asin(Math.min(1, apart / 2))) / RADIANS));
  return source.light.map((value) => value * by) as unknown as Triple;
}
