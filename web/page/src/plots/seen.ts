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

/** The mirror image of a lamp. */
export interface Mirror {
  /** The direction towards the lamp. */
  readonly towards: Triple;
  /** Cosine of its angular radius. */
  readonly cosine: number;
  /** Linear sRGB that is added. */
  readonly light: Triple;
}

/** Light that is scattered in the eye. */
export interface Veil {
  /** The direction from the eye. */
  readonly from: Triple;
  /** Linear sRGB of the illuminance at the eye; the glare function times it is added. */
  readonly light: Triple;
  /** Nearer to the direction than this, the veil is uniform, degrees. */
  readonly radius_deg: number;
}

/** Sub-pixels that are drawn where pixels are large: rectangles, each with its own light instead of that of the picture. */
export interface SubPixels {
  readonly states: Uint8Array;
  /** x0, y0, x1, y1 in fractions of the pixel, from its lower left corner. */
  readonly windows: readonly (readonly [number, number, number, number])[];
  /** Linear sRGB by state, then by window, and last between the windows. */
  readonly light: readonly (readonly Triple[])[];
}

export interface Scenery {
  readonly lit: Lit;
  readonly camera: Camera;
  readonly frame: Frame;
  readonly mirrors: readonly Mirror[];
  readonly veils: readonly Veil[];
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
