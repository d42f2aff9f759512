// The numbers that the user chose: each with its error, its target, and its difference from the pinned design.

import { useSignal } from "@preact/signals";

import type { Num, View } from "../api/types.ts";
import { digits, fixed, signed, thousands, withError } from "../model/format.ts";
import { errorOf, inWords, isValue, meets, metricsOf, type Target } from "../model/metrics.ts";
import { compact } from "../state/compact.ts";
import { view } from "../state/design.ts";
import { labelOf } from "../state/labels.ts";
import { addNumber, chosen, removeNumber, setTarget, type Chosen } from "../state/numbers.ts";
import { addObjective } from "../state/optimize.ts";
import { isPinned, pinnedView } from "../state/pin.ts";
import { showTab } from "../state/tab.ts";
import { MetricPicker } from "./metric-picker.tsx";

/** How a number is shown. */
export interface Form {
  /** A fixed name, with the unit, for tests. */
  readonly id: string;
  readonly name: string;
  readonly unit: string;
  readonly decimals: number | null;
  /** What is shown is the number times this. */
  readonly factor: number;
  readonly help: string;
}

const USUAL: Readonly<Record<string, Omit<Form, "factor"> & { factor?: number }>> = {
  "white.Y": {
    id: "White % Y",
    name: "White reflectance",
    unit: "%",
    decimals: 1,
    factor: 100,
    help: "Luminance factor of the white state: 100 % for a perfect white diffuser in the same light",
  },
  contrast_ratio: {
    id: "Contrast : 1",
    name: "Contrast",
    unit: ": 1",
    decimals: 2,
    help: "Luminance factor of white divided by that of black",
  },
  gamut_percent_srgb: {
    id: "Gamut % sRGB",
    name: "Gamut vs sRGB, u′v′",
    unit: "%",
    decimals: 2,
    help: "Area of the triangle of red, green and blue in u′v′ divided by that of sRGB",
  },
  gamut_percent_ebu: {
    id: "Gamut % EBU",
    name: "Gamut vs EBU, u′v′",
    unit: "%",
    decimals: 2,
    help: "Area of the triangle of red, green and blue in u′v′ divided by that of EBU",
  },
  "white.luminance_cd_m2": {
    id: "White cd/m²",
    name: "White luminance",
    unit: "cd/m²",
    decimals: 1,
    help: "Luminance of the white state",
  },
  text_contrast: {
    id: "Text contrast",
    name: "Text contrast",
    unit: "",
    decimals: 3,
    help: "(white − black)/(white + black/3), with luminances",
  },
};

export function formOf(metric: string): Form {
  const usual = USUAL[metric];
  if (usual) return { factor: 1, ...usual };
  const { quantity, unit, text } = labelOf(metric);
  return { id: metric, name: quantity, unit, decimals: null, factor: 1, help: `${text}: ${metric}` };
}

const times = (value: Num, factor: number): Num => (typeof value === "number" ? factor * value : null);

const shown = (value: Num, error: Num, { decimals }: Form): string =>
  decimals === null ? digits(value, 5) : thousands(withError(value, error, decimals));

/** The fields of a target. */
function TargetEditor({ of, form, close }: { of: Chosen; form: Form; close: () => void }) {
  const kind = useSignal<Target["kind"]>(of.target?.kind ?? "at_least");
  const typed = useSignal(of.target ? String(of.target.value) : "");
  const take = (event: Event) => {
    event.preventDefault();
    const value = Number(typed.value.replace(",", "."));
    if (typed.value.trim() === "" || !Number.isFinite(value)) return;
    setTarget(of.metric, { kind: kind.value, value });
    close();
  };
  const aim = (to: string) => {
    addObjective(of.metric, to);
    showTab("optimize");
    close();
  };
  return (
    <form class="target-editor" onSubmit={take}>
      <select
        aria-label={`Kind of target of ${form.name}`}
        value={kind.value}
        onChange={(event) => (kind.value = event.currentTarget.value as Target["kind"])}
      >
        <option value="at_least">at least</option>
        <option value="at_most">at most</option>
      </select>
      <input
        inputMode="decimal"
        aria-label={`Target of ${form.name}`}
        value={typed.value}
        onInput={(event) => (typed.value = event.currentTarget.value)}
      />
      {form.unit && <span>{form.unit}</span>}
      <button type="submit">Set</button>
      <button type="button" onClick={() => aim("maximise")} title="Make it an objective of Optimise">
        Maximise
      </button>
      <button type="button" onClick={() => aim("minimise")} title="Make it an objective of Optimise">
        Minimise
      </button>
      {of.target && (
        <button
          type="button"
          onClick={() => {
            setTarget(of.metric, null);
            close();
          }}
        >
          No target
        </button>
      )}
      <button
        type="button"
        onClick={() => {
          removeNumber(of.metric);
          close();
        }}
      >
        Remove the number
      </button>
    </form>
  );
}

function Row({ of, now, before }: { of: Chosen; now: View; before: View | null }) {
  const isOpen = useSignal(false);
  const form = formOf(of.metric);
  const value = times(metricsOf(now).get(of.metric), form.factor);
  const error = times(errorOf(now, of.metric), form.factor);
  const was = before ? times(metricsOf(before).get(of.metric), form.factor) : null;
  const decimals = form.decimals ?? 3;
  const met = of.target && meets(value, of.target);
  return (
    <div class={met === false ? "figure missed" : "figure"} title={form.help} data-figure={form.id}>
      <dt>
        <button
          type="button"
          class="figure-name"
          aria-expanded={isOpen.value}
          title={`${form.help}. Click for its target`}
          onClick={() => (isOpen.value = !isOpen.value)}
        >
          {form.name}
        </button>
      </dt>
      <dd>
        <b>{shown(value, error, form)}</b> <small>{form.unit}</small>
        {of.target && (
          <small class={met === null ? "" : met ? "agrees" : "disagrees"}>
            {" "}
            {met === null ? "" : met ? "✓ " : "✗ "}
            {inWords(of.target, form.unit)}
          </small>
        )}
        {before && (
          <span class="difference">
            {typeof was === "number" && typeof value === "number"
              ? `${signed(value - was, decimals)} from ${fixed(was, decimals)}`
              : ""}
          </span>
        )}
        {isOpen.value && <TargetEditor of={of} form={form} close={() => (isOpen.value = false)} />}
      </dd>
    </div>
  );
}

/** Returns the names of all numbers that the view has. */
export const namesNow = (): string[] => (view.value ? [...metricsOf(view.value).keys()].filter(isValue) : []);

export function Summary() {
  const now = view.value;
  // A design does not differ from itself.
  const before = isPinned.value ? null : pinnedView.value;
  if (!now) return null;
  const known = chosen.value.map(({ metric }) => metric);
  return (
    <div class="numbers-chosen">
      <dl class="summary">
        {chosen.value.map((one) => (
          <Row key={one.metric} of={one} now={now} before={before} />
        ))}
      </dl>
      {!compact.value && (
        <MetricPicker
          label="Add a number"
          names={namesNow().filter((name) => !known.includes(name))}
          chosen=""
          choose={addNumber}
        >
          Add a number
        </MetricPicker>
      )}
    </div>
  );
}
