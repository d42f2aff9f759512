// The text of the scenario. It is read while it is edited; errors are shown with their lines.

import { useEffect, useRef } from "preact/hooks";

import { Elsewhere } from "../fields/form.tsx";
import { draft, pending, problems, text } from "../state/design.ts";
import { retype } from "../state/live.ts";
import { writeOut } from "../state/open.ts";

export function Source() {
  const area = useRef<HTMLTextAreaElement>(null);
  const shown = draft.value ?? text.value;
  // Pending edits must be in the text before it is edited.
  useEffect(() => void writeOut(), []);
  useEffect(() => {
    if (area.current && area.current.value !== shown && document.activeElement !== area.current)
      area.current.value = shown;
  }, [shown]);
  return (
    <div class="source">
      <label for="source">
        The scenario, as for <code>papilio run</code>
      </label>
      <textarea
        id="source"
        ref={area}
        spellcheck={false}
        readOnly={pending.value.length > 0}
        defaultValue={shown}
        aria-invalid={problems.value.length > 0}
        aria-describedby="source-errors"
        onInput={(event) => retype(event.currentTarget.value)}
      />
      <div id="source-errors">
        <Elsewhere />
      </div>
    </div>
  );
}
