// A sweep, as by `papilio sweep`: a metric over one key as a curve, over two keys as a map.

import type { SweepPoint } from "../api/types.ts";
import { useSignal } from "@preact/signals";

import { digits } from "../model/format.ts";
import { label, unit } from "../model/schema.ts";
import { split } from "../model/json.ts";
import { Curves } from "../plots/curves.tsx";
import { Map } from "../plots/map.tsx";
import { edit } from "../state/live.ts";
import {
  asEdits,
  axes,
  axisFor,
  keys,
  metric,
  points,
  run,
  sweep,
  swept,
  valuesOf,
  type Axis,
} from "../state/sweep.ts";
import { dark } from "../state/theme.ts";
import { Problems } from "./problems.tsx";
import { selected, states } from "../state/design.ts";

const METRICS = ["gamut_percent_srgb", "contrast_ratio", "gamut_percent_ebu", "text_contrast", "text_luminance_cd_m2"];
const OF_STATES = ["Y", "L_star", "u_prime", "v_prime", "peak_nm"];
const FINE = 21;
const COARSE = 11;

/** Returns the label of a key with its unit. */
export function nameOf(path: string): string {
  const [parent, key] = split(path);
  const u = unit(/^\w+$/.test(key) && unit(key) ? key : split(parent)[1]);
  return `${label(key)}${u ? ` (${u})` : ""}`;
}

function put(index: number, axis: Axis): void {
  axes.value = axes.value.map((one, i) => (i === index ? axis : one));
}

/** Maximum number of points on an axis of the page; `papilio sweep` allows more. */
const MOST = 101;

function AxisFields({ axis, index }: { axis: Axis; index: number }) {
  const wrong = useSignal("");
  const take = (key: "from" | "to" | "count", typed: string) => {
    const value = Number(typed.replace(",", "."));
    const counts = key !== "count" || (Number.isInteger(value) && value >= 2 && value <= MOST);
    const right = typed.trim() !== "" && Number.isFinite(value) && counts;
    wrong.value = right
      ? ""
      : `“${typed}”: ${key} must be ${key === "count" ? `an integer from 2 to ${MOST}` : "a number"}`;
    if (right) put(index, { ...axis, [key]: value });
  };
  const number = (key: "from" | "to" | "count") => (
    <label>
      {key} <input inputMode="decimal" value={axis[key]} onChange={(event) => take(key, event.currentTarget.value)} />
    </label>
  );
  return (
    <div class="controls axis">
      <select
        aria-label={`Key of axis ${index + 1}`}
        value={axis.path}
        onChange={(event) => put(index, axisFor(event.currentTarget.value, axis.count))}
      >
        {keys.value.map((path) => (
          <option key={path} value={path}>
            {path}
          </option>
        ))}
      </select>
      {number("from")}
      {number("to")}
      {number("count")}
      <button
        type="button"
        onClick={() => (axes.value = axes.value.filter((_, i) => i !== index))}
        aria-label={`Remove axis ${index + 1}`}
      >
        Remove
      </button>
      {wrong.value && (
        <p class="error" role="alert">
          {wrong.value}
        </p>
      )}
    </div>
  );
}

/** Adds an axis: a key of the part that is selected in the drawing, if it has one. */
function addAxis(): void {
  const taken = axes.value.map(({ path }) => path);
  const free = keys.value.filter((path) => !taken.includes(path));
  const near = free.find((path) => path.startsWith(selected.value) && !/straight|phi|fill/.test(path)) ?? free[0];
  const count = axes.value.length === 0 ? FINE : COARSE;
  if (near)
    axes.value = [
      ...axes.value.map((axis) => ({ ...axis, count: Math.min(axis.count, axes.value.length ? COARSE : FINE) })),
      axisFor(near, count),
    ];
}

function Plot() {
  const [first, second] = swept.value;
  if (!first || points.value.length === 0) return null;
  const by = new globalThis.Map(points.value.map((point) => [point.index, point.metrics[metric.value] ?? null]));
  const name = metric.value;
  if (!second) {
    const x = valuesOf(first);
    const curve = {
      name,
      values: x.map((_, i) => by.get(i) ?? null),
      colour: dark.value ? "#7da4f2" : "#2b5fc7",
      dash: [],
      width: 2,
    };
    return (
      <Curves
        x={x}
        curves={[curve]}
        xName={nameOf(first.path)}
        yName={name}
        height={300}
        label={`${name} against ${first.path}`}
      />
    );
  }
  const [ys, xs] = [valuesOf(first), valuesOf(second)];
  return (
    <Map
      xs={xs}
      ys={ys}
      xName={nameOf(second.path)}
      yName={nameOf(first.path)}
      name={name}
      values={ys.map((_, j) => xs.map((__, i) => by.get(j * xs.length + i) ?? null))}
    />
  );
}

export function SweepPanel() {
  if (axes.value.length === 0) addAxis();
  const end = points.value.reduce<SweepPoint | null>(
    (last, point) => (last && last.index > point.index ? last : point),
    null,
  );
  const running = sweep.phase.value === "running";
  const total = axes.value.reduce((product, { count }) => product * count, 1);
  return (
    <>
      {axes.value.map((axis, i) => (
        <AxisFields key={i} axis={axis} index={i} />
      ))}
      <div class="controls">
        {axes.value.length < 2 && (
          <button type="button" onClick={addAxis}>
            Add a second key
          </button>
        )}
        <label for="sweep-metric">Metric</label>
        <select id="sweep-metric" value={metric.value} onChange={(event) => (metric.value = event.currentTarget.value)}>
          {[...METRICS, ...states.value.flatMap(([name]) => OF_STATES.map((of) => `${name}.${of}`))].map((one) => (
            <option key={one} value={one}>
              {one}
            </option>
          ))}
        </select>
        {running ? (
          <button type="button" onClick={sweep.cancel}>
            Cancel
          </button>
        ) : (
          <button type="button" class="run" onClick={() => void run()}>
            Sweep {total} points
          </button>
        )}
        <progress max={total} value={points.value.length} aria-label="Progress of the sweep" />
        <span role="status" data-phase={sweep.phase.value}>
          {running
            ? `${points.value.length} of ${total}`
            : sweep.phase.value === "done"
              ? `${points.value.length} points, done`
              : ""}
        </span>
        <button
          type="button"
          onClick={() => edit(asEdits())}
          title="Write this sweep to the scenario, for `papilio sweep FILE`"
        >
          Add to the scenario
        </button>
      </div>
      <Problems of={sweep.problems.value} />
      <Plot />
      {end && (
        <p class="remark">
          {points.value.length} points; value at the last point: {digits(end.metrics[metric.value], 4)}.
        </p>
      )}
    </>
  );
}
