// A short introduction for the first visit.

import { signal } from "@preact/signals";

import { recall, remember } from "../state/keep.ts";

const KEY = "papilio.welcomed";
const shown = signal(recall<boolean>(KEY) !== true);

export function Welcome() {
  if (!shown.value) return null;
  const close = () => {
    shown.value = false;
    remember(KEY, true);
  };
  return (
    <aside class="welcome">
      <p>
        <b>This page simulates a reflective display.</b> Drag the sun, the eye or the display, or click a layer and move
        its sliders: colours, gamut and contrast follow. The steps at the top lead from an example to a report. All numbers equal those of{" "}
        <code>papilio run</code>.
      </p>
      <button type="button" onClick={close}>
        Got it
      </button>
    </aside>
  );
}
