// Names of metrics, with their units, for labels. The keys are those of result.json and of sweep.csv.

import { split } from "./json.ts";
import { label, unit } from "./schema.ts";

interface Name {
  readonly name: string;
  readonly unit: string;
}

const NAMES: Record<string, Name> = {
  contrast_ratio: { name: "Contrast ratio", unit: "" },
  gamut_percent_srgb: { name: "Gamut area, u′v′", unit: "% of sRGB" },
  gamut_percent_ebu: { name: "Gamut area, u′v′", unit: "% of EBU" },
  gamut_percent_ntsc: { name: "Gamut area, u′v′", unit: "% of NTSC" },
  gamut_percent_dci_p3: { name: "Gamut area, u′v′", unit: "% of DCI-P3" },
  gamut_percent_srgb_xy: { name: "Gamut area, xy", unit: "% of sRGB" },
  gamut_percent_ebu_xy: { name: "Gamut area, xy", unit: "% of EBU" },
  gamut_percent_ntsc_xy: { name: "Gamut area, xy", unit: "% of NTSC" },
  gamut_percent_dci_p3_xy: { name: "Gamut area, xy", unit: "% of DCI-P3" },
  coverage_percent_srgb: { name: "Gamut coverage, u′v′", unit: "% of sRGB" },
  gamut_volume: { name: "Gamut volume", unit: "CIELAB units³" },
  text_contrast: { name: "Text contrast", unit: "" },
  text_luminance_cd_m2: { name: "Text luminance", unit: "cd/m²" },
  reading_surrogate_age_20: { name: "Small print at 20 years", unit: "" },
  reading_surrogate_age_50: { name: "Small print at 50 years", unit: "" },
  reading_surrogate_age_75: { name: "Small print at 75 years", unit: "" },
  X: { name: "X", unit: "" },
  Y: { name: "Luminance factor Y", unit: "" },
  Z: { name: "Z", unit: "" },
  luminance_cd_m2: { name: "Luminance", unit: "cd/m²" },
  contrast: { name: "Contrast to black", unit: "" },
  L_star: { name: "Lightness L*", unit: "" },
  a_star: { name: "a*", unit: "" },
  b_star: { name: "b*", unit: "" },
  C_star: { name: "Chroma C*", unit: "" },
  h_deg: { name: "Hue angle", unit: "°" },
  x: { name: "x", unit: "" },
  y: { name: "y", unit: "" },
  u_prime: { name: "u′", unit: "" },
  v_prime: { name: "v′", unit: "" },
  shift_with_angle_uv: { name: "Colour shift with angle, Δu′v′", unit: "" },
  delta_E_2000_with_angle: { name: "Colour difference with angle, ΔE00", unit: "" },
  distance_from_d65_uv: { name: "Distance from D65, Δu′v′", unit: "" },
  delta_E_2000_from_reference: { name: "Colour difference from the reference state, ΔE00", unit: "" },
  peak_nm: { name: "Peak wavelength", unit: "nm" },
  peak_shift_nm: { name: "Peak shift", unit: "nm" },
};

/** Returns the name of a metric without its unit: "White, lightness L*" for `white.L_star`. */
export function metricName(metric: string): string {
  const dot = metric.lastIndexOf(".");
  const [state, key] = dot < 0 ? ["", metric] : [metric.slice(0, dot), metric.slice(dot + 1)];
  const name = NAMES[key]?.name ?? key.replaceAll("_", " ");
  return state === "" ? name : `${name} of ${state}`;
}

export const metricUnit = (metric: string): string => NAMES[metric.slice(metric.lastIndexOf(".") + 1)]?.unit ?? "";

/** Returns the name of a metric with its unit in parentheses. */
export const metricLabel = (metric: string): string =>
  metricName(metric) + (metricUnit(metric) ? ` (${metricUnit(metric)})` : "");

/** Tables whose keys are names that the scenario chooses. */
const NAMED = ["gap_nm", "area", "reflectance"];

/** Returns the label of a key with its place and its unit: "Thickness of film 2 (nm)", "Gap of red (nm)". */
export function keyLabel(path: string): string {
  const [parent, key] = split(path);
  const [list, entry] = split(parent);
  const inUnit = (words: string, of: string) => (of ? `${words} (${of})` : words);
  if (NAMED.includes(entry)) return inUnit(`${label(entry)} of ${key}`, unit(entry));
  if (!/^\d+$/.test(entry)) return inUnit(label(key), unit(key));
  const kind = split(list)[1].replace("directed", "source");
  return inUnit(`${label(key)} of ${kind} ${Number(entry) + 1}`, unit(key));
}
