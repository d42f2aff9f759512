// Side view of the directions above the display: their projection on the plane of azimuth 0. Directions in this plane
// are on the half circle, all others inside it.

/** Inclination and azimuth of a direction, degrees; a negative inclination means the opposite azimuth. */
export interface Direction {
  readonly theta: number;
  readonly phi: number;
}

const RADIANS = Math.PI / 180;

/** Returns the cosine of an azimuth, exactly for multiples of 90°. */
const cosOf = (phi: number): number => {
  const turned = ((phi % 360) + 360) % 360;
  return turned === 90 || turned === 270 ? 0 : turned === 180 ? -1 : Math.cos(turned * RADIANS);
};

/** Returns the position of a direction in a half circle of radius 1: to the right, and up. */
export const seen = ({ theta, phi }: Direction): [right: number, up: number] => [
  Math.sin(theta * RADIANS) * cosOf(phi),
  Math.cos(theta * RADIANS),
];

/** Returns true for a direction in the plane of the drawing. */
export const inPlane = ({ theta, phi }: Direction): boolean => theta === 0 || Math.abs(cosOf(phi)) > 0.9998;

/** Returns the direction in which the mirror image of a source is seen. */
export const mirrored = ({ theta, phi }: Direction): Direction => ({ theta: -theta, phi });

/** Returns the side to which an increasing inclination moves: 1 to the right, -1 to the left. */
export const sense = (phi: number): 1 | -1 => (cosOf(phi) < 0 ? -1 : 1);

/**
 * Returns the inclination, in steps from -most to most, whose position is nearest to a point. Of two inclinations at the
 * same position (azimuth 90), it is the one nearer to the previous inclination.
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
