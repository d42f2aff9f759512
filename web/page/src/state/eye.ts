// The eye before the picture on the display: its place, the mirror images of lamps that it sees, and the veil in it.

import { computed } from "@preact/signals";

import { glareOf, type Lamp } from "../model/glare.ts";
import { camera, type Camera } from "../model/perspective.ts";
import type { Seen } from "../model/seen.ts";
import { lamps, veilInTheMiddle } from "../panels/image-parts.ts";
import { exposed, factors, isGlaring, shown, tilt } from "./image.ts";
import { steady } from "./steady.ts";

/** Distance of the eye in widths of a display whose size is unknown. */
export const FAR = 4;
/** The nearest eye, in widths of the display. */
const NEAR = 0.7;

/** Distance of the eye in widths of the display; null if the size of the pixels is unknown. */
function distanceOf({ head, size }: Seen): number | null {
  const width = (head.pitch_mm?.[0] ?? 0) * size[0];
  return width > 0 ? Math.max(NEAR, head.distance_mm / width) : null;
}

/** Whether the size of the display is known. */
export const isSizeKnown = computed(() => shown.value !== null && distanceOf(shown.value.seen) !== null);

export const eye = steady<Camera | null>(() => {
  const seen = shown.value?.seen;
  return seen ? camera(tilt.value, distanceOf(seen) ?? FAR, seen.size[1] / seen.size[0]) : null;
});

/** Lamps that have a mirror image. */
export const lampsSeen = computed<readonly Lamp[]>(() => {
  if (!shown.value) return [];
  return lamps(shown.value.seen, factors.value);
});

/** A mirror image in words. */
export interface ImageOfLamp {
  readonly lamp: Lamp;
  readonly isVisible: boolean;
  /** Its angular diameter, degrees. */
  readonly wide_deg: number;
  /** Its luminance on a state, cd/m2: on the brightest and on the darkest, or on all; none if the light is collimated. */
  readonly onStates: readonly (readonly [state: string, cd_m2: number])[];
}

/** Luminances that differ by less than this part are one. */
const SAME = 0.005;

/** The luminance of a mirror image on the brightest and the darkest state; they do not depend on the picture. */
function extremes({ ofStates }: Lamp, white_cd_m2: number): (readonly [string, number])[] {
  const all = [...ofStates].map(([state, Y]) => [state, Y * white_cd_m2] as const).sort((a, b) => b[1] - a[1]);
  const [first, last] = [all[0], all.at(-1)];
  if (!first || !last) return [];
  return first[1] - last[1] <= SAME * first[1] ? [["", first[1]]] : [first, last];
}

export const imagesOfLamps = computed<readonly ImageOfLamp[]>(() =>
  lampsSeen.value.map((lamp) => ({
    lamp,
    isVisible: eye.value !== null && glareOf(lamp, eye.value) !== null,
    wide_deg: 2 * lamp.radius_deg,
    onStates: lamp.isCollimated || !exposed.value ? [] : extremes(lamp, exposed.value.white_cd_m2),
  })),
);

/** Luminance of the veil in the middle of the display, cd/m2. */
export const veil_cd_m2 = computed(() =>
  eye.value && exposed.value && isGlaring.value
    ? veilInTheMiddle(lampsSeen.value, eye.value) * exposed.value.white_cd_m2
    : 0,
);

