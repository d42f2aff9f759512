// The states as colour patches. The frame of the patches represents a perfect white diffuser in the same light. The
// lower part of each patch shows the pinned design.

import { useComputed } from "@preact/signals";

import type { StateResult, View, Result } from "../api/types.ts";
import { isLight, painted } from "../model/colour.ts";
import { fixed, withError } from "../model/format.ts";
import { result, selected, showState, shownState, states, view } from "../state/design.ts";
import { hoverClass, pointsAt } from "../state/hover.ts";
import { pinned, pinnedView } from "../state/pin.ts";

/** Returns the colours of a view's states by name, and the states that are brighter than the screen can show. */
export function coloursOf(
  result: Result | null,
  view: View | null,
): { colours: Map<string, string>; clipped: readonly string[] } {
  if (!result || !view) return { colours: new Map(), clipped: [] };
  const all = Object.entries(view.states);
  const { white, own } = seenAgainst(result, view);
  const found = painted(
    all.map(([, s]) => [s.X, s.Y, s.Z] as const),
    white,
    own,
  );
  return {
    colours: new Map(all.map(([name], i) => [name, found[i]!.colour])),
    clipped: all.flatMap(([name], i) => (found[i]!.isClipped ? [name] : [])),
  };
}

/** Returns the white to which the viewer is adapted: that of the light, or, without ambient light, the display's own. */
export function seenAgainst(result: Result, view: View): { white: readonly [number, number]; own: number | null } {
  const white = view.states["white"];
  if (!white || white.reflectance_factor || !(white.Y > 0))
    return { white: [result.illuminant.x, result.illuminant.y], own: null };
  const sum = white.X + white.Y + white.Z;
  return { white: [white.X / sum, white.Y / sum], own: white.Y };
}

export const useColours = () => useComputed(() => coloursOf(result.value, view.value));

function Patch({
  name,
  state,
  colour,
  before,
}: {
  name: string;
  state: StateResult;
  colour: string;
  before: string | undefined;
}) {
  const chosen = shownState.value === name;
  const choose = () => {
    showState(name);
    if (chosen) selected.value = "display.pixel.states";
  };
  return (
    <button
      type="button"
      class={(chosen ? "patch chosen" : "patch") + hoverClass(name)}
      aria-pressed={chosen}
      onClick={choose}
      data-state={name}
      {...pointsAt(name)}
    >
      <span
        class={isLight(colour) ? "swatch light" : "swatch"}
        ref={(e) => e?.style.setProperty("background-color", colour)}
      >
        {before && <span class="before" ref={(e) => e?.style.setProperty("background-color", before)} />}
      </span>
      <b>{name}</b>
      <span class="patch-numbers">
        <span>L* {fixed(state.L_star, 1)}</span>
        <span class="dot">, </span>
        <span>Y {withError(100 * state.Y, 100 * state.standard_error.Y, 1)} %</span>
      </span>
    </button>
  );
}

export function Patches() {
  const now = useColours();
  const before = useComputed(() => coloursOf(pinned.value?.result ?? null, pinnedView.value).colours);
  const { colours, clipped } = now.value;
  return (
    <section class="patches" aria-label="States as colour patches">
      <div class="row">
        {states.value.map(([name, state]) => (
          <Patch
            key={name}
            name={name}
            state={state}
            colour={colours.get(name) ?? "#888888"}
            before={before.value.get(name)}
          />
        ))}
      </div>
      {(clipped.length > 0 || pinned.value) && (
        <p class="remark">
          {clipped.length > 0 &&
            `Clipped: ${clipped.join(", ")} ${clipped.length > 1 ? "are" : "is"} brighter than the screen can show, whose white is a perfect white in this light; the hue is kept. `}
          {pinned.value && "The lower part of each patch shows the version that is compared."}
        </p>
      )}
    </section>
  );
}
