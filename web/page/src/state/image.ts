// The picture on the display. One request is in progress at a time, and only the newest values wait for it. While something moves, the
// panel holds its picture, and only what is seen of it is computed; when all rests, its states are decided again for the new light and view:
// by the fast default first, then by the search, if that is wanted.

import { batch, computed, signal } from "@preact/signals";

import { postForBlob, postForBytes, Refused, type Work } from "../api/client.ts";
import type { Problem } from "../api/types.ts";
import { stepsOf } from "../model/halftones.ts";
import { at, isTable, numberAt, textAt } from "../model/json.ts";
import { anglesOf, type Tilt, tiltOf } from "../model/perspective.ts";
import { brighter, exposure, intensities, unpacked, type Planes, type ScreenLight, type Seen, type White } from "../model/seen.ts";
import { answer, fields, states, text, viewIndex } from "./design.ts";
import { present } from "./age.ts";
import { fileIds, keptIds, sendAgain } from "./files.ts";
import { edit, settled } from "./live.ts";
import { BUSY } from "./server.ts";
import { ageOf, revisionOf, type Age, type Revision } from "./revision.ts";
import { steady } from "./steady.ts";

/** Time without changes after which the states are decided again, ms. */
const REST_MS = 300;
/** Time after which a request to a busy server is repeated, ms. */
const AGAIN_MS = 700;
/** A request older than this is cancelled for another design or view, ms. */
const PATIENCE_MS = 1000;
/** Time after which a request to a server that does not respond is repeated, ms. */
const GONE_MS = 2000;

/** What is seen, with the design, the request and the lights for which it was computed. */
export interface Shown {
  readonly seen: Seen;
  readonly design: Revision;
  readonly request: string;
  /** How many there were before it. */
  readonly count: number;
  /** Name of the picture: that of its file, or in words. */
  readonly picture: string;
  /** Illuminance of each light, lx. */
  readonly lights: ReadonlyMap<string, number>;
  /** Whether the states were decided for this light and view. */
  readonly isFresh: boolean;
  /** The halftone that decided them. */
  readonly halftone: string;
  /** Whether a better halftone is being computed. */
  readonly isFirst: boolean;
}

export const shown = signal<Shown | null>(null);
/** The last refusal. */
const refused = signal<{ readonly request: string; readonly problems: readonly Problem[] } | null>(null);
/** The name of a picture that was dropped or chosen; null: that of the scenario, or the program's own. */
export const pictureName = signal<string | null>(null);
/** The halftone that is chosen on the page; null: that of the scenario, or the default and the search. */
export const halftone = signal<string | null>(null);
/** The halftones of the picture if `chosen` is chosen on the page. */
export const stepsFor = (chosen: string | null): readonly string[] =>
  stepsOf({
    chosen,
    own: textAt(fields.value, "image.halftone"),
    hasMatrix: isTable(at(fields.value, "display.matrix")),
    text: text.value,
  });
/** The halftones of the picture: each but the last is shown until the next one is computed. */
export const steps = computed(() => stepsFor(halftone.value));
/** Whether the panel holds its picture whatever the light. */
export const holds = signal(false);
/** Direction of the eye while it is not that of the design. */
export const tilted = signal<Tilt | null>(null);
/** Whether the pointer tilts the display. */
export const isTilting = signal(false);
export const whiteOfPage = signal<White>("perfect");
/** How bright the screen beside the display is. */
export const screenLight = signal<ScreenLight>("paper");
/** Whether the veil in the eye is shown. */
export const isGlaring = signal(true);
/** The picture itself, for the screen beside the display. */
export const source = signal<Planes | null>(null);

/** The direction of the design's only view; null if it has several. */
const onlyView = computed<Tilt | null>(() => {
  const [theta, phi] = ["theta_deg", "phi_deg"].map((key) => at(fields.value, `viewer.${key}`) ?? 0);
  return typeof theta === "number" && typeof phi === "number" ? tiltOf(theta, phi) : null;
});
/** Whether the design has one view, which is moved with the picture. */
export const movesEye = computed(() => onlyView.value !== null);

/** Direction of the eye. */
export const tilt = steady<Tilt>(() => {
  const view = answer.value?.views[viewIndex.value];
  return tilted.value ?? onlyView.value ?? tiltOf(view?.theta_deg ?? 0, view?.phi_deg ?? 0);
});

/** Directions closer than this to the plane of azimuth 0 are moved into it, degrees. */
const IN_PLANE_DEG = 1.5;

/** Moves the eye of the design to a direction, if it has one view. */
export function moveEye([x, y]: Tilt): void {
  if (!movesEye.value) return;
  const { theta_deg, phi_deg } = anglesOf([x, Math.abs(y) < IN_PLANE_DEG ? 0 : y]);
  const theta = Math.round(10 * theta_deg) / 10;
  const phi = Math.round(phi_deg);
  const before = numberAt(fields.value, "viewer.phi_deg") ?? 0;
  edit([
    { op: "set", path: "viewer.theta_deg", value: theta },
    ...(phi === before ? [] : [{ op: "set" as const, path: "viewer.phi_deg", value: phi }]),
  ]);
}

/** Makes a direction the only view of the design. */
export function lookFrom(from: Tilt): void {
  const { theta_deg, phi_deg } = anglesOf(from);
  tilted.value = null;
  edit([
    { op: "set", path: "viewer.theta_deg", value: theta_deg },
    { op: "set", path: "viewer.phi_deg", value: phi_deg },
  ]);
}

/** Factors of the lights of the picture: lamps that have become brighter or darker since it was computed. */
export const factors = steady<readonly number[]>(() =>
  shown.value ? brighter(shown.value.seen.head.lights, shown.value.lights, intensities(fields.value)) : [],
);

/** How colours are shown on this page, in the light of this moment. */
export const exposed = steady(() => {
  const lux = numberAt(fields.value, "lighting.illuminance_lx") ?? 0;
  return shown.value ? exposure(shown.value.seen, factors.value, lux, whiteOfPage.value, screenLight.value) : null;
});

/** The largest magnification. */
export const MOST_ZOOM = 64;
/** Magnification. */
export const zoom = signal(1);
/** The point of the display in the middle of the canvas, in its widths. */
export const middle = signal<readonly [number, number]>([0, 0]);
/** What dragging with the pointer does. */
export const drags = signal<"tilt" | "move">("tilt");

/** Limits the middle to the display. */
export function within([x, y]: readonly [number, number]): readonly [number, number] {
  const [columns, rows] = shown.value?.seen.size ?? [1, 1];
  const inside = (value: number, most: number) => Math.min(most, Math.max(-most, value));
  return [inside(x, 0.5), inside(y, (0.5 * rows) / columns)];
}

export function zoomBy(factor: number): void {
  zoom.value = Math.min(MOST_ZOOM, Math.max(1, zoom.value * factor));
  if (zoom.value === 1) middle.value = [0, 0];
}

/** Shows the whole display as in the design. */
export const reset = (): void =>
  batch(() => {
    [zoom.value, middle.value, tilted.value] = [1, [0, 0], null];
  });

interface Wanted extends Work {
  picture: string | null;
  halftone: string | null;
  theta_deg: number;
  phi_deg: number;
}

const wanted = (): Wanted => ({
  scenario: text.value,
  files: fileIds.value,
  picture: pictureName.value !== null && pictureName.value in fileIds.value ? pictureName.value : null,
  halftone: halftone.value,
  ...anglesOf(tilt.value),
});

/** What determines the picture. */
const keyOf = ({ scenario, picture, halftone, theta_deg, phi_deg }: Wanted): string =>
  JSON.stringify([revisionOf(scenario, keptIds.value), picture, keptIds.value[picture ?? ""], halftone, theta_deg, phi_deg]);
const wantedKey = computed(() => keyOf(wanted()));

/** Why there is no picture of the current design and settings. */
export const imageProblems = computed(() => (refused.value?.request === wantedKey.value ? refused.value.problems : []));

/**
 * The age of the picture. While the eye moves, it is that of the direction before, which its words say.
 */
export const imageAge = computed((): Age => {
  if (shown.value === null) return "current";
  const hasFailed = imageProblems.value.length > 0;
  const age = ageOf(shown.value.design, present.value, hasFailed);
  return age === "current" && shown.value.request !== wantedKey.value ? (hasFailed ? "failed" : "settings") : age;
});

/** Keys of `[image]` that name what is shown. */
export const OWN_SOURCES = ["file", "text", "pattern"];

/** The name of the picture that a request shows. */
const nameOf = ({ picture }: Wanted): string => {
  const isGiven = OWN_SOURCES.some((key) => typeof at(fields.value, `image.${key}`) === "string");
  return picture ?? (isGiven ? "Picture of the scenario" : "A page of text and a photograph");
};

/** What is shown if light and view do not matter: the states are held as long as it is the same. */
const motif = (of: Wanted): string => JSON.stringify([of.picture, of.halftone]);

let running = false;
/** The part of the page that shows the picture; null: none does, and nothing is requested. */
let viewer: object | null = null;
/** The last request that was answered, and how many of its halftones are computed; none: its states were held. */
let done = { what: "", steps: 0 };
/** The request for which files were sent again. */
let resent = "";
/** What the last answer shows. */
let heldFor = "";
let rest: ReturnType<typeof setTimeout> | undefined;
let abort: AbortController | null = null;
/** The request in progress, when it was sent, and whether it is a search, which gives way at once. */
let flying = { what: "", since: 0, isSearch: false };

/** Requests the picture if anything has changed, for the part of the page that shows it. Called whenever it may have. */
export function follow(by: object): void {
  viewer = by;
  const what = wantedKey.value;
  clearTimeout(rest);
  const flight = abort;
  if (flight && what !== flying.what) {
    const until = flying.isSearch ? 0 : flying.since + PATIENCE_MS - performance.now();
    setTimeout(() => abort === flight && flight.abort(), Math.max(0, until));
  }
  if (what !== done.what) void run(false);
  if (isTilting.value) return;
  const left = steps.value.length - (done.what === what ? done.steps : 0);
  if (left <= 0 || (done.what === what && done.steps === 0 && holds.value)) return;
  // The next halftone of what is shown follows at once.
  rest = setTimeout(() => void run(true), done.what === what && done.steps > 0 ? 0 : REST_MS);
}

/** Stops requesting while a part of the page does not show the picture, unless another part has taken it over. */
export function unfollow(by: object): void {
  if (viewer !== by) return;
  viewer = null;
  clearTimeout(rest);
  abort?.abort();
}

async function run(isResting: boolean): Promise<void> {
  if (running || viewer === null) return;
  running = true;
  const request = wanted();
  const [what, design, picture] = [keyOf(request), revisionOf(request.scenario, keptIds.value), nameOf(request)];
  const head = shown.value?.seen.head;
  const names = states.value.map(([name]) => name);
  const canHold = head?.states.every((name) => names.includes(name)) && heldFor === motif(request);
  const [all, step] = [steps.value, done.what === what ? done.steps : 0];
  const isHeld = canHold && head?.held != null && step === 0 && (holds.value || !isResting);
  const kind = all[Math.min(step, all.length - 1)]!;
  const lights = intensities(answer.value?.fields as never);
  abort = new AbortController();
  flying = { what, since: performance.now(), isSearch: step > 0 };
  let wait = 0;
  try {
    const how = isHeld ? { held: head?.held } : all.length > 1 ? { halftone: kind } : {};
    const seen = unpacked(await postForBytes("image", { ...request, ...how }, abort.signal));
    batch(() => {
      const count = (shown.value?.count ?? 0) + 1;
      const halftone = isHeld ? shown.value!.halftone : kind;
      const isFirst = !isHeld && step + 1 < all.length;
      shown.value = { seen, design, request: what, count, picture, lights, isFresh: !isHeld, halftone, isFirst };
      if (seen.source) source.value = seen.source;
      refused.value = null;
    });
    heldFor = motif(request);
    done = { what, steps: isHeld ? 0 : step + 1 };
  } catch (why) {
    const refusal = why instanceof Refused ? why : new Refused(0, [{ message: String(why) }]);
    if (abort.signal.aborted) done = { what: "", steps: 0 };
    else if (refusal.status === BUSY) wait = AGAIN_MS;
    else if (refusal.status === 0) wait = GONE_MS;
    else if (isHeld) {
      // The server no longer holds the picture, or the display has other states now.
      heldFor = "";
    } else if (resent !== what && (await sendAgain(refusal))) resent = what;
    else {
      refused.value = { request: what, problems: refusal.problems };
      done = { what, steps: all.length };
    }
  } finally {
    abort = null;
    running = false;
  }
  if (wait > 0) await new Promise((resolve) => setTimeout(resolve, wait));
  if (viewer) follow(viewer);
}

/** Returns a file of the picture in full size, as `papilio image` and `papilio palette` write it. */
export async function pictureFile(what: string): Promise<Blob> {
  if (!(await settled())) throw new Error("The design has a change that cannot be computed.");
  // Palettes need no states, whose search takes seconds.
  const kind = what.startsWith("palette") ? "none" : steps.value.length > 1 ? steps.value.at(-1) : halftone.value;
  return postForBlob("image/export", { ...wanted(), halftone: kind, what });
}
