// What changed, for screen readers: the display in a sentence, once the hand rests.

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { fixed } from "../model/format.ts";
import { view } from "../state/design.ts";

/** After a pause of so many ms. */
const REST_MS = 900;

export function Spoken() {
  const words = useSignal("");
  const now = view.value;
  useEffect(() => {
    if (!now) return;
    const say = () => {
      const white = now.states["white"];
      words.value = `${white ? `White ${fixed(100 * white.Y, 1)} per cent. ` : ""}Contrast ${fixed(now.contrast_ratio, 1)}. Gamut ${fixed(now.gamut_percent_srgb, 1)} per cent of sRGB.`;
    };
    const rest = setTimeout(say, REST_MS);
    return () => clearTimeout(rest);
  }, [now]);
  return (
    <p class="spoken" role="status">
      {words.value}
    </p>
  );
}
