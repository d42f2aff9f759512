// Curves as an SVG of their own, for files: uPlot draws them on a canvas.

import { plain } from "../model/format.ts";
import { logTicks, nice, power, ticks } from "./axis.ts";
import type { Plot } from "./curves.tsx";

const SIZE = { width: 720, height: 420 } as const;
const BOX = { left: 72, top: 16, right: 560, bottom: 362 } as const;

export const escaped = (text: string): string =>
  text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;");

interface Scale {
  readonly at: (value: number) => number;
  readonly ticks: readonly number[];
  readonly words: (value: number) => string;
}

function scale(low: number, high: number, from: number, to: number, isLog: boolean): Scale {
  const place = isLog ? Math.log10 : (value: number) => value;
  const span = place(high) - place(low) || 1;
  return {
    at: (value) => from + ((place(value) - place(low)) / span) * (to - from),
    ticks: isLog ? logTicks(low, high) : ticks(low, high, 7),
    words: isLog ? power : (value) => plain(value, 4),
  };
}

/** Returns the points of a curve as path data; undefined values interrupt it. */
function path(
  x: readonly number[],
  values: readonly (number | null)[],
  at: (i: number, value: number) => string,
): string {
  let isDown = false;
  return values
    .map((value, i) => {
      if (value === null || x[i] === undefined) {
        isDown = false;
        return "";
      }
      const step = `${isDown ? "L" : "M"}${at(i, value)}`;
      isDown = true;
      return step;
    })
    .join("");
}

/** Draws curves with axes and a legend on white. */
export function curvesSvg({ x, curves, xName, yName, range, log, xLog, xWords }: Plot): string {
  const values = curves.flatMap((curve) => curve.values).filter((value) => value !== null);
  const finite = (all: readonly number[], other: number[]): number[] => (all.length > 0 ? [...all] : other);
  const [xs, ys] = [finite(x, [0, 1]), finite(values, [0, 1])];
  const [low, high] = [Math.min(...ys, range?.[0] ?? Infinity), Math.max(...ys, range?.[1] ?? -Infinity)];
  const [from, to] = log ? [low, high] : nice(Math.min(low, log ? low : 0), high);
  const across = scale(Math.min(...xs), Math.max(...xs), BOX.left, BOX.right, Boolean(log || xLog));
  const up = scale(from, to, BOX.bottom, BOX.top, Boolean(log));
  const grid = '<g stroke="#e3e6e9" stroke-width="1">';
  const text = 'font-family="Roboto, Helvetica, Arial, sans-serif" font-size="12" fill="#26292e"';
  const xTicks = xWords ? x.map((_, i) => i) : across.ticks;
  const parts = [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${SIZE.width}" height="${SIZE.height}" viewBox="0 0 ${SIZE.width} ${SIZE.height}">`,
    `<rect width="${SIZE.width}" height="${SIZE.height}" fill="#ffffff"/>`,
    grid,
    ...xTicks.map((tick) => `<path d="M${across.at(tick).toFixed(1)} ${BOX.top}V${BOX.bottom}"/>`),
    ...up.ticks.map((tick) => `<path d="M${BOX.left} ${up.at(tick).toFixed(1)}H${BOX.right}"/>`),
    "</g>",
    `<g ${text}>`,
    ...xTicks.map(
      (tick) =>
        `<text x="${across.at(tick).toFixed(1)}" y="${BOX.bottom + 18}" text-anchor="middle">${escaped(xWords?.[tick] ?? across.words(tick))}</text>`,
    ),
    ...up.ticks.map(
      (tick) =>
        `<text x="${BOX.left - 8}" y="${(up.at(tick) + 4).toFixed(1)}" text-anchor="end">${up.words(tick)}</text>`,
    ),
    `<text x="${(BOX.left + BOX.right) / 2}" y="${BOX.bottom + 42}" text-anchor="middle">${escaped(xName)}</text>`,
    `<text transform="translate(18 ${(BOX.top + BOX.bottom) / 2}) rotate(-90)" text-anchor="middle">${escaped(yName)}</text>`,
    "</g>",
  ];
  curves.forEach((curve, i) => {
    const stroke = `fill="none" stroke="${curve.colour}" stroke-width="${curve.width}"${curve.dash.length > 0 ? ` stroke-dasharray="${curve.dash.join(" ")}"` : ""}`;
    const d = path(x, curve.values, (k, value) => `${across.at(x[k]!).toFixed(2)} ${up.at(value).toFixed(2)}`);
    const y = BOX.top + 10 + 20 * i;
    parts.push(`<path ${stroke} d="${d}"/>`);
    if (curves.length > 1)
      parts.push(
        `<path ${stroke} d="M${BOX.right + 12} ${y}h26"/>`,
        `<text ${text} x="${BOX.right + 44}" y="${y + 4}">${escaped(curve.name)}</text>`,
      );
  });
  return [...parts, "</svg>"].join("\n");
}
