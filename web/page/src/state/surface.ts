// A surface by its geometry, which is measured as by `papilio gonio`: its text (TOML), and the last preview or full measurement.
//
// One preview is requested at a time, and only the newest values wait for it: first with few rays, then with more as soon as nothing
// changes. The surface is stored in the browser, for all tabs.

import { batch, computed, signal } from "@preact/signals";

import { get, post, Refused } from "../api/client.ts";
import type { Edit, Gonio, GonioProgress, Named, Problem, SurfaceLayer } from "../api/types.ts";
import { tableAt, type Json, type Table } from "../model/json.ts";
import { Schema, type Node } from "../model/schema.ts";
import { facesOf, type Face } from "../model/surface.ts";
import { fields as design, text as scenario } from "./design.ts";
import { edited, merged } from "./edits.ts";
import { add, fileIds, keptIds, sendAgain } from "./files.ts";
import { ageOf, revisionOf, type Ids, type Revision } from "./revision.ts";
import { recall, remember } from "./keep.ts";
import { edit as editDesign } from "./live.ts";
import { BUSY } from "./server.ts";
import { said } from "./said.ts";
import { showTab } from "./tab.ts";
import { long } from "./work.ts";

/** Rays from each side at each inclination: of a preview while something changes, and of one when nothing does. */
const RAYS = { first: 2_000, fine: 20_000 } as const;
type Step = keyof typeof RAYS;

/** Time without changes after which a preview has more rays, ms; time after which a busy server is asked again, ms. */
const REST_MS = 400;
const AGAIN_MS = 1000;

/** The surface that is shown first. */
const FIRST = "hemispheres";
const KEPT = "papilio.surface";
/** The text of a surface before it has a file. */
const FLAT = '[microgeometry]\nsurface = "flat"\n';

export const schema = signal<Schema | null>(null);
/** Examples of surfaces. */
export const examples = signal<readonly Named[]>([]);

/** Its name: that of its file, without extension. */
export const name = signal("");
export const text = signal("");
/** Changes that are not in the text yet. */
export const pending = signal<readonly Edit[]>([]);
export const gonio = signal<Gonio | null>(null);
/** The surface to which it belongs. */
const gonioOf = signal<Revision>("");
export const problems = signal<readonly Problem[]>([]);
/** A full measurement, and its progress. */
export const full = long();
export const progress = signal<GonioProgress | null>(null);

const revision = computed(() => revisionOf(text.value, keptIds.value));

/** The age of what was measured. */
export const age = computed(() => {
  const isWaiting = pending.value.length > 0;
  const hasFailed = problems.value.length > 0;
  return ageOf(gonioOf.value, { revision: revision.value, isWaiting, isRefused: isWaiting && hasFailed }, hasFailed);
});

/** The keys of the surface with all defaults, without changes; none before its text was read. */
const known = computed(() => (gonioOf.value === revision.value ? ((gonio.value?.fields ?? {}) as Json) : {}));
/** The surface with all defaults, and with the changes that are not measured yet. */
export const fields = computed(() => edited(known.value, pending.value));
export const own = computed((): Table => tableAt(fields.value, "microgeometry"));

let isOpen = false;
let flight: { abort: AbortController; step: Step } | null = null;
let timer: ReturnType<typeof setTimeout> | undefined;
let waiting = false;

/** Whether the surface is the user's own, which is stored; examples and layers are not. */
let isOwn = false;

/** Opens another text. What was measured of the last surface stays, marked, until there are new numbers. */
export function open(whole: string, file: string, own = true, edits: readonly Edit[] = []): void {
  full.reset();
  isOwn = own;
  batch(() => {
    [text.value, name.value, pending.value, problems.value] = [whole, file.replace(/\.toml$/, ""), edits, []];
  });
  flight?.abort.abort();
  kick();
}

/** Changes keys. */
export function edit(edits: readonly Edit[]): void {
  full.reset();
  isOwn = true;
  pending.value = merged(pending.value, edits);
  kick();
}

export const set = (path: string, value: unknown): void => edit([{ op: "set", path, value }]);

/** Discards changes that were refused. */
export function discard(): void {
  batch(() => ([pending.value, problems.value] = [[], []]));
  kick();
}

/** Requests a preview of the newest values. */
function kick(): void {
  clearTimeout(timer);
  if (!isOpen || text.value === "") return;
  waiting = flight !== null;
  if (flight === null) void request("first");
  else if (flight.step === "fine") flight.abort.abort();
}

async function request(step: Step): Promise<void> {
  clearTimeout(timer);
  const [base, sent, ids] = [text.value, pending.value, keptIds.value];
  const abort = new AbortController();
  flight = { abort, step };
  waiting = false;
  let next: (() => void) | null = null;
  try {
    const work = { scenario: base, files: fileIds.value, edits: sent, rays: RAYS[step] };
    const found = await post<Gonio>("gonio", work, abort.signal);
    if (text.value === base) take(found, sent, ids);
    if (step === "first" && found.totals.length > 0)
      next = () => (timer = setTimeout(() => void request("fine"), REST_MS));
  } catch (why) {
    if (!abort.signal.aborted) {
      const refusal = why instanceof Refused ? why : new Refused(0, [{ message: String(why) }]);
      if (refusal.status === BUSY) next = () => (timer = setTimeout(() => void request(step), AGAIN_MS));
      else if (await sendAgain(refusal)) waiting = true;
      else if (text.value === base) problems.value = refusal.problems;
    }
  } finally {
    flight = null;
    if (waiting && isOpen) void request("first");
    else if (next && isOpen) next();
  }
}

function take(found: Gonio, sent: readonly Edit[], ids: Ids): void {
  batch(() => {
    gonio.value = found;
    gonioOf.value = revisionOf(found.scenario, ids);
    text.value = found.scenario;
    pending.value = pending.value.filter((edit) => !sent.includes(edit));
    problems.value = [];
  });
  if (isOwn) remember(KEPT, { name: name.value, text: text.value });
}

/** Measures the surface with all of its rays. */
export async function measure(): Promise<void> {
  clearTimeout(timer);
  flight?.abort.abort();
  progress.value = null;
  const [base, ids] = [text.value, keptIds.value];
  await full.start("gonio/full", { scenario: base, files: fileIds.value }, [], (event, data) => {
    if (event === "progress") progress.value = data as GonioProgress;
    if (event === "done" && text.value === base) take(data as Gonio, [], ids);
  });
}

/** Opens an example. */
export async function openExample(which: string): Promise<void> {
  const { scenario: found } = await get<{ scenario: string }>(`surfaces/${encodeURIComponent(which)}`);
  open(found, which, false);
}

/** Opens the surface of a layer of the design, with the keys of the layer and the indices of its neighbours. */
export async function openLayer(face: Face): Promise<void> {
  try {
    const found = await post<SurfaceLayer[]>("gonio/layers", { scenario: scenario.value, files: fileIds.value });
    const layer = found.find(({ path }) => path === face.path);
    if (layer) open(layer.scenario, layer.file.split("/").at(-1)!, false);
  } catch (why) {
    if (why instanceof Refused && (why.status === BUSY || (await sendAgain(why)))) {
      await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
      return openLayer(face);
    }
    said.value = why instanceof Error ? why.message : String(why);
  }
}

/** The opening of a surface that was requested elsewhere on the page. */
let opening: Promise<void> | null = null;

/** Shows the surface of a layer in its tab. */
export function showLayer(face: Face): void {
  opening = openLayer(face);
  showTab("surface");
}

/** Measures again what was refused or belongs to other files, for example because a file was missing. */
export function again(): void {
  if (problems.peek().length > 0 || (gonio.peek() !== null && gonioOf.peek() !== revision.peek())) kick();
}

/** Shows a surface of the heights or the triangles of an uploaded file in its tab. */
export function showFile(file: string, kind: string): void {
  const surface = { surface: kind === "mesh" ? "mesh" : "height-map", file };
  // As a change, so that its fields are shown if it is refused, for example because the distance of the heights is unknown.
  open(FLAT, file.replace(/\.[^.]*$/, ""), true, [{ op: "set", path: "microgeometry", value: surface }]);
  showTab("surface");
}

/** Puts the surface into the design. */
export async function use(edits: (file: string) => Edit[]): Promise<void> {
  const file = `${name.value || "surface"}.toml`;
  if (!(await add(file, new Blob([text.value])))) return;
  editDesign(edits(file));
  said.value = `${file} is in the design.`;
}

/** Starts measuring when the tab opens; the first surface is the user's last one, that of the design, or an example. */
export async function enter(): Promise<void> {
  isOpen = true;
  if (schema.value === null) {
    const [of, listed] = await Promise.all([get<Node>("surface-schema"), get<Named[]>("surfaces")]);
    batch(() => ([schema.value, examples.value] = [new Schema(of), listed]));
  }
  await opening;
  if (text.value !== "") return kick();
  const face = facesOf(design.value).find(({ isKernel }) => !isKernel);
  const kept = recall<{ name: string; text: string }>(KEPT);
  if (kept?.text) open(kept.text, kept.name);
  else if (face) await openLayer(face);
  if (text.value === "") await openExample(FIRST);
}

/** Stops measuring when the tab closes. A full measurement continues. */
export function leave(): void {
  isOpen = false;
  clearTimeout(timer);
  flight?.abort.abort();
}
