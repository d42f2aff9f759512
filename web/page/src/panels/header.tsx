// What is done with the design as a whole: its name, undo, examples, open, save, link, pin, run.

import { named, postForBlob, Refused } from "../api/client.ts";
import { fields, text, title } from "../state/design.ts";
import { fileIds } from "../state/files.ts";
import { edit, replace, set } from "../state/live.ts";
import { packed } from "../state/link.ts";
import { pin, pinned, unpin } from "../state/pin.ts";
import { said } from "../state/said.ts";
import { EXAMPLES } from "../state/shelf.ts";
import { openTab } from "../state/tab.ts";
import { theme, type Theme } from "../state/theme.ts";
import { run, walk } from "../state/walk.ts";
import { canRedo, canUndo, redone, undone } from "../state/undo.ts";
import { at } from "../model/json.ts";
import { FileButton, Menu } from "./choose.tsx";
import { save } from "./save.ts";

const step = (whole: string | null): void => {
  if (whole !== null) replace(whole);
};
export const undo = (): void => step(undone());
export const redo = (): void => step(redone());

/** A file's name for the design. */
export const fileName = (): string =>
  title.value
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-|-$/g, "") || "scenario";

/** The user's own files that the scenario names, as a half sentence. */
function without(): string {
  const left = Object.keys(fileIds.value).filter((name) => text.value.includes(JSON.stringify(name)));
  return left.length > 0 ? `, but not its files: ${left.join(", ")}` : "";
}

function saveText(): void {
  save(`${fileName()}.toml`, new Blob([text.value], { type: "application/toml" }));
  if (without()) said.value = `The scenario is saved${without()}. Keep them beside it.`;
}

function runWalk(): void {
  openTab.value = "walk";
  if (walk.phase.value !== "running") void run();
}

async function copyLink(): Promise<void> {
  const fragment = await packed(text.value);
  history.replaceState(null, "", `#${fragment}`);
  try {
    await navigator.clipboard.writeText(location.href);
    said.value = `The link is copied; it holds the whole scenario${without()}.`;
  } catch {
    said.value = `The address now holds the whole scenario${without()}.`;
  }
}

async function openExample(name: string): Promise<void> {
  if (name) replace((await named("examples", name)).scenario);
}

/** What a design is exported as: the command line's own files. */
const EXPORTS = [
  "report.html",
  "result.json",
  "states.csv",
  "spectra.csv",
  "overview.svg",
  "overview.png",
  "chromaticity.svg",
  "spectra.svg",
  "patches.svg",
  "cone.svg",
];

async function exportAs(what: string): Promise<void> {
  if (!what) return;
  said.value = `Making ${what}…`;
  try {
    save(`${fileName()}-${what}`, await postForBlob("export", { scenario: text.value, files: fileIds.value, what }));
    said.value = `${what} is saved.`;
  } catch (why) {
    said.value = why instanceof Refused ? why.message : String(why);
  }
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

export function Header() {
  const retitle = (name: string) =>
    name === "" && at(fields.value, "title") !== undefined
      ? edit([{ op: "remove", path: "title" }])
      : set("title", name);
  return (
    <header class="head">
      <h1>
        <Mark />
        Papilio
      </h1>
      <input
        class="title"
        aria-label="Title of the design"
        value={title.value}
        onChange={(event) => retitle(event.currentTarget.value)}
        spellcheck={false}
      />
      <div class="tools">
        <button type="button" disabled={!canUndo.value} onClick={undo} title="Undo (Ctrl+Z)">
          Undo
        </button>
        <button type="button" disabled={!canRedo.value} onClick={redo} title="Redo (Ctrl+Shift+Z)">
          Redo
        </button>
        <Menu label="Examples" class="examples" items={EXAMPLES.value} choose={openExample} />
        <FileButton label="Open" title="A scenario, or a measured file" />
        <button type="button" onClick={saveText}>
          Save
        </button>
        <Menu label="Export" class="export" items={EXPORTS.map((name) => ({ name }))} choose={exportAs} />
        <button type="button" onClick={() => void copyLink()}>
          Link
        </button>
        <button type="button" aria-pressed={pinned.value !== null} onClick={() => (pinned.value ? unpin() : pin())}>
          {pinned.value ? "Unpin" : "Pin"}
        </button>
        <button type="button" class="run" onClick={runWalk}>
          Run
        </button>
        <select
          aria-label="Colours of the page"
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
      <p class="said" role="status">
        {said.value}
      </p>
    </header>
  );
}
