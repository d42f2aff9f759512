// What opens a choice and does what was chosen: files of the reader's own, and menus.

import { useRef } from "preact/hooks";

import { take } from "./drop.tsx";

/** A button that opens the browser's choice of files. */
export function FileButton({ label, title }: { label: string; title?: string }) {
  const chooser = useRef<HTMLInputElement>(null);
  return (
    <>
      <button type="button" onClick={() => chooser.current?.click()} title={title}>
        {label}
      </button>
      <input
        ref={chooser}
        class="hidden"
        type="file"
        multiple
        tabindex={-1}
        aria-hidden="true"
        onChange={(event) => void take([...(event.currentTarget.files ?? [])])}
      />
    </>
  );
}

interface MenuProps {
  /** Shown while nothing is chosen, which is always. */
  label: string;
  class: string;
  items: readonly { name: string; summary?: string }[];
  choose: (name: string) => Promise<void>;
}

/** A menu that does what is chosen, and stands at its name again. */
export function Menu({ label, class: of, items, choose }: MenuProps) {
  return (
    <select
      class={of}
      aria-label={label}
      value=""
      onChange={(event) => {
        void choose(event.currentTarget.value);
        event.currentTarget.value = "";
      }}
    >
      <option value="">{label}</option>
      {items.map(({ name, summary }) => (
        <option key={name} value={name} title={summary}>
          {name}
        </option>
      ))}
    </select>
  );
}
