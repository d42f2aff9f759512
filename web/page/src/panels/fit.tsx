// A fit, as by `papilio fit`: keys of the design from measured files, with their intervals, and what the data cannot tell apart.

import { useSignal } from "@preact/signals";

import type { Compared, FitDone } from "../api/types.ts";
import { correlated, decimalsOf, type FitVariable } from "../model/fit.ts";
import { digits, fixed, NONE, plain } from "../model/format.ts";
import { Drawn } from "../plots/figure.tsx";
import {
  addVariable,
  age,
  done,
  fit,
  fittedTo,
  isOfFile,
  isOfInputs,
  keep,
  keys,
  measured,
  ofFile,
  own,
  progress,
  run,
  runAsJob,
  take,
  use,
  used,
  variableFor,
  variables,
} from "../state/fit.ts";
import { fileIds } from "../state/files.ts";
import { useFollowed } from "../state/follow.ts";
import { labelText } from "../state/labels.ts";
import { said } from "../state/said.ts";
import { Aged } from "./aged.tsx";
import { FileButton } from "./choose.tsx";
import { Downloads } from "./downloads.tsx";
import { fileName } from "./file-name.ts";
import { AsJob } from "./jobs.tsx";
import { KeySelect } from "./key-select.tsx";
import { Problems } from "./problems.tsx";
import { Rename, SaveRenamed } from "./rename.tsx";
import { save } from "./save.ts";

type Report = FitDone["report"];
type Fitted = Report["variables"][number];

/** Correlations that are at least this large are named. */
const STRONG = 0.9;
/** Time without changes after which a measured file is compared, ms. */
const REST_MS = 150;
/** The most pairs that are named. */
const MOST_PAIRS = 5;

const change = (index: number, to: FitVariable | null): void => {
  own.value = variables.value.flatMap((one, i) => (i !== index ? [one] : to ? [to] : []));
};

/** What the scenario says of a variable besides its key and bounds. */
function Remarks({ more }: { more: FitVariable["more"] }) {
  const { prior, compensated_by: other, keys: all } = more;
  const known = prior as { mean?: number; sigma?: number } | undefined;
  const words = [
    ...(Array.isArray(all) && all.length > 1 ? [`with ${all.slice(1).join(", ")}`] : []),
    ...(typeof other === "string" ? [`compensated by ${other}`] : []),
    ...(known?.mean !== undefined && known.sigma !== undefined ? [`prior ${plain(known.mean)} ± ${plain(known.sigma)}`] : []),
  ];
  return words.length > 0 ? <small>{words.join("; ")}</small> : null;
}

function VariableFields({ variable, index }: { variable: FitVariable; index: number }) {
  const wrong = useSignal("");
  const { key, bounds, more } = variable;
  const name = `variable ${index + 1}`;
  const put = (end: 0 | 1, typed: string) => {
    const value = Number(typed.replace(",", "."));
    const next: [number, number] = end === 0 ? [value, bounds[1]] : [bounds[0], value];
    const isNumber = typed.trim() !== "" && Number.isFinite(value);
    wrong.value = !isNumber
      ? `“${typed}”: a bound must be a number`
      : next[0] < next[1]
        ? ""
        : `${plain(next[0], 8)} to ${plain(next[1], 8)}: the smaller bound must come first`;
    if (wrong.value === "") change(index, { ...variable, bounds: next });
  };
  const bound = (end: 0 | 1, words: string, which: string) => (
    <label>
      {words}{" "}
      <input
        inputMode="decimal"
        aria-label={`${which} value of ${name}`}
        value={String(bounds[end])}
        onChange={(event) => put(end, event.currentTarget.value)}
      />
    </label>
  );
  return (
    <div class="controls axis">
      <KeySelect label={`Key of ${name}`} value={key} keys={keys.value} change={(to) => change(index, variableFor(to))} />
      {bound(0, "from", "Smallest")}
      {bound(1, "to", "Largest")}
      <button type="button" onClick={() => change(index, null)} aria-label={`Remove ${name}`}>
        Remove
      </button>
      <Remarks more={more} />
      {wrong.value && (
        <p class="error" role="alert">
          {wrong.value}
        </p>
      )}
    </div>
  );
}

/** How well the design matches a measured file before the fit, or why it cannot be compared with it. */
function Match({ name, id }: { name: string; id: string }) {
  const { value, age, problems } = useFollowed<Compared>("compare", { panel: id }, REST_MS);
  if (problems.length > 0)
    return (
      <div>
        <Problems of={problems} />
        <Rename name={name} id={id} />
      </div>
    );
  if (value === null) return <small>reading…</small>;
  const { states: compared, left_out: leftOut, metrics } = value.comparison;
  const distances = compared.map(({ state, delta_E_2000: far }) => (typeof far === "number" ? `${state} ${fixed(far, 1)}` : state));
  const count = (metrics ?? []).length;
  return (
    <span class="remark" aria-busy={age !== "current"}>
      {compared.length > 0 && `ΔE00 of the design: ${distances.join(", ")}`}
      {count > 0 && ` ${count} ${count === 1 ? "metric" : "metrics"}`}
      {leftOut.map((reason) => (
        <span key={reason}>. Note: {reason}</span>
      ))}{" "}
      {leftOut.length > 0 && <Rename name={name} id={id} />}
    </span>
  );
}

function MeasuredFiles() {
  return (
    <fieldset>
      <legend>Measured files</legend>
      {measured.value.map(({ name, isUsed }) => (
        <div class="measured-file" key={name}>
          <label>
            <input type="checkbox" checked={isUsed} onChange={(event) => use(name, event.currentTarget.checked)} /> {name}
          </label>
          {isUsed && <Match key={fileIds.value[name]} name={name} id={fileIds.value[name]!} />}
          {isUsed && <SaveRenamed name={name} />}
        </div>
      ))}
      <div class="controls">
        <FileButton label="Choose a measurement" stays />
        <span class="remark">
          or drop files: spectra, colours or metrics of the states, as for <i>Compare</i>; with a column
          standard_deviation, if it is known. The light must be that of the instrument: choose it in the list of lights (d8-included, 45-0).
        </span>
      </div>
    </fieldset>
  );
}

/** Returns an interval, or a dash. */
const interval = (ends: Fitted["interval_68"], decimals: number): string =>
  ends ? `${fixed(ends[0], decimals)} to ${fixed(ends[1], decimals)}` : NONE;

function Row({ one }: { one: Fitted }) {
  const decimals = decimalsOf(one.standard_error ?? 0);
  const name = one.keys.map(labelText).join(", ") + (one.compensated_by ? ` (compensated by ${labelText(one.compensated_by)})` : "");
  return (
    <tr data-key={one.key}>
      <th scope="row" title={one.keys.join(", ")}>
        {name}
      </th>
      <td>{digits(one.start, 5)}</td>
      <td>
        {typeof one.value === "number" ? fixed(one.value, decimals) : "not determined"}
        {one.at_bound && " (at its bound)"}
      </td>
      <td>{typeof one.standard_error === "number" ? fixed(one.standard_error, decimals) : NONE}</td>
      <td>{interval(one.interval_68, decimals)}</td>
      <td>{interval(one.interval_95, decimals)}</td>
    </tr>
  );
}

function Variables({ report }: { report: Report }) {
  return (
    <div class="scroll" tabindex={0} role="region" aria-label="Fitted variables">
      <table class="numbers">
        <thead>
          <tr>
            <th scope="col">variable</th>
            <th scope="col">design</th>
            <th scope="col">fitted</th>
            <th scope="col">standard error</th>
            <th scope="col">68.3 %</th>
            <th scope="col">95 %</th>
          </tr>
        </thead>
        <tbody>
          {report.variables.map((one) => (
            <Row key={one.key} one={one} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** What the data do not determine, and which variables they determine only together. */
function Apart({ report }: { report: Report }) {
  const pairs = correlated(report.correlations, STRONG).slice(0, MOST_PAIRS);
  const name = (k: number) => labelText(report.variables[k]!.key);
  return (
    <>
      {report.undetermined.map((group) => (
        <p class="remark warning" key={group.join()}>
          {group.length === 1
            ? `The data do not determine ${labelText(group[0]!)}: all its values fit.`
            : `The data cannot tell apart: ${group.map(labelText).join(", ")}.`}{" "}
          Give one of them a prior, or leave it out.
        </p>
      ))}
      {pairs.length > 0 && (
        <p class="remark">
          Strongly correlated: {pairs.map(({ pair, value }) => `${name(pair[0])} and ${name(pair[1])} (${fixed(value, 3)})`).join("; ")}.
        </p>
      )}
    </>
  );
}

function Fitness({ report }: { report: Report }) {
  const { chi_square: square, degrees_of_freedom: freedom, residual_rms: rms, runs, bic, starts } = report;
  const words = [
    `chi-square ${fixed(square, 1)}, ${freedom} degrees of freedom`,
    ...(typeof rms === "number" ? [`rms of the residuals ${digits(rms, 3)}`] : []),
    ...(runs ? [`${runs.count} runs of one sign, independent errors have ${fixed(runs.expected, 0)} (z = ${fixed(runs.z, 1)})`] : []),
    `BIC ${fixed(bic, 1)}`,
    `${starts.best} of ${starts.count} starts led to this minimum`,
  ];
  return (
    <p class="remark" data-figure="chi-square">
      {words.join("; ")}.
    </p>
  );
}

function Result({ of }: { of: FitDone }) {
  const { report } = of;
  const download = () => {
    save(`${fileName()}-fitted.toml`, new Blob([of.scenario], { type: "application/toml" }));
    said.value = "The fitted scenario is saved.";
  };
  return (
    <>
      <h3>Fitted to {fittedTo.value.join(", ")}</h3>
      <Variables report={report} />
      <Apart report={report} />
      <Fitness report={report} />
      <div class="controls">
        <button type="button" class="run" onClick={take} disabled={age.value !== "current"}>
          Take the fitted values
        </button>
        <button type="button" onClick={download} title="The scenario with the fitted values, and the intervals in comments">
          Download fitted.toml
        </button>
        <Downloads name="fit" table={() => of.csv} />
      </div>
      {report.undetermined.length > 0 && (
        <p class="remark">Of what the data do not determine, one of the many values that fit is taken.</p>
      )}
      {report.warnings.map((warning) => (
        <p class="remark warning" key={warning}>
          Warning: {warning}
        </p>
      ))}
      {[...of.notes, ...report.notes].map((note) => (
        <p class="remark" key={note}>
          Note: {note}
        </p>
      ))}
      {of.figures.map(({ name, svg }) => (
        <Drawn key={name} name={name} svg={svg} label={name === "fit-spectra" ? "Measured and fitted spectra" : "Residuals"} />
      ))}
    </>
  );
}

function Setup() {
  const running = fit.phase.value === "running";
  const count = variables.value.length;
  const now = progress.value;
  const missing = used.value.length === 0 ? "Choose a measurement first." : count === 0 ? "Add a variable first." : "";
  return (
    <>
      {ofFile.value !== null && (
        <div class="controls">
          <span role="status">
            {isOfFile.value ? "The fit of the scenario, [fit]." : "Changed variables; the scenario has its own, [fit]."}
          </span>
          {!isOfFile.value && (
            <button type="button" onClick={() => (own.value = null)}>
              Back to the scenario's fit
            </button>
          )}
        </div>
      )}
      <div class="controls">
        {running ? (
          <button type="button" onClick={fit.cancel}>
            Cancel
          </button>
        ) : (
          <button type="button" class="run" disabled={missing !== ""} title={missing} onClick={() => void run()}>
            Fit {count} {count === 1 ? "variable" : "variables"}
          </button>
        )}
        {!running && missing === "" && <AsJob start={runAsJob} />}
        <progress max={1} value={fit.phase.value === "done" ? 1 : (now?.fraction ?? 0)} aria-label="Progress of the fit" />
        <span role="status" data-phase={fit.phase.value}>
          {running ? (now?.words ?? "computing…") : fit.phase.value === "done" ? "done" : fit.phase.value === "cancelled" ? "cancelled" : missing}
        </span>
        {!isOfFile.value && count > 0 && (
          <button type="button" onClick={keep} title="Write these variables to the scenario, for `papilio fit FILE`">
            {ofFile.value === null ? "Add to the scenario" : "Replace the scenario's fit"}
          </button>
        )}
      </div>
      {age.value === "current" && isOfInputs.value && <Problems of={fit.problems.value} />}
    </>
  );
}

export function FitPanel() {
  return (
    <div class="fit">
      <div>
        <p class="remark">What did production deliver? Least squares of keys of the design, to measured data of its states.</p>
        <Setup />
        <div class="axes">
          <MeasuredFiles />
          <fieldset>
            <legend>
              Variables <small>what the data are to determine, with bounds</small>
            </legend>
            {variables.value.map((variable, i) => (
              <VariableFields key={`${i} ${variable.key}`} variable={variable} index={i} />
            ))}
            <button type="button" class="quiet" onClick={addVariable}>
              Add a variable
            </button>
          </fieldset>
        </div>
      </div>
      {done.value && (
        <Aged age={age.value}>
          <Result of={done.value} />
        </Aged>
      )}
    </div>
  );
}
