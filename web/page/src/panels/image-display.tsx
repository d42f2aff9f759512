// The display with its picture: drawn in perspective, tilted and moved by pointer and keys.

import { useComputed, useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { degrees, digits, plain, thousands } from "../model/format.ts";
import { halftoneName } from "../model/halftones.ts";
import { anglesOf, fitting, limited, type Tilt } from "../model/perspective.ts";
import { clippedShare } from "../model/seen.ts";
import { painterOf } from "../plots/painter.ts";
import { LARGE_PX, type Painter } from "../plots/seen.ts";
import { isFaded, markOf } from "../state/age.ts";
import { eye, lampsSeen } from "../state/eye.ts";
import {
  drags,
  exposed,
  factors,
  imageAge,
  imageProblems,
  isGlaring,
  isTilting,
  middle,
  moveEye,
  movesEye,
  reset,
  shown,
  type Shown,
  tilt,
  tilted,
  within,
  zoom,
  zoomBy,
} from "../state/image.ts";
import { awaitsNumbers } from "../state/live.ts";
import { AgeMark, fadedClass } from "./aged.tsx";
import { mirrors, subPixelsOf, veils } from "./image-parts.ts";

/** The least part of the pixels whose clipping is said. */
const LEAST_CLIPPED = 0.001;

/** Inclination for a pixel of the pointer, degrees. */
const DEGREES_PER_PX = 0.3;

/** Tilts the display. The eye of the design follows, so that numbers, patches and picture are of one view. */
function turnTo(to: Tilt, isDrag: boolean): void {
  const next = limited(to);
  if (isDrag || !movesEye.value) tilted.value = next;
  moveEye(next);
}

type Size = readonly [width: number, height: number];

/** Makes the pixels of a canvas those of the screen. */
function fit(canvas: HTMLCanvasElement, box: Size): void {
  const [width, height] = box.map((side) => Math.round(side * devicePixelRatio)) as [number, number];
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}

/**
 * A canvas that is drawn whenever a signal that `draw` reads has changed, at most once for each frame of the screen, and after the frame
 * with the numbers if they are awaited.
 */
export function useDrawing(draw: (canvas: HTMLCanvasElement) => ((painter: Painter) => void) | null) {
  const ref = useRef<HTMLCanvasElement>(null);
  const painter = useRef<Painter | null>(null);
  const box = useSignal<Size | null>(null);
  const next = useRef(0);
  /** What is to be drawn; null: it is drawn. */
  const latest = useRef<((painter: Painter) => void) | null>(null);
  const hasWaited = useRef(false);
  useEffect(() => {
    const observer = new ResizeObserver(([of]) => (box.value = [of!.contentRect.width, of!.contentRect.height]));
    observer.observe(ref.current!);
    return () => {
      observer.disconnect();
      cancelAnimationFrame(next.current);
      next.current = 0;
      painter.current?.release();
    };
  }, []);
  const paint = (): void => {
    next.current = 0;
    const canvas = ref.current;
    if (!canvas || !latest.current) return;
    painter.current ??= painterOf(canvas);
    canvas.dataset["painter"] = painter.current.name;
    latest.current(painter.current);
    latest.current = null;
    canvas.dataset["drawn"] = String(1 + Number(canvas.dataset["drawn"] ?? 0));
  };
  const schedule = (isWaiting: boolean): void => {
    if (!latest.current || next.current !== 0) return;
    if (!isWaiting) next.current = requestAnimationFrame(hasWaited.current ? () => (next.current = requestAnimationFrame(paint)) : paint);
    hasWaited.current = isWaiting;
  };
  useSignalEffect(() => {
    const canvas = ref.current;
    if (!canvas || !box.value) return;
    fit(canvas, box.value);
    latest.current = draw(canvas) ?? latest.current;
    schedule(awaitsNumbers.peek());
  });
  useSignalEffect(() => schedule(awaitsNumbers.value));
  return ref;
}

/** The class of what belongs to the picture. Of the same design, seen from elsewhere, it stays clear. */
export const imageClass = (): string =>
  imageAge.value === "settings" ? "" : fadedClass(imageAge.value, shown.value?.count ?? 0);

/** Which picture is shown. */
function which({ isFresh, isFirst, halftone, seen: { head } }: Shown): string {
  const mark = markOf(imageAge.value);
  if (mark) return mark.words;
  if (head.states.length === 1) return `all of it is in its only state, ${head.states[0]}`;
  if (head.held === null) return "exact colours without a halftone, which no panel of these states can show";
  const room = head.prepared_elsewhere ? "another light (image.prepared_for)" : "this light and view";
  const by = halftoneName(halftone);
  return `a picture prepared for ${isFresh ? room : "an earlier light and view"} by ${by}${isFirst ? "; a better one is being searched for…" : ""}`;
}

export function Display() {
  const isMoving = useSignal(false);
  const from = useRef<{ x: number; y: number; tilt: Tilt; middle: readonly [number, number] } | null>(null);
  const subPixels = useComputed(() =>
    shown.value && exposed.value ? subPixelsOf(shown.value.seen, exposed.value.matrix) : null,
  );
  const isMagnified = useSignal(false);
  const clippedPart = useComputed(() =>
    shown.value && exposed.value ? clippedShare(shown.value.seen, factors.value, exposed.value.matrix) : 0,
  );
  const ref = useDrawing((canvas) => {
    const [now, by, from] = [shown.value, exposed.value, eye.value];
    if (!now || !by || !from) return null;
    const { seen } = now;
    const size = [canvas.width, canvas.height] as const;
    const height = seen.size[1] / seen.size[0];
    const scale = fitting(size, height) * zoom.value;
    canvas.dataset["scale"] = String(scale / seen.size[0]);
    isMagnified.value = subPixels.value !== null && scale / seen.size[0] > LARGE_PX;
    const scenery = {
      lit: { picture: seen, factors: factors.value, added: [0, 0, 0] as const, matrix: by.matrix },
      camera: from,
      frame: { canvas: size, scale, middle: middle.value },
      mirrors: mirrors(lampsSeen.value, by.matrix),
      veils: isGlaring.value ? veils(lampsSeen.value, from, by.matrix) : [],
      subPixels: subPixels.value,
    };
    return (painter) => painter.draw(scenery);
  });
  const press = (event: PointerEvent) => {
    if (event.button !== 0) return;
    isMoving.value = drags.value === "move" || event.shiftKey;
    from.current = { x: event.clientX, y: event.clientY, tilt: tilt.value, middle: middle.value };
    (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
    isTilting.value = !isMoving.value;
  };
  const drag = (event: PointerEvent) => {
    const start = from.current;
    if (!start || !ref.current || !shown.value) return;
    const [dx, dy] = [event.clientX - start.x, event.clientY - start.y];
    if (isMoving.value) {
      const box = ref.current.getBoundingClientRect();
      const { size } = shown.value.seen;
      const scale = fitting([box.width, box.height], size[1] / size[0]) * zoom.value;
      middle.value = within([start.middle[0] - dx / scale, start.middle[1] + dy / scale]);
    } else turnTo([start.tilt[0] - DEGREES_PER_PX * dx, start.tilt[1] + DEGREES_PER_PX * dy], true);
  };
  const release = () => {
    from.current = null;
    isTilting.value = false;
    if (movesEye.value) tilted.value = null;
  };
  const turn = (event: KeyboardEvent) => {
    const steps: Record<string, Tilt> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[event.key];
    if (step && event.shiftKey) {
      const by = 0.1 / zoom.value;
      middle.value = within([middle.value[0] + by * step[0], middle.value[1] + by * step[1]]);
    } else if (step) turnTo([tilt.value[0] + step[0], tilt.value[1] + step[1]], false);
    else if (event.key === "+" || event.key === "=") zoomBy(1.25);
    else if (event.key === "-") zoomBy(0.8);
    else if (event.key === "0") reset();
    else return;
    event.preventDefault();
  };
  const wheel = (event: WheelEvent) => {
    // The wheel alone scrolls the page.
    if (!event.ctrlKey && document.activeElement !== ref.current) return;
    event.preventDefault();
    zoomBy(Math.exp(-0.002 * event.deltaY));
  };
  useEffect(() => {
    const canvas = ref.current!;
    canvas.addEventListener("wheel", wheel, { passive: false });
    return () => canvas.removeEventListener("wheel", wheel);
  }, []);
  const now = shown.value;
  const light = exposed.value && exposed.value.white_cd_m2 > 0 ? ` in ${thousands(plain(Math.PI * exposed.value.white_cd_m2, 4))} lx` : "";
  const { theta_deg, phi_deg } = anglesOf(tilt.value);
  const direction = `${degrees(theta_deg)}${phi_deg === 0 ? "" : `, azimuth ${degrees(phi_deg)}`}`;
  return (
    <figure class={`seen-display${imageClass()}`} data-age={imageAge.value} aria-busy={isFaded(imageAge.value)}>
      <AgeMark age={imageAge.value} count={now?.count ?? 0} />
      <canvas
        ref={ref}
        tabindex={0}
        role="img"
        aria-label={`The picture on the display, seen from ${direction}. Arrows tilt it, with Shift they move it; plus and minus zoom; 0 resets.`}
        onPointerDown={press}
        onPointerMove={drag}
        onPointerUp={release}
        onPointerCancel={release}
        onKeyDown={turn}
      />
      <figcaption>
        <span>
          The display, seen from {direction}
          {light}
          {now ? `: ${which(now)}` : imageProblems.value.length === 0 && ": computing the picture…"}
          {clippedPart.value >= LEAST_CLIPPED &&
            `. Clipped: ${clippedPart.value < 0.995 ? `${digits(100 * clippedPart.value, 2)} % of` : "all"} its pixels are brighter than the screen can show; their hue is kept`}
          {isMagnified.value && ". Magnifier: the panel's sub-pixels, without the blur of the layers above"}
        </span>
      </figcaption>
    </figure>
  );
}

