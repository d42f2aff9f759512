// Curves over one variable (uPlot). The plot is created once and then updated; it is created again if the style changes.

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

import { plain } from "../model/format.ts";
import { dark } from "../state/theme.ts";
import { logTicks, nice, power } from "./axis.ts";

export interface Curve {
  readonly name: string;
  readonly values: readonly (number | null)[];
  readonly colour: string;
  readonly dash: readonly number[];
  readonly width: number;
}

/** The content of a plot, on the page and as a file. */
export interface Plot {
  x: readonly number[];
  curves: readonly Curve[];
  xName: string;
  /** The unit of the abscissa, which is at its last number in a low plot, instead of its name below. */
  xUnit?: string;
  yName: string;
  /** The same in a low plot. */
  yShort?: string;
  /** The range that the ordinate always includes. */
  range?: readonly [number, number];
  /** Whether both axes are logarithmic. */
  log?: boolean;
  /** Whether the abscissa alone is logarithmic. */
  xLog?: boolean;
  /** Names of the abscissas 0, 1, 2, … instead of numbers. */
  xWords?: readonly string[] | undefined;
}

interface Props extends Plot {
  /** Height in px; without it, the plot fills its box. */
  height?: number;
  label: string;
  /** Called with the index at the pointer, or null. */
  hover?: (index: number | null) => void;
  /** Called with the name of the curve at the pointer, or null. */
  near?: (curve: string | null) => void;
  /** Called with the index that is clicked. */
  pick?: (index: number) => void;
  /** The name of the curve that is highlighted; the others are faded. */
  focus?: string | null;
  /** A vertical line at this abscissa. */
  marked?: number | undefined;
  /** Indices of points of the first curve that are drawn as discs. */
  dots?: readonly number[];
}

type Own = uPlot & { marked?: number; dots?: readonly number[] };

const FONT = "12px Roboto, Helvetica, Arial, sans-serif";
const SMALL_FONT = "9.5px Roboto, Helvetica, Arial, sans-serif";
const ink = () => (dark.value ? "#b4b9c1" : "#555555");
const faint = () => (dark.value ? "#2b2f36" : "#ececec");
const accent = () => (dark.value ? "#7da4f2" : "#2b5fc7");

/** Distance from a curve within which it is at the pointer, px. */
const NEAR = 24;

/** The least height of a plot, also in layout.css, px. */
const LEAST = 84;

/** Returns the size of the plot in its box. */
const sizeIn = (box: HTMLElement, height: number | undefined) => ({
  width: box.clientWidth || 400,
  height: height ?? Math.max(LEAST, box.clientHeight),
});

/** Height of a plot below which the label of its ordinate is written smaller, so that it is not cut, px. */
const LOW = 180;

function axis(label: string, isLog: boolean, words?: readonly string[], unit?: string): uPlot.Axis {
  const shown = (split: number | null): string =>
    split === null ? "" : words ? (words[split] ?? "") : isLog ? power(split) : plain(split, 4);
  return {
    stroke: ink,
    grid: { stroke: faint, width: 1 },
    ticks: { stroke: faint, width: 1, size: 5 },
    font: FONT,
    labelFont: FONT,
    ...(unit ? {} : { label }),
    values: (_, splits) => splits.map((split, i) => (unit && i === splits.length - 1 ? `${shown(split)} ${unit}` : shown(split))),
    labelSize: 18,
    labelGap: 2,
    ...(isLog ? { splits: (_, __, low, high) => logTicks(low, high), filter: (_, splits) => splits } : {}),
    ...(words ? { splits: () => words.map((_, i) => i) } : {}),
  };
}

function options(props: Props, size: { width: number; height: number }): uPlot.Options {
  const logarithmic = { distr: 3 as const };
  const isLow = size.height < LOW;
  const unit = isLow ? props.xUnit : undefined;
  return {
    ...size,
    padding: [10, props.log ? 30 : 12, 0, 0],
    legend: { show: false },
    focus: { alpha: 0.22 },
    cursor: {
      y: false,
      points: { size: 7 },
      drag: { x: false, y: false },
      ...(props.near ? { focus: { prox: NEAR } } : {}),
    },
    scales: {
      x: { time: false, ...(props.log || props.xLog ? logarithmic : {}) },
      y: props.log
        ? logarithmic
        : {
            range: (_, low, high) =>
              nice(
                Math.min(low ?? 0, props.range?.[0] ?? Infinity),
                Math.max(high ?? 1, props.range?.[1] ?? -Infinity),
              ),
          },
    },
    axes: [
      { ...axis(props.xName, Boolean(props.log || props.xLog), props.xWords, unit), size: unit ? 24 : 30, space: 44 },
      { ...axis((isLow && props.yShort) || props.yName, Boolean(props.log)), size: 56, space: isLow ? 16 : 30, ...(isLow ? { labelFont: SMALL_FONT } : {}) },
    ],
    series: [
      {},
      ...props.curves.map((curve): uPlot.Series => ({
        label: curve.name,
        stroke: curve.colour,
        width: curve.width,
        dash: [...curve.dash],
        points: { show: false },
        spanGaps: false,
      })),
    ],
    hooks: {
      setCursor: [(plot) => props.hover?.(plot.cursor.idx ?? null)],
      setSeries: [(plot, index) => props.near?.(index === null ? null : String(plot.series[index]?.label ?? ""))],
      draw: [(plot) => mark(plot), (plot) => drawDots(plot)],
    },
  };
}

/** Draws a thin vertical line at the marked abscissa. */
function mark(plot: Own): void {
  const at = plot.marked;
  if (at === undefined) return;
  const x = plot.valToPos(at, "x", true);
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = ink();
  ctx.setLineDash([2, 3]);
  ctx.lineWidth = devicePixelRatio;
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}

/** Draws discs at points of the first curve; the first disc is filled. */
function drawDots(plot: Own): void {
  const { ctx } = plot;
  (plot.dots ?? []).forEach((index, i) => {
    const [x, y] = [plot.data[0][index], plot.data[1]?.[index]];
    if (typeof x !== "number" || typeof y !== "number") return;
    ctx.save();
    ctx.fillStyle = i === 0 ? accent() : "transparent";
    ctx.strokeStyle = accent();
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.beginPath();
    ctx.arc(plot.valToPos(x, "x", true), plot.valToPos(y, "y", true), 5 * devicePixelRatio, 0, 2 * Math.PI);
    ctx.fill();
    ctx.stroke();
    ctx.restore();
  });
}

export function Curves(props: Props) {
  const holder = useRef<HTMLDivElement>(null);
  const plot = useRef<Own | null>(null);
  const latest = useRef(props);
  latest.current = props;
  const look = JSON.stringify([
    dark.value,
    props.log,
    props.xLog,
    props.xWords,
    props.xName,
    props.yName,
    props.height,
    props.curves.map(({ name, colour, dash, width }) => [name, colour, dash, width]),
  ]);
  useEffect(() => {
    const box = holder.current;
    if (!box) return;
    const now = latest.current;
    const forward: Props = { ...now, hover: (index) => latest.current.hover?.(index) };
    if (now.near) forward.near = (curve) => latest.current.near?.(curve);
    const made: Own = new uPlot(options(forward, sizeIn(box, props.height)), data(now), box);
    made.over.addEventListener("click", () => {
      if (typeof made.cursor.idx === "number") latest.current.pick?.(made.cursor.idx);
    });
    plot.current = made;
    mirror(made, now);
    const watch = new ResizeObserver(() => box.clientWidth > 0 && made.setSize(sizeIn(box, latest.current.height)));
    watch.observe(box);
    return () => {
      watch.disconnect();
      made.destroy();
      plot.current = null;
    };
  }, [look]);
  useEffect(() => {
    if (!plot.current) return;
    mirror(plot.current, props);
    plot.current.setData(data(props));
  }, [props.x, props.curves, props.marked, props.dots]);
  useEffect(() => {
    const made = plot.current;
    if (!made || props.focus === undefined) return;
    const index = props.curves.findIndex((curve) => curve.name === props.focus);
    made.setSeries(index < 0 ? null : index + 1, { focus: true }, false);
  }, [props.focus, look]);
  return (
    <div
      class={props.height === undefined ? "curves fill" : "curves"}
      role="img"
      aria-label={props.label}
      ref={holder}
    />
  );
}

/** Copies what the plot draws itself. */
function mirror(made: Own, props: Props): void {
  if (props.marked === undefined) delete made.marked;
  else made.marked = props.marked;
  made.dots = props.dots ?? [];
}

const data = (props: Props): uPlot.AlignedData =>
  [props.x, ...props.curves.map((curve) => curve.values)] as unknown as uPlot.AlignedData;
