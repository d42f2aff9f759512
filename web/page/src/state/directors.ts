// The directors of the cells of a liquid-crystal pixel by depth in each state, as the server computes them, for the drawing.

import { effect, signal } from "@preact/signals";

import { post, Refused } from "../api/client.ts";
import type { StateDirectors } from "../api/types.ts";
import { crystalParts } from "../model/crystal.ts";
import { answer, text } from "./design.ts";
import { fileIds } from "./files.ts";
import { BUSY } from "./server.ts";

/** Time after which a busy server is asked again, ms. */
const AGAIN_MS = 700;

/** The director of each cell in each state, by the number of the cell in the stack. */
export const directors = signal<ReadonlyMap<number, readonly StateDirectors[]>>(new Map());

let abort: AbortController | null = null;
let last = "";

/** Requests the directors of a design as soon as its result is there. */
effect(() => {
  const fields = answer.value?.fields;
  const cells = fields ? crystalParts(fields as never).filter(({ kind }) => kind === "cell") : [];
  const work = { scenario: text.value, files: fileIds.value };
  const wanted = JSON.stringify([cells.map(({ index }) => index), work]);
  if (wanted === last) return;
  last = wanted;
  abort?.abort();
  if (cells.length === 0) return;
  const mine = (abort = new AbortController());
  void (async () => {
    const found = new Map<number, readonly StateDirectors[]>();
    for (let i = 0; i < cells.length && !mine.signal.aborted; ) {
      const { index } = cells[i]!;
      try {
        found.set(index, await post<StateDirectors[]>("directors", { ...work, layer: index }, mine.signal));
        i += 1;
      } catch (why) {
        // A cell whose directors cannot be computed is drawn without them.
        if (!(why instanceof Refused && why.status === BUSY)) i += 1;
        else await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
      }
    }
    if (!mine.signal.aborted) directors.value = found;
  })();
});
