// Metrics against the viewing angle in a plane through the normal.

import { useSignal } from "@preact/signals";

import { NumberField } from "../fields/number.tsx";
import { digits, degrees } from "../model/format.ts";
import { Curves, type Curve } from "../plots/curves.tsx";
import { lineOf, Sample } from "../plots/spectra.tsx";
import { view } from "../state/design.ts";
import { useFollowed } from "../state/follow.ts";
import { pinned } from "../state/pin.ts";
import type { Angles } from "../api/types.ts";
import { dark } from "../state/theme.ts";
import { Problems } from "./problems.tsx";

/** Metrics of the display and of each state, by their names in result.json. */
const OF_DISPLAY: Record<string, string> = {
  contrast_ratio: "Contrast ratio",
  gamut_percent_srgb: "Gamut (% of sRGB)",
  gamut_percent_ebu: "Gamut (% of EBU)",
  text_contrast: "Text contrast",
};
const OF_STATES: Record<string, string> = {
  Y: "Luminance factor Y",
  luminance_cd_m2: "Luminance (cd/m²)",
  L_star: "Lightness L*",
  u_prime: "u′",
  v_prime: "v′",
  shift_with_angle_uv: "Colour shift Δu′v′",
  peak_nm: "Peak wavelength (nm)",
};
const NAMES: Record<string, string> = { ...OF_DISPLAY, ...OF_STATES };
const nameOf = (metric: string): string => NAMES[metric] ?? metric;
/** Time without changes after which the angles are requested, ms. */
const REST_MS = 60;

function curvesOf(angles: Angles | null, metric: string): Curve[] {
  if (!angles) return [];
  if (metric in OF_DISPLAY)
    return [
      {
        name: nameOf(metric),
        values: angles.metrics[metric] ?? [],
        colour: dark.value ? "#7da4f2" : "#2b5fc7",
        dash: [],
        width: 2,
      },
    ];
  return Object.entries(angles.states).map(([name, values], i) => ({
    name,
    values: values[metric] ?? [],
    ...lineOf(name, i),
    width: 1.8,
  }));
}

export function AnglesPanel() {
  const metric = useSignal("contrast_ratio");
  const phi = useSignal(0);
  const under = useSignal<number | null>(null);
  const request = { phi_deg: phi.value, from_deg: -80, to_deg: 80, step_deg: 2 };
  const now = useFollowed<Angles>("angles", request, REST_MS);
  const before = useFollowed<Angles>("angles", request, REST_MS, pinned.value?.text ?? null);
  const x = now.value?.theta_deg ?? [];
  const own = curvesOf(now.value, metric.value);
  const kept = before.value && before.value.theta_deg.length === x.length ? curvesOf(before.value, metric.value) : [];
  const dashed = kept.map((curve) => ({ ...curve, name: `${curve.name}, pinned`, width: 1, dash: [12, 3, 3, 3] }));
  const at = under.value;
  const theta = at === null ? undefined : x[at];
  return (
    <>
      <div class="controls">
        <label for="angle-metric">Show</label>
        <select id="angle-metric" value={metric.value} onChange={(event) => (metric.value = event.currentTarget.value)}>
          {Object.entries(NAMES).map(([key, name]) => (
            <option key={key} value={key}>
              {name}
            </option>
          ))}
        </select>
        <label for="angle-phi">in the plane of azimuth</label>
        <NumberField
          id="angle-phi"
          name="Azimuth of the plane"
          of="phi_deg"
          unit="°"
          value={phi.value}
          limits={{ min: -180, max: 180 }}
          invalid={false}
          describedBy="angle-remark"
          change={(to) => (phi.value = to)}
        />
      </div>
      <Problems of={now.problems} />
      <div class={now.busy ? "with-key waiting" : "with-key"}>
        <Curves
          x={x}
          curves={[...own, ...dashed]}
          xName="Viewing angle θ (°)"
          yName={nameOf(metric.value)}
          height={300}
          label={`${nameOf(metric.value)} against viewing angle`}
          hover={(index) => (under.value = index)}
          marked={view.value?.theta_deg}
        />
        <ul class="curve-key read">
          <li>
            <b>{theta === undefined ? "" : degrees(theta)}</b>
          </li>
          {own.map((curve, i) => (
            <li key={curve.name}>
              {metric.value in OF_STATES ? <Sample name={curve.name} index={i} /> : null}
              <span>{metric.value in OF_STATES ? curve.name : ""}</span>
              <output>{at === null ? "" : digits(curve.values[at], 4)}</output>
              {kept[i] && at !== null && <small>pinned {digits(kept[i].values[at], 4)}</small>}
            </li>
          ))}
        </ul>
      </div>
      <p class="remark" id="angle-remark">
        The dotted line marks the view that is shown above. The mirror image of a source is visible only if the source
        has an angular radius.
      </p>
    </>
  );
}
