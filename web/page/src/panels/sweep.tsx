// A sweep, as by `papilio sweep`: that of the scenario, or one that is set up here. A metric over one key is drawn as a
// curve, over two keys as a map; further axes are chosen by their values. A point is selected with a click and applied to
// the design with a button.

import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import type { SweepPoint } from "../api/types.ts";
import { lengthOf, placeOf, pointAt, pointsOf, shown, type Axis } from "../model/axes.ts";
import type { Rows } from "../model/csv.ts";
import { digits } from "../model/format.ts";
import { curvesSvg } from "../plots/curves-svg.ts";
import { Curves, type Plot } from "../plots/curves.tsx";
import { Drawn } from "../plots/figure.tsx";
import { Map as Field } from "../plots/map.tsx";
import { svgOf } from "../plots/picture.ts";
import { states } from "../state/design.ts";
import {
  age,
  apply,
  axes,
  done,
  isOfFile,
  keep,
  metric,
  ofFile,
  own,
  points,
  run,
  runAsJob,
  selectedPoint,
  showMetric,
  sweep,
  swept,
} from "../state/sweep.ts";
import { labelOf, labelText } from "../state/labels.ts";
import { ofPixels } from "../state/metrics.ts";
import { dark } from "../state/theme.ts";
import { Aged } from "./aged.tsx";
import { addAxis, AxesFields } from "./axes.tsx";
import { AsJob } from "./jobs.tsx";
import { Downloads } from "./downloads.tsx";
import { MetricPicker } from "./metric-picker.tsx";
import { Problems } from "./problems.tsx";

const METRICS = ["gamut_percent_srgb", "contrast_ratio", "gamut_percent_ebu", "text_contrast", "text_luminance_cd_m2"];
const OF_STATES = ["Y", "L_star", "u_prime", "v_prime", "peak_nm"];

/** False for the error of a metric. */
const isValue = (name: string): boolean => !/_(de|se)$/.test(name);

/**
 * Returns the metrics to choose from: all that the points have, or the usual ones before there are points of all metrics of
 * colours; and those of pixels.
 */
function metricsNow(): string[] {
  const computed = points.value[0]?.metrics;
  const known = computed && "contrast_ratio" in computed ? computed : undefined;
  const usual = [...METRICS, ...states.value.flatMap(([name]) => OF_STATES.map((of) => `${name}.${of}`))];
  const all = known
    ? Object.keys(known).filter(
        (name) =>
          isValue(name) && (name.includes(".") || METRICS.includes(name) || !OF_STATES.includes(name)),
      )
    : usual;
  const first = usual.filter((name) => all.includes(name));
  return [...new Set([...first, ...all, ...Object.keys(computed ?? {}).filter(isValue), ...ofPixels(), metric.value])];
}

const valueOf = (point: SweepPoint | undefined): number | null => point?.metrics[metric.value] ?? null;

/** Returns the point with the highest or the lowest value of the metric. */
function extreme(isLow: boolean): SweepPoint | null {
  return points.value.reduce<SweepPoint | null>((best, point) => {
    const [value, most] = [valueOf(point), best && valueOf(best)];
    if (value === null) return best;
    return most === null || (isLow ? value < most : value > most) ? point : best;
  }, null);
}

/** Returns the values of a point in words. */
const inWords = (point: SweepPoint): string =>
  Object.entries(point.values)
    .map(
      ([path, value]) => `${labelText(path)} ${typeof value === "number" ? digits(value, 5) : shown(value as never)}`,
    )
    .join(", ");

/** A point with its value, and a button that applies it to the design. */
function Chosen({ name, point }: { name: string; point: SweepPoint }) {
  return (
    <p class="chosen-point">
      <b>
        {name}: {labelOf(metric.value).quantity} {digits(valueOf(point), 5)} {labelOf(metric.value).unit}
      </b>{" "}
      at {inWords(point)}{" "}
      <button type="button" onClick={() => apply(point)}>
        Apply to the design
      </button>
    </p>
  );
}

/** All computed points: the keys, and the metric. */
const table = (): Rows => [
  ["point", ...swept.value.flat().map(({ path }) => path), metric.value],
  ...points.value.map((point) => [
    point.index,
    ...swept.value.flat().map(({ path }) => shown(point.values[path] as never)),
    valueOf(point),
  ]),
];

/** The values of the axes that are not drawn. */
function Slices({ at, put }: { at: readonly number[]; put: (axis: number, value: number) => void }) {
  return (
    <div class="controls">
      {swept.value.slice(0, -2).map((axis, i) => (
        <label key={i}>
          {labelText(axis[0]!.path)}{" "}
          <select value={String(at[i] ?? 0)} onChange={(event) => put(i, Number(event.currentTarget.value))}>
            {axis[0]!.values.map((value, k) => (
              <option key={k} value={String(k)}>
                {shown(value)}
              </option>
            ))}
          </select>
        </label>
      ))}
    </div>
  );
}

/** The name of an axis: its first key, and the number of keys that change with it. */
const axisName = (axis: Axis): string =>
  labelText(axis[0]!.path) + (axis.length > 1 ? ` and ${axis.length - 1} more` : "");

/** The words on an axis: the values of its first key. */
const words = (axis: Axis): string[] =>
  axis[0]!.values.map((value) =>
    typeof value === "number"
      ? digits(value, 4)
          .replace(/(\.\d*?)0+$/, "$1")
          .replace(/\.$/, "")
      : shown(value),
  );

function Line({ axis, best }: { axis: Axis; best: SweepPoint | null }) {
  const by = new Map(points.value.map((point) => [point.index, point]));
  const first = axis[0]!;
  const isNumeric = first.values.every((value) => typeof value === "number");
  const curve = {
    name: labelText(metric.value),
    values: first.values.map((_, i) => valueOf(by.get(i))),
    colour: dark.value ? "#7da4f2" : "#2b5fc7",
    dash: [],
    width: 2,
  };
  const plot: Plot = {
    x: isNumeric ? (first.values as number[]) : first.values.map((_, i) => i),
    curves: [curve],
    xName: axisName(axis),
    yName: labelText(metric.value),
    xLog: first.spacing === "log",
    ...(isNumeric ? {} : { xWords: words(axis) }),
  };
  const chosen = selectedPoint.value;
  return (
    <>
      <p class="figure-tools">
        <Downloads name="sweep" svg={() => curvesSvg(plot)} table={() => done.value?.csv ?? table()} />
      </p>
      <Curves
        {...plot}
        height={280}
        label={`${labelText(metric.value)} against ${first.path}`}
        pick={(index) => (selectedPoint.value = index)}
        dots={[...(chosen === null ? [] : [chosen]), ...(best ? [best.index] : [])]}
      />
    </>
  );
}

function Plane({ best }: { best: SweepPoint | null }) {
  const drawing = useRef<SVGSVGElement>(null);
  const slice = useSignal<readonly number[]>([]);
  const all = swept.value;
  const lengths = all.map(lengthOf);
  const [first, second] = [all.at(-2)!, all.at(-1)!];
  const others = all.slice(0, -2).map((_, i) => Math.min(slice.value[i] ?? 0, lengths[i]! - 1));
  const by = new Map(points.value.map((point) => [point.index, point]));
  const at = (column: number, row: number) => pointAt(lengths, [...others, row, column]);
  const place = (index: number | null): readonly [number, number] | null => {
    if (index === null) return null;
    const [column, row, ...rest] = placeOf(lengths, index).reverse() as [number, number, ...number[]];
    return rest.reverse().every((value, i) => value === others[i]) ? [column, row] : null;
  };
  const put = (axis: number, value: number) => (slice.value = others.map((old, i) => (i === axis ? value : old)));
  return (
    <>
      {others.length > 0 && <Slices at={others} put={put} />}
      <p class="figure-tools">
        <Downloads name="sweep" svg={() => svgOf(drawing.current!)} table={() => done.value?.csv ?? table()} />
      </p>
      <Field
        drawing={drawing}
        xs={words(second)}
        ys={words(first)}
        xName={axisName(second)}
        yName={axisName(first)}
        name={labelText(metric.value)}
        values={first[0]!.values.map((_, j) => second[0]!.values.map((__, i) => valueOf(by.get(at(i, j)))))}
        selected={place(selectedPoint.value)}
        best={place(best?.index ?? null)}
        pick={(column, row) => (selectedPoint.value = at(column, row))}
      />
    </>
  );
}

function Result() {
  const isLow = useSignal(false);
  const axis = swept.value[0];
  if (!axis || points.value.length === 0) return null;
  if (points.value.every((point) => !(metric.value in point.metrics)))
    return <p class="remark">This sweep has not computed this metric: start it again.</p>;
  const best = extreme(isLow.value);
  const chosen = points.value.find((point) => point.index === selectedPoint.value);
  const last = points.value.reduce((end, point) => (point.index > end.index ? point : end));
  return (
    <Aged age={age.value}>
      {swept.value.length === 1 ? <Line axis={axis} best={best} /> : <Plane best={best} />}
      <div class="controls">
        <label for="sweep-best">Best point</label>
        <select
          id="sweep-best"
          value={isLow.value ? "lowest" : "highest"}
          onChange={(event) => (isLow.value = event.currentTarget.value === "lowest")}
        >
          <option value="highest">highest</option>
          <option value="lowest">lowest</option>
        </select>
        <span class="remark">a ring in the plot; a click on the plot selects another point</span>
      </div>
      {best && <Chosen name={isLow.value ? "Lowest" : "Highest"} point={best} />}
      {chosen && chosen !== best && <Chosen name="Selected" point={chosen} />}
      <p class="remark">
        {points.value.length} points; value at the last point: {digits(valueOf(last), 4)} {labelOf(metric.value).unit}.
      </p>
      {done.value?.warnings.map((warning) => (
        <p class="remark warning" key={warning}>
          Warning: {warning}
        </p>
      ))}
      {(done.value?.figures.length ?? 0) > 0 && (
        <details>
          <summary>Figures as on the command line</summary>
          {done.value!.figures.map(({ name, svg }) => (
            <Drawn key={name} name={name} svg={svg} label={name.replaceAll("_", " ")} />
          ))}
        </details>
      )}
    </Aged>
  );
}

export function SweepPanel() {
  useEffect(() => {
    if (axes.value.length === 0) addAxis();
  }, []);
  const running = sweep.phase.value === "running";
  const total = pointsOf(axes.value);
  return (
    <div class="sweep">
      <div class="sweep-setup">
        {ofFile.value !== null && (
          <div class="controls">
            <span role="status">
              {isOfFile.value
                ? "The sweep of the scenario, [sweep]."
                : "A changed sweep; the scenario has its own, [sweep]."}
            </span>
            {!isOfFile.value && (
              <button type="button" onClick={() => (own.value = null)}>
                Back to the scenario's sweep
              </button>
            )}
          </div>
        )}
        <div class="controls">
          <span>Metric</span>
          <MetricPicker id="sweep-metric" label="Metric" names={metricsNow()} chosen={metric.value} choose={showMetric} />
          {running ? (
            <button type="button" onClick={sweep.cancel}>
              Cancel
            </button>
          ) : (
            <button type="button" class="run" disabled={axes.value.length === 0} onClick={() => void run()}>
              Sweep {total} points
            </button>
          )}
          {axes.value.length > 0 && <AsJob start={runAsJob} />}
          <progress max={Math.max(1, total)} value={points.value.length} aria-label="Progress of the sweep" />
          <span role="status" data-phase={sweep.phase.value}>
            {running
              ? `${points.value.length} of ${pointsOf(swept.value)}`
              : sweep.phase.value === "done"
                ? `${points.value.length} points, done`
                : ""}
          </span>
          {!isOfFile.value && (
            <button type="button" onClick={keep} title="Write this sweep to the scenario, for `papilio sweep FILE`">
              {ofFile.value === null ? "Add to the scenario" : "Replace the scenario's sweep"}
            </button>
          )}
        </div>
        {age.value === "current" && <Problems of={sweep.problems.value} />}
        <AxesFields />
      </div>
      <div class="sweep-result">
        <Result />
      </div>
    </div>
  );
}
