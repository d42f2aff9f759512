// Borders between the columns, which are moved by pointer or keys and kept for the next visit.

import { signal } from "@preact/signals";

import { recall, remember } from "../state/keep.ts";

const KEY = "papilio.columns";

interface Widths {
  /** Widths of the left and of the right column, px; null: that of the style sheet. */
  readonly left: number | null;
  readonly right: number | null;
}

type Side = keyof Widths;

const LIMITS: Readonly<Record<Side, readonly [number, number]>> = { left: [270, 620], right: [260, 720] };
const STEP = 20;
/** Widths of the style sheet, in usual and in wide windows. */
const USUAL: Readonly<Record<Side, readonly [number, number]>> = { left: [322, 380], right: [352, 440] };
const wide = matchMedia("(min-width: 1600px)");

const known = recall<Partial<Widths>>(KEY);
export const widths = signal<Widths>({ left: known?.left ?? null, right: known?.right ?? null });

/** Sets the widths of the columns of an element. */
export function applyWidths(bench: HTMLElement | null): void {
  for (const side of ["left", "right"] as const) {
    const width = widths.value[side];
    if (width === null) bench?.style.removeProperty(`--${side}`);
    else bench?.style.setProperty(`--${side}`, `${width}px`);
  }
}

function put(side: Side, width: number | null): void {
  const [least, most] = LIMITS[side];
  widths.value = { ...widths.value, [side]: width === null ? null : Math.round(Math.min(most, Math.max(least, width))) };
  remember(KEY, widths.value);
}

const NAMES: Readonly<Record<Side, string>> = { left: "Width of the design", right: "Width of the result" };

export function Divider({ side }: { side: Side }) {
  const column = (bar: HTMLElement): HTMLElement =>
    bar.closest(".bench")!.querySelector<HTMLElement>(side === "left" ? ".design" : ".picture")!;
  const towards = side === "left" ? 1 : -1;
  const drag = (event: PointerEvent) => {
    const bar = event.currentTarget as HTMLElement;
    if (!bar.hasPointerCapture(event.pointerId)) return;
    const box = column(bar).getBoundingClientRect();
    put(side, side === "left" ? event.clientX - box.left : box.right - event.clientX);
  };
  const press = (event: KeyboardEvent) => {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (event.key === "Home") put(side, null);
    else if (by !== 0) put(side, column(event.currentTarget as HTMLElement).offsetWidth + by * towards * STEP);
    else return;
    event.preventDefault();
  };
  return (
    <div
      class={`divider ${side}`}
      role="separator"
      tabindex={0}
      aria-orientation="vertical"
      aria-label={NAMES[side]}
      aria-valuemin={LIMITS[side][0]}
      aria-valuemax={LIMITS[side][1]}
      aria-valuenow={widths.value[side] ?? USUAL[side][wide.matches ? 1 : 0]}
      title="Drag to move the border; a double click resets it"
      onPointerDown={(event) => (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId)}
      onPointerMove={drag}
      onDblClick={() => put(side, null)}
      onKeyDown={press}
    />
  );
}
