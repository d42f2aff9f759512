// The comparison of two designs: the keys that differ, and the colours of every state.

import { Fragment } from "preact";

import type { StateResult } from "../api/types.ts";
import { fixed, NONE, plain, signed } from "../model/format.ts";
import { deltaE2000, type Lab } from "../model/difference.ts";
import { differences, partOf } from "../model/keys.ts";
import { isTable, type Json } from "../model/json.ts";
import { coloursOf } from "../plots/patches.tsx";
import { result, resultCount, selected, states, title, view } from "../state/design.ts";
import { open } from "../state/open.ts";
import type { Rows } from "../model/csv.ts";
import { hoverClass, pointsAt } from "../state/hover.ts";
import { isPinned, pin, pinned, pinnedName, pinnedView, unpin } from "../state/pin.ts";
import { liveAge } from "../state/age.ts";
import { Aged, ContentContext } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { MeasuredPanel } from "./measured.tsx";
import { CompareFormer, keep } from "./versions.tsx";

const shown = (value: Json | undefined): string =>
  value === undefined ? NONE : typeof value === "number" ? plain(value) : isTable(value) ? "…" : String(value);

function Keys() {
  const changed = differences(pinned.value!.result.scenario as Json, (result.value?.scenario ?? null) as Json);
  if (changed.length === 0) return <p class="remark">No key differs. Change the design to see the differences here.</p>;
  return (
    <table class="numbers">
      <thead>
        <tr>
          <th scope="col">key</th>
          <th scope="col">compared</th>
          <th scope="col">current</th>
        </tr>
      </thead>
      <tbody>
        {changed.slice(0, 60).map(({ path, before, now }) => (
          <tr key={path}>
            <th scope="row">
              <button type="button" class="key-link" onClick={() => (selected.value = partOf(path))}>
                <code>{path}</code>
              </button>
            </th>
            <td>{shown(before)}</td>
            <td>{shown(now)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** Returns the CIEDE2000 difference between a state of the current and of the pinned design. */
function distance(a: StateResult, b: StateResult): number | null {
  const [now, before] = [a, b].map(({ L_star, a_star, b_star }) => [L_star, a_star, b_star]);
  const known = [...now!, ...before!].every((part) => typeof part === "number");
  return known ? deltaE2000(before as unknown as Lab, now as unknown as Lab) : null;
}

function Colours() {
  const now = coloursOf(result.value, view.value).colours;
  const before = coloursOf(pinned.value!.result, pinnedView.value).colours;
  return (
    <div class="side-by-side">
      {states.value.map(([name, state]) => {
        const was = pinnedView.value?.states[name];
        return (
          <Fragment key={name}>
            <span class={hoverClass(name)} {...pointsAt(name)}>
              {name}
            </span>
            <span
              class="swatch half"
              ref={(e) => e?.style.setProperty("background-color", before.get(name) ?? "")}
              title="compared"
            />
            <span
              class="swatch half"
              ref={(e) => e?.style.setProperty("background-color", now.get(name) ?? "")}
              title="current"
            />
            <span>Y {was ? `${fixed(100 * was.Y, 1)} → ${fixed(100 * state.Y, 1)} %` : NONE}</span>
            <span>ΔL* {was ? signed((state.L_star ?? NaN) - (was.L_star ?? NaN), 1) : NONE}</span>
            <span>ΔE00 {was ? fixed(distance(state, was), 1) : NONE}</span>
          </Fragment>
        );
      })}
    </div>
  );
}

async function swap(): Promise<void> {
  const before = pinned.value;
  if (before && (await pin())) await open(before.text);
}

export function ComparePanel() {
  return (
    <>
      <PinnedPanel />
      <MeasuredPanel />
    </>
  );
}

/** The keys that differ, as a table for a file. */
const keysTable = (): Rows => [
  ["key", "compared", "current"],
  ...differences(pinned.value!.result.scenario as Json, (result.value?.scenario ?? null) as Json).map(
    ({ path, before, now }) => [path, JSON.stringify(before) ?? "", JSON.stringify(now) ?? ""],
  ),
];

/** The colours of both designs, as a table for a file. */
const coloursTable = (): Rows => [
  ["state", "Y_compared", "Y", "L_star_compared", "L_star", "delta_E_2000"],
  ...states.value.map(([name, state]) => {
    const was = pinnedView.value?.states[name];
    return [name, was?.Y, state.Y, was?.L_star, state.L_star, was ? distance(state, was) : null];
  }),
];

function PinnedPanel() {
  if (!pinned.value) {
    return (
      <div class="controls">
        <button type="button" class="run" onClick={() => void keep()}>
          Keep the current design
        </button>
        <CompareFormer />
        <span class="remark">
          The version that is compared is shown next to the current design: in the patches, both diagrams, the tables, and here key by
          key.
        </span>
      </div>
    );
  }
  const same = isPinned.value;
  return (
    <>
      <div class="controls">
        <span>
          Compared with <b>{pinnedName.value}</b>
          {same ? ", equal to the current design" : `; current: ${title.value}${title.value === pinnedName.value ? ", changed" : ""}`}
        </span>
        <button type="button" onClick={swap}>
          Swap
        </button>
        <button type="button" onClick={() => void keep()}>
          Keep the current design instead
        </button>
        <button type="button" onClick={unpin}>
          Stop comparing
        </button>
        <ContentContext.Provider value={{ age: liveAge.value }}>
          <Downloads name="keys" table={keysTable} isNamed />
          <Downloads name="colours" table={coloursTable} isNamed />
        </ContentContext.Provider>
      </div>
      <Aged age={liveAge.value} count={resultCount.value}>
        <div class="compare">
          <div class="scroll" tabindex={0} role="region" aria-label="Keys that differ">
            <Keys />
          </div>
          <Colours />
        </div>
      </Aged>
    </>
  );
}
