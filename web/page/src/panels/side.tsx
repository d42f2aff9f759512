// The current design and versions side by side: pictures, patches, numbers with their differences, and the spectra of a state.

import { useEffect } from "preact/hooks";

import type { Num } from "../api/types.ts";
import { deltaE2000, type Lab } from "../model/difference.ts";
import { fixed, digits, NONE, signed } from "../model/format.ts";
import { meets, metricsOf, inWords, type Target } from "../model/metrics.ts";
import { sideStroke } from "../model/states.ts";
import { Curves, type Curve, type Plot } from "../plots/curves.tsx";
import { curvesSvg } from "../plots/curves-svg.ts";
import { coloursOf } from "../plots/patches.tsx";
import { RADIANCE } from "../plots/spectra.tsx";
import { shownState, showState, states } from "../state/design.ts";
import { chosen } from "../state/numbers.ts";
import { answerOf, base, columns, CURRENT, followSide, setBase, toggle, type Column } from "../state/side.ts";
import { dark } from "../state/theme.ts";
import { versions } from "../state/versions.ts";
import { bring, CompareFormer } from "./versions.tsx";
import { Downloads } from "./downloads.tsx";
import { PageCanvas } from "./page-canvas.tsx";
import { formOf, type Form } from "./summary.tsx";

/** The line of a column in the plot and in its head. */
function lineOf(of: Column): { colour: string; dash: readonly number[] } {
  const { light, dark: night, dash } = sideStroke(columns.value.indexOf(of));
  return { colour: dark.value ? night : light, dash };
}

function Head({ of }: { of: Column }) {
  const answer = answerOf(of);
  const { colour, dash } = lineOf(of);
  const colours = answer ? [...coloursOf(answer.result, answer.view).colours] : [];
  const version = versions.value.find(({ id }) => id === of.id);
  return (
    <figure data-column={of.name} aria-busy={!answer?.seen && !answer?.words}>
      <figcaption>
        <svg class="sample" viewBox="0 0 22 8" aria-hidden="true">
          <path d="M0 4H22" stroke={colour} stroke-width="2.5" stroke-dasharray={dash.join(" ")} />
        </svg>
        <b>{of.name}</b>
        {of.id === CURRENT ? (
          <small>current</small>
        ) : (
          version && (
            <button type="button" class="key-link" onClick={() => void bring(version)}>
              Open
            </button>
          )
        )}
      </figcaption>
      <PageCanvas seen={answer?.seen} tilt={answer?.tilt ?? [0, 0]} label={`The display of ${of.name}`} />
      <div class="side-patches" role="img" aria-label={`Colours of the states of ${of.name}`}>
        {colours.map(([name, colour]) => (
          <span key={name} title={name} ref={(e) => e?.style.setProperty("background-color", colour)} />
        ))}
      </div>
      <small class="side-words">{answer ? answer.words || (answer.seen ? "" : "picture…") : "computing…"}</small>
    </figure>
  );
}

const numberOf = (of: Column, { metric, form }: Row): number | null => {
  const view = answerOf(of)?.view;
  const value = view ? metricsOf(view).get(metric) : null;
  return typeof value === "number" ? form.factor * value : null;
};

interface Row {
  readonly metric: string;
  readonly target: Target | null;
  readonly form: Form;
}
const rows = (): Row[] => chosen.value.map((one) => ({ ...one, form: formOf(one.metric) }));

const shown = (value: Num, { decimals }: Form): string => (decimals === null ? digits(value, 5) : fixed(value, decimals));

/** Whether a difference is towards the target: true better, false worse, null if no target says so. */
function isBetter(difference: number, target: Target | null): boolean | null {
  if (!target || difference === 0) return null;
  return target.kind === "at_least" ? difference > 0 : difference < 0;
}

function Cell({ of, row }: { of: Column; row: Row }) {
  const [value, from] = [numberOf(of, row), numberOf(base.value, row)];
  const met = row.target && value !== null ? meets(value, row.target) : null;
  const difference = of.id === base.value.id || value === null || from === null ? null : value - from;
  const better = difference === null ? null : isBetter(difference, row.target);
  const decimals = row.form.decimals ?? 3;
  return (
    <td>
      {shown(value, row.form)}
      {met !== null && <span class={met ? "agrees" : "disagrees"}>{met ? " ✓" : " ✗"}</span>}
      {difference !== null && (
        <small class={better === null ? "difference" : better ? "difference agrees" : "difference disagrees"}>
          {signed(difference, decimals)}
          {better !== null && (better ? " better" : " worse")}
        </small>
      )}
    </td>
  );
}

/** CIEDE2000 of a state from that of the base. */
function distance(of: Column, state: string): number | null {
  const labs = [of, base.value].map((one) => {
    const found = answerOf(one)?.view?.states[state];
    return found ? [found.L_star, found.a_star, found.b_star] : [];
  });
  const isKnown = labs.every((lab) => lab.length === 3 && lab.every((part) => typeof part === "number"));
  return isKnown ? deltaE2000(labs[1] as unknown as Lab, labs[0] as unknown as Lab) : null;
}

const table = () => [
  ["number", "unit", "target", ...columns.value.map(({ name }) => name)],
  ...rows().map((row) => [row.form.name, row.form.unit, row.target ? inWords(row.target) : "", ...columns.value.map((of) => numberOf(of, row))]),
  ...states.value.map(([state]) => [`ΔE00 of ${state} from ${base.value.name}`, "", "", ...columns.value.map((of) => distance(of, state))]),
];

function Numbers() {
  return (
    <div class="scroll" tabindex={0} role="region" aria-label="Numbers side by side">
      <table class="numbers side-numbers">
        <thead>
          <tr>
            <th scope="col">
              <Downloads name="side-by-side" table={table} />
            </th>
            {columns.value.map((of) => (
              <th scope="col" key={of.id}>
                {of.name}
                {of.id === CURRENT && versions.value.length > 0 && <small>, current</small>}
              </th>
            ))}
          </tr>
          <tr>
            <th scope="row">differences from</th>
            {columns.value.map((of) => (
              <td key={of.id}>
                <label class="radio">
                  <input
                    type="radio"
                    name="side-base"
                    checked={of.id === base.value.id}
                    onChange={() => setBase(of.id)}
                    aria-label={`Differences from ${of.name}`}
                  />
                </label>
              </td>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows().map((row) => (
            <tr key={row.metric} data-row={row.form.id}>
              <th scope="row" title={row.form.help}>
                {row.form.name} <small>{row.form.unit}</small>
                {row.target && <small> {inWords(row.target)}</small>}
              </th>
              {columns.value.map((of) => (
                <Cell key={of.id} of={of} row={row} />
              ))}
            </tr>
          ))}
          {states.value.map(([state]) => (
            <tr key={state} data-row={`ΔE00 ${state}`}>
              <th scope="row">
                ΔE00 <small>{state}</small>
              </th>
              {columns.value.map((of) => (
                <td key={of.id}>{of.id === base.value.id ? NONE : fixed(distance(of, state), 1)}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** The spectra of the shown state. Designs at other wavelengths are interpolated to those of the current one. */
function spectra(): Plot {
  const known = columns.value.flatMap((of) => {
    const answer = answerOf(of);
    const state = answer?.view?.states[shownState.value];
    const values = state?.reflectance_factor ?? state?.radiance;
    return answer?.result && values ? [{ of, x: answer.result.wavelength_nm, values }] : [];
  });
  // Without ambient light, there is nothing to reflect: the spectra are radiances.
  const isRadiance = known.length > 0 && known.every(({ of }) => !answerOf(of)?.view?.states[shownState.value]?.reflectance_factor);
  const x = known[0]?.x ?? [];
  const at = (nm: number, xs: readonly number[], ys: readonly (number | null)[]): number | null => {
    const k = xs.findIndex((one) => one >= nm);
    if (k < 0 || (k === 0 && xs[0] !== nm)) return null;
    if (xs[k] === nm) return ys[k] ?? null;
    const [a, b] = [ys[k - 1], ys[k]];
    return typeof a === "number" && typeof b === "number" ? a + ((b - a) * (nm - xs[k - 1]!)) / (xs[k]! - xs[k - 1]!) : null;
  };
  const curves = known.map(({ of, x: xs, values }): Curve => ({
    name: of.name,
    values: x.map((nm) => at(nm, xs, values)),
    ...lineOf(of),
    width: of.id === CURRENT ? 3 : 1.8,
  }));
  return { x, curves, xName: "Wavelength (nm)", yName: isRadiance ? RADIANCE : "Reflectance factor", range: isRadiance ? [0, 0] : [0, 0.1] };
}

function Spectra() {
  const plot = spectra();
  if (plot.curves.length === 0) return null;
  const rows = () => [
    ["wavelength_nm", ...plot.curves.map(({ name }) => name)],
    ...plot.x.map((nm, i) => [nm, ...plot.curves.map(({ values }) => values[i])]),
  ];
  return (
    <figure class="side-spectra">
      <figcaption>
        <label>
          Spectra of{" "}
          <select aria-label="State of the spectra" value={shownState.value} onChange={(event) => showState(event.currentTarget.value)}>
            {states.value.map(([name]) => (
              <option key={name} value={name}>
                {name}
              </option>
            ))}
          </select>
        </label>
        <Downloads name="spectra-side-by-side" table={rows} svg={() => curvesSvg(plot)} />
      </figcaption>
      <Curves {...plot} height={230} label={`Spectra of ${shownState.value} of all designs`} />
    </figure>
  );
}

export function SidePanel() {
  useEffect(() => followSide(), []);
  const shownIds = columns.value.map(({ id }) => id);
  return (
    <section class="side seen" aria-label="Designs side by side">
      {versions.value.length === 0 ? (
        <div class="controls">
          <CompareFormer />
          <span class="remark">No version is kept yet. “Keep this version”, below, keeps the current design; then change it, and both are here.</span>
        </div>
      ) : (
        <fieldset class="room-choice">
          <legend>
            Versions <small>each in its own light, as an eye sees it that is adapted to it</small>
          </legend>
          {versions.value.map(({ id, name }) => (
            <label key={id}>
              <input type="checkbox" checked={shownIds.includes(id)} onChange={() => toggle(id)} /> {name}
            </label>
          ))}
        </fieldset>
      )}
      <div class="room-pictures">
        {columns.value.map((of) => (
          <Head key={of.id} of={of} />
        ))}
      </div>
      <Numbers />
      <Spectra />
    </section>
  );
}
