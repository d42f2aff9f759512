// The regular ray of the first source and the line of sight through the layers, and the lobes of the diffusers at their
// real width. Angles are those of the media; thicknesses are not to scale.

import { at, listAt, numberAt } from "../model/json.ts";
import { indexOf, lobePath, ray, type Medium, type Point } from "../model/rays.ts";
import type { Layer } from "../model/stack.ts";
import { answer, fields, view } from "../state/design.ts";

/** Radius of a lobe at its maximum, px of the drawing. */
const RADIUS = 72;

/** Layers above the first medium are in air. */
const SCATTERS = ["diffuser", "rough"];

const line = (points: readonly Point[]): string =>
  points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`).join("");

/** Returns the direction cosine of propagation, along the plane of the drawing, of light from a direction. */
const betaFrom = (theta: number, phi: number): number =>
  -Math.sin((theta * Math.PI) / 180) * Math.cos((phi * Math.PI) / 180);

/** Returns the index in which a ray crosses the band of each layer: an interface belongs to the medium below it. */
function indices(stack: readonly Layer[]): number[] {
  const all = fields.value;
  let below = 1;
  const from = [...stack].reverse().map((layer) => {
    const isMedium = layer.look === "medium" || layer.look === "slab";
    if (isMedium) below = indexOf(all, layer.path);
    return layer.path.startsWith("display.front") || layer.look === "guide" ? 1 : below;
  });
  const found = from.reverse();
  // A component belongs to the medium above it.
  return found.map((index, i) => {
    if (stack[i]!.look !== "component") return index;
    const above = stack.slice(0, i).findLastIndex(({ look }) => look === "medium" || look === "slab");
    return above < 0 ? 1 : found[above]!;
  });
}

interface Props {
  stack: readonly Layer[];
  /** Heights of the bands, including the gap below each. */
  heights: readonly number[];
  /** The point at which light enters the first layer. */
  from: Point;
  /** Heights of the films, and depth of the gap at a place. */
  pixel: readonly Medium[];
  right: number;
  left: number;
}

export function Rays({ stack, heights, from, pixel, left, right }: Props) {
  const all = fields.value;
  const n = indices(stack);
  const media: Medium[] = [...stack.map((_, i) => ({ height: heights[i]!, index: n[i]! })), ...pixel];
  const source = listAt(all, "lighting.directed")[0];
  const light =
    source === undefined
      ? null
      : ray(from, betaFrom(numberAt(source, "theta_deg") ?? 0, numberAt(source, "phi_deg") ?? 0), media);
  const now = view.value;
  const sight = now && ray(from, betaFrom(now.theta_deg, now.phi_deg ?? 0), media);
  const scatterers = stack.flatMap((layer, i) =>
    SCATTERS.includes(layer.look) && at(all, layer.path) !== undefined ? [i] : [],
  );
  // The reflected part of the regular ray: back up with the mirrored direction.
  const back = light && [...light].reverse().map(([x, y]): Point => [2 * light.at(-1)![0] - x, y]);
  const normal = ray(from, 0, media);
  return (
    <g class="rays" aria-hidden="true" clip-path="url(#inside)">
      <defs>
        <clipPath id="inside">
          <rect x={left} y="0" width={right - left} height="2000" />
        </clipPath>
      </defs>
      {(answer.value?.lobes ?? []).map((lobe) => {
        const i = scatterers[lobe.number];
        const origin = i === undefined ? undefined : (light ?? normal)[i + 1];
        return origin && <path key={lobe.number} class="lobe" d={lobePath(origin, lobe, RADIUS)} />;
      })}
      {light && <path class="ray" d={line(light)} />}
      {back && <path class="ray back" d={line(back)} />}
      {sight && <path class="ray sight-ray" d={line(sight)} />}
    </g>
  );
}
