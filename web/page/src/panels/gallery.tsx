// The examples in groups by kind of display and by question, found by typing words; and new displays.

import { signal, useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { list, named, post, Refused } from "../api/client.ts";
import type { Named, New } from "../api/types.ts";
import { galleryOf, type Icon, patchesOf } from "../model/gallery.ts";
import { matches } from "../model/metrics.ts";
import { newKind } from "../state/choices.ts";
import { opening } from "../state/design.ts";
import { add } from "../state/files.ts";
import { open } from "../state/open.ts";
import { said } from "../state/said.ts";
import { EXAMPLES, PRESETS } from "../state/shelf.ts";
import { showTab } from "../state/tab.ts";
import { FileButton } from "./choose.tsx";

/** The drawn symbol of a group. */
const ICONS: Readonly<Record<Icon, string>> = {
  film: "M4 9H44M4 14H44M4 19H44M4 19V33H18V27H32V33H44",
  inks: "M4 8H44V32H4ZM12 15a3.5 3.500 0 1 0 .1 0M24 22a3.500 3.500 0 1 0 .1 0M36 14a3.500 3.500 0 1 0 .1 0M13 27a2.500 2.500 0 1 0 .1 0M36 26a2.500 2.500 0 1 0 .1 0",
  face: "M4 18C8 10 12 24 16 16S24 22 28 14S38 22 44 15M4 32H44M24 2V10M14 3L18 10M34 3L30 10",
  lamp: "M24 2V8M16 20L19 8H29L32 20ZM20 20a4 4 0 0 0 8 0M10 34L16 24M38 34L32 24M24 36V28",
  cell: "M4 6H44M4 34H44M12 11L16 29M20 11L22 29M28 11L27 29M36 11L32 29",
  sheet: "M12 4H30L38 12V36H12ZM30 4V12H38M17 20H33M17 26H33M17 31H27",
  eye: "M4 20C14 7 34 7 44 20C34 33 14 33 4 20ZM24 13.5a6.500 6.500 0 1 0 .1 0",
  search: "M5 34V6M5 34H45M9 12C14 28 22 30 42 31M16 26a2 2 0 1 0 .1 0M27 29a2 2 0 1 0 .1 0",
  meter: "M5 34V6M5 34H45M10 28L18 18L26 22L40 9M18 13V23M26 17V27",
  grid: "M6 6H42V34H6ZM18 6V34M30 6V34M6 20H42",
};

/** The title of an example: its name in words, before its summary is read. */
const nameOf = (name: string): string =>
  `${name.charAt(0).toUpperCase()}${name.slice(1)}`
    .replaceAll("-", " ")
    .replace(/^Epaper/, "Electronic paper")
    .replace("Mip lcd", "Memory-in-pixel LCD")
    .replace(/\b(ptfe|iec|h65|h78)\b/gi, (word) => word.toUpperCase());

/** Opens an example; the stage shows it. */
export async function openExample(name: string): Promise<void> {
  opening.value = `Opening ${name}…`;
  try {
    const { scenario } = await named("examples", name);
    if (await open(scenario, "", `Opening ${name}…`)) showTab("stage");
    else opening.value = "";
  } catch (why) {
    opening.value = "";
    said.value = why instanceof Refused ? why.message : String(why);
  }
}

const plain = (summary: string): string => summary.replace(/[`*]/g, "");

/** The colours of an example's states in its light, on the white of a perfect diffuser. */
function Thumbnail({ colours }: { colours: readonly string[] }) {
  if (colours.length === 0) return null;
  return (
    <span class="thumbnail" aria-hidden="true">
      {colours.map((colour, i) => (
        <i key={i} ref={(e) => e?.style.setProperty("background-color", colour)} />
      ))}
    </span>
  );
}

export function Gallery() {
  const search = useSignal("");
  const all = new Map(EXAMPLES.value.map(({ name, summary }) => [name, summary]));
  const groups = galleryOf([...all.keys()])
    .map((group) => ({
      ...group,
      examples: group.examples.filter((name) => matches(`${group.name} ${name} ${all.get(name)}`, search.value)),
    }))
    .filter(({ examples }) => examples.length > 0);
  return (
    <section class="gallery" aria-label="Examples">
      <div class="controls">
        <label>
          Search{" "}
          <input
            type="text"
            class="search"
            value={search.value}
            placeholder="sun, glass, ink, tolerance"
            onInput={(event) => (search.value = event.currentTarget.value)}
          />
        </label>
        <FileButton label="Open a file" title="A scenario, a measurement, n and k, a diffuser, a surface or a photograph" />
        <span class="remark">or drop a scenario, a measurement, n and k, a diffuser, a surface or a photograph anywhere.</span>
      </div>
      {groups.map(({ name, icon, examples }) => (
        <section key={name} aria-label={name}>
          <h2>
            <svg viewBox="0 0 48 40" aria-hidden="true">
              <path d={ICONS[icon]} />
            </svg>
            {name}
          </h2>
          <ul>
            {examples.map((example) => (
              <li key={example}>
                <button type="button" data-example={example} onClick={() => void openExample(example)}>
                  <Thumbnail colours={patchesOf(example)} />
                  <b>{nameOf(example)}</b>
                  <small>{plain(all.get(example) ?? "")}</small>
                </button>
              </li>
            ))}
          </ul>
        </section>
      ))}
      {groups.length === 0 && <p class="remark">No example has these words.</p>}
    </section>
  );
}

/** The kinds of displays to start from. */
const kinds = signal<readonly Named[]>([]);

/** Opens a new display in the light of a preset, with its files, as `papilio new` writes them. */
async function create(display: string, light: string): Promise<void> {
  opening.value = "Opening a new display…";
  try {
    const { scenario, files } = await post<New>("new", { display, light });
    for (const { name, text } of files) await add(name, new Blob([text]));
    if (await open(scenario, "", "Opening a new display…")) showTab("stage");
    else opening.value = "";
  } catch (why) {
    opening.value = "";
    said.value = why instanceof Refused ? why.message : String(why);
  }
}

/** A new display: its kind, and then its light. */
export function NewDisplay() {
  useEffect(() => {
    if (kinds.value.length === 0) void list("displays").then((all) => void (kinds.value = all), () => {});
  }, []);
  return (
    <section class="gallery" aria-label="New display">
      <h2>1. Which display?</h2>
      <ul>
        {kinds.value.map(({ name, summary }) => (
          <li key={name}>
            <button type="button" data-kind={name} aria-pressed={newKind.value === name} onClick={() => (newKind.value = name)}>
              <b>{name}</b>
              <small>{plain(summary)}</small>
            </button>
          </li>
        ))}
      </ul>
      <h2>2. In which light? A click opens it</h2>
      <ul>
        {PRESETS.value.map(({ name, summary }) => (
          <li key={name}>
            <button type="button" data-preset={name} onClick={() => void create(newKind.value, name)}>
              <b>{nameOf(name)}</b>
              <small>{plain(summary)}</small>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
