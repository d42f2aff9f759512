// A picture on the display, as the server sends it: X, Y, Z of each pixel in each light of the room, which the page adds up. Bytes:
// the length of the head (32 bits), the head (JSON), the states (8 bits, if the picture has a halftone), a plane of X, Y, Z (16-bit floating point) for each light, and
// perhaps the picture itself; the length of each block is a multiple of 4 bytes.

import type { PictureHead } from "../api/types.ts";
import { CLIPPED, screenMatrix, type Triple } from "./colour.ts";
import { listAt, numberAt, type Json } from "./json.ts";

/** A picture in several lights: X, Y, Z of each pixel, row by row from the top, as 16-bit floating point numbers. */
export interface Planes {
  readonly size: readonly [number, number];
  readonly planes: readonly Uint16Array[];
}

/** A picture on the display. */
export interface Seen extends Planes {
  readonly head: PictureHead;
  /** The state of each pixel; none without a halftone. */
  readonly states: Uint8Array;
  /** Mean X, Y, Z of the pixels of each state in each light; null for a state that no pixel has. */
  readonly means: readonly (readonly (Triple | null)[])[];
  /** The picture itself under D65, if it was sent. */
  readonly source: Planes | null;
}

const padded = (length: number): number => (length + 3) & ~3;

/** Reads the bytes of a response. */
export function unpacked(bytes: ArrayBuffer): Seen {
  const length = new DataView(bytes).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as PictureHead;
  const [columns, rows] = head.size as [number, number];
  const count = columns * rows;
  const states = new Uint8Array(bytes, 4 + length, head.held === null ? 0 : count);
  let at = 4 + length + padded(states.length);
  const plane = () => {
    const found = new Uint16Array(bytes, at, 3 * count);
    at += padded(6 * count);
    return found;
  };
  const planes = head.lights.map(plane);
  const size = [columns, rows] as const;
  const source = head.has_source ? { size, planes: [plane()] } : null;
  let means: Seen["means"] | null = null;
  return {
    head,
    size,
    states,
    planes,
    // Computed when they are needed: a few thousandths of a second, for the white of the display alone.
    get means() {
      return (means ??= planes.map((one) => meansOf(one, states, head.states.length)));
    },
    source,
  };
}

let halves: Float32Array | null = null;

/** The values of all 16-bit floating point numbers. */
export function halfValues(): Float32Array {
  halves ??= Float32Array.from({ length: 1 << 16 }, (_, bits) => {
    const [exponent, fraction] = [(bits >> 10) & 31, bits & 0x3ff];
    const size = exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
    return bits >> 15 ? -size : size;
  });
  return halves;
}

function meansOf(plane: Uint16Array, states: Uint8Array, count: number): (Triple | null)[] {
  const values = halfValues();
  const sums = new Float64Array(4 * count);
  for (let i = 0, at = 0; i < states.length; i++, at += 3) {
    const k = 4 * states[i]!;
    sums[k]! += values[plane[at]!]!;
    sums[k + 1]! += values[plane[at + 1]!]!;
    sums[k + 2]! += values[plane[at + 2]!]!;
    sums[k + 3]! += 1;
  }
  const mean = (k: number): Triple | null => {
    const [x, y, z, number] = sums.subarray(4 * k, 4 * k + 4) as unknown as [number, number, number, number];
    return number > 0 ? [x / number, y / number, z / number] : null;
  };
  return Array.from({ length: count }, (_, k) => mean(k));
}

/** Illuminance of each light of a scenario by its name, lx. */
export function intensities(fields: Json): Map<string, number> {
  const all = new Map<string, number>();
  const lux = numberAt(fields, "lighting.illuminance_lx") ?? 0;
  all.set("diffuse", lux * (numberAt(fields, "lighting.diffuse") ?? 0));
  for (const kind of ["directed", "environment"])
    listAt(fields, `lighting.${kind}`).forEach((_, k) => {
      const share = (key: string) => numberAt(fields, `lighting.${kind}.${k}.${key}`) ?? 0;
      all.set(`${kind}.${k}`, lux * (share("share") + share("sun_share")));
    });
  all.set("front_light", numberAt(fields, "lighting.front_light.illuminance_lx") ?? 0);
  return all;
}

/** Returns by how much each light of a picture has become brighter since it was requested. */
export function brighter(
  lights: readonly { readonly light: string }[],
  then: ReadonlyMap<string, number>,
  now: ReadonlyMap<string, number>,
): number[] {
  return lights.map(({ light }) => {
    const before = then.get(light) ?? 0;
    return before > 0 ? (now.get(light) ?? 0) / before : 1;
  });
}

/** Adds up triples, each with a factor; undefined ones are 0. */
export function mixed(all: readonly (Triple | null | undefined)[], factors: readonly number[]): Triple {
  const sum = (k: 0 | 1 | 2) => all.reduce((total, one, i) => total + (one?.[k] ?? 0) * factors[i]!, 0);
  return [sum(0), sum(1), sum(2)];
}

/** What is white, 255, 255, 255, on this page. */
export type White = "perfect" | "display" | "screen";

/** How a screen shows light: linear sRGB is `matrix` times X, Y, Z. */
export interface Exposure {
  readonly matrix: readonly Triple[];
  /** X, Y, Z of a perfect white. */
  readonly white: Triple;
  /** Luminance of a perfect white, cd/m2. */
  readonly white_cd_m2: number;
}

/** Luminance of the white of the screen for comparison: that of white paper in the room, or a number, cd/m2. */
export type ScreenLight = "paper" | number;
/** Fraction of the room's light that it reflects. */
export const SCREEN_REFLECTANCE = 0.04;
/** Reflectance of white paper. */
export const PAPER = 0.9;
/** White of sRGB. */
export const D65: Triple = [0.95047, 1, 1.08883];

/** Returns the exposure of a picture. `lux` is the illuminance on the display. */
export function exposure(
  seen: Seen,
  factors: readonly number[],
  lux: number,
  white: White,
  screenLight: ScreenLight = "paper",
): Exposure {
  const perfect = mixed(
    seen.head.lights.map((one) => one.white as unknown as Triple),
    factors,
  );
  const white_cd_m2 = lux / Math.PI;
  if (white === "display") {
    const own = whiteOf(seen, factors);
    if (own[1] > 0) return { matrix: screenMatrix(own, 1 / own[1]), white: perfect, white_cd_m2 };
  }
  const screen = screenOverWhite(screenLight, white_cd_m2) + SCREEN_REFLECTANCE;
  const scale = white === "screen" ? 1 / Math.max(1, screen) : 1;
  return { matrix: screenMatrix(perfect, scale / perfect[1]), white: perfect, white_cd_m2 };
}

/** Luminance of the white of the screen over that of a perfect white in the room. */
const screenOverWhite = (light: ScreenLight, white_cd_m2: number): number =>
  light === "paper" ? PAPER : light / Math.max(white_cd_m2, 1e-9);

/** X, Y, Z of the state `white`, or else of the brightest one: means of their pixels, or a page without a halftone. */
function whiteOf(seen: Seen, factors: readonly number[]): Triple {
  const named = seen.head.states.indexOf("white");
  const pages = seen.head.colours as unknown as readonly Triple[];
  const means = seen.head.states.map((_, k) =>
    seen.states.length === 0 ? pages[k]! :
    mixed(
      seen.means.map((light) => light[k]),
      factors,
    ),
  );
  const brightest = means.reduce((best, one) => (one[1] > best[1] ? one : best), [0, 0, 0] as Triple);
  const own = means[named];
  return own && own[1] > 0 ? own : brightest;
}

/** The light of an sRGB screen in the same room: the factor of the picture, and the light that is added everywhere. */
export function onScreen(by: Exposure, light: ScreenLight): { factors: number[]; added: Triple } {
  return {
    factors: [by.white[1] * screenOverWhite(light, by.white_cd_m2)],
    added: by.white.map((value) => value * SCREEN_REFLECTANCE) as unknown as Triple,
  };
}

/** Largest number of pixels of which the fraction is estimated that the screen cannot show. */
const SAMPLES = 20_000;

/** Returns the fraction of the pixels that are brighter than the screen can show. */
export function clippedShare({ size, planes }: Planes, factors: readonly number[], matrix: readonly Triple[]): number {
  const values = halfValues();
  const pixels = size[0] * size[1];
  // Odd, so that the pixels are not those of few columns.
  const step = Math.max(1, Math.ceil(pixels / SAMPLES)) | 1;
  const [[rx, ry, rz], [gx, gy, gz], [bx, by, bz]] = matrix as readonly [Triple, Triple, Triple];
  let count = 0;
  let clipped = 0;
  for (let pixel = 0; pixel < pixels; pixel += step, count++) {
    let x = 0;
    let y = 0;
    let z = 0;
    for (let i = 0; i < planes.length; i++) {
      const plane = planes[i]!;
      const factor = factors[i]!;
      x += factor * values[plane[3 * pixel]!]!;
      y += factor * values[plane[3 * pixel + 1]!]!;
      z += factor * values[plane[3 * pixel + 2]!]!;
    }
    if (Math.max(rx * x + ry * y + rz * z, gx * x + gy * y + gz * z, bx * x + by * y + bz * z) > CLIPPED) clipped += 1;
  }
  return count > 0 ? clipped / count : 0;
}
