// Directions drawn from the side: the half of the sphere above the display, seen along the plane of azimuth 0.
// A direction in that plane lies on the half circle; one outside it lies within, where it is seen from the side.

/** A direction's inclination and azimuth, degrees; a negative inclination is the other side of its azimuth. */
export interface Direction {
  readonly theta: number;
  readonly phi: number;
}

const RADIANS = Math.PI / 180;

/** Cosine of an azimuth, exact where a quarter of a turn makes it 0 or 1. */
const cosOf = (phi: number): number => {
  const turned = ((phi % 360) + 360) % 360;
  return turned === 90 || turned === 270 ? 0 : turned === 180 ? -1 : Math.cos(turned * RADIANS);
};

/** Where a direction is drawn on a half circle of radius 1: to the right, and up. */
export const seen = ({ theta, phi }: Direction): [right: number, up: number] => [
  Math.sin(theta * RADIANS) * cosOf(phi),
  Math.cos(theta * RADIANS),
];

/** Whether it lies in the plane of drawing. */
export const inPlane = ({ theta, phi }: Direction): boolean => theta === 0 || Math.abs(cosOf(phi)) > 0.9998;

/** The direction from which the mirror image of a light is seen. */
export const mirrored = ({ theta, phi }: Direction): Direction => ({ theta: -theta, phi });

/** Which way a growing inclination goes: 1 to the right, -1 to the left. */
export const sense = (phi: number): 1 | -1 => (cosOf(phi) < 0 ? -1 : 1);

/**
 * The inclination, in steps from -most to most, whose place is nearest to a point; of two that are drawn at
 * the same place (azimuth 90) the one nearer to that of before.
 */
export function nearest(to: readonly [number, number], from: Direction, step: number, most: number): number {
  const count = Math.round((2 * most) / step);
  let [best, least] = [from.theta, Infinity];
  for (let i = 0; i <= count; i++) {
    const theta = -most + i * step;
    const [x, y] = seen({ theta, phi: from.phi });
    const apart = Math.hypot(x - to[0], y - to[1]) + 1e-9 * Math.abs(theta - from.theta);
    if (apart < least) [best, least] = [theta, apart];
  }
  return best;
}
