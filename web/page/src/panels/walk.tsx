// A run of the Monte Carlo solver, compared with the live result of adding. The two solvers have no integration in
// common, so that their agreement within the error bars checks both.

import type { WalkState } from "../api/types.ts";
import { count, digits, fixed, plain, signed } from "../model/format.ts";
import { numberAt } from "../model/json.ts";
import { fields, viewIndex } from "../state/design.ts";
import { aim, course, progress, run, stale, walk } from "../state/walk.ts";
import { Curves } from "../plots/curves.tsx";
import { dark } from "../state/theme.ts";
import { Problems } from "./problems.tsx";

/** Relative errors to choose from. */
const AIMS = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
const WIDTH = 260;
/** The axis of the error bars extends from -LIMIT to LIMIT times the requested error. */
const LIMIT = 4;

/** The relative difference of Y between Monte Carlo and adding, with bars of one and two standard errors. */
function Bars({ state, target }: { state: WalkState; target: number }) {
  const x = (relative: number) =>
    WIDTH / 2 + (Math.max(-LIMIT, Math.min(LIMIT, relative / target)) * WIDTH) / (2 * LIMIT);
  const off = (state.Y - state.live_Y) / state.live_Y;
  const se = state.Y_se / state.live_Y;
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
const verdict = (z: number): string =>
  Math.abs(z) < 2 ? "agrees" : Math.abs(z) < 3 ? "agrees (2 to 3 standard errors)" : "differs (over 3 standard errors)";

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
              <Bars state={state} target={target} />
            </td>
            <td>{signed(state.z, 1)}</td>
            <td class="words">{verdict(state.z ?? 0)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

export function WalkPanel() {
  const target = aim.value ?? numberAt(fields.value, "solver.relative_error") ?? 0.001;
  const now = progress.value;
  const running = walk.phase.value === "running";
  const reached = now ? Math.min(1, (target / Math.max(now.relative_error, 1e-12)) ** 2) : 0;
  const states = now?.states.filter((state) => state.view === viewIndex.value) ?? [];
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
        <progress max={1} value={walk.phase.value === "done" ? 1 : reached} aria-label="Progress of the run" />
        <span role="status" data-phase={walk.phase.value}>
          {now &&
            `${count(now.paths)} paths in ${fixed(now.seconds, now.seconds < 1 ? 2 : 1)} s, relative error ${digits(100 * now.relative_error, 2)} %`}
          {walk.phase.value === "cancelled" && ", cancelled"}
          {walk.phase.value === "done" && ", done"}
        </span>
      </div>
      <Problems of={walk.problems.value} />
      {stale.value && (
        <p class="remark warning">
          The design has changed since this run. The results are those of the earlier design.
        </p>
      )}
      {states.length > 0 && (
        <div
          class={stale.value ? "scroll stale" : "scroll"}
          tabindex={0}
          role="region"
          aria-label="Monte Carlo and adding"
        >
          <Rows states={states} target={target} />
        </div>
      )}
      {course.value.length > 1 && (
        <Curves
          x={course.value.map(([paths]) => paths)}
          xName="Paths"
          yName="Relative error of Y (%)"
          height={170}
          log
          label="Relative error against paths"
          curves={[
            {
              name: "error",
              values: course.value.map(([, error]) => 100 * error),
              colour: dark.value ? "#7da4f2" : "#2b5fc7",
              dash: [],
              width: 2,
            },
          ]}
        />
      )}
      <p class="remark">
        Monte Carlo traces random paths and has no integration in common with adding, which computes the live result.
        Its standard errors (one standard deviation) are computed from independent replicates; z is the difference in
        standard errors.
      </p>
    </>
  );
}
