// What is drawn of a picture on a canvas.

import type { Triple } from "../model/colour.ts";
import type { Camera, Frame } from "../model/perspective.ts";
import type { Planes } from "../model/seen.ts";

/** The light of a picture: its planes, each with a factor, and light that is added everywhere. */
export interface Lit {
  readonly picture: Planes;
  readonly factors: readonly number[];
  readonly added: Triple;
  /** From X, Y, Z to linear sRGB. */
  readonly matrix: readonly Triple[];
}

/** A lamp whose mirror image may be visible. */
export interface Lamp {
  /** The direction towards it. */
  readonly towards: Triple;
  /** Cosine of its angular radius. */
  readonly cosine: number;
}

/** Sub-pixels that are drawn where pixels are large: rectangles with what they add to the colour of the pixel in each state. */
export interface SubPixels {
  readonly states: Uint8Array;
  /** x0, y0, x1, y1 in fractions of the pixel, from its lower left corner. */
  readonly windows: readonly (readonly [number, number, number, number])[];
  /** Linear sRGB by state, then by window, and last between the windows. */
  readonly added: readonly (readonly Triple[])[];
}

export interface Scenery {
  readonly lit: Lit;
  readonly camera: Camera;
  readonly frame: Frame;
  readonly lamps: readonly Lamp[];
  readonly subPixels: SubPixels | null;
}

/** Sub-pixels are drawn in pixels that are larger than this, px. */
export const LARGE_PX = 10;

export interface Painter {
  /** `WebGL2` or `canvas`. */
  readonly name: string;
  draw(of: Scenery): void;
  release(): void;
}
