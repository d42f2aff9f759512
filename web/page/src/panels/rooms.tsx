// The same page in other rooms: presets of light, seen from the direction of the design.

import { useEffect, useRef } from "preact/hooks";
import { useSignal } from "@preact/signals";

import { post, postForBytes, Refused } from "../api/client.ts";
import { anglesOf } from "../model/perspective.ts";
import { unpacked, type Seen } from "../model/seen.ts";
import { at } from "../model/json.ts";
import { fields, text, title } from "../state/design.ts";
import { fileIds } from "../state/files.ts";
import { pictureName, tilt } from "../state/image.ts";
import { rooms as chosen, showRooms } from "../state/rooms.ts";
import { BUSY } from "../state/server.ts";
import { PRESETS } from "../state/shelf.ts";
import { picturesSvg } from "../plots/pictures-svg.ts";
import { ContentContext } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { applyPreset } from "./editor.tsx";
import { PageCanvas, pageInWords } from "./page-canvas.tsx";

const REST_MS = 300;
const AGAIN_MS = 700;

interface InRoom {
  readonly seen: Seen | null;
  readonly words: string;
}

/** Requests the picture in the light of a preset; the front light of the display is kept. */
async function seenIn(preset: string, signal: AbortSignal): Promise<Seen> {
  const guide = at(fields.value, "lighting.front_light");
  const edits = [{ op: "set", path: "lighting", value: { preset, ...(guide === undefined ? {} : { front_light: guide }) } }];
  const { scenario } = await post<{ scenario: string }>("edit", { scenario: text.value, edits }, signal);
  const picture = pictureName.value !== null && pictureName.value in fileIds.value ? pictureName.value : null;
  const request = { scenario, files: fileIds.value, picture, halftone: null, ...anglesOf(tilt.value) };
  return unpacked(await postForBytes("image", request, signal));
}

const summaryOf = (preset: string): string => PRESETS.value.find(({ name }) => name === preset)?.summary.replace(/[`*]/g, "") ?? "";

function Picture({ of, preset }: { of: InRoom | undefined; preset: string }) {
  return (
    <figure data-room={preset} aria-busy={of === undefined}>
      <PageCanvas seen={of?.seen} tilt={tilt.value} label={`The display in the light of ${preset}`} />
      <figcaption>
        <span title={summaryOf(preset)}>
          <b>{preset}</b> <small>{of?.words ?? "computing…"}</small>
        </span>
        <button type="button" onClick={() => applyPreset(preset)}>
          Take this light
        </button>
      </figcaption>
    </figure>
  );
}

/** All pictures with their captions as one figure. */
const figureOf = (panel: HTMLElement, rooms: readonly string[], found: Readonly<Record<string, InRoom>>): string =>
  picturesSvg(
    `${title.value}, to an eye that is adapted to each light`,
    rooms.flatMap((room) => {
      const canvas = panel.querySelector<HTMLCanvasElement>(`[data-room="${room}"] canvas`);
      return canvas && found[room]?.seen ? [{ canvas, title: room, words: found[room].words }] : [];
    }),
  );

export function RoomsPanel() {
  const panel = useRef<HTMLElement>(null);
  const found = useSignal<Readonly<Record<string, InRoom>>>({});
  const rooms = chosen.value.filter((name) => PRESETS.value.some((preset) => preset.name === name));
  const key = JSON.stringify([text.value, fileIds.value, pictureName.value, tilt.value, rooms]);
  useEffect(() => {
    const abort = new AbortController();
    found.value = {};
    const all = async () => {
      for (const room of rooms) {
        if (abort.signal.aborted) return;
        try {
          const seen = await seenIn(room, abort.signal);
          found.value = { ...found.value, [room]: { seen, words: pageInWords(seen) } };
        } catch (why) {
          if (abort.signal.aborted) return;
          if (why instanceof Refused && why.status === BUSY) {
            await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
            rooms.push(room);
          } else found.value = { ...found.value, [room]: { seen: null, words: why instanceof Error ? why.message : String(why) } };
        }
      }
    };
    const rest = setTimeout(() => void all(), REST_MS);
    return () => {
      clearTimeout(rest);
      abort.abort();
    };
  }, [key]);
  return (
    <section class="rooms seen" aria-label="Rooms" ref={panel}>
      <fieldset class="room-choice">
        <legend>
          Rooms <small>an eye that is adapted to each; white is a perfect white in its light</small>
        </legend>
        {PRESETS.value.map(({ name, summary }) => (
          <label key={name} title={summary}>
            <input
              type="checkbox"
              checked={rooms.includes(name)}
              onChange={() =>
                showRooms(chosen.value.includes(name) ? chosen.value.filter((one) => one !== name) : [...chosen.value, name])
              }
            />{" "}
            {name}
          </label>
        ))}
      </fieldset>
      {rooms.length > 0 && (
        <div class="controls">
          <ContentContext.Provider value={{ age: rooms.every((room) => room in found.value) ? "current" : "before" }}>
            <Downloads name="rooms" svg={() => figureOf(panel.current!, rooms, found.value)} isNamed />
          </ContentContext.Provider>
        </div>
      )}
      <div class="room-pictures">
        {rooms.map((room) => (
          <Picture key={room} preset={room} of={found.value[room]} />
        ))}
      </div>
    </section>
  );
}
