// A browser of named materials and of illuminants: a list with a search, and for one of them its source and a small plot.
// It opens below the box of the name.

import { signal, useSignal } from "@preact/signals";

import { get } from "../api/client.ts";
import type { IlluminantEntry, IlluminantSheet, MaterialEntry, MaterialSheet } from "../api/types.ts";
import { matching } from "../model/catalogue.ts";
import { plain } from "../model/format.ts";
import { Sketch, type Line } from "../plots/sketch.tsx";

/** What is browsed: the name of the endpoint. */
export type Kind = "materials" | "illuminants";
type Entry = MaterialEntry | IlluminantEntry;
type Sheet = MaterialSheet | IlluminantSheet;

const lists = { materials: signal<readonly Entry[]>([]), illuminants: signal<readonly Entry[]>([]) };
const sheets = new Map<string, Sheet>();

/** Loads the list of a kind once. */
function load(kind: Kind): void {
  if (lists[kind].value.length > 0) return;
  void get<Entry[]>(kind).then(
    (all) => void (lists[kind].value = all),
    () => undefined,
  );
}

/** Returns the names of a kind, as suggestions; they are loaded when first needed. */
export function names(kind: Kind): string[] {
  load(kind);
  return lists[kind].value.map(({ name }) => name);
}

const isMaterial = (entry: Entry): entry is MaterialEntry => "n_550" in entry;

/** A line about an entry in the list. */
const brief = (entry: Entry): string =>
  isMaterial(entry)
    ? `n ${entry.n_550.toFixed(2)}${entry.k_550 >= 0.005 ? `, k ${entry.k_550.toFixed(2)}` : ""}`
    : entry.cct_K
      ? `${Math.round(entry.cct_K)} K${entry.Ra ? `, Ra ${Math.round(entry.Ra)}` : ""}`
      : "";

function lines(sheet: Sheet): Line[] {
  if ("n" in sheet) {
    const line = (name: string, values: number[], colour: string) => ({ name, x: sheet.wavelength_nm, values, colour });
    return [line("n", sheet.n, "#2b5fc7"), line("k", sheet.k, "#c8321f")];
  }
  return [{ name: "", x: sheet.wavelength_nm, values: sheet.relative_power, colour: "#2b5fc7" }];
}

/** The facts about an entry below its plot. */
function Facts({ entry }: { entry: Entry }) {
  const range = isMaterial(entry) ? entry.measured_nm : null;
  return (
    <div class="help">
      <p>{entry.what}</p>
      {isMaterial(entry) && (
        <p>
          n {plain(entry.n_550, 5)}, k {plain(entry.k_550, 3)} at 550 nm;{" "}
          {range
            ? `data from ${plain(range[0] ?? 0, 4)} to ${plain(range[1] ?? 0, 4)} nm`
            : "the same at all wavelengths"}
        </p>
      )}
      {!isMaterial(entry) && (
        <p>
          x {entry.x.toFixed(4)}, y {entry.y.toFixed(4)}; {brief(entry)}; {Math.round(entry.lm_per_W)} lm/W
        </p>
      )}
      <p>
        Source: {entry.source}
        {isMaterial(entry) && entry.page ? `. Page: ${entry.page} (${entry.licence ?? ""})` : ""}
      </p>
    </div>
  );
}

/** A button that opens the browser; `choose` takes the name. */
export function Browser({ kind, value, choose }: { kind: Kind; value: string; choose: (name: string) => void }) {
  const open = useSignal(false);
  const search = useSignal("");
  const sheet = useSignal<Sheet | null>(null);
  const one = kind === "materials" ? "material" : "illuminant";

  const show = async (name: string) => {
    const known = sheets.get(`${kind}/${name}`);
    if (known) return void (sheet.value = known);
    try {
      const loaded = await get<Sheet>(`${kind}/${encodeURIComponent(name)}`);
      sheets.set(`${kind}/${name}`, loaded);
      sheet.value = loaded;
    } catch {
      sheet.value = null;
    }
  };
  const toggle = () => {
    open.value = !open.value;
    if (!open.value) return;
    load(kind);
    void show(value);
  };
  if (!open.value)
    return (
      <button type="button" class="browse" aria-expanded="false" onClick={toggle}>
        Browse {kind}
      </button>
    );

  const found = matching(lists[kind].value, search.value);
  const shown = sheet.value;
  return (
    <div class="browser" role="group" aria-label={`Browser of ${kind}`}>
      <div class="browser-head">
        <span class="box wide">
          <input
            type="search"
            aria-label={`Search ${kind}`}
            placeholder={`Search ${kind}`}
            value={search.value}
            onInput={(event) => (search.value = event.currentTarget.value)}
          />
        </span>
        <button type="button" aria-expanded="true" onClick={toggle}>
          Close
        </button>
      </div>
      <ul class="browser-list" aria-label={`${found.length} ${kind}`}>
        {found.map((entry) => (
          <li key={entry.name}>
            <button
              type="button"
              class={entry.name === shown?.name ? "chosen" : ""}
              aria-pressed={entry.name === value}
              title={entry.what}
              onClick={() => {
                void show(entry.name);
                choose(entry.name);
              }}
              onFocus={() => void show(entry.name)}
              onPointerEnter={() => void show(entry.name)}
            >
              <b>{entry.name}</b> <span>{brief(entry)}</span>
              <small>{entry.what}</small>
            </button>
          </li>
        ))}
        {found.length === 0 && <li class="help">No {one} has these words.</li>}
      </ul>
      {shown && (
        <div aria-live="polite">
          <Sketch
            lines={lines(shown)}
            label={`${shown.name}: ${"n" in shown ? "n and k" : "relative power"} against wavelength`}
          />
          <Facts entry={shown} />
        </div>
      )}
    </div>
  );
}
