// The frame of the page at the top: the title of the design, the steps, undo, open and save.

import { busy, draft, fields, held, opening, pending, title } from "../state/design.ts";
import { discard, edit, isTyped } from "../state/live.ts";
import { unfinished } from "../state/jobs.ts";
import { isNew, redo, undo } from "../state/open.ts";
import { said } from "../state/said.ts";
import { gone } from "../state/server.ts";
import { showTab } from "../state/tab.ts";
import { theme, type Theme } from "../state/theme.ts";
import { canRedo, canUndo } from "../state/undo.ts";
import { missing, wholeText, withoutFiles } from "../state/whole.ts";
import type { Edit } from "../api/types.ts";
import { at } from "../model/json.ts";
import { FileButton } from "./choose.tsx";
import { fileName } from "./file-name.ts";
import { save } from "./save.ts";
import { StepBar } from "./steps.tsx";

async function saveText(): Promise<void> {
  // A text that is being typed belongs to the user as it is, with its mistakes.
  const whole = isTyped() && pending.value.length === 0 ? { text: draft.value!, left: [] } : await wholeText("saved");
  if (whole === null) return;
  save(`${fileName()}.toml`, new Blob([whole.text], { type: "application/toml" }));
  const files = withoutFiles(whole.text);
  if (files || whole.left.length > 0)
    said.value = `The scenario is saved${files}${files && ". Keep them in the same folder"}${missing(whole)}.`;
}

function Mark() {
  return (
    <svg class="logo" viewBox="0 0 32 32" aria-hidden="true">
      <path d="M15 15C9 3 2 4 3 10c.6 4 5 6 11 6.500C8 17 5 20 6 24c1.500 4 7 4 9.500-6Z" class="wing-a" />
      <path d="M17 15C23 3 30 4 29 10c-.6 4-5 6-11 6.500 6 .5 9 3.500 8 7.500-1.500 4-7 4-9.500-6Z" class="wing-b" />
    </svg>
  );
}

const THEMES: readonly Theme[] = ["system", "light", "dark"];

/** Returns the edit that sets the title; an empty title removes the key. */
const titled = (name: string): Edit =>
  name === "" && at(fields.value, "title") !== undefined
    ? { op: "remove", path: "title" }
    : { op: "set", path: "title", value: name };

/** Moves the focus to the result; the address keeps its fragment, which may be a scenario. */
function skip(event: Event): void {
  event.preventDefault();
  document.getElementById("result")?.focus();
}

export function Header() {
  return (
    <header class="head">
      <a class="skip" href="#result" onClick={skip}>
        Skip to the result
      </a>
      <h1>
        <Mark />
        Papilio
      </h1>
      <input
        class="title"
        aria-label="Title of the design"
        readOnly={opening.value !== ""}
        value={title.value}
        onInput={(event) => (held.value = titled(event.currentTarget.value))}
        onChange={(event) => edit([titled(event.currentTarget.value)])}
        onBlur={() => (held.value = null)}
        spellcheck={false}
      />
      {busy.value && isNew.value && (
        <button type="button" class="cancel-change" onClick={discard} title="Go back to the design that is shown">
          Cancel
        </button>
      )}
      <StepBar />
      <div class="tools">
        {unfinished.value > 0 && (
          <button type="button" class="jobs-mark" onClick={() => showTab("jobs")} title="Jobs that are running on the server">
            {unfinished.value} {unfinished.value === 1 ? "job" : "jobs"}
          </button>
        )}
        <button
          type="button"
          disabled={!canUndo.value && !isNew.value}
          onClick={() => void undo()}
          title="Undo (Ctrl+Z)"
        >
          Undo
        </button>
        <button type="button" disabled={!canRedo.value} onClick={redo} title="Redo (Ctrl+Shift+Z)">
          Redo
        </button>
        <FileButton label="Open" title="Open a scenario or a measured file" />
        <button type="button" onClick={() => void saveText()}>
          Save
        </button>
        <select
          aria-label="Colour theme"
          value={theme.value}
          onChange={(event) => (theme.value = event.currentTarget.value as Theme)}
        >
          {THEMES.map((one) => (
            <option key={one} value={one}>
              {one}
            </option>
          ))}
        </select>
      </div>
      {gone.value && (
        <p class="offline" role="alert">
          Papilio does not respond. Your changes are stored in the browser; the page continues when it is back.
        </p>
      )}
      <p class="said" role="status">
        {said.value}
      </p>
    </header>
  );
}
