// The error messages of the server. Where the server knows a value that is accepted, or that the Monte Carlo solver can
// compute what adding refuses, a button does it.

import type { Problem } from "../api/types.ts";
import { plain } from "../model/format.ts";
import { mendOf } from "../model/mends.ts";
import { words } from "../model/words.ts";
import { labelOf } from "../state/labels.ts";
import { edit, set } from "../state/live.ts";
import { computeByMonteCarlo, isOfNow, progress, rescue } from "../state/rescue.ts";

/** Returns the label of the button that sets a key to a value. */
function offer(path: string, value: unknown): string {
  const { quantity, unit } = labelOf(path);
  const shown = typeof value === "number" ? plain(value, 8) : String(value);
  return `Set ${quantity.charAt(0).toLowerCase()}${quantity.slice(1)} to ${shown}${unit ? ` ${unit}` : ""}`;
}

/** The run of the Monte Carlo solver in place of adding, with its progress. */
function ByMonteCarlo() {
  const isRunning = isOfNow.value && rescue.phase.value === "running";
  const error = progress.value?.relative_error;
  return (
    <span class="mend">
      {isRunning ? (
        <button type="button" onClick={rescue.cancel}>
          Cancel
        </button>
      ) : (
        <button type="button" class="run" onClick={() => void computeByMonteCarlo()}>
          Compute with Monte Carlo
        </button>
      )}
      <small role="status">
        {isRunning &&
          (error === undefined ? "computing…" : `computing, relative error ${(100 * error).toPrecision(2)} %`)}
      </small>
      {isOfNow.value && <Problems of={rescue.problems.value} />}
    </span>
  );
}

function Mend({ of }: { of: Problem }) {
  const { path, accepted } = of;
  if (of.monte_carlo) return <ByMonteCarlo />;
  if (!path || accepted === undefined || accepted === null) return null;
  return (
    <span class="mend">
      <button type="button" class="run" onClick={() => set(path, accepted)}>
        {offer(path, accepted)}
      </button>
    </span>
  );
}

/** The button that adds what errors say is missing, such as the thickness of the glass; nothing where that is not known. */
export function Addition({ of }: { of: readonly Problem[] }) {
  const mend = mendOf(of);
  return (
    mend && (
      <span class="mend">
        <button type="button" class="run" onClick={() => edit(mend.edits)}>
          Add {mend.words}
        </button>
      </span>
    )
  );
}

/** The buttons for errors, without their messages. */
export function Mends({ of }: { of: readonly Problem[] }) {
  const byMonteCarlo = of.find((problem) => problem.monte_carlo);
  return (
    <>
      {of
        .filter((problem) => !problem.monte_carlo)
        .map((problem) => (
          <Mend key={problem.message} of={problem} />
        ))}
      {byMonteCarlo && <Mend of={byMonteCarlo} />}
    </>
  );
}

interface Props {
  of: readonly Problem[];
  /** Whether the place in the text is shown. */
  withPlace?: boolean;
}

export function Problems({ of, withPlace = false }: Props) {
  return (
    <>
      {of.map((problem) => (
        <p class="error" role="alert" key={problem.message}>
          {words(problem, withPlace)}
          {problem.hint && <span class="hint">{problem.hint}</span>}
        </p>
      ))}
    </>
  );
}
