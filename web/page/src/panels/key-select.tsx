// A box that selects a key of the scenario, with its quantity and unit in words.

import { labelText } from "../state/labels.ts";

interface Props {
  /** The accessible name. */
  label: string;
  value: string;
  keys: readonly string[];
  change: (key: string) => void;
}

export function KeySelect({ label, value, keys, change }: Props) {
  return (
    <span class="key-select">
      <select aria-label={label} value={value} onChange={(event) => change(event.currentTarget.value)}>
        {[...new Set([...keys, value])].map((path) => (
          <option key={path} value={path}>
            {path}
          </option>
        ))}
      </select>
      <small>{labelText(value)}</small>
    </span>
  );
}
