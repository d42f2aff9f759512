// One sentence for a first visit, over a working example.

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
        <b>This is a reflective display on a bench.</b> Drag the lamp or the eye, click a layer and move its sliders:
        colours, gamut and contrast follow at once, and every number is the one that <code>papilio run</code> prints.
      </p>
      <button type="button" onClick={close}>
        Got it
      </button>
    </aside>
  );
}
