// Text controls: names and files, and lists of numbers.

import { listAt, type Json } from "../model/json.ts";
import type { Found } from "../model/schema.ts";
import { files } from "../state/files.ts";
import { held } from "../state/design.ts";
import { set } from "../state/live.ts";

/** The properties of a field's control. */
export interface Props {
  id: string;
  path: string;
  found: Found;
  value: Json | undefined;
  name: string;
  unit: string;
  invalid: boolean;
}

/**
 * Event handlers of a box whose value is applied when it loses the focus. Until then it is stored in `held`, so that it
 * is not lost with the page.
 */
function entered(path: string, meant: (text: string) => Json | undefined) {
  type Of = { currentTarget: HTMLInputElement };
  const of = (event: Of) => meant(event.currentTarget.value);
  return {
    onInput: (event: Of) => {
      const value = of(event);
      held.value = value === undefined ? null : { op: "set", path, value };
    },
    onChange: (event: Of) => {
      const value = of(event);
      if (value !== undefined) set(path, value);
    },
    onBlur: () => void (held.value = null),
  };
}

/** Text with suggestions: known names, uploaded files. */
export function Text({ id, path, value, invalid, found, options = [] }: Props & { options?: string[] }) {
  const names = [...options, ...files.value.filter((file) => file.audit).map((file) => file.name)];
  const list = `${id}-list`;
  const meant = (text: string): Json | undefined => {
    const number = Number(text);
    const wantsNumber = found.def !== "" && text.trim() !== "" && Number.isFinite(number);
    return text === "" ? undefined : wantsNumber ? number : text;
  };
  return (
    <span class="box wide">
      <input
        id={id}
        value={String(value ?? "")}
        list={list}
        aria-invalid={invalid}
        aria-describedby={`${id}-help`}
        autocomplete="off"
        spellcheck={false}
        {...entered(path, meant)}
      />
      <datalist id={list}>
        {names.map((name) => (
          <option key={name} value={name} />
        ))}
      </datalist>
    </span>
  );
}

/** Numbers, separated by commas. */
export function List({ id, path, value, unit, invalid }: Props) {
  const meant = (text: string): Json | undefined => {
    const numbers = text
      .split(/[,;\s]+/)
      .filter(Boolean)
      .map(Number);
    return numbers.length > 0 && numbers.every(Number.isFinite) ? numbers : undefined;
  };
  const numbers = Array.isArray(value) ? value : listAt(value ?? null, "");
  return (
    <span class="box wide">
      <input
        id={id}
        value={numbers.join(", ")}
        aria-invalid={invalid}
        aria-describedby={unit ? `${id}-unit ${id}-help` : `${id}-help`}
        autocomplete="off"
        {...entered(path, meant)}
      />
      {unit && (
        <span class="unit" id={`${id}-unit`}>
          {unit}
        </span>
      )}
    </span>
  );
}
