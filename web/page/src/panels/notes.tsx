// The warnings and notes of the scenario.

import { answer, result } from "../state/design.ts";

export function Notes() {
  const now = result.value;
  if (!now) return null;
  const took = answer.value?.cost_ms;
  return (
    <footer class="notes">
      {now.warnings.map((words) => (
        <p class="warning" key={words}>
          <b>Warning:</b> {words}
        </p>
      ))}
      {now.notes.map((words) => (
        <p key={words}>
          <b>Note:</b> {words}
        </p>
      ))}
      <p class="trace">
        Papilio {now.papilio}, {now.solver.method}
        {took === undefined ? "" : `, ${took.toFixed(1)} ms`}; scenario{" "}
        <code title={`SHA-256 of the scenario and its files: ${now.hash}`}>{now.hash.slice(0, 12)}</code>
      </p>
    </footer>
  );
}
