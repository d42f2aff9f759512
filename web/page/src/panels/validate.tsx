// Samples that others measured, predicted from their printed inputs, as by `papilio validate --measured`.

import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { get } from "../api/client.ts";
import type { Prediction, SampleEntry, ValidateDone, ValidateProgress } from "../api/types.ts";
import { digits, fixed, NONE } from "../model/format.ts";
import { long } from "../state/work.ts";
import { said } from "../state/said.ts";
import { Drawn } from "../plots/figure.tsx";
import { Problems } from "./problems.tsx";
import { save } from "./save.ts";

const validation = long();
const samples = signal<readonly SampleEntry[]>([]);
const progress = signal<ValidateProgress | null>(null);
const predicted = signal<Readonly<Record<string, Prediction>>>({});
const done = signal<ValidateDone | null>(null);

async function run(sample: string | null): Promise<void> {
  [progress.value, done.value] = [null, null];
  await validation.start("validate", { sample } as never, [], (event, data) => {
    if (event === "progress") progress.value = data as ValidateProgress;
    if (event === "sample") {
      const one = data as Prediction;
      predicted.value = { ...predicted.value, [one.name]: one };
    }
    if (event === "done") done.value = data as ValidateDone;
  });
}

const VERDICTS: Readonly<Record<string, string>> = { agrees: "✓ agrees", "within its unknowns": "within its unknowns", disagrees: "✗ disagrees" };

function Row({ of }: { of: SampleEntry }) {
  const found = predicted.value[of.name];
  const verdict = found?.verdict ?? null;
  return (
    <tr data-sample={of.name}>
      <th scope="row">
        {of.title}
        <small>{of.source}</small>
        {found?.remark && <small>{found.remark}</small>}
      </th>
      <td class={verdict === "agrees" ? "agrees" : verdict === "disagrees" ? "disagrees" : ""}>
        {found ? (verdict ? VERDICTS[verdict] : "no stated error") : NONE}
      </td>
      <td>
        {digits(found?.rms, 2)}
        {found && <small>{found.rms_of}</small>}
      </td>
      <td>{fixed(found?.z_rms, 2)}</td>
      <td>{fixed(found?.delta_e_2000_mean, 2)}</td>
      <td>
        <button type="button" disabled={validation.phase.value === "running"} onClick={() => void run(of.name)} aria-label={`Predict ${of.name}`}>
          Predict
        </button>
      </td>
    </tr>
  );
}

export function ValidatePanel() {
  useEffect(() => {
    if (samples.value.length === 0) void get<SampleEntry[]>("samples").then((all) => void (samples.value = all), () => {});
  }, []);
  const isRunning = validation.phase.value === "running";
  const report = () => {
    save("measured-samples.html", new Blob([done.value!.html], { type: "text/html" }));
    said.value = "The report is saved.";
  };
  return (
    <section class="validate" aria-label="Published samples">
      <p class="remark">
        Samples that others measured, predicted from their printed inputs without fitting. They do not depend on the design.
      </p>
      <div class="controls">
        {isRunning ? (
          <button type="button" onClick={validation.cancel}>
            Cancel
          </button>
        ) : (
          <button type="button" class="run" onClick={() => void run(null)}>
            Predict all samples
          </button>
        )}
        <progress max={1} value={validation.phase.value === "done" ? 1 : (progress.value?.fraction ?? 0)} aria-label="Progress" />
        <span role="status" data-phase={validation.phase.value}>
          {isRunning ? `${progress.value?.words ?? ""}…` : validation.phase.value === "idle" ? "" : validation.phase.value}
        </span>
        {done.value && (
          <button type="button" onClick={report}>
            Download report.html
          </button>
        )}
      </div>
      <Problems of={validation.problems.value} />
      <div class="scroll" tabindex={0} role="region" aria-label="Samples">
        <table class="numbers">
          <thead>
            <tr>
              <th scope="col">sample</th>
              <th scope="col">verdict</th>
              <th scope="col">rms difference</th>
              <th scope="col">rms z</th>
              <th scope="col">mean ΔE00</th>
              <th scope="col">
                <span class="spoken">Run</span>
              </th>
            </tr>
          </thead>
          <tbody>
            {samples.value.map((one) => (
              <Row key={one.name} of={one} />
            ))}
          </tbody>
        </table>
      </div>
      {done.value?.figures.map(({ name, svg }) => (
        <Drawn key={name} name={name} svg={svg} label={`${name.replace("sample-", "")}: predicted and measured`} />
      ))}
    </section>
  );
}
