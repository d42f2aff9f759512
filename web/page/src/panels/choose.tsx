// A button for choosing local files.

import { useRef } from "preact/hooks";

import { take } from "./drop.tsx";

/** A button that opens the file dialog of the browser. With `stays`, the open tab stays open. */
export function FileButton({ label, title, stays }: { label: string; title?: string; stays?: boolean }) {
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
        onChange={({ currentTarget }) => {
          const files = [...(currentTarget.files ?? [])];
          // A file that was changed and is chosen again is read again.
          currentTarget.value = "";
          void take(files, stays);
        }}
      />
    </>
  );
}
