// Curves over one variable (uPlot). The plot is created once and then updated; it is created again if the style changes.

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

import { plain } from "../model/format.ts";
import { dark } from "../state/theme.ts";

export interface Curve {
  readonly name: string;
  readonly values: readonly (number | null)[];
  readonly colour: string;
  readonly dash: readonly number[];
  readonly width: number;
}

interface Props {
  x: readonly number[];
  curves: readonly Curve[];
  xName: string;
  yName: string;
  /** Height in px; without it, the plot fills its box. */
  height?: number;
  /** The range that the ordinate always includes. */
  range?: readonly [number, number];
  label: string;
  /** Whether both axes are logarithmic. */
  log?: boolean;
  /** Called with the index at the pointer, or null. */
  hover?: (index: number | null) => void;
  /** A vertical line at this abscissa. */
  marked?: number | undefined;
}

const FONT = "11px Roboto, Helvetica, Arial, sans-serif";
const ink = () => (dark.value ? "#b4b9c1" : "#555555");
const faint = () => (dark.value ? "#2b2f36" : "#ececec");

/** Returns the size of the plot in its box. */
const sizeIn = (box: HTMLElement, height: number | undefined) => ({
  width: box.clientWidth || 400,
  height: height ?? Math.max(200, box.clientHeight),
});

function options(props: Props, size: { width: number; height: number }): uPlot.Options {
  const axis = (label: string): uPlot.Axis => ({
    stroke: ink,
    grid: { stroke: faint, width: 1 },
    ticks: { stroke: faint, width: 1, size: 5 },
    font: FONT,
    labelFont: FONT,
    label,
    values: (_, splits) => splits.map((split) => (split === null ? "" : plain(split, 4))),
    labelSize: 18,
    labelGap: 2,
  });
  return {
    ...size,
    padding: [10, props.log ? 30 : 12, 0, 0],
    legend: { show: false },
    cursor: { y: false, points: { size: 7 }, drag: { x: false, y: false } },
    scales: {
      x: { time: false, ...(props.log ? { distr: 3 as const } : {}) },
      y: props.log
        ? { distr: 3 }
        : {
            range: (_, low, high) =>
              nice(
                Math.min(low ?? 0, props.range?.[0] ?? Infinity),
                Math.max(high ?? 1, props.range?.[1] ?? -Infinity),
              ),
          },
    },
    axes: [
      { ...axis(props.xName), size: 30, space: 44 },
      { ...axis(props.yName), size: 56, space: 34 },
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
      draw: [(plot) => mark(plot)],
    },
  };
}

/** Draws a thin vertical line at the marked abscissa. */
function mark(plot: uPlot): void {
  const at = (plot as uPlot & { marked?: number }).marked;
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

/** Returns a range with round ends that includes both values. */
function nice(low: number, high: number): [number, number] {
  const width = high - low || Math.abs(high) || 1;
  const unit = 10 ** Math.floor(Math.log10(width / 4));
  const step = [1, 2, 5, 10].map((k) => k * unit).find((s) => width / s <= 6) ?? 10 * unit;
  return [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step];
}

export function Curves(props: Props) {
  const holder = useRef<HTMLDivElement>(null);
  const plot = useRef<(uPlot & { marked?: number }) | null>(null);
  const latest = useRef(props);
  latest.current = props;
  const look = JSON.stringify([
    dark.value,
    props.log,
    props.xName,
    props.yName,
    props.height,
    props.curves.map(({ name, colour, dash, width }) => [name, colour, dash, width]),
  ]);
  useEffect(() => {
    const box = holder.current;
    if (!box) return;
    const forward = { ...latest.current, hover: (index: number | null) => latest.current.hover?.(index) };
    const made = new uPlot(options(forward, sizeIn(box, props.height)), data(latest.current), box);
    plot.current = made;
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
    if (props.marked === undefined) delete plot.current.marked;
    else plot.current.marked = props.marked;
    plot.current.setData(data(props));
  }, [props.x, props.curves, props.marked]);
  return (
    <div
      class={props.height === undefined ? "curves fill" : "curves"}
      role="img"
      aria-label={props.label}
      ref={holder}
    />
  );
}

const data = (props: Props): uPlot.AlignedData =>
  [props.x, ...props.curves.map((curve) => curve.values)] as unknown as uPlot.AlignedData;
