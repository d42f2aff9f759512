// A part of the cross-section: a band that is selected with a click or a key, and its words.

import { compact } from "../state/compact.ts";
import { selected } from "../state/design.ts";
import { moveSelected, removeSelected } from "./actions.ts";

/** Left edge and width of the bands. */
export const LEFT = 14;
export const WIDTH = 432;

/** The least height of a band in the compact layout, for fingers: 32 px on a phone. */
const FINGER = 41;
export const scaled = (height: number): number => (compact.value ? Math.max(FINGER, height) : height);

/** A part of the drawing that is selected with a click, Enter or Space. */
export function Part({ path, children, y }: { path: string; children: preact.ComponentChildren; y: number }) {
  const chosen = selected.value === path;
  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" || event.key === " ") selected.value = path;
    else if (event.key === "Delete" || event.key === "Backspace") removeSelected();
    else if (event.altKey && event.key === "ArrowUp") moveWithFocus(-1);
    else if (event.altKey && event.key === "ArrowDown") moveWithFocus(1);
    else if (event.key === "ArrowUp" || event.key === "ArrowDown")
      neighbour(event.currentTarget as Element, event.key === "ArrowUp" ? -1 : 1);
    else return;
    event.preventDefault();
  };
  return (
    <g
      class={chosen ? "part chosen" : "part"}
      role="button"
      tabindex={0}
      aria-pressed={chosen}
      data-part={path}
      transform={`translate(0 ${y})`}
      onClick={() => (selected.value = path)}
      onKeyDown={press}
    >
      {children}
    </g>
  );
}

/** Moves the selected layer, together with the focus. */
function moveWithFocus(by: number): void {
  moveSelected(by);
  requestAnimationFrame(() =>
    document.querySelector<SVGElement>(`[data-part="${CSS.escape(selected.value)}"]`)?.focus(),
  );
}

/** Moves the focus to the next part above or below. */
function neighbour(from: Element, by: number): void {
  const parts = [...(from.closest("svg")?.querySelectorAll<SVGElement>("[data-part]") ?? [])];
  parts[parts.indexOf(from as SVGElement) + by]?.focus();
}

/** The text of a band: its name on the left, its description on the right. */
export function Words({ name, note, height }: { name: string; note: string; height: number }) {
  return (
    <>
      <text class="name" x={LEFT + 9} y={height / 2 + 4}>
        {name}
      </text>
      <text class="note" x={LEFT + WIDTH - 9} y={height / 2 + 4} text-anchor="end">
        {note}
      </text>
    </>
  );
}
