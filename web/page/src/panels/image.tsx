// The picture on the display, as the reader sees it in this room: beside it the same picture on a screen, and white paper.

import { useComputed, useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { hex, times, type Triple } from "../model/colour.ts";
import { degrees, digits } from "../model/format.ts";
import { at, listAt, numberAt } from "../model/json.ts";
import { anglesOf, camera, direction, fitting, limited, type Tilt } from "../model/perspective.ts";
import { exposure, onScreen, PAPER, SCREEN_CD_M2, SCREEN_REFLECTANCE, type Seen, type White } from "../model/seen.ts";
import { painterOf, type Lamp, type Painter, type SubPixels } from "../plots/seen.ts";
import { answer, fields } from "../state/design.ts";
import {
  factors,
  follow,
  holds,
  imageProblems,
  isComputing,
  isTilting,
  pictureFile,
  pictureName,
  shown,
  source,
  tilt,
  tilted,
  unfollow,
  whiteOfPage,
} from "../state/image.ts";
import { said } from "../state/said.ts";
import { Aged } from "./aged.tsx";
import { FileButton } from "./choose.tsx";
import { fileName } from "./file-name.ts";
import { Menu } from "./menu.tsx";
import { Problems } from "./problems.tsx";
import { save } from "./save.ts";

/** Inclination for a pixel of the pointer, degrees. */
const DEGREES_PER_PX = 0.3;
/** Distance of the eye in widths of a display whose size is unknown. */
const FAR = 4;
/** Angular radius of the image of a lamp that has none, degrees. */
const POINT_DEG = 0.5;
/** The largest magnification. */
const MOST_ZOOM = 64;

const WHITES: readonly (readonly [White, string])[] = [
  ["perfect", "a perfect white in this light"],
  ["display", "the white of the display"],
  ["screen", "the brighter of screen and perfect white"],
];

const FILES = ["states.png", "seen.png", "image.json", "palette.gpl", "palette.css", "palette-epdoptimize.json"];

const illuminance = (): number => numberAt(fields.value, "lighting.illuminance_lx") ?? 0;

/** The exposure of the picture in the light of this moment. */
function useExposure() {
  return useComputed(() => (shown.value ? exposure(shown.value.seen, factors.value, illuminance(), whiteOfPage.value) : null));
}

/** Distance of the eye in widths of the display. */
function distanceOf({ head, size }: Seen): number {
  const width = (head.pitch_mm?.[0] ?? 0) * size[0];
  return width > 0 ? Math.max(1.2, head.distance_mm / width) : FAR;
}

/** Lamps whose mirror images a flat face shows. */
function lamps(): Lamp[] {
  const faces = listAt(fields.value, "display.front").reduce<number>(
    (sum, one) => sum + (numberAt(one, "reflectance") ?? 0),
    0,
  );
  const isBare = !at(fields.value, "display.diffuser") && at(fields.value, "display.glass") && !at(fields.value, "display.glass.surface");
  if (!(faces > 0) && !isBare) return [];
  return listAt(fields.value, "lighting.directed").flatMap((lamp) => {
    if (!((numberAt(lamp, "share") ?? 0) > 0)) return [];
    const radius = Math.max(POINT_DEG, numberAt(lamp, "radius_deg") ?? 0);
    const towards = direction(numberAt(lamp, "theta_deg") ?? 0, numberAt(lamp, "phi_deg") ?? 0);
    return [{ towards, cosine: Math.cos((radius * Math.PI) / 180) }];
  });
}

/** What the sub-pixels of each state add to the colour of the whole pixel; their mean is 0. */
function subPixelsOf(seen: Seen, matrix: readonly Triple[]): SubPixels | null {
  const { sub_pixels: all, colours, states } = seen.head;
  const black = colours[states.indexOf("black")];
  if (all.length === 0 || colours.length !== states.length || !black) return null;
  const windows = all.flatMap(({ window }, k) => window.map((one) => ({ k, one })));
  const area = all.map(({ window }) => window.reduce((sum, [x0, y0, x1, y1]) => sum + (x1! - x0!) * (y1! - y0!), 0));
  const only = all.map((_, k) => states.findIndex((_, s) => all.every(({ shown }, j) => shown[s] === (j === k ? 1 : 0))));
  if (only.some((state) => state < 0)) return null;
  const light = (xyz: readonly number[]) => times(matrix, xyz as unknown as Triple);
  const difference = (a: readonly number[], b: readonly number[], factor: number) =>
    a.map((value, i) => (value - b[i]!) * factor);
  const added = states.map((_, s) => {
    const whole = difference(colours[s]!, black, 1);
    const of = (k: number) => difference(colours[only[k]!]!, black, all[k]!.shown[s]! / Math.max(area[k]!, 1e-6));
    const between = light(whole.map((value) => -value));
    return [...windows.map(({ k }) => light(difference(of(k), whole, 1))), between];
  });
  return { states: seen.states, windows: windows.map(({ one }) => one as [number, number, number, number]), added };
}

/** Makes the pixels of a canvas those of the screen. */
function fitted(canvas: HTMLCanvasElement): [number, number] {
  const box = canvas.getBoundingClientRect();
  const size: [number, number] = [Math.round(box.width * devicePixelRatio), Math.round(box.height * devicePixelRatio)];
  if (canvas.width !== size[0]) canvas.width = size[0];
  if (canvas.height !== size[1]) canvas.height = size[1];
  return size;
}

/** A canvas that is drawn whenever something that it shows has changed, at most once for each frame of the screen. */
function useDrawing(draw: (painter: Painter, canvas: HTMLCanvasElement) => void) {
  const ref = useRef<HTMLCanvasElement>(null);
  const painter = useRef<Painter | null>(null);
  const resized = useSignal(0);
  const next = useRef(0);
  useEffect(() => {
    const canvas = ref.current!;
    painter.current = painterOf(canvas, new URLSearchParams(location.search).has("canvas"));
    canvas.dataset["painter"] = painter.current.name;
    const observer = new ResizeObserver(() => resized.value++);
    observer.observe(canvas);
    // After a reset of the graphics processor the picture is drawn by the main one when the tab is opened again.
    return () => {
      observer.disconnect();
      cancelAnimationFrame(next.current);
      painter.current?.release();
    };
  }, []);
  useSignalEffect(() => {
    void resized.value;
    // The signals that are read here are those after which it is drawn again.
    void [shown.value, factors.value, whiteOfPage.value, tilt.value, source.value, fields.value, zoom.value, middle.value];
    cancelAnimationFrame(next.current);
    next.current = requestAnimationFrame(() => {
      if (painter.current && ref.current) draw(painter.current, ref.current);
    });
  });
  return ref;
}

function Display() {
  const by = useExposure();
  const isMoving = useSignal(false);
  const from = useRef<{ x: number; y: number; tilt: Tilt; middle: readonly [number, number] } | null>(null);
  const subPixels = useComputed(() => (shown.value && by.value ? subPixelsOf(shown.value.seen, by.value.matrix) : null));
  const ref = useDrawing((painter, canvas) => {
    const now = shown.value;
    if (!now || !by.value) return;
    const size = fitted(canvas);
    const height = now.seen.size[1] / now.seen.size[0];
    const scale = fitting(size, height) * zoom.value;
    canvas.dataset["scale"] = String(scale / now.seen.size[0]);
    painter.draw({
      lit: { picture: now.seen, factors: factors.value, added: [0, 0, 0], matrix: by.value.matrix },
      camera: camera(tilt.value, distanceOf(now.seen), height),
      frame: { canvas: size, scale, middle: middle.value },
      lamps: lamps(),
      subPixels: subPixels.value,
    });
    canvas.dataset["drawn"] = String(1 + Number(canvas.dataset["drawn"] ?? 0));
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
    } else tilted.value = limited([start.tilt[0] - DEGREES_PER_PX * dx, start.tilt[1] + DEGREES_PER_PX * dy]);
  };
  const release = () => {
    from.current = null;
    isTilting.value = false;
  };
  const turn = (event: KeyboardEvent) => {
    const steps: Record<string, Tilt> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[event.key];
    if (step && event.shiftKey) {
      const by = 0.1 / zoom.value;
      middle.value = within([middle.value[0] + by * step[0], middle.value[1] + by * step[1]]);
    } else if (step) tilted.value = limited([tilt.value[0] + step[0], tilt.value[1] + step[1]]);
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
  const { theta_deg, phi_deg } = anglesOf(tilt.value);
  const direction = `${degrees(theta_deg)}${phi_deg === 0 ? "" : `, azimuth ${degrees(phi_deg)}`}`;
  return (
    <figure class="seen-display">
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
        <span>The display, seen from {direction}</span>
      </figcaption>
    </figure>
  );
}

/** Magnification, and the point of the display in the middle, in its widths. */
const zoom = { signal: null as never, value: 1 };
