// The table of Feng 2012, table 5.1, and what is said of a state besides, each number with its error; beside
// a pinned design, with the difference.

import { useSignal } from "@preact/signals";

import type { StateResult, Values } from "../api/types.ts";
import { error, fixed, signed } from "../model/format.ts";
import { result, shownState, states } from "../state/design.ts";
import { pinnedView } from "../state/pin.ts";
import { useColours } from "../plots/patches.tsx";

interface Column {
  readonly head: string;
  readonly help: string;
  readonly decimals: number;
  readonly of: (values: Values) => number | null | undefined;
}

const COLUMNS: readonly Column[] = [
  { head: "Y", decimals: 4, help: "Luminous reflectance factor", of: (v) => v.Y },
  { head: "cd/m²", decimals: 2, help: "Luminance", of: (v) => v.luminance_cd_m2 },
  { head: "contrast", decimals: 2, help: "Its Y over that of black", of: (v) => v.contrast },
  { head: "L*", decimals: 2, help: "CIELAB against the light's white", of: (v) => v.L_star },
  { head: "a*", decimals: 2, help: "CIELAB", of: (v) => v.a_star },
  { head: "b*", decimals: 2, help: "CIELAB", of: (v) => v.b_star },
  { head: "u′", decimals: 4, help: "CIE 1976 chromaticity", of: (v) => v.u_prime },
  { head: "v′", decimals: 4, help: "CIE 1976 chromaticity", of: (v) => v.v_prime },
  { head: "dR", decimals: 4, help: "u′v′ distance from D65 (Feng 2012, table 5.1)", of: (v) => v.distance_from_d65_uv },
  { head: "peak nm", decimals: 1, help: "Largest reflectance factor between 400 and 700 nm", of: (v) => v.peak_nm },
  {
    head: "R hemi",
    decimals: 4,
    help: "Luminous reflectance factor in the diffuse light alone (Feng 2012, eq. 3-1)",
    of: (v) => v.R_hemi,
  },
  { head: "R dir", decimals: 4, help: "The same in the first directed source alone", of: (v) => v.R_dir?.[0] },
];

/** The error of a number: the standard error of a walk, or what the discretisation leaves. */
const errorOf = (state: StateResult): Values => state.discretisation_error ?? state.standard_error;

/** An error to two digits, however small. */
function small(value: number | null | undefined): string {
  if (value === null || value === undefined || !(value > 0)) return "";
  return `± ${value < 1e-4 ? value.toExponential(0).replace("e-", "e−") : Number(value.toPrecision(2))}`;
}

function Cell({
  column,
  state,
  before,
  errors,
}: {
  column: Column;
  state: StateResult;
  before: StateResult | undefined;
  errors: boolean;
}) {
  const value = column.of(state);
  const se = column.of(errorOf(state));
  const seen = errors ? small(se) : error(se, column.decimals);
  const was = before && column.of(before);
  return (
    <td>
      {fixed(value, column.decimals)}
      {seen && <small>{seen}</small>}
      {before && typeof was === "number" && typeof value === "number" && (
        <small class="difference">{signed(value - was, column.decimals)}</small>
      )}
    </td>
  );
}

export function StatesTable() {
  const errors = useSignal(false);
  const colours = useColours().value.colours;
  const solver = result.value?.solver;
  if (!solver) return null;
  const adding = solver.method === "adding";
  return (
    <>
      <div class="scroll" tabindex={0} role="region" aria-label="Table of the states">
        <table class="numbers">
          <thead>
            <tr>
              <th scope="col">state</th>
              {COLUMNS.map(({ head, help }) => (
                <th scope="col" key={head} title={help}>
                  {head}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {states.value.map(([name, state]) => (
              <tr key={name} class={name === shownState.value ? "chosen" : ""}>
                <th scope="row">
                  <span class="chip" ref={(e) => e?.style.setProperty("background-color", colours.get(name) ?? "")} />
                  {name}
                </th>
                {COLUMNS.map((column) => (
                  <Cell
                    key={column.head}
                    column={column}
                    state={state}
                    before={pinnedView.value?.states[name]}
                    errors={errors.value}
                  />
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p class="remark">
        {adding
          ? `Adding: ${solver.nodes} nodes, no noise; discretisation error of Y at most ${(100 * solver.relative_error_reached).toPrecision(2)} %. `
          : `Walk: standard errors of one sigma, ${solver.degrees_of_freedom} degrees of freedom. `}
        <label class="toggle inline">
          <input type="checkbox" checked={errors.value} onChange={(e) => (errors.value = e.currentTarget.checked)} />{" "}
          show errors however small
        </label>
      </p>
    </>
  );
}
