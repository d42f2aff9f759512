// The text of the scenario, with line numbers and colours. It is read while it is edited; errors are marked at their lines.

import { useEffect, useRef } from "preact/hooks";

import { Elsewhere } from "../fields/form.tsx";
import { coloured } from "../model/toml.ts";
import { draft, pending, problems, text } from "../state/design.ts";
import { retype } from "../state/live.ts";
import { writeOut } from "../state/open.ts";
import { Mends } from "./problems.tsx";

/** Height of a line, px; as in the style sheet. */
const LINE = 18;

/** Lines with errors, from 1, with their columns. */
const errorLines = (): Map<number, number> =>
  new Map(problems.value.flatMap(({ line, column }) => (line ? [[line, column ?? 1] as const] : [])));

/** The lines behind the text: their numbers, their colours, and the marks of errors. */
function Lines({ of }: { of: string }) {
  const wrong = errorLines();
  return (
    <div class="lines" aria-hidden="true">
      {of.split("\n").map((line, i) => (
        <div key={i} class={wrong.has(i + 1) ? "line wrong-line" : "line"}>
          <span class="number">{i + 1}</span>
          {coloured(line).map(({ kind, text: words }, k) => (
            <span key={k} class={kind}>
              {words}
            </span>
          ))}
        </div>
      ))}
    </div>
  );
}

export function Source() {
  const area = useRef<HTMLTextAreaElement>(null);
  const scroller = useRef<HTMLDivElement>(null);
  const shown = draft.value ?? text.value;
  // Pending edits must be in the text before it is edited.
  useEffect(() => void writeOut(), []);
  useEffect(() => {
    if (area.current && area.current.value !== shown && document.activeElement !== area.current)
      area.current.value = shown;
  }, [shown]);
  /** Puts the caret at an error. */
  const jump = (line: number, column: number) => {
    const before = shown.split("\n").slice(0, line - 1);
    const at = before.reduce((sum, one) => sum + one.length + 1, 0) + column - 1;
    area.current?.focus();
    area.current?.setSelectionRange(at, at);
    scroller.current?.scrollTo({ top: Math.max(0, (line - 4) * LINE) });
  };
  const longest = shown.split("\n").reduce((most, line) => Math.max(most, line.length), 0);
  return (
    <div class="source">
      <label for="source">
        The scenario, as for <code>papilio run</code>
      </label>
      <div class="editor-text" ref={scroller}>
        <div
          class="sheet"
          ref={(sheet) => {
            sheet?.style.setProperty("--lines", String(shown.split("\n").length));
            sheet?.style.setProperty("--columns", String(longest));
          }}
        >
          <Lines of={shown} />
          <textarea
            id="source"
            ref={area}
            spellcheck={false}
            wrap="off"
            readOnly={pending.value.length > 0}
            defaultValue={shown}
            aria-invalid={problems.value.length > 0}
            aria-describedby="source-errors"
            onInput={(event) => retype(event.currentTarget.value)}
          />
        </div>
      </div>
      <div id="source-errors">
        {[...errorLines()].map(([line, column]) => (
          <button type="button" key={line} onClick={() => jump(line, column)}>
            Go to line {line}
          </button>
        ))}
        <Elsewhere />
        <div class="mend">
          <Mends of={problems.value} />
        </div>
      </div>
    </div>
  );
}
