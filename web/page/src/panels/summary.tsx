// The six main numbers of the result, each with its difference from the pinned design.

import type { Num, View } from "../api/types.ts";
import { fixed, signed, withError } from "../model/format.ts";
import { view } from "../state/design.ts";
import { pinnedView } from "../state/pin.ts";

interface Figure {
  readonly name: string;
  readonly unit: string;
  readonly decimals: number;
  readonly of: (view: View) => readonly [Num | undefined, Num | undefined];
  readonly help: string;
}

const FIGURES: readonly Figure[] = [
  {
    name: "White",
    unit: "% Y",
    decimals: 1,
    help: "Luminance factor of the white state: 100 % for a perfect white diffuser in the same light",
    of: (v) => [percent(v.states["white"]?.Y), percent(v.states["white"]?.standard_error.Y)],
  },
  {
    name: "Contrast",
    unit: ": 1",
    decimals: 2,
    help: "Luminance factor of white divided by that of black",
    of: (v) => [v.contrast_ratio, v.standard_error.contrast_ratio],
  },
  {
    name: "Gamut",
    unit: "% sRGB",
    decimals: 2,
    help: "Area of the triangle of red, green and blue in u′v′ divided by that of sRGB",
    of: (v) => [v.gamut_percent_srgb, v.standard_error.gamut_percent_srgb],
  },
  {
    name: "Gamut",
    unit: "% EBU",
    decimals: 2,
    help: "Area of the triangle of red, green and blue in u′v′ divided by that of EBU",
    of: (v) => [v.gamut_percent_ebu, v.standard_error.gamut_percent_ebu],
  },
  {
    name: "White",
    unit: "cd/m²",
    decimals: 1,
    help: "Luminance of the white state",
    of: (v) => [v.states["white"]?.luminance_cd_m2, v.states["white"]?.standard_error.luminance_cd_m2],
  },
  {
    name: "Text contrast",
    unit: "",
    decimals: 3,
    help: "(white − black)/(white + black/3), with luminances",
    of: (v) => [v.text_contrast, v.standard_error.text_contrast],
  },
];

const percent = (share: Num | undefined): Num => (share === null || share === undefined ? null : 100 * share);

export function Summary() {
  const now = view.value;
  const before = pinnedView.value;
  if (!now) return null;
  return (
    <dl class="summary">
      {FIGURES.map(({ name, unit, decimals, of, help }) => {
        const [value, se] = of(now);
        const was = before ? of(before)[0] : null;
        const difference =
          was === null || was === undefined || value === null || value === undefined ? null : value - was;
        return (
          <div key={name + unit} title={help} data-figure={`${name} ${unit}`.trim()}>
            <dt>{name}</dt>
            <dd>
              <b>{withError(value, se, decimals)}</b> <small>{unit}</small>
              {before && (
                <span class="difference">
                  {difference === null ? "" : `${signed(difference, decimals)} from ${fixed(was, decimals)}`}
                </span>
              )}
            </dd>
          </div>
        );
      })}
    </dl>
  );
}
