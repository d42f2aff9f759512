// The table of the states: the columns of Feng 2012, table 5.1, and others, each number with its error and its
// difference from the pinned design.

import { useSignal } from "@preact/signals";

import type { StateResult, Values } from "../api/types.ts";
import { fixed, signed } from "../model/format.ts";
import { fileIds } from "../state/files.ts";
import { postForBlob } from "../api/client.ts";
import { result, shownState, showState, states, text } from "../state/design.ts";
import { hoverClass, pointsAt } from "../state/hover.ts";
import { pinnedView } from "../state/pin.ts";
import { Choice } from "../fields/choice.tsx";
import { useColours } from "../plots/patches.tsx";
import { ColumnHeads, type Head } from "./column-heads.tsx";
import { Downloads } from "./downloads.tsx";

interface Column extends Head {
  readonly decimals: number;
  readonly of: (values: Values) => number | null | undefined;
}

const column = (head: string, decimals: number, help: string, of: Column["of"]): Column => ({
  head,
  decimals,
  help,
  of,
});

const Y = column("Y", 4, "Luminance factor", (v) => v.Y);
const LUMINANCE = column("cd/m²", 2, "Luminance", (v) => v.luminance_cd_m2);
const CONTRAST = column("contrast", 2, "Y divided by Y of black (Feng 2012: CR)", (v) => v.contrast);
const LAB = [
  column(
    "L*",
    2,
    "CIELAB, relative to a perfect white in the same light, or to the white state (metrics.white)",
    (v) => v.L_star,
  ),
  column("a*", 2, "CIELAB", (v) => v.a_star),
  column("b*", 2, "CIELAB", (v) => v.b_star),
];
const UV = [
  column("u′", 4, "CIE 1976 chromaticity", (v) => v.u_prime),
  column("v′", 4, "CIE 1976 chromaticity", (v) => v.v_prime),
];
const DR = column("Δu′v′ D65", 4, "u′v′ distance from D65 (Feng 2012: dR)", (v) => v.distance_from_d65_uv);
const hue = (name: string, i: number) =>
  column(name, 0, "Hue without lightness: linear sRGB of x, y, z", (v) => v.hue_rgb?.[i]);

/** The column that has values for states that drive one sub-pixel only: the peak of a mixture is that of one of its parts. */
const PEAK = "peak (nm)";

/** Sets of columns; the second one has all columns of the table in the dissertation. */
const SETS: Record<string, readonly Column[]> = {
  Overview: [
    Y,
    LUMINANCE,
    CONTRAST,
    ...LAB,
    ...UV,
    DR,
    column(
      PEAK,
      1,
      "Wavelength of the largest reflectance factor, 400 to 700 nm, of states that drive one sub-pixel",
      (v) => v.peak_nm,
    ),
    column("Y diffuse", 4, "Luminance factor in the diffuse light only (Feng 2012, eq. 3-1: R hemi)", (v) => v.R_hemi),
  ],
  "Feng 2012, table 5.1": [
    DR,
    CONTRAST,
    column("X", 4, "Relative tristimulus value: Y is 1 for a perfect white diffuser", (v) => v.X),
    Y,
    column("Z", 4, "Relative tristimulus value", (v) => v.Z),
    ...UV,
    column("x", 4, "CIE 1931 chromaticity", (v) => v.x),
    column("y", 4, "CIE 1931 chromaticity", (v) => v.y),
    column("z", 4, "CIE 1931 chromaticity", (v) => v.z),
    ...LAB,
    hue("R", 0),
    hue("G", 1),
    hue("B", 2),
    LUMINANCE,
  ],
  Differences: [
    column(
      "ΔE00 white",
      2,
      "CIEDE2000 difference from a perfect white diffuser in the same light",
      (v) => v.delta_E_2000_from_white,
    ),
    column(
      "ΔE00 reference",
      2,
      "CIEDE2000 difference from metrics.reference_state",
      (v) => v.delta_E_2000_from_reference,
    ),
    column("Δu′v′ reference", 4, "u′v′ distance from metrics.reference_state", (v) => v.distance_from_reference_uv),
    column(
      "ΔE00 angle",
      2,
      "CIEDE2000 difference from the view nearest to the normal",
      (v) => v.delta_E_2000_with_angle,
    ),
    column("Δu′v′ angle", 4, "u′v′ distance from the view nearest to the normal", (v) => v.shift_with_angle_uv),
    column(
      "peak shift (nm)",
      2,
      "Peak minus the peak of the pixel alone in the specular direction (Feng 2012, eq. 5-12)",
      (v) => v.peak_shift_nm,
    ),
  ],
};

const FIRST = "Overview";

/** A column without values. */
const UNDEFINED = column(PEAK, 1, "", () => null);

/** Returns the columns of R in each directed source and in each environment only. */
function byLight(state: StateResult | undefined): Column[] {
  const named = (name: string, i: number, count: number) => (count > 1 ? `${name} ${i + 1}` : name);
  const dir = (state?.R_dir ?? []).map((_, i, all) =>
    column(
      named("Y source", i, all.length),
      4,
      "Luminance factor in this directed source only (R dir)",
      (v) => v.R_dir[i],
    ),
  );
  const around = (state?.R_environment ?? []).map((_, i, all) =>
    column(
      named("Y environment", i, all.length),
      4,
      "Luminance factor in this environment only",
      (v) => v.R_environment[i],
    ),
  );
  return [...dir, ...around];
}

/** The errors of a state: discretisation errors of adding, or standard errors of Monte Carlo. */
const errorOf = (state: StateResult): Values => state.discretisation_error ?? state.standard_error;

/**
 * Formats a value with its error in units of its last decimal, 0.9767(1), so that a row has the same height with and
 * without errors.
 */
function compact(value: number | null | undefined, se: number | null | undefined, decimals: number): string {
  const shown = fixed(value, decimals);
  if (typeof value !== "number" || typeof se !== "number" || !(se >= 0.5 * 10 ** -decimals)) return shown;
  return `${shown}(${se >= 10 ** (1 - decimals) && decimals > 0 ? se.toPrecision(2) : Math.round(se * 10 ** decimals)})`;
}

/** Formats an error with two digits, even if it is smaller than the last digit of the value. */
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
  const seen = errors ? small(se) : "";
  const was = before && column.of(before);
  return (
    <td>
      {errors ? fixed(value, column.decimals) : compact(value, se, column.decimals)}
      {seen && <small>{seen}</small>}
      {before && typeof was === "number" && typeof value === "number" && (
        <small class="difference">{signed(value - was, column.decimals)}</small>
      )}
    </td>
  );
}

/** Requests states.csv, as `papilio run` writes it. */
const statesCsv = async (): Promise<string> =>
  (await postForBlob("export", { scenario: text.value, files: fileIds.value, what: "states.csv" })).text();

export function StatesTable() {
  const errors = useSignal(false);
  const set = useSignal(Object.keys(SETS)[0]!);
  const columns = [...SETS[set.value]!, ...(set.value === FIRST ? byLight(states.value[0]?.[1]) : [])];
  const colours = useColours().value.colours;
  const solver = result.value?.solver;
  const primaries = result.value?.primaries ?? [];
  if (!solver) return null;
  const adding = solver.method === "adding";
  return (
    <>
      <div class="scroll" tabindex={0} role="region" aria-label="Table of the states">
        <table class="numbers">
          <ColumnHeads columns={columns} />
          <tbody>
            {states.value.map(([name, state]) => (
              <tr
                key={name}
                class={(name === shownState.value ? "chosen" : "") + hoverClass(name)}
                data-state={name}
                onClick={() => showState(name)}
                {...pointsAt(name)}
              >
                <th scope="row">
                  <span class="chip" ref={(e) => e?.style.setProperty("background-color", colours.get(name) ?? "")} />
                  {name}
                </th>
                {columns.map((column) => (
                  <Cell
                    key={column.head}
                    column={column.head === PEAK && !primaries.includes(name) ? UNDEFINED : column}
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
        <Choice label="Columns" value={set.value} options={Object.keys(SETS)} change={(name) => (set.value = name)} />{" "}
        {adding
          ? `Adding: ${solver.nodes} nodes; relative discretisation error of Y at most ${(100 * solver.relative_error_reached).toPrecision(2)} %, no noise. `
          : `Monte Carlo: standard errors (one standard deviation), ${solver.degrees_of_freedom} degrees of freedom. `}
        <label class="toggle inline">
          <input type="checkbox" checked={errors.value} onChange={(e) => (errors.value = e.currentTarget.checked)} />{" "}
          show all errors
        </label>{" "}
        <Downloads name="states" table={statesCsv} />
      </p>
    </>
  );
}
