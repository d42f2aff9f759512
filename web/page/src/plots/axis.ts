// Round numbers on the axes of plots.

import { plain } from "../model/format.ts";

/** Returns a round step, so that a range has at most `most` of them. */
export function roundStep(width: number, most = 6): number {
  const size = Math.abs(width) || 1;
  const unit = 10 ** Math.floor(Math.log10(size / most));
  return [1, 2, 5, 10].map((k) => k * unit).find((step) => size / step <= most) ?? 10 * unit;
}

/** Returns a range with round ends that includes both values. */
export function nice(low: number, high: number): [number, number] {
  const step = roundStep(high - low || Math.abs(high) || 1);
  return [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step];
}

/** Returns the multiples of a round step in a range. */
export function ticks(low: number, high: number, most = 6): number[] {
  const step = roundStep(high - low, most);
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.max(0, Math.floor(high / step + 1e-9) - first);
  return Array.from({ length: count + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** Formats a number of a logarithmic axis: a power of ten as 10⁴, small ones in full. */
export function power(value: number): string {
  const exponent = Math.log10(value);
  if (Math.abs(exponent - Math.round(exponent)) > 1e-9 || Math.abs(exponent) < 2.5) return plain(value, 4);
  const digits = String(Math.abs(Math.round(exponent)));
  return `10${exponent < 0 ? "⁻" : ""}${[...digits].map((digit) => RAISED[Number(digit)]).join("")}`;
}

/** Returns the powers of ten, and for a narrow range also 2 and 5 times of them, in a range. */
export function logTicks(low: number, high: number): number[] {
  const factors = Math.log10(high / low) > 3 ? [1] : [1, 2, 5];
  const from = Math.floor(Math.log10(low));
  const all = Array.from({ length: Math.ceil(Math.log10(high)) - from + 1 }, (_, i) => 10 ** (from + i));
  return all
    .flatMap((decade) => factors.map((factor) => Number((factor * decade).toPrecision(6))))
    .filter((tick) => tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9));
}
