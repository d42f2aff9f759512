// A metric over two keys as a map: dark cells are low, bright cells are high. The value at the pointer is shown; a click
// selects a point.

import { useSignal } from "@preact/signals";
import type { Ref } from "preact";

import { digits } from "../model/format.ts";
import { ticks } from "./axis.ts";

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
  /** The values on both axes as text. */
  xs: readonly string[];
  ys: readonly string[];
  xName: string;
  yName: string;
  /** The name of the metric, with its unit. */
  name: string;
  /** Values by row (y), then column (x). */
  values: readonly (readonly (number | null)[])[];
  /** The selected and the best point: column and row. */
  selected: readonly [number, number] | null;
  best: readonly [number, number] | null;
  pick: (column: number, row: number) => void;
  drawing?: Ref<SVGSVGElement>;
}

const WIDTH = 560;
const HEIGHT = 300;
const LEFT = 74;
const TOP = 26;
const BAR = LEFT + WIDTH + 18;

function ColourBar({ low, high, name }: { low: number; high: number; name: string }) {
  const at = (value: number) => TOP + HEIGHT * (1 - (high > low ? (value - low) / (high - low) : 0.5));
  return (
    <g>
      <text x={BAR + 96} y={TOP - 11} text-anchor="end">
        {name}
      </text>
      {Array.from({ length: 32 }, (_, i) => (
        <rect
          key={i}
          x={BAR}
          y={TOP + HEIGHT - ((i + 1) * HEIGHT) / 32}
          width="14"
          height={HEIGHT / 32 + 0.3}
          fill={ramp((i + 0.5) / 32)}
        />
      ))}
      {(high > low ? ticks(low, high, 6) : [low]).map((value) => (
        <g key={value}>
          <path class="axis" d={`M${BAR + 14} ${at(value)}h5`} />
          <text x={BAR + 23} y={at(value) + 4}>
            {digits(value, 4)
              .replace(/(\.\d*?)0+$/, "$1")
              .replace(/\.$/, "")}
          </text>
        </g>
      ))}
    </g>
  );
}

export function Map({ xs, ys, xName, yName, name, values, selected, best, pick, drawing }: Props) {
  const under = useSignal<readonly [number, number] | null>(null);
  const all = values.flat().filter((value) => value !== null);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const [w, h] = [WIDTH / xs.length, HEIGHT / ys.length];
  const at = under.value;
  const every = (count: number) => Math.ceil(count / 7);
  const cell = (place: readonly [number, number], kind: string) => (
    <rect class={kind} x={LEFT + place[0] * w} y={TOP + HEIGHT - (place[1] + 1) * h} width={w} height={h} />
  );
  return (
    <div class="map-plot">
      <svg
        ref={drawing}
        viewBox={`0 0 ${BAR + 100} ${TOP + HEIGHT + 44}`}
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
                data-cell={`${i} ${j}`}
                onPointerEnter={() => (under.value = [i, j])}
                onClick={() => pick(i, j)}
              />
            ),
          ),
        )}
        {best && cell(best, "cell best")}
        {selected && cell(selected, "cell selected")}
        {at && cell(at, "cell")}
        {xs.map(
          (x, i) =>
            i % every(xs.length) === 0 && (
              <text key={i} x={LEFT + (i + 0.5) * w} y={TOP + HEIGHT + 16} text-anchor="middle">
                {x}
              </text>
            ),
        )}
        {ys.map(
          (y, j) =>
            j % every(ys.length) === 0 && (
              <text key={j} x={LEFT - 7} y={TOP + HEIGHT - (j + 0.5) * h + 4} text-anchor="end">
                {y}
              </text>
            ),
        )}
        <text x={LEFT + WIDTH / 2} y={TOP + HEIGHT + 37} text-anchor="middle">
          {xName}
        </text>
        <text transform={`translate(12 ${TOP + HEIGHT / 2}) rotate(-90)`} text-anchor="middle">
          {yName}
        </text>
        <ColourBar low={low} high={high} name={name} />
      </svg>
      <output>
        {at
          ? `${xName} ${xs[at[0]]}, ${yName} ${ys[at[1]]}: ${digits(values[at[1]]?.[at[0]], 5)}`
          : "move the pointer over the map to read values; click to select a point"}
      </output>
    </div>
  );
}
