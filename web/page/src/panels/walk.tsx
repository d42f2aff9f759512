// A run of the Monte Carlo solver, compared with the live result of adding. The two solvers have no integration in
// common, so that their agreement within the error bars checks both.

import type { WalkState } from "../api/types.ts";
import type { Rows as Cells } from "../model/csv.ts";
import { count, digits, fixed, plain, signed } from "../model/format.ts";
import { numberAt } from "../model/json.ts";
import { fields, viewIndex } from "../state/design.ts";
import { age, aim, course, fraction, progress, run, target, walk } from "../state/walk.ts";
import { curvesSvg } from "../plots/curves-svg.ts";
import { Curves, type Plot } from "../plots/curves.tsx";
import { dark } from "../state/theme.ts";
import { Aged } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { Problems } from "./problems.tsx";

/** Relative errors to choose from. */
const AIMS = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
const WIDTH = 260;
/** The axis of the error bars extends from -LIMIT to LIMIT times the requested error. */
const LIMIT = 4;

/** The relative difference of Y between Monte Carlo and adding, with bars of one and two standard errors. */
function Bars({ state, live, target }: { state: WalkState; live: number; target: number }) {
  const x = (relative: number) =>
    WIDTH / 2 + (Math.max(-LIMIT, Math.min(LIMIT, relative / target)) * WIDTH) / (2 * LIMIT);
  const off = (state.Y - live) / live;
  const se = state.Y_se / live;
  return (
    <svg
      class="bars"
      viewBox={`0 0 ${WIDTH} 18`}
      role="img"
      aria-label={`difference from adding ${fixed(100 * off, 3)} percent, standard error ${fixed(100 * se, 3)} percent`}
    >
      <path class="zero" d={`M${WIDTH / 2} 0V18`} />
      <path class="bar-2" d={`M${x(off - 2 * se)} 9H${x(off + 2 * se)}`} />
      <path class="bar-1" d={`M${x(off - se)} 9H${x(off + se)}`} />
      <circle cx={x(off)} cy="9" r="3.2" />
    </svg>
  );
}

/** Returns the number of decimals that shows two digits of the error. */
const decimals = ({ Y_se: se }: WalkState): number =>
  se > 0 ? Math.min(9, Math.max(4, 1 - Math.floor(Math.log10(se)))) : 5;

/** Rates the agreement by the difference in standard errors. */
function Verdict({ z }: { z: number | null | undefined }) {
  if (typeof z !== "number") return <>no result of adding</>;
  if (Math.abs(z) >= 3) return <b class="disagrees">✗ differs (over 3 standard errors)</b>;
  return <span class="agrees">✓ agrees{Math.abs(z) >= 2 ? " (2 to 3 standard errors)" : ""}</span>;
}

/** Rates all states together. Their differences have one cause, because they are computed from the same paths. */
function verdictOfAll(states: readonly WalkState[]): string {
  const known = states.map(({ z }) => z).filter((z) => typeof z === "number");
  if (known.length === 0) return "Adding refuses this design, so that there is nothing to compare with.";
  const largest = Math.max(...known.map(Math.abs));
  const all = largest < 3 ? `All ${known.length} states agree` : "Not all states agree";
  return `${all}: the largest |z| is ${largest.toFixed(1)}. All states are computed from the same paths, so that their z are similar, and often all of one sign.`;
}

const tableOf = (states: readonly WalkState[]): Cells => [
  ["view", "state", "X", "X_se", "Y", "Y_se", "Z", "Z_se", "Y_adding", "z"],
  ...states.map((one) => [one.view, one.name, one.X, one.X_se, one.Y, one.Y_se, one.Z, one.Z_se, one.live_Y, one.z]),
];

function Rows({ states, target }: { states: readonly WalkState[]; target: number }) {
  return (
    <table class="numbers walk">
      <thead>
        <tr>
          <th scope="col">state</th>
          <th scope="col">Y, adding</th>
          <th scope="col">Y, Monte Carlo</th>
          <th scope="col" class="bar-head">
            Monte Carlo minus adding, ±1 and ±2 standard errors
          </th>
          <th scope="col">z</th>
          <th scope="col" class="words">
            agreement
          </th>
        </tr>
      </thead>
      <tbody>
        {states.map((state) => (
          <tr key={state.name}>
            <th scope="row">{state.name}</th>
            <td>{fixed(state.live_Y, decimals(state))}</td>
            <td>
              {fixed(state.Y, decimals(state))} ± {fixed(state.Y_se, decimals(state))}
            </td>
            <td class="bar-cell">
              {typeof state.live_Y === "number" && <Bars state={state} live={state.live_Y} target={target} />}
            </td>
            <td>{signed(state.z, 1)}</td>
            <td class="words">
              <Verdict z={state.z} />
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

export function WalkPanel() {
  const now = progress.value;
  const running = walk.phase.value === "running";
  const states = now?.states.filter((state) => state.view === viewIndex.value) ?? [];
  const plot: Plot = {
    x: course.value.map(([paths]) => paths),
    xName: "Paths",
    yName: "Relative error of Y (%)",
    log: true,
    curves: [
      {
        name: "error",
        values: course.value.map(([, error]) => 100 * error),
        colour: dark.value ? "#7da4f2" : "#2b5fc7",
        dash: [],
        width: 2,
      },
    ],
  };
  return (
    <>
      <div class="controls">
        {running ? (
          <button type="button" onClick={walk.cancel}>
            Cancel
          </button>
        ) : (
          <button type="button" class="run" onClick={() => void run()}>
            {now ? "Run again" : "Run Monte Carlo"}
          </button>
        )}
        <label for="walk-aim">until the relative error is</label>
        <select
          id="walk-aim"
          value={String(aim.value ?? "")}
          disabled={running}
          onChange={(event) =>
            (aim.value = event.currentTarget.value === "" ? null : Number(event.currentTarget.value))
          }
        >
          <option value="">
            {digits(100 * (numberAt(fields.value, "solver.relative_error") ?? 0.001), 2)} %, as in the scenario
          </option>
          {AIMS.map((one) => (
            <option key={one} value={String(one)}>
              {plain(100 * one)} %
            </option>
          ))}
        </select>
        <progress max={1} value={walk.phase.value === "done" ? 1 : fraction.value} aria-label="Progress of the run" />
        <span role="status" data-phase={walk.phase.value}>
          {now &&
            `${count(now.paths)} paths in ${fixed(now.seconds, now.seconds < 1 ? 2 : 1)} s, relative error ${digits(100 * now.relative_error, 2)} %`}
          {walk.phase.value === "cancelled" && ", cancelled"}
          {walk.phase.value === "done" && ", done"}
        </span>
      </div>
      {age.value === "current" && <Problems of={walk.problems.value} />}
      <Aged age={now || course.value.length > 0 ? age.value : "current"}>
        {states.length > 0 && (
          <>
            <div class="scroll" tabindex={0} role="region" aria-label="Monte Carlo and adding">
              <Rows states={states} target={target.value} />
            </div>
            <p class="remark">
              {verdictOfAll(states)} <Downloads name="monte-carlo" table={() => tableOf(now?.states ?? [])} />
            </p>
          </>
        )}
        {course.value.length > 1 && (
          <>
            <p class="figure-tools">
              <Downloads
                name="monte-carlo-error"
                svg={() => curvesSvg(plot)}
                table={() => [["paths", "relative_error"], ...course.value]}
              />
            </p>
            <Curves {...plot} height={170} label="Relative error against paths" />
          </>
        )}
      </Aged>
      <p class="remark">
        Monte Carlo traces random paths and has no integration in common with adding, which computes the live result.
        Its standard errors (one standard deviation) are computed from independent replicates; z is the difference in
        standard errors.
      </p>
    </>
  );
}
