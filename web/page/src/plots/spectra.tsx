// Reflectance factors against wavelength; the values at the pointer are shown next to the names.

import { useComputed, useSignal } from "@preact/signals";

import type { View } from "../api/types.ts";
import { fixed } from "../model/format.ts";
import { stroke } from "../model/states.ts";
import { LiveMark } from "../panels/aged.tsx";
import { Downloads } from "../panels/downloads.tsx";
import { result, shownState, states, title, view } from "../state/design.ts";
import { hoverClass, hovered, pointsAt } from "../state/hover.ts";
import { pinned, pinnedName, pinnedView } from "../state/pin.ts";
import { dark } from "../state/theme.ts";
import { curvesSvg } from "./curves-svg.ts";
import { Curves, type Curve, type Plot } from "./curves.tsx";

/** Returns the colour and the dashes of a state's line in the current theme; they are the same in all diagrams. */
export function lineOf(name: string): { colour: string; dash: readonly number[] } {
  const index = states.value.findIndex(([state]) => state === name);
  const { light, dark: night, dash } = stroke(name, Math.max(0, index));
  return { colour: dark.value ? night : light, dash };
}

/** A sample of a state's line, for the key. */
export function Sample({ name }: { name: string }) {
  const { colour, dash } = lineOf(name);
  return (
    <svg class="sample" viewBox="0 0 22 8" aria-hidden="true">
      <path d="M0 4H22" stroke={colour} stroke-width="2" stroke-dasharray={dash.join(" ")} />
    </svg>
  );
}

const spectrum = (of: View | null, name: string): readonly (number | null)[] =>
  of?.states[name]?.reflectance_factor ?? of?.states[name]?.radiance ?? [];

/** The name of the ordinate without ambient light. */
export const RADIANCE = "Radiance (W/(m² sr nm))";

/** The curve of the pinned design: a colour and dashes that no state has. */
const PINNED = "pinned";
const PINNED_DASH = [9, 1.5, 1, 1.5, 9, 3];
const pinnedLine = () => ({ colour: dark.value ? "#ffb4f1" : "#8a1f7a", dash: PINNED_DASH });

export function Spectra() {
  const under = useSignal<number | null>(null);
  const hidden = useSignal<ReadonlySet<string>>(new Set());
  const wavelengths = useComputed(() => result.value?.wavelength_nm ?? []);
  const curves = useComputed((): Curve[] => {
    const shown = states.value.filter(([name]) => !hidden.value.has(name));
    const own = shown.map(([name]) => ({
      name,
      values: spectrum(view.value, name),
      ...lineOf(name),
      width: name === shownState.value ? 3 : 1.8,
    }));
    const kept = pinnedView.value;
    const before =
      kept && spectrum(kept, shownState.value).length === wavelengths.value.length
        ? [{ name: PINNED, values: spectrum(kept, shownState.value), ...pinnedLine(), width: 1.8 }]
        : [];
    return [...own, ...before];
  });
  const toggle = (name: string) => {
    const next = new Set(hidden.value);
    if (!next.delete(name)) next.add(name);
    hidden.value = next;
  };
  const at = under.value;
  const nm = at === null ? null : wavelengths.value[at];
  const radiance = view.value !== null && !view.value.states[shownState.value]?.reflectance_factor;
  const name = radiance ? RADIANCE : "Reflectance factor";
  const hasPinned = curves.value.some((curve) => curve.name === PINNED);
  const plot: Plot = {
    x: wavelengths.value,
    curves: curves.value,
    xName: "Wavelength (nm)",
    xUnit: "nm",
    yName: name,
    yShort: radiance ? "W/(m² sr nm)" : "Refl. factor",
    range: radiance ? [0, 0] : [0, 0.1],
  };
  const table = () => [
    ["wavelength_nm", ...curves.value.map((curve) => curve.name)],
    ...wavelengths.value.map((nm, i) => [nm, ...curves.value.map((curve) => curve.values[i])]),
  ];
  return (
    <figure class="spectra">
      <figcaption>
        <span>
          Spectra{" "}
          <small class={nm === null || nm === undefined ? "idle" : ""}>
            {nm === null || nm === undefined
              ? "move the pointer over the curves to read values"
              : `at ${fixed(nm, 0)} nm`}
          </small>{" "}
          <LiveMark />
        </span>
        <Downloads name="spectra" table={table} svg={() => curvesSvg(plot)} />
      </figcaption>
      <div class="with-key">
        <Curves
          {...plot}
          label={`${name} of each state against wavelength; the numbers are in spectra.csv`}
          hover={(index) => (under.value = index)}
          near={(curve) => (hovered.value = curve === PINNED ? null : curve)}
          focus={hovered.value}
        />
        <ul class="curve-key">
          {states.value.map(([state]) => (
            <li key={state} class={hoverClass(state)} {...pointsAt(state)}>
              <button type="button" aria-pressed={!hidden.value.has(state)} onClick={() => toggle(state)}>
                <Sample name={state} />
                <span>{state}</span>
                <output>{at === null ? "" : fixed(spectrum(view.value, state)[at], 4)}</output>
              </button>
            </li>
          ))}
          {hasPinned && (
            <li class="pinned-key" title={pinnedName.value}>
              <svg class="sample" viewBox="0 0 22 8" aria-hidden="true">
                <path d="M0 4H22" stroke={pinnedLine().colour} stroke-width="2" stroke-dasharray={PINNED_DASH.join(" ")} />
              </svg>
              <span>
                {shownState.value}, compared
                {pinned.value && pinned.value.title !== title.value && <small> {pinned.value.title}</small>}
              </span>
              <output>{at === null ? "" : fixed(spectrum(pinnedView.value, shownState.value)[at], 4)}</output>
            </li>
          )}
        </ul>
      </div>
    </figure>
  );
}
