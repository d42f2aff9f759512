// A picture on a canvas: drawn by the graphics processor (WebGL2), or else by the main processor, which takes a third of the time that WebGL2
// takes there.

import { onCanvas } from "./seen-2d.ts";
import { onGraphics } from "./seen-gl.ts";
import type { Painter } from "./seen.ts";

/** Returns the painter of a canvas. `?canvas` and `?webgl` in the address choose one. */
export function painterOf(canvas: HTMLCanvasElement): Painter {
  const wish = new URLSearchParams(location.search);
  return (wish.has("canvas") ? null : onGraphics(canvas, wish.has("webgl"))) ?? onCanvas(canvas);
}
