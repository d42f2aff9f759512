// A number with its unit: a slider over the useful range, and an input box that accepts all allowed values.
// The box keeps the typed text while it has the focus; a refused value stays, with the error message.

import { signal, useSignal } from "@preact/signals";
import { useRef } from "preact/hooks";

import { plain } from "../model/format.ts";
import type { Limits } from "../model/schema.ts";
import { position, span, valueAt, type Span } from "../model/span.ts";

/** The id of the field whose slider is being dragged, or "". */
export const dragged = signal("");
for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => (dragged.value = ""));

const NUMBER = /^[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?$/;

/** Returns the number that is typed; null for anything else, such as 0x1F. */
const typedNumber = (text: string): number | null => {
  const plainly = text.trim().replace("−", "-");
  return NUMBER.test(plainly) ? Number(plainly.replace(",", ".")) : null;
};

interface Props {
  id: string;
  name: string;
  /** The key of the number, which determines the useful range. */
  of: string;
  unit: string;
  value: number | undefined;
  limits: Limits;
  /** The text of an empty box. */
  placeholder?: string;
  integer?: boolean;
  invalid: boolean;
  describedBy: string;
  change: (value: number) => void;
}

/** Returns the range of the slider. It stays the same while the slider moves, so that its end does not move away. */
function useSpan(of: string, limits: Limits, value: number): Span {
  const kept = useRef<Span | null>(null);
  if (!kept.current || value < kept.current.min || value > kept.current.max) kept.current = span(of, limits, value);
  return kept.current;
}

/** Number of steps of a slider. */
const STEPS = 1000;

export function NumberField(props: Props) {
  const { id, name, of, unit, value, limits, invalid, describedBy, change } = props;
  const typed = useSignal<string | null>(null);
  const before = useRef(value);
  if (before.current !== value) {
    // A value that was changed elsewhere replaces the typed text.
    before.current = value;
    if (typed.value !== null && typedNumber(typed.value) !== value) typed.value = null;
  }
  const isEmpty = typed.value !== null && typed.value.trim() === "" && value !== undefined;
  const bad = isEmpty || (typed.value !== null && typed.value.trim() !== "" && typedNumber(typed.value) === null);
  const scale = useSpan(of, limits, value ?? Math.max(0, limits.min));
  const shown = typed.value ?? (value === undefined ? "" : plain(value, 10).replace("−", "-"));
  const take = (text: string) => {
    typed.value = text;
    const number = typedNumber(text);
    if (number !== null && Number.isFinite(number)) change(number);
  };
  const slide = (at: number) => {
    const moved = valueAt(scale, at / STEPS);
    change(props.integer ? Math.round(moved) : moved);
  };
  const nudge = (event: KeyboardEvent) => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && bad) {
      // What is typed here was never applied: only the box goes back.
      typed.value = null;
      event.preventDefault();
      event.stopPropagation();
      return;
    }
    const sign = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
    if (sign === 0 || value === undefined) return;
    event.preventDefault();
    const size = scale.log
      ? Math.abs(value) * 0.01
      : Math.max(scale.step, 10 ** Math.floor(Math.log10(Math.abs(value) || 1) - 1));
    typed.value = null;
    change(Number((value + sign * (props.integer ? 1 : size) * (event.shiftKey ? 10 : 1)).toPrecision(8)));
  };
  return (
    <div class="number">
      <input
        type="range"
        min={0}
        max={STEPS}
        step={1}
        value={Math.round(position(scale, value ?? scale.min) * STEPS)}
        aria-label={`${name}, slider`}
        aria-valuetext={`${plain(value ?? scale.min)} ${unit}`}
        onPointerDown={() => (dragged.value = id)}
        onInput={(event) => slide(Number(event.currentTarget.value))}
        ref={(input) => input?.style.setProperty("--part", `${100 * position(scale, value ?? scale.min)}%`)}
      />
      <span class="box">
        <input
          id={id}
          inputMode="decimal"
          autocomplete="off"
          spellcheck={false}
          value={shown}
          placeholder={props.placeholder ?? ""}
          aria-invalid={invalid || bad}
          aria-describedby={[unit && `${id}-unit`, describedBy].filter(Boolean).join(" ") || undefined}
          onInput={(event) => take(event.currentTarget.value)}
          onKeyDown={nudge}
          onBlur={() => (typed.value = null)}
        />
        {unit && <span class="unit" id={`${id}-unit`}>{unit}</span>}
      </span>
      {bad && (
        <p class="error" role="alert">
          {isEmpty ? `Empty: the value stays ${plain(value ?? 0, 10)}.` : `${typed.value} is not a number.`} Expected a
          number
          {Number.isFinite(limits.max - limits.min) && ` from ${plain(limits.min)} to ${plain(limits.max)}`}
          {unit && ` (${unit})`} without unit
        </p>
      )}
    </div>
  );
}
