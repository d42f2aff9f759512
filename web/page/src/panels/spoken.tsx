// A summary of the result for screen readers, after each change.

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { fixed } from "../model/format.ts";
import { liveAge } from "../state/age.ts";
import { view } from "../state/design.ts";

/** Time without changes after which the summary is announced, ms. */
const REST_MS = 900;

export function Spoken() {
  const words = useSignal("");
  const isCurrent = liveAge.value === "current" || liveAge.value === "first";
  const now = isCurrent ? view.value : null;
  useEffect(() => {
    if (!now) return;
    const say = () => {
      const white = now.states["white"];
      words.value = `${white ? `White ${fixed(100 * white.Y, 1)} percent. ` : ""}Contrast ${fixed(now.contrast_ratio, 1)}. Gamut ${fixed(now.gamut_percent_srgb, 1)} percent of sRGB.`;
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
