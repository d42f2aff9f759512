// The design compared with a measured panel, as by `papilio compare`: a table of the states, and figures of the spectra and
// gamuts.

import type { Compared } from "../api/types.ts";
import { degrees, digits, fixed, NONE, signed } from "../model/format.ts";
import { Drawn } from "../plots/figure.tsx";
import { comparedPanel } from "../state/choices.ts";
import { panelNow, panels } from "../state/commands.ts";
import { showState } from "../state/design.ts";
import { fileIds } from "../state/files.ts";
import { useFollowed } from "../state/follow.ts";
import { hoverClass, pointsAt } from "../state/hover.ts";
import { labelText } from "../state/labels.ts";
import { showTab } from "../state/tab.ts";
import { Aged } from "./aged.tsx";
import { FileButton } from "./choose.tsx";
import { ColumnHeads, type Head } from "./column-heads.tsx";
import { Downloads } from "./downloads.tsx";
import { Problems } from "./problems.tsx";
import { Rename, SaveRenamed } from "./rename.tsx";

/** Time without changes after which the comparison is requested, ms. */
const REST_MS = 150;

/** Opens the comparison with a file. */
export function compareWith(name: string): void {
  comparedPanel.value = name;
  showTab("compare");
}

type State = Compared["comparison"]["states"][number];
type View = Compared["comparison"]["views"][number];

interface Column extends Head {
  readonly of: (state: State) => string;
}

/** Formats a simulated and a measured value. */
const pair = (simulated: number | null | undefined, measured: number | null | undefined, decimals: number): string =>
  typeof simulated !== "number" && typeof measured !== "number"
    ? NONE
    : `${fixed(simulated, decimals)} / ${fixed(measured, decimals)}`;

const COLUMNS: readonly Column[] = [
  { head: "Y", help: "Luminance factor: simulated / measured", of: (s) => pair(s.simulated.Y, s.measured.Y, 4) },
  {
    head: "contrast",
    help: "Y divided by Y of black: simulated / measured",
    of: (s) => pair(s.simulated.contrast, s.measured.contrast, 2),
  },
  {
    head: "peak (nm)",
    help: "Wavelength of the largest reflectance factor: simulated / measured",
    of: (s) => pair(s.simulated.peak_nm, s.measured.peak_nm, 1),
  },
  { head: "ΔE00", help: "CIEDE2000 difference in the light of the simulation", of: (s) => fixed(s.delta_E_2000, 2) },
  { head: "Δu′v′", help: "u′v′ distance", of: (s) => fixed(s.distance_uv, 4) },
  {
    head: "mean ΔR",
    help: "Mean difference of the reflectance factors, simulated minus measured",
    of: (s) => signed(s.spectrum?.mean_difference, 4),
  },
  {
    head: "rms ΔR",
    help: "Root mean square difference of the reflectance factors",
    of: (s) => fixed(s.spectrum?.rms_difference, 4),
  },
];

function States({ states }: { states: readonly State[] }) {
  return (
    <div class="scroll" tabindex={0} role="region" aria-label="States, simulated and measured">
      <table class="numbers">
        <ColumnHeads columns={COLUMNS} />
        <tbody>
          {states.map((one) => (
            <tr
              key={one.state}
              class={hoverClass(one.state)}
              onClick={() => showState(one.state)}
              {...pointsAt(one.state)}
            >
              <th scope="row">{one.state}</th>
              {COLUMNS.map(({ head, of }) => (
                <td key={head}>{of(one)}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** The metrics of a view, simulated / measured. */
function metrics(view: View): string {
  const parts = [
    ["contrast ratio ", view.contrast_ratio, ""],
    ["gamut area ", view.gamut_percent_srgb, " % of sRGB"],
    ["", view.gamut_percent_ebu, " % of EBU"],
  ] as const;
  const known = parts
    .filter(([, values]) => values.some((value) => typeof value === "number"))
    .map(([name, values, unit]) => `${name}${pair(values[0], values[1], 2)}${unit}`);
  const [rms, mean] = [view.rms_peak_difference_nm, view.average_peak_difference_nm];
  if (typeof rms === "number" && typeof mean === "number")
    known.push(`rms difference of the peaks ${rms.toFixed(1)} nm (mean with sign ${signed(mean, 1)} nm)`);
  return known.join(", ");
}

type Metric = NonNullable<Compared["comparison"]["metrics"]>[number];

/** Formats a value with its standard deviation, if it is known. */
const spread = (value: number, deviation: number | null | undefined): string =>
  deviation ? `${digits(value, 4)} ± ${digits(deviation, 2)}` : digits(value, 4);

/** Measured metrics, with those of the simulation. */
function Metrics({ metrics }: { metrics: readonly Metric[] }) {
  return (
    <section>
      <h3>Metrics</h3>
      <div class="scroll" tabindex={0} role="region" aria-label="Metrics, simulated and measured">
        <table class="numbers">
          <thead>
            <tr>
              <th scope="col">metric</th>
              <th scope="col">simulated</th>
              <th scope="col">measured</th>
              <th scope="col" title="Difference over its standard deviation">
                z
              </th>
            </tr>
          </thead>
          <tbody>
            {metrics.map((one) => (
              <tr key={`${one.metric} ${one.theta_deg} ${one.phi_deg}`}>
                <th scope="row" title={one.metric}>
                  {labelText(one.metric)}, from {degrees(one.theta_deg)}
                </th>
                <td>{spread(one.simulated, one.simulated_deviation)}</td>
                <td>{spread(one.measured, one.measured_deviation)}</td>
                <td>{signed(one.z, 2)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

function Comparison({ compared, name }: { compared: Compared; name: string }) {
  const { states, views, left_out: leftOut, agreement } = compared.comparison;
  // Without metrics, there is no such field.
  const measured = compared.comparison.metrics ?? [];
  return (
    <>
      {views.map((view) => (
        <section key={`${view.theta_deg} ${view.phi_deg}`}>
          <h3>
            Seen from {degrees(view.theta_deg)}
            {view.phi_deg !== 0 && `, azimuth ${degrees(view.phi_deg)}`}: simulated / measured
          </h3>
          <States states={states.filter((s) => s.theta_deg === view.theta_deg && s.phi_deg === view.phi_deg)} />
          <p class="remark">{metrics(view)}</p>
        </section>
      ))}
      {measured.length > 0 && <Metrics metrics={measured} />}
      {agreement && (
        <p class="remark">
          z of {agreement.count} numbers with a standard deviation: rms {fixed(agreement.z_rms, 2)},{" "}
          {fixed(100 * agreement.within_2, 0)} % within 2.
        </p>
      )}
      <p class="remark">
        Table of all numbers <Downloads name="comparison" table={() => compared.csv} />
        {compared.spectra_csv !== "" && (
          <>
            {" "}
            and of all spectra <Downloads name="comparison-spectra" table={() => compared.spectra_csv} />
          </>
        )}
      </p>
      {compared.warnings.map((warning) => (
        <p class="remark warning" key={warning}>
          Warning: {warning}
        </p>
      ))}
      {leftOut.map((reason) => (
        <p class="remark" key={reason}>
          Note: {reason}
        </p>
      ))}
      {compared.figures.map((figure) => (
        <Drawn
          key={figure.name}
          name={figure.name}
          svg={figure.svg}
          label={`${figure.name.replaceAll("-", " ")}: the design and ${name}`}
        />
      ))}
    </>
  );
}

function Follow({ name, id }: { name: string; id: string }) {
  const now = useFollowed<Compared>("compare", { panel: id }, REST_MS);
  return (
    <>
      <Problems of={now.problems} />
      {(now.problems.length > 0 || (now.value?.comparison.left_out.length ?? 0) > 0) && (
        <p class="controls">
          <Rename name={name} id={id} />
        </p>
      )}
      {!now.value && now.problems.length === 0 && <p role="status">computing…</p>}
      {now.value && (
        <Aged age={now.age} count={now.count}>
          <Comparison compared={now.value} name={name} />
        </Aged>
      )}
    </>
  );
}

/** The comparison with a measured panel, of which there may be several. */
export function MeasuredPanel() {
  const names = panels();
  const name = panelNow();
  const id = fileIds.value[name];
  return (
    <section class="measured" aria-label="Measured panel">
      <div class="controls">
        <b>With a measured panel</b>
        {names.length > 0 && (
          <select
            aria-label="Measured panel"
            value={name}
            onChange={(event) => (comparedPanel.value = event.currentTarget.value)}
          >
            {names.map((one) => (
              <option key={one} value={one}>
                {one}
              </option>
            ))}
          </select>
        )}
        <FileButton label="Choose a measurement" stays />
        <SaveRenamed name={name} />
        <span class="remark">
          or drop a CSV file with the columns state, theta_deg, wavelength_nm, reflectance_factor (or X, Y, Z), or metric, value; states
          are matched by name, directions to within 1°.
        </span>
      </div>
      {id && <Follow key={id} name={name} id={id} />}
    </section>
  );
}
