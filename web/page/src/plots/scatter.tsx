// Points of two quantities, some of which are selected by a click: the Pareto front of a search.

import { plain } from "../model/format.ts";
import { nice, ticks } from "./axis.ts";

export interface Dot {
  readonly x: number;
  readonly y: number;
  /** "front": can be selected; "found": another design; "own": that of the scenario. */
  readonly kind: "front" | "found" | "own";
  /** The index that a click selects. */
  readonly index?: number;
  readonly title: string;
}

interface Props {
  dots: readonly Dot[];
  xName: string;
  yName: string;
  label: string;
  selected: number | null;
  pick: (index: number) => void;
}

const [WIDTH, HEIGHT] = [640, 360];
const [LEFT, RIGHT, TOP, BOTTOM] = [66, 14, 12, 44];

export function Scatter({ dots, xName, yName, label, selected, pick }: Props) {
  if (dots.length === 0) return null;
  const range = (of: (dot: Dot) => number) => nice(Math.min(...dots.map(of)), Math.max(...dots.map(of)));
  const [[x0, x1], [y0, y1]] = [range((dot) => dot.x), range((dot) => dot.y)];
  const x = (value: number) => LEFT + ((WIDTH - LEFT - RIGHT) * (value - x0)) / (x1 - x0 || 1);
  const y = (value: number) => HEIGHT - BOTTOM - ((HEIGHT - TOP - BOTTOM) * (value - y0)) / (y1 - y0 || 1);
  const front = dots.filter(({ kind }) => kind === "front").sort((a, b) => a.x - b.x);
  return (
    <svg class="scatter" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="group" aria-label={label}>
      {ticks(x0, x1).map((value) => (
        <g key={value}>
          <path class="grid" d={`M${x(value)} ${TOP}V${HEIGHT - BOTTOM}`} />
          <text x={x(value)} y={HEIGHT - BOTTOM + 16} text-anchor="middle">
            {plain(value, 5)}
          </text>
        </g>
      ))}
      {ticks(y0, y1).map((value) => (
        <g key={value}>
          <path class="grid" d={`M${LEFT} ${y(value)}H${WIDTH - RIGHT}`} />
          <text x={LEFT - 7} y={y(value) + 4} text-anchor="end">
            {plain(value, 5)}
          </text>
        </g>
      ))}
      <text x={(LEFT + WIDTH - RIGHT) / 2} y={HEIGHT - 8} text-anchor="middle">
        {xName}
      </text>
      <text transform={`translate(14 ${(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)`} text-anchor="middle">
        {yName}
      </text>
      {front.length > 1 && <path class="front" d={`M${front.map((dot) => `${x(dot.x)} ${y(dot.y)}`).join("L")}`} />}
      {dots.map((dot, i) =>
        dot.kind === "front" ? (
          <circle
            key={i}
            class={dot.index === selected ? "dot front-dot chosen" : "dot front-dot"}
            cx={x(dot.x)}
            cy={y(dot.y)}
            r={dot.index === selected ? 8 : 6}
            role="button"
            tabindex={0}
            aria-label={dot.title}
            aria-pressed={dot.index === selected}
            data-design={dot.index}
            onClick={() => pick(dot.index!)}
            onKeyDown={(event) => (event.key === "Enter" || event.key === " ") && (event.preventDefault(), pick(dot.index!))}
          >
            <title>{dot.title}</title>
          </circle>
        ) : dot.kind === "own" ? (
          <path key={i} class="dot own-dot" d={`M${x(dot.x) - 7} ${y(dot.y)}h14m-7 -7v14`}>
            <title>{dot.title}</title>
          </path>
        ) : (
          <circle key={i} class="dot" cx={x(dot.x)} cy={y(dot.y)} r="3">
            <title>{dot.title}</title>
          </circle>
        ),
      )}
    </svg>
  );
}
