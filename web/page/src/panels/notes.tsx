// The warnings and notes of the scenario.

import { digits } from "../model/format.ts";
import { at } from "../model/json.ts";
import { stringAt } from "../model/about.ts";
import { answer, fields, result, text } from "../state/design.ts";
import { openTab, showTab } from "../state/tab.ts";
import { run, walk } from "../state/walk.ts";
import { LiveMark, liveClass } from "./aged.tsx";

/** Studies of a scenario that tools of the page compute. */
const TOOLS = [
  ["sweep", "a sweep"],
  ["optimize", "a search for better designs"],
  ["tolerance", "a tolerance analysis"],
  ["fit", "a fit to measured data"],
] as const;

/** The tables of a scenario that are not part of its result, and what uses them. */
const STUDIES = {
  measure: "`papilio diffuser measure` simulates the measurement; the page shows the display.",
} as const;

/** Says where the studies of the scenario are computed. */
function Studies() {
  const has = (key: string) => at(fields.value, key) !== undefined;
  return (
    <>
      {TOOLS.filter(([key]) => has(key) && openTab.value !== key).map(([key, name]) => (
        <p key={key}>
          <b>Note:</b> this scenario has {name}.{" "}
          <button type="button" class="key-link" onClick={() => showTab(key)}>
            Show it
          </button>
        </p>
      ))}
      {Object.entries(STUDIES)
        .filter(([key]) => has(key))
        .map(([key, words]) => (
          <p key={key}>
            <b>Note:</b> this scenario has [{key}]: {words.replaceAll("`", "")}
          </p>
        ))}
    </>
  );
}

/** The solver that a text asks for; "" if it does not say, or cannot be read. */
function methodOf(scenario: string): string {
  try {
    return stringAt(scenario, "solver.method") ?? "";
  } catch {
    return "";
  }
}

/** Says that the page shows another solver than that of the scenario. */
function OtherSolver() {
  const shown = result.value?.solver.method;
  if (methodOf(text.value) !== "monte-carlo" || shown !== "adding") return null;
  const show = () => {
    showTab("walk");
    if (walk.phase.value !== "running") void run();
  };
  return (
    <p class="warning">
      <b>Note:</b> this scenario asks for Monte Carlo (solver.method). The page shows the result of adding, which has no noise and follows every
      change.{" "}
      <button type="button" class="key-link" onClick={show}>
        Run Monte Carlo
      </button>
    </p>
  );
}

export function Notes() {
  const now = result.value;
  if (!now) return null;
  const took = answer.value?.cost_ms;
  const error = `\u00b1${digits(100 * now.solver.relative_error_reached, 2)} %`;
  return (
    <footer class={`notes${liveClass()}`} tabindex={0} aria-label="Warnings and notes" role="group">
      {now.warnings.map((words) => (
        <p class="warning" key={words}>
          <b>Warning:</b> {words}
        </p>
      ))}
      <OtherSolver />
      <Studies />
      {now.notes.map((words) => (
        <p key={words}>
          <b>Note:</b> {words}
        </p>
      ))}
      <p class="trace">
        <LiveMark /> Papilio {now.papilio}, {now.solver.method}, {now.solver.is_final ? "exact to" : "first answer"} {error}
        {took === undefined ? "" : `, ${took.toFixed(1)} ms`}; scenario{" "}
        <code title={`SHA-256 of the scenario and its files: ${now.hash}`}>{now.hash.slice(0, 12)}</code>
      </p>
    </footer>
  );
}
