// Conoscopic maps over all viewing directions, drawn by the same code as on the command line.

import { useSignal } from "@preact/signals";

import type { Cone } from "../api/types.ts";
import type { Rows } from "../model/csv.ts";
import { Drawn } from "../plots/figure.tsx";
import { useFollowed } from "../state/follow.ts";
import { pinned, pinnedName } from "../state/pin.ts";
import { Aged } from "./aged.tsx";
import { Problems } from "./problems.tsx";

/** Time without changes after which the maps are requested, ms; they take longer than the live result. */
const REST_MS = 300;

/** Step of the inclinations of the first answer, degrees, and time without changes after which it is requested, ms. */
const COARSE_DEG = 10;
const FIRST_MS = 80;

/** The quantities of all directions and states; theta varies fastest. */
function tableOf(cone: Cone | null): Rows {
  if (!cone) return [];
  const { theta_deg: theta, phi_deg: phi, states, data, quantities } = cone;
  return [
    ["theta_deg", "phi_deg", "state", ...quantities],
    ...data.flatMap((of, i) =>
      of.map((values, k) => [theta[i % theta.length], phi[Math.floor(i / theta.length)], states[k], ...values]),
    ),
  ];
}

export function ConePanel() {
  const step = useSignal("3");
  const fine = useFollowed<Cone>("cone", { step_deg: Number(step.value) }, REST_MS);
  const coarse = useFollowed<Cone>("cone", { step_deg: COARSE_DEG }, FIRST_MS);
  // Until the maps of this design are there, coarse ones are a first answer.
  const isFirst = coarse.value !== null && coarse.age === "current" && fine.age !== "current" && fine.problems.length === 0;
  const now = isFirst ? { ...coarse, age: "first" as const } : fine;
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
      </div>
      <Problems of={now.problems} />
      {isFirst && <p class="remark">First in steps of {COARSE_DEG}°; the maps in steps of {step.value}° are being computed.</p>}
      <Aged age={now.value ? now.age : "current"} count={now.count}>
        {!now.value && now.problems.length === 0 && <p role="status">computing…</p>}
        {now.value?.figures.map(({ name, svg }) => (
          <Drawn
            key={name}
            name={name}
            svg={svg}
            label={`${name}: maps over all viewing directions`}
            table={() => tableOf(now.value)}
          />
        ))}
      </Aged>
      {before.value && before.age === "current" && pinned.value && (
        <>
          <h3>Compared with {pinnedName.value}</h3>
          {before.value.figures.map(({ name, svg }) => (
            <Drawn key={name} svg={svg} label={`${name} of the version that is compared`} />
          ))}
        </>
      )}
    </>
  );
}
