// The six steps across the top of the page.

import { STEPS } from "../model/tools.ts";
import { openStep, showStep } from "../state/tab.ts";

export function StepBar() {
  return (
    <nav class="steps" aria-label="Steps">
      <ol>
        {STEPS.map(({ id, name, about, tools }, i) => (
          <li key={id}>
            <button
              type="button"
              data-step={id}
              aria-current={openStep.value.id === id ? "step" : undefined}
              title={about}
              onClick={() => showStep(id, tools[0]!.id)}
            >
              <span aria-hidden="true">{i + 1}</span> {name}
            </button>
          </li>
        ))}
      </ol>
    </nav>
  );
}
