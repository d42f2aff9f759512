// The six main numbers of the result, each with its difference from the pinned design.

import type { Num, View } from "../api/types.ts";
import { fixed, signed, thousands, withError } from "../model/format.ts";
import { view } from "../state/design.ts";
import { pinnedView } from "../state/pin.ts";

interface Figure {
  /** A fixed name, with the unit, for tests. */
  readonly id: string;
  readonly name: string;
  readonly unit: string;
  readonly decimals: number;
  readonly of: (view: View) => readonly [Num | undefined, Num | undefined];
  readonly help: string;
}

const FIGURES: readonly Figure[] = [
  {
    id: "White % Y",
    name: "White reflectance",
    unit: "%",
    decimals: 1,
    help: "Luminance factor of the white state: 100 % for a perfect white diffuser in the same light",
    of: (v) => [percent(v.states["white"]?.Y), percent(v.states["white"]?.standard_error.Y)],
  },
  {
    id: "Contrast : 1",
    name: "Contrast",
    unit: ": 1",
    decimals: 2,
    help: "Luminance factor of white divided by that of black",
    of: (v) => [v.contrast_ratio, v.standard_error.contrast_ratio],
  },
  {
    id: "Gamut % sRGB",
    name: "Gamut vs sRGB, u′v′",
    unit: "%",
    decimals: 2,
    help: "Area of the triangle of red, green and blue in u′v′ divided by that of sRGB",
    of: (v) => [v.gamut_percent_srgb, v.standard_error.gamut_percent_srgb],
  },
  {
    id: "Gamut % EBU",
    name: "Gamut vs EBU, u′v′",
    unit: "%",
    decimals: 2,
    help: "Area of the triangle of red, green and blue in u′v′ divided by that of EBU",
    of: (v) => [v.gamut_percent_ebu, v.standard_error.gamut_percent_ebu],
  },
  {
    id: "White cd/m²",
    name: "White luminance",
    unit: "cd/m²",
    decimals: 1,
    help: "Luminance of the white state",
    of: (v) => [v.states["white"]?.luminance_cd_m2, v.states["white"]?.standard_error.luminance_cd_m2],
  },
  {
    id: "Text contrast",
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
      {FIGURES.map(({ id, name, unit, decimals, of, help }) => {
        const [value, se] = of(now);
        const was = before ? of(before)[0] : null;
        const difference =
          was === null || was === undefined || value === null || value === undefined ? null : value - was;
        return (
          <div key={id} title={help} data-figure={id}>
            <dt>{name}</dt>
            <dd>
              <b>{thousands(withError(value, se, decimals))}</b> <small>{unit}</small>
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
