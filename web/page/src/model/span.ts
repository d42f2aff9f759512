// The range of a slider, which covers the useful values of a key. The allowed range is often much larger (0 to a million
// nanometres); the input box next to the slider accepts all of it.

import type { Limits } from "./schema.ts";

export interface Span {
  readonly min: number;
  readonly max: number;
  readonly step: number;
  /** Whether the scale is logarithmic. */
  readonly log: boolean;
}

const USEFUL: Record<string, Span> = {
  reflectance: { min: 0, max: 0.1, step: 0.0005, log: false },
  absorptance: { min: 0, max: 0.1, step: 0.0005, log: false },
  haze: { min: 0.005, max: 0.99, step: 0.005, log: false },
  thickness_nm: { min: 0, max: 200, step: 0.1, log: false },
  gap_nm: { min: 0, max: 500, step: 0.1, log: false },
  illuminance_lx: { min: 1, max: 200_000, step: 0, log: true },
  thickness_mm: { min: 0.01, max: 20, step: 0, log: true },
  optical_thickness: { min: 0.01, max: 200, step: 0, log: true },
  width: { min: 0.003, max: 3, step: 0, log: true },
  field_deg: { min: 0, max: 20, step: 0.1, log: false },
  distance_mm: { min: 100, max: 5000, step: 10, log: false },
  age_years: { min: 20, max: 75, step: 1, log: false },
  text_height_mm: { min: 0.5, max: 10, step: 0.1, log: false },
  distance_m: { min: 0.3, max: 30, step: 0, log: true },
  index: { min: 1, max: 3, step: 0.005, log: false },
  pitch_um: { min: 0.5, max: 200, step: 0, log: true },
  aperture_radius_um: { min: 0.1, max: 100, step: 0, log: true },
  radius_um: { min: 0.1, max: 200, step: 0, log: true },
  length_um: { min: 1, max: 1000, step: 0, log: true },
  thickness_um: { min: 1, max: 2000, step: 0, log: true },
  rms_nm: { min: 1, max: 5000, step: 0, log: true },
  correlation_um: { min: 0.2, max: 200, step: 0, log: true },
  cutoff_um: { min: 0.1, max: 20, step: 0, log: true },
  longest_um: { min: 1, max: 1000, step: 0, log: true },
  volume_fraction: { min: 0.005, max: 0.3, step: 0.005, log: false },
  rays: { min: 64, max: 2_000_000, step: 0, log: true },
  n: { min: 0.05, max: 5, step: 0.005, log: false },
  k: { min: 0, max: 8, step: 0.005, log: false },
  step_nm: { min: 1, max: 20, step: 1, log: false },
  relative_error: { min: 1e-4, max: 1e-1, step: 0, log: true },
  radius_deg: { min: 0.1, max: 30, step: 0.1, log: false },
  daylight_K: { min: 4000, max: 12000, step: 50, log: false },
  planck_K: { min: 1500, max: 12000, step: 50, log: false },
  led_nm: { min: 380, max: 780, step: 1, log: false },
  width_nm: { min: 5, max: 100, step: 1, log: false },
  adapting_luminance_cd_m2: { min: 1, max: 1000, step: 0, log: true },
};

/** Returns the range for a key, extended if necessary to include the value. */
export function span(key: string, limits: Limits, value: number): Span {
  const width = limits.max - limits.min;
  const all: Span = {
    min: limits.min,
    max: limits.max,
    step: width <= 2 ? 0.001 : width <= 200 ? 0.1 : 0.5,
    log: false,
  };
  const useful =
    USEFUL[key] ?? (Number.isFinite(width) && width <= 720 ? all : { min: 0, max: 10, step: 0.01, log: false });
  // An end that is excluded is not on the slider.
  const inside = [0, 1].map((end) => (limits.open?.[end] && !useful.log ? useful.step : 0)) as [number, number];
  return {
    ...useful,
    min: Math.max(limits.min + inside[0], Math.min(useful.min, value)),
    max: Math.min(limits.max - inside[1], value > useful.max ? 2 * value : useful.max),
  };
}

/** Returns the position of a value on a slider, 0 to 1. */
export function position({ min, max, log }: Span, value: number): number {
  const fraction = log ? Math.log(value / min) / Math.log(max / min) : (value - min) / (max - min);
  return Math.min(1, Math.max(0, Number.isFinite(fraction) ? fraction : 0));
}

/** Returns the value at a position, rounded to the step, or to three digits on a logarithmic slider. */
export function valueAt({ min, max, step, log }: Span, fraction: number): number {
  if (log) return Number((min * (max / min) ** fraction).toPrecision(3));
  const raw = min + fraction * (max - min);
  return Number(Math.min(max, Math.max(min, Math.round(raw / step) * step)).toPrecision(8));
}
