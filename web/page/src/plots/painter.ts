// A picture on a canvas: drawn by the graphics processor (WebGL2), or else by the same arithmetic on the main processor.

import { onCanvas } from "./seen-2d.ts";
import { onGraphics } from "./seen-gl.ts";
import type { Painter } from "./seen.ts";

/** Returns the painter of a canvas. `plainly` avoids the graphics processor. */
export const painterOf = (canvas: HTMLCanvasElement, plainly: boolean): Painter =>
  (plainly ? null : onGraphics(canvas)) ?? onCanvas(canvas);
