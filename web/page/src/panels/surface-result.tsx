// What was measured of a surface: a verdict, where the light goes by inclination, haze by wavelength, statistics of the heights.

import { useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";

import type { Gonio } from "../api/types.ts";
import { count, degrees, digits, withError } from "../model/format.ts";
import { verdict, type SurfaceAudit, type WaveRow } from "../model/surface.ts";
import { Curves, type Curve } from "../plots/curves.tsx";
import { Drawn } from "../plots/figure.tsx";
import { dark } from "../state/theme.ts";
import { Downloads } from "./downloads.tsx";

type Total = Gonio["totals"][number];
type Estimate = Total["reflected"];

const percent = ({ value, error }: Estimate): string => withError(100 * value, 100 * error, 2);

/** Colours of quantities in both themes, and their dashes; lines from below are thin. */
const COLOURS = {
  light: ["#2b5fc7", "#2f8f5b", "#b06a1c", "#777777"],
  dark: ["#7da4f2", "#6cc894", "#e0a45c", "#a0a5ad"],
};
const DASHES = [[], [8, 3], [3.5, 2.5], [8, 3, 2, 3]];
const WIDTHS = { above: 2.4, below: 1.2 };

const line = (name: string, hue: number, isBelow: boolean, values: readonly (number | null)[]): Curve => ({
  name,
  values,
  colour: (dark.value ? COLOURS.dark : COLOURS.light)[hue]!,
  dash: DASHES[hue]!,
  width: isBelow ? WIDTHS.below : WIDTHS.above,
});

/** The key of a plot, with the values at the pointer. */
function Legend({ curves, at, head }: { curves: readonly Curve[]; at: number | null; head: string }) {
  return (
    <ul class="curve-key read">
      <li>
        <b>{head}</b>
      </li>
      {curves.map(({ name, colour, dash, width, values }) => (
        <li key={name}>
          <svg class="sample" viewBox="0 0 22 8" aria-hidden="true">
            <path d="M0 4H22" stroke={colour} stroke-width={width} stroke-dasharray={dash.join(" ")} />
          </svg>
          <span>{name}</span>
          <output>{at === null ? "" : digits(values[at], 3)}</output>
        </li>
      ))}
    </ul>
  );
}

interface FigureProps {
  of: Gonio;
  heading: ComponentChildren;
  /** The name of the figure and of the table of the command line. */
  name: string;
  x: readonly number[];
  xName: string;
  yName: string;
  unit: string;
  curves: readonly Curve[];
  label: string;
}

/** Curves over an abscissa. What is saved is the figure and the table of `papilio gonio`. */
function Figure({ of, heading, name, x, xName, yName, unit, curves, label }: FigureProps) {
  const under = useSignal<number | null>(null);
  const at = under.value;
  const figure = of.figures.find((one) => one.name === name);
  const table = of.tables.find((one) => one.name === name);
  return (
    <>
      <div class="surface-head">
        <h3>{heading}</h3>
        <Downloads name={name} svg={() => figure?.svg ?? ""} table={() => table?.csv ?? ""} />
      </div>
      <div class="with-key surface-figure">
        <Curves
          x={x}
          curves={curves}
          xName={xName}
          yName={yName}
          range={[0, 100]}
          height={220}
          label={label}
          hover={(index) => (under.value = index)}
        />
        <Legend curves={curves} at={at} head={at === null ? "" : `${digits(x[at], 3)}${unit}`} />
      </div>
    </>
  );
}

/** Reflected, transmitted and trapped light by inclination, from both sides. */
function ByInclination({ of }: { of: Gonio }) {
  const side = (from: string) => of.totals.filter((total) => total.from === from);
  const values = (from: string, value: (total: Total) => number) => side(from).map((total) => 100 * value(total));
  const seen = (total: Total) => total.transmitted.value - total.trapped.value;
  const all = [
    line(
      "R, above",
      0,
      false,
      values("above", (total) => total.reflected.value),
    ),
    line("T, above", 1, false, values("above", seen)),
    line(
      "trapped",
      2,
      false,
      values("above", (total) => total.trapped.value),
    ),
    line(
      "absorbed",
      3,
      false,
      values("above", (total) => total.absorbed.value),
    ),
    line(
      "R, below",
      0,
      true,
      values("below", (total) => total.reflected.value),
    ),
    line(
      "T, below",
      1,
      true,
      values("below", (total) => total.transmitted.value),
    ),
    line(
      "absorbed, b.",
      3,
      true,
      values("below", (total) => total.absorbed.value),
    ),
  ];
  return (
    <Figure
      of={of}
      heading="By inclination"
      name="totals"
      x={side("above").map(({ theta_deg }) => theta_deg)}
      xName="Inclination of the light in its medium (°)"
      yName="Light (%)"
      unit="°"
      curves={all.filter(({ values }) => values.some((value) => (value ?? 0) > 0))}
      label="Reflected, transmitted and trapped light against inclination, from above and from below"
    />
  );
}

/** Where the light of one inclination goes. */
function AtInclination({ totals }: { totals: readonly Total[] }) {
  const chosen = useSignal<number | null>(null);
  const angles = [...new Set(totals.map(({ theta_deg }) => theta_deg))];
  const theta = angles.includes(chosen.value ?? NaN) ? chosen.value! : (angles[0] ?? 0);
  const rows = totals.filter((total) => total.theta_deg === theta);
  const isAbsorbed = totals.some(({ absorbed }) => absorbed.value > 0);
  return (
    <>
      <div class="controls">
        <label for="surface-theta">Light of inclination</label>
        <select
          id="surface-theta"
          value={String(theta)}
          onChange={(event) => (chosen.value = Number(event.currentTarget.value))}
        >
          {angles.map((angle) => (
            <option key={angle} value={String(angle)}>
              {degrees(angle)}
            </option>
          ))}
        </select>
      </div>
      <div class="scroll" tabindex={0} role="region" aria-label="Where the light of an inclination goes">
        <table class="numbers">
          <thead>
            <tr>
              <th scope="col">from</th>
              <th scope="col">reflected, %</th>
              <th scope="col">transmitted, %</th>
              <th scope="col" title="Transmitted to directions that do not exist in air; a part of transmitted">
                trapped, %
              </th>
              <th scope="col" title="Leaves exactly as from a flat face">
                regular, %
              </th>
              {isAbsorbed && <th scope="col">absorbed, %</th>}
              <th scope="col" title="Of the light transmitted to directions of air, the part beyond 2.5° of the normal">
                haze, %
              </th>
              <th scope="col">facets met</th>
            </tr>
          </thead>
          <tbody>
            {rows.map((total) => (
              <tr key={total.from}>
                <th scope="row">{total.from}</th>
                <td>{percent(total.reflected)}</td>
                <td>{percent(total.transmitted)}</td>
                <td>{percent(total.trapped)}</td>
                <td>{percent(total.regular)}</td>
                {isAbsorbed && <td>{percent(total.absorbed)}</td>}
                <td>{theta === 0 ? percent(total.haze) : "–"}</td>
                <td>{withError(total.mean_facets.value, total.mean_facets.error, 3)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </>
  );
}

/** What waves do along the normal, by wavelength. */
function ByWavelength({ of, waves }: { of: Gonio; waves: readonly WaveRow[] }) {
  const values = (value: (row: WaveRow) => number) => waves.map((row) => 100 * value(row));
  const curves = [
    line(
      "haze",
      0,
      false,
      values(({ haze }) => haze),
    ),
    line(
      "straight",
      1,
      false,
      values(({ straight }) => straight),
    ),
    line(
      "mirror",
      2,
      false,
      values(({ mirror }) => mirror),
    ),
  ];
  const hasForm = waves.some(({ haze_closed_form: form }) => form !== null);
  const withErrors = (value: number, error: number) => withError(100 * value, 100 * error, 2);
  return (
    <section>
      <Figure
        of={of}
        heading="By waves, along the normal"
        name="waves"
        x={waves.map(({ wavelength_nm: nm }) => nm)}
        xName="Wavelength (nm)"
        yName="Light (%)"
        unit=" nm"
        curves={curves}
        label="Haze, straight and mirror part of light along the normal against wavelength"
      />
      <div class="scroll" tabindex={0} role="region" aria-label="Waves by wavelength">
        <table class="numbers">
          <thead>
            <tr>
              <th scope="col">nm</th>
              <th scope="col" title="Square of the rms phase; rays hold above about 10">
                g
              </th>
              <th scope="col">haze, %</th>
              {hasForm && (
                <th scope="col" title="Without a cut-off">
                  haze, closed form, %
                </th>
              )}
              <th scope="col">straight through, %</th>
              <th scope="col">as by a mirror, %</th>
            </tr>
          </thead>
          <tbody>
            {waves.map((row) => (
              <tr key={row.wavelength_nm}>
                <th scope="row">{row.wavelength_nm}</th>
                <td>{digits(row.g, 3)}</td>
                <td>{withErrors(row.haze, row.haze_error)}</td>
                {hasForm && <td>{withErrors(row.haze_closed_form ?? NaN, 0)}</td>}
                <td>{withErrors(row.straight, row.straight_error)}</td>
                <td>{withErrors(row.mirror, row.mirror_error)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      {of.roads && <p class="remark">Validity: {of.roads}.</p>}
    </section>
  );
}

function Statistics({ of, audit }: { of: Gonio; audit: SurfaceAudit }) {
  const heights = audit.heights;
  if (!heights) return null;
  const rows: readonly (readonly [string, string])[] = [
    ["rms height (nm)", digits(1e3 * heights.rms_um, 4)],
    ["rms slope along x, y", `${digits(heights.slope_rms_x, 3)}, ${digits(heights.slope_rms_y, 3)}`],
    ["correlation length (µm)", digits(heights.correlation_um, 4)],
    ["skewness, kurtosis", `${digits(heights.skewness, 2)}, ${digits(heights.kurtosis, 3)}`],
  ];
  return (
    <section>
      <h3>Heights</h3>
      <table class="numbers surface-heights" aria-label="Statistics of the heights">
        <tbody>
          {rows.map(([name, value]) => (
            <tr key={name}>
              <th scope="row">{name}</th>
              <td>{value}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <details>
        <summary>Spectral density, and what the cut-off of an instrument leaves</summary>
        {of.figures
          .filter(({ name }) => name === "psd" || name === "cutoff")
          .map(({ name, svg }) => (
            <Drawn
              key={name}
              name={name}
              svg={svg}
              label={name === "psd" ? "Power spectral density of the heights" : "Rms slope against the cut-off"}
              table={() => of.tables.find((one) => one.name === name)?.csv ?? ""}
            />
          ))}
      </details>
    </section>
  );
}

export function SurfaceResult({ of }: { of: Gonio }) {
  const audit = of.audit as unknown as SurfaceAudit;
  const judged = verdict(audit);
  const along = audit.waves.filter(({ from, theta_deg: deg }) => from === "above" && deg === 0);
  return (
    <>
      {of.totals.length > 0 && (
        <>
          <h3>
            By rays{" "}
            <small>{of.is_full ? `all ${count(of.rays)}` : `a preview, ${count(of.rays)}`} for each inclination</small>
          </h3>
          {judged && (
            <p class="remark verdict">
              <b class={judged.agrees ? "agrees" : "disagrees"}>{judged.agrees ? "✓" : "✗"}</b> {judged.words}
            </p>
          )}
          <AtInclination totals={of.totals} />
          <ByInclination of={of} />
        </>
      )}
      {along.length > 0 && <ByWavelength of={of} waves={along} />}
      <Statistics of={of} audit={audit} />
      {of.notes.map((note) => (
        <p class="remark" key={note}>
          Note: {note}
        </p>
      ))}
    </>
  );
}
