// Controls that are typed into: names and files, and lists of numbers.

import { listAt, type Json } from "../model/json.ts";
import type { Found } from "../model/schema.ts";
import { files } from "../state/files.ts";
import { set } from "../state/live.ts";

/** What a control is told about its field. */
export interface Props {
  id: string;
  path: string;
  found: Found;
  value: Json | undefined;
  name: string;
  unit: string;
  invalid: boolean;
}

/** Free text with suggestions: names that are known, files that were dropped. */
export function Text({ id, path, value, invalid, found, options = [] }: Props & { options?: string[] }) {
  const names = [...options, ...files.value.filter((file) => file.audit).map((file) => file.name)];
  const list = `${id}-list`;
  const take = (text: string) => {
    const number = Number(text);
    const wantsNumber = found.def !== "" && text.trim() !== "" && Number.isFinite(number);
    if (text !== "") set(path, wantsNumber ? number : text);
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
        onChange={(event) => take(event.currentTarget.value)}
      />
      <datalist id={list}>
        {names.map((name) => (
          <option key={name} value={name} />
        ))}
      </datalist>
    </span>
  );
}

/** Numbers, parted by commas. */
export function List({ id, path, value, invalid }: Props) {
  const take = (text: string) => {
    const numbers = text
      .split(/[,;\s]+/)
      .filter(Boolean)
      .map(Number);
    if (numbers.length > 0 && numbers.every(Number.isFinite)) set(path, numbers);
  };
  const numbers = Array.isArray(value) ? value : listAt(value ?? null, "");
  return (
    <span class="box wide">
      <input
        id={id}
        value={numbers.join(", ")}
        aria-invalid={invalid}
        aria-describedby={`${id}-help`}
        autocomplete="off"
        onChange={(event) => take(event.currentTarget.value)}
      />
    </span>
  );
}
