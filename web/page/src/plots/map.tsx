// A metric over two keys as a map: dark cells are low, bright cells are high; the value at the pointer is shown.

import { useSignal } from "@preact/signals";

import { digits } from "../model/format.ts";

const STOPS = [
  [68, 1, 84],
  [59, 82, 139],
  [33, 145, 140],
  [94, 190, 90],
  [224, 186, 28],
] as const;

/** Returns the colour at position `t` of the scale from dark violet through green to yellow, as on the command line. */
function ramp(t: number): string {
  const at = Math.min(1, Math.max(0, t)) * (STOPS.length - 1);
  const left = Math.min(Math.floor(at), STOPS.length - 2);
  return `rgb(${[0, 1, 2].map((i) => Math.round(STOPS[left]![i]! * (1 - at + left) + STOPS[left + 1]![i]! * (at - left))).join(" ")})`;
}

interface Props {
  xs: readonly number[];
  ys: readonly number[];
  xName: string;
  yName: string;
  name: string;
  /** Values by row (y), then column (x). */
  values: readonly (readonly (number | null)[])[];
}

const WIDTH = 560;
const HEIGHT = 300;
const LEFT = 64;
const TOP = 8;

export function Map({ xs, ys, xName, yName, name, values }: Props) {
  const under = useSignal<readonly [number, number] | null>(null);
  const all = values.flat().filter((value) => value !== null);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const [w, h] = [WIDTH / xs.length, HEIGHT / ys.length];
  const at = under.value;
  const every = (count: number) => Math.ceil(count / 7);
  return (
    <div class="map-plot">
      <svg
        viewBox={`0 0 ${LEFT + WIDTH + 90} ${TOP + HEIGHT + 44}`}
        role="img"
        aria-label={`${name} over ${xName} and ${yName}, from ${digits(low, 3)} to ${digits(high, 3)}`}
        onPointerLeave={() => (under.value = null)}
      >
        {values.flatMap((row, j) =>
          row.map((value, i) =>
            value === null ? null : (
              <rect
                key={`${i} ${j}`}
                x={LEFT + i * w}
                y={TOP + HEIGHT - (j + 1) * h}
                width={w + 0.3}
                height={h + 0.3}
                fill={ramp(high > low ? (value - low) / (high - low) : 0.5)}
                onPointerEnter={() => (under.value = [i, j])}
              />
            ),
          ),
        )}
        {at && <rect class="cell" x={LEFT + at[0] * w} y={TOP + HEIGHT - (at[1] + 1) * h} width={w} height={h} />}
        {xs.map(
          (x, i) =>
            i % every(xs.length) === 0 && (
              <text key={i} x={LEFT + (i + 0.5) * w} y={TOP + HEIGHT + 16} text-anchor="middle">
                {digits(x, 3)}
              </text>
            ),
        )}
        {ys.map(
          (y, j) =>
            j % every(ys.length) === 0 && (
              <text key={j} x={LEFT - 7} y={TOP + HEIGHT - (j + 0.5) * h + 4} text-anchor="end">
                {digits(y, 3)}
              </text>
            ),
        )}
        <text x={LEFT + WIDTH / 2} y={TOP + HEIGHT + 37} text-anchor="middle">
          {xName}
        </text>
        <text transform={`translate(12 ${TOP + HEIGHT / 2}) rotate(-90)`} text-anchor="middle">
          {yName}
        </text>
        {Array.from({ length: 20 }, (_, i) => (
          <rect
            key={i}
            x={LEFT + WIDTH + 18}
            y={TOP + HEIGHT - ((i + 1) * HEIGHT) / 20}
            width="14"
            height={HEIGHT / 20 + 0.3}
            fill={ramp((i + 0.5) / 20)}
          />
        ))}
        {[0, 0.5, 1].map((t) => (
          <text key={t} x={LEFT + WIDTH + 38} y={TOP + HEIGHT * (1 - t) + (t === 1 ? 10 : t === 0 ? 0 : 4)}>
            {digits(low + t * (high - low), 3)}
          </text>
        ))}
      </svg>
      <output>
        {at
          ? `${xName} ${digits(xs[at[0]], 4)}, ${yName} ${digits(ys[at[1]], 4)}: ${digits(values[at[1]]?.[at[0]], 5)}`
          : name}
      </output>
    </div>
  );
}
