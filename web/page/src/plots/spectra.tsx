// Reflectance factors against wavelength; the values at the pointer are shown next to the names.

import { useComputed, useSignal } from "@preact/signals";

import type { View } from "../api/types.ts";
import { fixed } from "../model/format.ts";
import { stroke } from "../model/states.ts";
import { result, shownState, states, view } from "../state/design.ts";
import { pinnedView } from "../state/pin.ts";
import { dark } from "../state/theme.ts";
import { Curves, type Curve } from "./curves.tsx";

/** Returns the colour and the dashes of a state's line in the current theme. */
export function lineOf(name: string, index: number): { colour: string; dash: readonly number[] } {
  const { light, dark: night, dash } = stroke(name, index);
  return { colour: dark.value ? night : light, dash };
}

/** A sample of a state's line, for the key. */
export function Sample({ name, index }: { name: string; index: number }) {
  const { colour, dash } = lineOf(name, index);
  return (
    <svg class="sample" viewBox="0 0 22 8" aria-hidden="true">
      <path d="M0 4H22" stroke={colour} stroke-width="2" stroke-dasharray={dash.join(" ")} />
    </svg>
  );
}

const spectrum = (of: View | null, name: string): readonly (number | null)[] =>
  of?.states[name]?.reflectance_factor ?? of?.states[name]?.radiance ?? [];

export function Spectra() {
  const under = useSignal<number | null>(null);
  const hidden = useSignal<ReadonlySet<string>>(new Set());
  const wavelengths = useComputed(() => result.value?.wavelength_nm ?? []);
  const curves = useComputed((): Curve[] => {
    const shown = states.value.filter(([name]) => !hidden.value.has(name));
    const own = shown.map(([name], i) => ({
      name,
      values: spectrum(view.value, name),
      ...lineOf(name, i),
      width: name === shownState.value ? 3 : 1.8,
    }));
    const kept = pinnedView.value;
    const before =
      kept && spectrum(kept, shownState.value).length === wavelengths.value.length
        ? [
            {
              name: "pinned",
              values: spectrum(kept, shownState.value),
              colour: dark.value ? "#ffffff" : "#000000",
              dash: [12, 3, 3, 3],
              width: 1.4,
            },
          ]
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
  const name = radiance ? "Radiance (W/(m² sr nm))" : "Reflectance factor";
  return (
    <figure class="spectra">
      <figcaption>
        Spectra{" "}
        <small>
          {nm === null || nm === undefined
            ? "move the pointer over the curves to read values"
            : `at ${fixed(nm, 0)} nm`}
        </small>
      </figcaption>
      <div class="with-key">
        <Curves
          x={wavelengths.value}
          curves={curves.value}
          xName="Wavelength (nm)"
          yName={name}
          range={radiance ? [0, 0] : [0, 0.1]}
          label={`${name} of each state against wavelength; the numbers are in spectra.csv`}
          hover={(index) => (under.value = index)}
        />
        <ul class="curve-key">
          {states.value.map(([state], i) => (
            <li key={state}>
              <button type="button" aria-pressed={!hidden.value.has(state)} onClick={() => toggle(state)}>
                <Sample name={state} index={i} />
                <span>{state}</span>
                <output>{at === null ? "" : fixed(spectrum(view.value, state)[at], 4)}</output>
              </button>
            </li>
          ))}
        </ul>
      </div>
    </figure>
  );
}
