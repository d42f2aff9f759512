// Positions for the names of points, so that names overlap neither each other nor other points.

export interface Named {
  readonly name: string;
  readonly x: number;
  readonly y: number;
}

/** Returns the distance of a point from a box. */
const from = ({ left, right, top, bottom }: Box, { x, y }: Named): number =>
  Math.hypot(Math.max(left - x, 0, x - right), Math.max(top - y, 0, y - bottom));

/** Returns true if the middle or the end of a leader line is inside a box. */
const within = (
  { left, right, top, bottom }: Box,
  [x0, y0, x1, y1]: readonly [number, number, number, number],
): boolean =>
  [0.35, 0.7, 1].some((t) => {
    const [x, y] = [x0 + t * (x1 - x0), y0 + t * (y1 - y0)];
    return x > left && x < right && y > top && y < bottom;
  });

export interface Placed extends Named {
  readonly anchor: "start" | "end" | "middle";
  /** A leader line from the point, if the name is far from it. */
  readonly from: readonly [number, number, number, number] | null;
}

export interface Box {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/** Width of a character at the normal size, px of the drawing. */
export const LETTER = 6.3;
const overlap = (a: Box, b: Box): number =>
  Math.max(0, Math.min(a.right, b.right) - Math.max(a.left, b.left)) *
  Math.max(0, Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));

/** Returns the position of a name at a distance in one of eight directions. */
function candidate(point: Named, angle: number, distance: number, size: number): { placed: Placed; box: Box } {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const [px, py] = [point.x + distance * c, point.y + distance * s];
  const width = LETTER * size * point.name.length;
  const half = 8 * size;
  const anchor = c > 0.4 ? "start" : c < -0.4 ? "end" : "middle";
  const left = anchor === "start" ? px : anchor === "end" ? px - width : px - width / 2;
  const leader =
    distance > 14
      ? ([point.x + 7 * c, point.y + 7 * s, point.x + (distance - 3) * c, point.y + (distance - 3) * s] as const)
      : null;
  return {
    placed: { name: point.name, x: px, y: py + 4 + 3 * s, anchor, from: leader },
    box: { left, right: left + width, top: py - half + 3 * s, bottom: py + half + 3 * s },
  };
}

/** Returns positions for the names, for text of `size` times the normal size, inside a drawing of this width and height, beside other text. */
export function placed(points: readonly Named[], size: number, [width, height]: readonly [number, number], others: readonly Box[] = []): Placed[] {
  const marks: Box[] = points.map(({ x, y }) => ({ left: x - 7, right: x + 7, top: y - 7, bottom: y + 7 }));
  const taken: Box[] = [...others];
  return points.map((point) => {
    let best: { placed: Placed; box: Box; cost: number } | null = null;
    for (const distance of [10, 10 + 12 * size, 10 + 24 * size]) {
      for (let turn = 0; turn < 8; turn++) {
        const one = candidate(point, (turn * Math.PI) / 4, distance, size);
        const crowd = [...marks, ...taken].reduce((sum, box) => sum + overlap(one.box, box), 0);
        const leader = marks.reduce((sum, box) => sum + (one.placed.from && within(box, one.placed.from) ? 60 : 0), 0);
        const astray = points.some((other) => other !== point && from(one.box, other) < from(one.box, point)) ? 80 : 0;
        const cost =
          crowd * 10 +
          leader +
          astray +
          distance +
          (turn === 0 ? 0 : turn === 4 ? 1 : 2) +
          (one.box.left < 60 || one.box.top < 0 || one.box.right > width || one.box.bottom > height ? 200 : 0);
        if (!best || cost < best.cost) best = { ...one, cost };
      }
    }
    taken.push(best!.box);
    return best!.placed;
  });
}
