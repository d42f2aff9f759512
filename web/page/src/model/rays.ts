// Rays through the layers of the drawing. Direction cosines are conserved by flat interfaces, so that the angle in each
// medium follows from its index; heights are those of the drawing, not to scale.

import { at, isTable, type Json } from "./json.ts";

export type Point = readonly [x: number, y: number];

/** A band of the drawing that a ray crosses. */
export interface Medium {
  readonly height: number;
  readonly index: number;
}

/** Largest horizontal distance that a ray moves in one band, px of the drawing. */
const MOST = 90;

/** Returns the points of a ray from a point downwards; `beta` is its direction cosine in air, positive to the right. */
export function ray(from: Point, beta: number, media: readonly Medium[]): Point[] {
  const points: Point[] = [from];
  let [x, y] = from;
  for (const { height, index } of media) {
    const sine = beta / Math.max(1, index);
    const across = Math.abs(sine) < 1 ? (height * sine) / Math.sqrt(1 - sine * sine) : Math.sign(sine) * MOST;
    x += Math.max(-MOST, Math.min(MOST, across));
    y += height;
    points.push([x, y]);
  }
  return points;
}

/** The index of materials that are given by name, for the drawing only. */
const NAMED: Record<string, number> = { air: 1, water: 1.333, SiO2: 1.458, BK7: 1.517, MgF2: 1.378 };
const USUAL = 1.5;

/** Returns the index of a layer's medium. */
export function indexOf(fields: Json, path: string): number {
  const index = at(fields, `${path}.index`);
  if (typeof index === "number") return index;
  if (isTable(index)) return Number(index["n"] ?? USUAL);
  return typeof index === "string" ? (NAMED[index] ?? USUAL) : USUAL;
}

/** Returns the outline of a lobe below a point; the radius is proportional to the relative radiance. */
export function lobePath(
  [x, y]: Point,
  { theta_deg: theta, relative }: { theta_deg: readonly number[]; relative: readonly number[] },
  radius: number,
): string {
  const points = theta.map((angle, i) => {
    const [r, t] = [radius * relative[i]!, (angle * Math.PI) / 180];
    return `L${(x + r * Math.sin(t)).toFixed(2)} ${(y + r * Math.cos(t)).toFixed(2)}`;
  });
  return `M${x.toFixed(2)} ${y.toFixed(2)}${points.join("")}Z`;
}
