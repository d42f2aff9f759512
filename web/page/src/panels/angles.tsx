// Metrics against the viewing angle in a plane through the normal.

import { useSignal } from "@preact/signals";

import { NumberField } from "../fields/number.tsx";
import type { Rows } from "../model/csv.ts";
import { digits, degrees } from "../model/format.ts";
import { curvesSvg } from "../plots/curves-svg.ts";
import { Curves, type Curve, type Plot } from "../plots/curves.tsx";
import { lineOf, Sample } from "../plots/spectra.tsx";
import { anglePhi } from "../state/choices.ts";
import { result, states, view } from "../state/design.ts";
import { useFollowed } from "../state/follow.ts";
import { hoverClass, hovered, pointsAt } from "../state/hover.ts";
import { labelText } from "../state/labels.ts";
import { pinned } from "../state/pin.ts";
import type { Angles } from "../api/types.ts";
import { dark } from "../state/theme.ts";
import { Aged } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { Problems } from "./problems.tsx";

/** Metrics of the display and of each state, by their names in result.json. */
const OF_DISPLAY = [
  "contrast_ratio",
  "gamut_percent_srgb",
  "gamut_percent_ebu",
  "gamut_percent_ntsc_xy",
  "text_contrast",
];
const OF_STATES = ["Y", "luminance_cd_m2", "L_star", "u_prime", "v_prime", "shift_with_angle_uv", "peak_nm"];
/** Time without changes after which the angles are requested, ms. */
const REST_MS = 60;

function curvesOf(angles: Angles | null, metric: string): Curve[] {
  if (!angles) return [];
  if (OF_DISPLAY.includes(metric))
    return [
      {
        name: labelText(metric),
        values: angles.metrics[metric] ?? [],
        colour: dark.value ? "#7da4f2" : "#2b5fc7",
        dash: [],
        width: 2,
      },
    ];
  const curves = Object.entries(angles.states).map(([name, values]) => ({
    name,
    values: values[metric] ?? [],
    ...lineOf(name),
    width: 1.8,
  }));
  // The peak of a mixture of sub-pixels jumps between those of its parts.
  const primaries = result.value?.primaries ?? [];
  return metric === "peak_nm" ? curves.filter(({ name }) => primaries.includes(name)) : curves;
}

/** All metrics: a row for each inclination. */
function tableOf(angles: Angles | null): Rows {
  if (!angles) return [];
  const columns = [
    ...Object.entries(angles.metrics),
    ...Object.entries(angles.states).flatMap(([state, all]) =>
      Object.entries(all).map(([name, values]) => [`${state}.${name}`, values] as const),
    ),
  ];
  return [
    ["theta_deg", "phi_deg", ...columns.map(([name]) => name)],
    ...angles.theta_deg.map((theta, i) => [theta, angles.phi_deg, ...columns.map(([, values]) => values[i])]),
  ];
}

export function AnglesPanel() {
  const metric = useSignal("contrast_ratio");
  const phi = anglePhi;
  const under = useSignal<number | null>(null);
  const request = { phi_deg: phi.value, from_deg: -80, to_deg: 80, step_deg: 2 };
  const exact = useFollowed<Angles>("angles", request, REST_MS);
  const isExact = exact.value !== null && exact.age === "current";
  // A first answer in large steps is shown until the exact one is there.
  const first = useFollowed<Angles>("angles", { ...request, step_deg: 10, accuracy: "first" }, 0, isExact ? null : undefined);
  const isFirst = !isExact && exact.problems.length === 0 && first.value !== null && first.age === "current";
  const now = isFirst || exact.value === null ? first : exact;
  const before = useFollowed<Angles>("angles", request, REST_MS, pinned.value?.text ?? null);
  const x = now.value?.theta_deg ?? [];
  const own = curvesOf(now.value, metric.value);
  const kept = before.value && before.age === "current" && before.value.theta_deg.length === x.length ? curvesOf(before.value, metric.value) : [];
  const dashed = kept.map((curve) => ({ ...curve, name: `${curve.name}, compared`, width: 1, dash: [12, 3, 3, 3] }));
  const at = under.value;
  const theta = at === null ? undefined : x[at];
  const plot: Plot = {
    x,
    curves: [...own, ...dashed],
    xName: "Viewing angle θ (°)",
    yName: labelText(metric.value),
  };
  return (
    <>
      <div class="controls">
        <label for="angle-metric">Show</label>
        <select id="angle-metric" value={metric.value} onChange={(event) => (metric.value = event.currentTarget.value)}>
          {[...OF_DISPLAY, ...OF_STATES].map((key) => (
            <option key={key} value={key}>
              {labelText(key)}
            </option>
          ))}
        </select>
        <span class="with-label">
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
        </span>
      </div>
      <Problems of={exact.problems} />
      {!isExact && exact.problems.length === 0 && (
        <p class="controls" role="status" data-phase={exact.isCancelled ? "cancelled" : "running"}>
          {isFirst && !first.value!.is_final && `First answer ±${digits(100 * first.value!.relative_error, 2)} %. `}
          {exact.isCancelled ? (
            <button type="button" onClick={exact.restart}>
              Compute the exact one
            </button>
          ) : (
            <>
              {isFirst ? "The exact one is being computed… " : "computing… "}
              <button type="button" onClick={exact.cancel}>
                Cancel
              </button>
            </>
          )}
        </p>
      )}
      <Aged age={now.value ? now.age : "current"} count={now.count}>
        {now.value && (
          <p class="figure-tools">
            <Downloads name="angles" svg={() => curvesSvg(plot)} table={() => tableOf(now.value)} />
          </p>
        )}
        <div class="with-key">
          {x.length === 0 ? (
            <p class="empty-plot" role="status">
              {exact.problems.length > 0 ? "no result" : exact.isCancelled ? "cancelled" : "computing…"}
            </p>
          ) : (
            <Curves
              {...plot}
              height={300}
              label={`${labelText(metric.value)} against viewing angle`}
              hover={(index) => (under.value = index)}
              near={(curve) => (hovered.value = states.value.some(([name]) => name === curve) ? curve : null)}
              focus={hovered.value}
              marked={view.value?.theta_deg}
            />
          )}
          <ul class="curve-key read">
            <li>
              <b>{theta === undefined ? "" : degrees(theta)}</b>
            </li>
            {own.map((curve, i) => (
              <li key={curve.name} class={hoverClass(curve.name)} {...pointsAt(curve.name)}>
                {OF_STATES.includes(metric.value) ? <Sample name={curve.name} /> : null}
                <span>{OF_STATES.includes(metric.value) ? curve.name : ""}</span>
                <output>{at === null ? "" : digits(curve.values[at], 4)}</output>
                {kept[i] && at !== null && <small>compared {digits(kept[i].values[at], 4)}</small>}
              </li>
            ))}
          </ul>
        </div>
      </Aged>
      <p class="remark" id="angle-remark">
        The dotted line marks the view that is shown above. The mirror image of a source is visible only if the source
        has an angular radius.
      </p>
    </>
  );
}
