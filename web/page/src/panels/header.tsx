// The actions on the whole design: title, undo, examples, open, save, link, pin, run.

import { named, postForBlob, Refused } from "../api/client.ts";
import { addressOf, show } from "../state/address.ts";
import { draft, fields, held, opening, pending, text, title } from "../state/design.ts";
import { fileIds, keptIds } from "../state/files.ts";
import { edit, isTyped } from "../state/live.ts";
import { isNew, open, redo, undo } from "../state/open.ts";
import { pin, pinned, unpin } from "../state/pin.ts";
import { ready } from "../state/ready.ts";
import { said } from "../state/said.ts";
import { gone } from "../state/server.ts";
import { EXAMPLES } from "../state/shelf.ts";
import { earlier, lookForEarlier, takeUp } from "../state/start.ts";
import { showTab } from "../state/tab.ts";
import { theme, type Theme } from "../state/theme.ts";
import { run, walk } from "../state/walk.ts";
import { canRedo, canUndo } from "../state/undo.ts";
import { missing, wholeText } from "../state/whole.ts";
import type { Edit } from "../api/types.ts";
import { at } from "../model/json.ts";
import { FileButton } from "./choose.tsx";
import { fileName } from "./file-name.ts";
import { Menu } from "./menu.tsx";
import { pngOf } from "../plots/picture.ts";
import { save } from "./save.ts";

/** Returns the uploaded files that a scenario uses and that are not part of its text, as an end of a sentence. */
function withoutFiles(scenario: string): string {
  const left = Object.keys(keptIds.value).filter((name) => scenario.includes(JSON.stringify(name)));
  return left.length > 0 ? `, but not its files: ${left.join(", ")}` : "";
}

async function saveText(): Promise<void> {
  // A text that is being typed belongs to the user as it is, with its mistakes.
  const whole = isTyped() && pending.value.length === 0 ? { text: draft.value!, left: [] } : await wholeText("saved");
  if (whole === null) return;
  save(`${fileName()}.toml`, new Blob([whole.text], { type: "application/toml" }));
  const files = withoutFiles(whole.text);
  if (files || whole.left.length > 0)
    said.value = `The scenario is saved${files}${files && ". Keep them in the same folder"}${missing(whole)}.`;
}

function runWalk(): void {
  showTab("walk");
  if (walk.phase.value !== "running") void run();
}

async function copyLink(): Promise<void> {
  const whole = await wholeText("linked");
  if (whole === null) return;
  const scenario = whole.text;
  const address = await addressOf(scenario);
  try {
    await navigator.clipboard.writeText(address);
    said.value = `The link is copied to the clipboard. It contains the whole scenario${withoutFiles(scenario)}${missing(whole)}.`;
  } catch {
    show(address, scenario);
    said.value = `The address of the page now contains the whole scenario${withoutFiles(scenario)}${missing(whole)}.`;
  }
}

async function openExample(name: string): Promise<void> {
  opening.value = `Opening ${name}…`;
  try {
    const { scenario } = await named("examples", name);
    if (!(await open(scenario, "", `Opening ${name}…`))) opening.value = "";
  } catch (why) {
    opening.value = "";
    said.value = why instanceof Refused ? why.message : String(why);
  }
}

/** Returns the time of a design's last change as text. */
const when = (at: number): string =>
  new Date(at).toLocaleString(undefined, {
    weekday: "short",
    day: "numeric",
    month: "short",
    hour: "2-digit",
    minute: "2-digit",
  });

/** The files that can be exported, the same as on the command line. */
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

/** The status of a program that was built without PNG. */
const NOT_BUILT = 501;

/** Requests a file. A program without PNG sends the figure as SVG, which the browser converts. */
async function exported(what: string): Promise<Blob> {
  const request = (what: string) => postForBlob("export", { scenario: text.value, files: fileIds.value, what });
  try {
    return await request(what);
  } catch (why) {
    if (!(why instanceof Refused && why.status === NOT_BUILT)) throw why;
    return pngOf(await (await request(what.replace(/png$/, "svg"))).text());
  }
}

async function exportAs(what: string): Promise<void> {
  if (!(await ready("exported"))) return;
  said.value = `Exporting ${what}…`;
  try {
    save(`${fileName()}-${what}`, await exported(what));
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
      <div class="tools">
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
        <Menu items={EXAMPLES.value} choose={openExample}>
          Examples
        </Menu>
        {earlier.value.length > 0 && (
          <Menu
            title="Designs of other tabs and earlier visits"
            items={earlier.value.map(({ id, title, change, at }) => ({
              name: id,
              label: title,
              summary: when(at) + (change && `: ${change}`),
            }))}
            choose={takeUp}
            opens={lookForEarlier}
          >
            Earlier
          </Menu>
        )}
        <FileButton label="Open" title="Open a scenario or a measured file" />
        <button type="button" onClick={() => void saveText()}>
          Save
        </button>
        <Menu items={EXPORTS.map((name) => ({ name }))} choose={exportAs}>
          Export
        </Menu>
        <button type="button" onClick={() => void copyLink()}>
          Link
        </button>
        <button
          type="button"
          class="pin"
          aria-pressed={pinned.value !== null}
          title="Keep this design to compare later ones with"
          onClick={() => (pinned.value ? unpin() : void pin())}
        >
          {pinned.value ? "Unpin" : "Pin"}
        </button>
        <button type="button" onClick={runWalk} title="Run the Monte Carlo solver and compare it with the live result">
          Verify
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
