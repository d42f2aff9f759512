// A picture on a canvas without graphics processor: the arithmetic of seen-gl.ts for each pixel of the canvas.

import { displayed, encoded, type Triple } from "../model/colour.ts";
import { glareFunction } from "../model/glare.ts";
import { pointAt } from "../model/perspective.ts";
import { halfValues } from "../model/seen.ts";
import { LARGE_PX, type Lit, type Painter, type Scenery } from "./seen.ts";

/** Steps of the table of encoded values. */
const STEPS = 4096;
const ENCODED = Uint8ClampedArray.from({ length: STEPS + 1 }, (_, i) => Math.round(255 * encoded(i / STEPS)));
/** Dark values, where the steps of the table are too coarse, are computed. */
const DARK = 0.02;
const code = (linear: number): number =>
  linear < DARK ? Math.round(255 * encoded(linear)) : ENCODED[Math.round(Math.min(1, linear) * STEPS)]!;

/** Largest number of pixels of the picture, along a side, whose mean a pixel of the canvas is. */
const MOST_MEAN = 4;

/** Returns linear sRGB of each pixel, without clipping. */
export function linear({ picture, factors, added, matrix }: Lit): Float32Array {
  const values = halfValues();
  const out = new Float32Array(3 * picture.size[0] * picture.size[1]);
  const [r, g, b] = matrix as [Triple, Triple, Triple];
  for (let at = 0; at < out.length; at += 3) {
    let [x, y, z] = added;
    for (let i = 0; i < factors.length; i++) {
      const [plane, factor] = [picture.planes[i]!, factors[i]!];
      x += factor * values[plane[at]!]!;
      y += factor * values[plane[at + 1]!]!;
      z += factor * values[plane[at + 2]!]!;
    }
    out[at] = r[0] * x + r[1] * y + r[2] * z;
    out[at + 1] = g[0] * x + g[1] * y + g[2] * z;
    out[at + 2] = b[0] * x + b[1] * y + b[2] * z;
  }
  return out;
}

export function onCanvas(canvas: HTMLCanvasElement): Painter {
  const context = canvas.getContext("2d")!;
  let former: Lit | null = null;
  let pixels = new Float32Array();
  return {
    name: "canvas",
    draw(of) {
      if (!same(former, of.lit)) pixels = linear(of.lit) as Float32Array<ArrayBuffer>;
      former = of.lit;
      const [width, height] = [canvas.width, canvas.height];
      const image = context.createImageData(width, height);
      for (let j = 0, at = 0; j < height; j++)
        for (let i = 0; i < width; i++, at += 4) {
          const colour = colourAt(of, pixels, i + 0.5, j + 0.5);
          if (!colour) continue;
          const [r, g, b] = displayed(colour);
          image.data[at] = code(r);
          image.data[at + 1] = code(g);
          image.data[at + 2] = code(b);
          image.data[at + 3] = 255;
        }
      context.putImageData(image, 0, 0);
    },
    release: () => {},
  };
}

const same = (a: Lit | null, b: Lit): boolean =>
  a !== null && a.picture === b.picture && [a.factors, a.added, a.matrix].join() === [b.factors, b.added, b.matrix].join();

/** Linear sRGB at a point of the canvas; null beside the display. */
export function colourAt(of: Scenery, pixels: Float32Array, x: number, y: number): Triple | null {
  const { camera, frame, lit } = of;
  const [columns, rows] = lit.picture.size;
  const place = (dx: number, dy: number): [number, number] | null => {
    const point = pointAt(camera, frame, x + dx, y + dy);
    return point && [(point[0] + 0.5) * columns, (0.5 - point[1] / camera.height) * rows];
  };
  const here = place(0, 0);
  if (!here || here[0] < 0 || here[1] < 0 || here[0] >= columns || here[1] >= rows) return null;
  const [right, below] = [place(0.5, 0), place(0, 0.5)];
  const reach = (k: 0 | 1) => Math.abs((right?.[k] ?? here[k]) - here[k]) + Math.abs((below?.[k] ?? here[k]) - here[k]);
  const more = inTheEye(of, x, y);
  const inEye = (light: Triple): Triple => [light[0] + more[0], light[1] + more[1], light[2] + more[2]];
  // The mean of the pixels whose middles are within half a pixel of the canvas; where pixels are large, the one.
  const range = (k: 0 | 1, count: number): [number, number] => {
    const half = Math.min(reach(k), MOST_MEAN / 2);
    const from = Math.floor(here[k]);
    if (half <= 0.5) return [from, from];
    return [Math.max(0, Math.round(here[k] - half)), Math.min(count - 1, Math.round(here[k] + half) - 1)];
  };
  const [[left, last], [top, bottom]] = [range(0, columns), range(1, rows)];
  let [r, g, b, count] = [0, 0, 0, 0];
  for (let row = top; row <= bottom; row++)
    for (let column = left; column <= last; column++, count++) {
      const at = 3 * (row * columns + column);
      r += pixels[at]!;
      g += pixels[at + 1]!;
      b += pixels[at + 2]!;
    }
  const colour: Triple = [r / count, g / count, b / count];
  const { subPixels } = of;
  if (!subPixels || Math.max(reach(0), reach(1)) * 2 * LARGE_PX > 1) return inEye(colour);
  const [u, v] = [here[0] - left, 1 - (here[1] - top)];
  const window = subPixels.windows.findIndex(([x0, y0, x1, y1]) => u >= x0 && u < x1 && v >= y0 && v < y1);
  const all = subPixels.light[subPixels.states[top * columns + left]!]!;
  return inEye(all[window < 0 ? all.length - 1 : window]!);
}

/** Mirror images of lamps and the veil in the eye at a point of the canvas, linear sRGB. */
function inTheEye({ camera, frame, mirrors, veils }: Scenery, x: number, y: number): Triple {
  const point = mirrors.length + veils.length > 0 ? pointAt(camera, frame, x, y) : null;
  if (!point) return [0, 0, 0];
  const [dx, dy, dz] = [point[0] - camera.place[0], point[1] - camera.place[1], -camera.place[2]];
  const length = Math.hypot(dx, dy, dz);
  const sight: Triple = [dx / length, dy / length, dz / length];
  const sum: [number, number, number] = [0, 0, 0];
  const add = (light: Triple, factor: number) => light.forEach((value, k) => (sum[k]! += factor * value));
  for (const { towards, cosine, light } of mirrors)
    if (sight[0] * towards[0] + sight[1] * towards[1] - sight[2] * towards[2] > cosine) add(light, 1);
  for (const { from, light, radius_deg } of veils) {
    const straight = from[0] * sight[0] + from[1] * sight[1] + from[2] * sight[2];
    const apart = Math.hypot(from[0] - sight[0], from[1] - sight[1], from[2] - sight[2]);
    add(light, Math.max(0, straight) * glareFunction(Math.max(radius_deg, (2 * Math.asin(Math.min(1, apart / 2)) * 180) / Math.PI)));
  }
  return sum;
}
