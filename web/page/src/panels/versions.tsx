// Versions of the design: kept with thumbnail, name and key numbers, opened again, and compared with the current design.

import { useSignal } from "@preact/signals";

import type { Result, View } from "../api/types.ts";
import { digits } from "../model/format.ts";
import { metricsOf } from "../model/metrics.ts";
import { coloursOf } from "../plots/patches.tsx";
import { onCanvas } from "../plots/seen-2d.ts";
import { camera, fitting } from "../model/perspective.ts";
import { result, text, title, view } from "../state/design.ts";
import { keptIds, recallFiles } from "../state/files.ts";
import { exposed, factors, imageAge, shown } from "../state/image.ts";
import { labelText } from "../state/labels.ts";
import { former, open } from "../state/open.ts";
import { pin, pinned, pinnedName, pinnedView, repin, unpin } from "../state/pin.ts";
import { said } from "../state/said.ts";
import { earlier, lookForEarlier, takeUp } from "../state/start.ts";
import { present } from "../state/age.ts";
import { revisionOf } from "../state/revision.ts";
import { showTab } from "../state/tab.ts";
import { dropVersion, keepVersion, renameVersion, versions, type Version } from "../state/versions.ts";
import { Menu } from "./menu.tsx";

/** Size of a thumbnail, px. */
const SIZE = [112, 84] as const;
/** The numbers of a card. */
const NUMBERS = ["contrast_ratio", "gamut_percent_srgb", "white.Y"];

/** Draws the colours of the states of a result as stripes. */
function stripes(of: Result | null, view: View | null): string {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = SIZE;
  const context = canvas.getContext("2d");
  const colours = [...coloursOf(of, view).colours.values()];
  colours.forEach((colour, i) => {
    if (!context) return;
    context.fillStyle = colour;
    context.fillRect((i * SIZE[0]) / colours.length, 0, Math.ceil(SIZE[0] / colours.length), SIZE[1]);
  });
  return canvas.toDataURL("image/png");
}

/** Draws the picture of the current design small; its states in stripes if it has no picture. */
function thumbnail(): string {
  const [now, by] = [shown.value, exposed.value];
  if (!now || !by || imageAge.value !== "current") return stripes(result.value, view.value);
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = SIZE;
  const height = now.seen.size[1] / now.seen.size[0];
  onCanvas(canvas).draw({
    lit: { picture: now.seen, factors: factors.value, added: [0, 0, 0], matrix: by.matrix },
    camera: camera([0, 0], 4, height),
    frame: { canvas: SIZE, scale: fitting(SIZE, height), middle: [0, 0] },
    mirrors: [],
    veils: [],
    subPixels: null,
  });
  return canvas.toDataURL("image/png");
}

function numbersOf(view: View | null): Record<string, number> {
  const all = view ? metricsOf(view) : new Map();
  return Object.fromEntries(NUMBERS.flatMap((name) => (typeof all.get(name) === "number" ? [[name, all.get(name)]] : [])));
}

/** Keeps the current design as a version, and compares later ones with it. */
export async function keep(): Promise<void> {
  if (!(await pin())) return;
  const same = versions.value.filter(({ name }) => name === title.value || name.startsWith(`${title.value} `)).length;
  const name = same === 0 ? title.value : `${title.value} ${same + 1}`;
  keepVersion({ name, text: text.value, files: keptIds.value, thumbnail: thumbnail(), numbers: numbersOf(view.value) });
  said.value = `“${name}” is kept; later designs are compared with it.`;
}

/** Keeps the design as it was opened or before the last change as a version, and compares the current one with it. */
export async function keepFormer(): Promise<void> {
  const before = former.value;
  if (!before) return;
  const files = keptIds.value;
  if (!(await repin(before.text, files))) return void (said.value = `The design ${before.words} cannot be computed.`);
  const { revision, title: name, result } = pinned.value!;
  if (versions.value.some((one) => revisionOf(one.text, one.files) === revision)) return;
  const of = pinnedView.value;
  keepVersion({ name: `${name}, ${before.words}`, text: before.text, files, thumbnail: stripes(result, of), numbers: numbersOf(of) });
}

/** The button that compares the current design with what it was before, where nothing is compared yet. */
export function CompareFormer() {
  if (pinned.value || !former.value) return null;
  return (
    <button type="button" onClick={() => void keepFormer()} title={`Keep the design ${former.value.words} as a version, and compare the current one with it`}>
      Compare with before
    </button>
  );
}

export async function bring({ name, text: whole, files }: Version): Promise<void> {
  await recallFiles(files);
  if (await open(whole, "", `Opening ${name}…`)) said.value = `“${name}” is open. Undo restores the previous design.`;
}

/** Compares the current design with a version. */
async function compare({ name, text: whole, files }: Version): Promise<void> {
  if (!(await repin(whole, files))) said.value = `“${name}” cannot be computed, so that nothing is compared with it.`;
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

function Card({ of }: { of: Version }) {
  /** The name while it is typed. */
  const typed = useSignal<string | null>(null);
  const revision = revisionOf(of.text, of.files);
  const isCompared = pinned.value?.revision === revision;
  return (
    <li class={revision === present.value.revision ? "version current" : "version"} data-version={of.name}>
      <button type="button" class="thumbnail" onClick={() => void bring(of)} title={`Open ${of.name}, kept ${when(of.at)}`} aria-label={`Show ${of.name}`}>
        {of.thumbnail && <img src={of.thumbnail} alt="" width={SIZE[0]} height={SIZE[1]} />}
      </button>
      <div>
        <input
          aria-label={`Name of the version ${of.name}`}
          title={of.name}
          value={typed.value ?? of.name}
          onInput={(event) => (typed.value = event.currentTarget.value)}
          onChange={(event) => renameVersion(of.id, event.currentTarget.value)}
          onBlur={() => (typed.value = null)}
        />
        <small>
          {Object.entries(of.numbers).map(([name, value]) => (
            <span key={name} title={labelText(name)}>
              {name === "white.Y" ? `Y ${digits(100 * value, 3)} %` : name === "contrast_ratio" ? `${digits(value, 3)} : 1` : `${digits(value, 3)} % sRGB`}
            </span>
          ))}
        </small>
        <span class="card-tools">
          <button
            type="button"
            aria-pressed={isCompared}
            title="Compare the current design with it"
            onClick={() => (isCompared ? unpin() : void compare(of))}
          >
            {isCompared ? "Compared" : "Compare"}
          </button>
          <button type="button" onClick={() => dropVersion(of.id)} aria-label={`Remove ${of.name}`} title="Remove">
            ×
          </button>
        </span>
      </div>
    </li>
  );
}

export function Versions() {
  const isOpen = useSignal(true);
  const all = versions.value;
  return (
    <section class="versions" aria-label="Versions">
      <div class="versions-bar">
        <button type="button" class="keep" onClick={() => void keep()} title="Keep this design as a version, and compare later ones with it">
          Keep this version
        </button>
        <CompareFormer />
        {pinned.value && (
          <>
            <button type="button" class="key-link" onClick={() => showTab("compare")}>
              Compared with {pinnedName.value}
            </button>
            <button type="button" onClick={unpin}>
              Stop comparing
            </button>
          </>
        )}
        {all.length > 0 && (
          <button type="button" onClick={() => showTab("side")} title="Pictures, spectra and numbers of the versions and the current design">
            Side by side
          </button>
        )}
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
        {all.length > 0 && (
          <button type="button" class="fold" aria-expanded={isOpen.value} onClick={() => (isOpen.value = !isOpen.value)}>
            {all.length} {all.length === 1 ? "version" : "versions"}
          </button>
        )}
      </div>
      {isOpen.value && all.length > 0 && (
        <ul class="cards">
          {all.map((one) => (
            <Card key={one.id} of={one} />
          ))}
        </ul>
      )}
    </section>
  );
}
