// Conoscopic maps over all viewing directions, drawn by the same code as on the command line.

import { useSignal } from "@preact/signals";

import type { Cone } from "../api/types.ts";
import { Drawn } from "../plots/figure.tsx";
import { useFollowed } from "../state/follow.ts";
import { pinned } from "../state/pin.ts";
import { Problems } from "./problems.tsx";

/** Time without changes after which the maps are requested, ms; they take longer than the live result. */
const REST_MS = 300;

export function ConePanel() {
  const step = useSignal("3");
  const now = useFollowed<Cone>("cone", { step_deg: Number(step.value) }, REST_MS);
  const before = useFollowed<Cone>("cone", { step_deg: Number(step.value) }, REST_MS, pinned.value?.text ?? null);
  return (
    <>
      <div class="controls">
        <label for="cone-step">Step of the inclinations</label>
        <select id="cone-step" value={step.value} onChange={(event) => (step.value = event.currentTarget.value)}>
          <option value="5">5°</option>
          <option value="3">3°</option>
          <option value="2">2°</option>
          <option value="1">1°</option>
        </select>
        <span role="status">{now.busy ? "computing…" : ""}</span>
      </div>
      <Problems of={now.problems} />
      <div class={now.busy ? "waiting" : ""}>
        {now.value?.figures.map(({ name, svg }) => (
          <Drawn key={name} svg={svg} label={`${name}: maps over all viewing directions`} />
        ))}
      </div>
      {before.value && pinned.value && (
        <>
          <h3>Pinned: {pinned.value.title}</h3>
          {before.value.figures.map(({ name, svg }) => (
            <Drawn key={name} svg={svg} label={`${name} of the pinned design`} />
          ))}
        </>
      )}
    </>
  );
}
