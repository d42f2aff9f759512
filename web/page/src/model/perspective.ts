// The display in perspective, as an eye at its place sees it. Lengths are in widths of the display, whose middle is the origin; x is to the
// right, y up, z towards the eye.

import type { Triple } from "./colour.ts";

/** Direction of the eye as inclination times cosine and sine of the azimuth, degrees. */
export type Tilt = readonly [number, number];

/** The largest inclination of the eye, degrees. */
export const MOST_TILT = 75;

export interface Camera {
  readonly place: Triple;
  readonly right: Triple;
  readonly up: Triple;
  readonly forward: Triple;
  /** Distance of the eye, which is also the focal length. */
  readonly distance: number;
  /** Height of the display. */
  readonly height: number;
}

/** How the picture of the camera lies on the canvas. */
export interface Frame {
  /** Width and height of the canvas, px. */
  readonly canvas: readonly [number, number];
  /** Width of the display that faces the eye, px. */
  readonly scale: number;
  /** The point of the camera's picture in the middle of the canvas, in widths of the display. */
  readonly middle: readonly [number, number];
}

/** Fraction of the canvas that the display fills at zoom 1. */
const FILLED = 0.94;

const RADIANS = Math.PI / 180;

const dot = ([a, b, c]: Triple, [x, y, z]: Triple): number => a * x + b * y + c * z;

const cross = ([a, b, c]: Triple, [x, y, z]: Triple): Triple => [b * z - c * y, c * x - a * z, a * y - b * x];

/** Returns the direction of an inclination and an azimuth. */
export const tiltOf = (theta: number, phi: number): Tilt => [
  theta * Math.cos(phi * RADIANS),
  theta * Math.sin(phi * RADIANS),
];

/** Returns inclination and azimuth of a direction, degrees, to a hundredth. */
export function anglesOf([x, y]: Tilt): { theta_deg: number; phi_deg: number } {
  const rounded = (value: number) => Math.round(100 * value) / 100 || 0;
  // In the plane of azimuth 0, inclinations to the left are negative, as in the drawing.
  if (Math.abs(y) < 0.005) return { theta_deg: rounded(x), phi_deg: 0 };
  return { theta_deg: rounded(Math.hypot(x, y)), phi_deg: rounded(Math.atan2(y, x) / RADIANS) };
}

/** Reduces an inclination that is too large. */
export function limited([x, y]: Tilt): Tilt {
  const theta = Math.hypot(x, y);
  return theta > MOST_TILT ? [(x * MOST_TILT) / theta, (y * MOST_TILT) / theta] : [x, y];
}

/** The unit vector towards an inclination and an azimuth, degrees. */
export function direction(theta: number, phi: number): Triple {
  const [t, p] = [theta * RADIANS, phi * RADIANS];
  return [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
}

/** Returns the camera at a place; `height` is that of the display. */
export function camera([x, y]: Tilt, distance: number, height: number): Camera {
  const theta = Math.hypot(x, y);
  const towards = direction(theta, theta > 0 ? Math.atan2(y, x) / RADIANS : 0);
  const forward = towards.map((value) => -value || 0) as unknown as Triple;
  const side = cross(forward, [0, 1, 0]);
  const length = Math.hypot(...side);
  const right = side.map((value) => value / length || 0) as unknown as Triple;
  return {
    place: towards.map((value) => value * distance) as unknown as Triple,
    right,
    up: cross(right, forward),
    forward,
    distance,
    height,
  };
}

/** Returns the scale at which a display fills a canvas. */
export const fitting = ([width, height]: readonly [number, number], tall: number): number =>
  FILLED * Math.min(width, height / tall);

/**
 * Returns the part of the canvas, in pixels from its lower left corner, outside which there is nothing of the display: x, y, width, height.
 */
export function extent({ place, right, up, forward, distance, height }: Camera, frame: Frame): [number, number, number, number] {
  const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]] as [[number, number], [number, number]];
  for (const x of [-0.5, 0.5])
    for (const y of [-height / 2, height / 2]) {
      const ray: Triple = [x - place[0], y - place[1], -place[2]];
      const depth = dot(forward, ray);
      // A corner behind the eye: all of the canvas.
      if (depth <= 0) return [0, 0, ...frame.canvas];
      [right, up].forEach((axis, k) => {
        const at = frame.canvas[k]! / 2 + frame.scale * ((distance * dot(axis, ray)) / depth - frame.middle[k]!);
        low[k] = Math.min(low[k]!, at);
        high[k] = Math.max(high[k]!, at);
      });
    }
  const from = low.map((at, k) => Math.min(frame.canvas[k]!, Math.max(0, Math.floor(at) - 1)));
  const to = high.map((at, k) => Math.min(frame.canvas[k]!, Math.max(0, Math.ceil(at) + 1)));
  return [from[0]!, from[1]!, Math.max(0, to[0]! - from[0]!), Math.max(0, to[1]! - from[1]!)];
}

/** Returns the point of the display, in its widths, at a point of the canvas; null beside its plane. */
export function pointAt(of: Camera, frame: Frame, x: number, y: number): [number, number] | null {
  const { place, right, up, forward, distance } = of;
  const a = (x - frame.canvas[0] / 2) / frame.scale + frame.middle[0];
  const b = (frame.canvas[1] / 2 - y) / frame.scale + frame.middle[1];
  const ray = (k: 0 | 1 | 2) => forward[k] * distance + right[k] * a + up[k] * b;
  const depth = -place[2] / ray(2);
  return depth > 0 ? [place[0] + depth * ray(0), place[1] + depth * ray(1)] : null;
}

/**
 * Returns the matrix from a point x, y, 1 of the canvas to column, row, 1 of the picture on the display, each times the same number, which is
 * positive before the eye.
 */
export function onDisplay(of: Camera, frame: Frame, columns: number, rows: number): readonly Triple[] {
  const { place, right, up, forward, distance, height } = of;
  const { canvas, scale, middle } = frame;
  // The line of sight, a linear function of the point of the canvas.
  const [x, y, z] = [0, 1, 2].map((k): Triple => {
    const [a, b] = [right[k]! / scale, -up[k]! / scale];
    const start = forward[k]! * distance + right[k]! * middle[0] + up[k]! * middle[1];
    return [a, b, start - (a * canvas[0] + b * canvas[1]) / 2];
  }) as [Triple, Triple, Triple];
  // It meets the display where its length, in units of itself, is -place z / ray z.
  const ahead = z.map((value) => -value / place[2]) as unknown as Triple;
  const along = (ray: Triple, from: number): Triple => ray.map((value, k) => value + from * ahead[k]!) as unknown as Triple;
  const mixed = (a: Triple, by: number, offset: number): Triple => a.map((value, k) => by * value + offset * ahead[k]!) as unknown as Triple;
  return [mixed(along(x, place[0]), columns, columns / 2), mixed(along(y, place[1]), -rows / height, rows / 2), ahead];
}
