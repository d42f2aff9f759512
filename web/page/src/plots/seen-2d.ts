// A picture on a canvas without graphics processor. Each pixel of the canvas has the mean light of the part of the display that it shows.

import { encoded, type Triple } from "../model/colour.ts";
import { glareFunction } from "../model/glare.ts";
import { extent, onDisplay } from "../model/perspective.ts";
import { halfValues } from "../model/seen.ts";
import { LARGE_PX, type Lit, type Painter, type Scenery } from "./seen.ts";

/** Steps of the table of encoded values: 20 for the largest step between two codes, that of dark colours. */
const STEPS = 1 << 16;
let codes: Uint8Array | null = null;
const codesOf = (): Uint8Array =>
  (codes ??= Uint8Array.from({ length: STEPS + 1 }, (_, i) => Math.round(255 * encoded(i / STEPS))));

/** A pixel of the canvas of which the display covers less has no colour: half a code. */
const LEAST_COVERED = 1 / 510;
/** Largest number of pixels of the picture, along a side, whose mean a pixel of the canvas is. */
const MOST_MEAN = 16;

/** Returns linear sRGB of each pixel, without clipping. */
export function linear({ picture, factors, added, matrix }: Lit): Float32Array {
  const values = halfValues();
  const out = new Float32Array(3 * picture.size[0] * picture.size[1]);
  const [[rx, ry, rz], [gx, gy, gz], [bx, by, bz]] = matrix as readonly [Triple, Triple, Triple];
  const [x0, y0, z0] = added;
  for (let at = 0; at < out.length; at += 3) {
    let x = x0;
    let y = y0;
    let z = z0;
    for (let i = 0; i < factors.length; i++) {
      const plane = picture.planes[i]!;
      const factor = factors[i]!;
      x += factor * values[plane[at]!]!;
      y += factor * values[plane[at + 1]!]!;
      z += factor * values[plane[at + 2]!]!;
    }
    out[at] = rx * x + ry * y + rz * z;
    out[at + 1] = gx * x + gy * y + gz * z;
    out[at + 2] = bx * x + by * y + bz * z;
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
      context.clearRect(0, 0, canvas.width, canvas.height);
      const [left, bottom, width, height] = extent(of.camera, of.frame);
      if (width === 0 || height === 0) return;
      const top = canvas.height - bottom - height;
      const image = context.createImageData(width, height);
      fill(image.data, colours(of, pixels), left, top, width);
      context.putImageData(image, left, top);
    },
    release: () => {},
  };
}

const same = (a: Lit | null, b: Lit): boolean =>
  a !== null && a.picture === b.picture && [a.factors, a.added, a.matrix].join() === [b.factors, b.added, b.matrix].join();

/** Encodes the colours of a part of the canvas. What is too bright keeps its hue, as `displayed` in model/colour.ts. */
function fill(data: Uint8ClampedArray, at: Colours, left: number, top: number, width: number): void {
  const encode = codesOf();
  const light = new Float64Array(4);
  for (let to = 0, i = 0, j = 0; to < data.length; to += 4) {
    if (at(left + i + 0.5, top + j + 0.5, light)) {
      const scale = STEPS / Math.max(1, light[0]!, light[1]!, light[2]!);
      // To the nearest step.
      for (let k = 0; k < 3; k++) data[to + k] = encode[(Math.max(0, scale * light[k]!) + 0.5) | 0]!;
      data[to + 3] = 255 * light[3]!;
    }
    if (++i === width) [i, j] = [0, j + 1];
  }
}

/**
 * The light at a point of the canvas: `into` becomes linear sRGB without clipping, and the fraction of the canvas's pixel that the display
 * covers. Returns false beside the display.
 */
export type Colours = (x: number, y: number, into: Float64Array) => boolean;

/** The light of a scenery whose pixels have these colours, [`linear`]. */
export function colours(of: Scenery, pixels: Float32Array): Colours {
  const { subPixels } = of;
  const [columns, rows] = of.lit.picture.size;
  const [a, b, c] = onDisplay(of.camera, of.frame, columns, rows) as [Triple, Triple, Triple];
  const [ax, ay, az] = a;
  const [bx, by, bz] = b;
  const [cx, cy, cz] = c;
  const addInTheEye = inTheEye(of);
  return (x, y, into) => {
    const depth = 1 / (cx * x + cy * y + cz);
    if (!(depth > 0)) return false;
    const u = depth * (ax * x + ay * y + az);
    const v = depth * (bx * x + by * y + bz);
    // The part of the picture that is a pixel of the canvas: a rectangle with sides of these lengths.
    const wide = depth * (Math.abs(ax - u * cx) + Math.abs(ay - u * cy));
    const tall = depth * (Math.abs(bx - v * cx) + Math.abs(by - v * cy));
    const covered =
      Math.min(1, Math.max(0, Math.min(u, columns - u) / wide + 0.5)) * Math.min(1, Math.max(0, Math.min(v, rows - v) / tall + 0.5));
    if (!(covered > LEAST_COVERED)) return false;
    into[3] = covered;
    const column = Math.min(columns - 1, Math.max(0, Math.floor(u)));
    const row = Math.min(rows - 1, Math.max(0, Math.floor(v)));
    if (subPixels && Math.max(wide, tall) * LARGE_PX < 1) {
      const [right, up] = [u - column, 1 - (v - row)];
      const window = subPixels.windows.findIndex(([x0, y0, x1, y1]) => right >= x0 && right < x1 && up >= y0 && up < y1);
      const all = subPixels.light[subPixels.states[row * columns + column]!]!;
      into.set(all[window < 0 ? all.length - 1 : window]!);
    } else {
      const halfWide = Math.min(wide, MOST_MEAN) / 2;
      const halfTall = Math.min(tall, MOST_MEAN) / 2;
      const left = Math.min(Math.max(u - halfWide, 0), column);
      const right = Math.max(Math.min(u + halfWide, columns), column + 1e-6);
      const top = Math.min(Math.max(v - halfTall, 0), row);
      const bottom = Math.max(Math.min(v + halfTall, rows), row + 1e-6);
      let red = 0;
      let green = 0;
      let blue = 0;
      let sum = 0;
      for (let j = Math.floor(top); j < bottom; j++) {
        const height = Math.min(bottom, j + 1) - Math.max(top, j);
        for (let i = Math.floor(left); i < right; i++) {
          const weight = height * (Math.min(right, i + 1) - Math.max(left, i));
          const at = 3 * (j * columns + i);
          red += weight * pixels[at]!;
          green += weight * pixels[at + 1]!;
          blue += weight * pixels[at + 2]!;
          sum += weight;
        }
      }
      into[0] = red / sum;
      into[1] = green / sum;
      into[2] = blue / sum;
    }
    addInTheEye?.(u / columns - 0.5, (0.5 - v / rows) * of.camera.height, into);
    return true;
  };
}

/** Adds mirror images of lamps and the veil in the eye at a point of the display; null if there are none. */
function inTheEye({ camera, mirrors, veils }: Scenery): ((x: number, y: number, into: Float64Array) => void) | null {
  if (mirrors.length + veils.length === 0) return null;
  const [fromX, fromY, fromZ] = camera.place;
  return (x, y, into) => {
    const dx = x - fromX;
    const dy = y - fromY;
    const far = 1 / Math.sqrt(dx * dx + dy * dy + fromZ * fromZ);
    const a = dx * far;
    const b = dy * far;
    const c = -fromZ * far;
    for (const { towards, cosine, light } of mirrors)
      if (a * towards[0] + b * towards[1] - c * towards[2] > cosine) addTo(into, light, 1);
    for (const { from, light, radius_deg } of veils) {
      const straight = from[0] * a + from[1] * b + from[2] * c;
      const p = from[0] - a;
      const q = from[1] - b;
      const r = from[2] - c;
      const apart = Math.sqrt(p * p + q * q + r * r);
      const degrees = (2 * Math.asin(Math.min(1, apart / 2)) * 180) / Math.PI;
      addTo(into, light, Math.max(0, straight) * glareFunction(Math.max(radius_deg, degrees)));
    }
  };
}

function addTo(sum: Float64Array, light: Triple, factor: number): void {
  for (let k = 0; k < 3; k++) sum[k]! += factor * light[k]!;
}
