// Parts of the tools that compute long: their start, progress and cancel; and lists of limits on metrics.

import { useSignal } from "@preact/signals";

import type { Table } from "../model/json.ts";
import { numberFrom, replaced } from "../model/study.ts";
import { isValue, metricsOf } from "../model/metrics.ts";
import { view } from "../state/design.ts";
import { startJob } from "../state/jobs.ts";
import { labelText } from "../state/labels.ts";
import type { OwnStudy } from "../state/own-study.ts";
import type { Long } from "../state/work.ts";
import { AsJob } from "./jobs.tsx";
import { MetricPicker } from "./metric-picker.tsx";
import { namesNow } from "./summary.tsx";

/** The names of all metrics that the design has. */
export const metricNames = (): string[] => namesNow().filter(isValue);

interface StartProps {
  of: Long;
  study: OwnStudy;
  /** The name of the table in the scenario. */
  table: string;
  /** The words of the button. */
  words: string;
  /** Why it cannot be started; "" if it can. */
  missing: string;
  run: () => unknown;
  fraction: number;
  /** What is done so far. */
  course: string;
}

export function Start({ of, study, table, words, missing, run, fraction, course }: StartProps) {
  const phase = of.phase.value;
  const hasOwn = study.own.value !== null;
  return (
    <>
      {study.ofFile.value !== null && (
        <div class="controls">
          <span role="status">
            {hasOwn ? `Changed; the scenario has its own, [${table}].` : `That of the scenario, [${table}].`}
          </span>
          {hasOwn && (
            <button type="button" onClick={() => (study.own.value = null)}>
              Back to that of the scenario
            </button>
          )}
        </div>
      )}
      <div class="controls">
        {phase === "running" ? (
          <button type="button" onClick={of.cancel}>
            Cancel
          </button>
        ) : (
          <button type="button" class="run" disabled={missing !== ""} title={missing} onClick={() => void run()}>
            {words}
          </button>
        )}
        {phase !== "running" && missing === "" && (
          <AsJob start={() => startJob({ command: table, edits: study.isOfFile.value ? [] : study.asEdits() })} />
        )}
        <progress max={1} value={phase === "done" ? 1 : fraction} aria-label="Progress" />
        <span role="status" data-phase={phase}>
          {phase === "running" ? course || "computing…" : phase === "idle" ? missing : phase === "failed" ? "" : phase}
        </span>
        {hasOwn && missing === "" && (
          <button type="button" onClick={study.keep} title={`Write the table [${table}] to the scenario, for the command line`}>
            {study.ofFile.value === null ? "Add to the scenario" : `Replace [${table}] of the scenario`}
          </button>
        )}
      </div>
    </>
  );
}

/** A box for a number. */
export function NumberBox({ label, value, put }: { label: string; value: number | undefined; put: (value: number | null) => void }) {
  const wrong = useSignal(false);
  /** The text while it is typed, or while it is no number. */
  const typing = useSignal<string | null>(null);
  return (
    <input
      inputMode="decimal"
      aria-label={label}
      aria-invalid={wrong.value}
      class={wrong.value ? "wrong-box" : ""}
      value={typing.value ?? (value === undefined ? "" : String(value))}
      onInput={(event) => (typing.value = event.currentTarget.value)}
      onChange={(event) => {
        const typed = event.currentTarget.value;
        const read = numberFrom(typed);
        wrong.value = read === null && typed.trim() !== "";
        if (wrong.value) return;
        typing.value = null;
        put(read);
      }}
    />
  );
}

/** A table without a key, or with another value of it. */
export function withKey(table: Table, key: string, value: Table[string] | null): Table {
  const { [key]: _, ...rest } = table;
  return value === null ? rest : { ...rest, [key]: value };
}

const number = (value: Table[string] | undefined): number | undefined => (typeof value === "number" ? value : undefined);

/** Returns the present value of a metric, rounded down to two digits: a limit to start from. */
function nearValue(metric: string): number {
  const value = view.value === null ? null : metricsOf(view.value).get(metric);
  if (typeof value !== "number" || value <= 0) return 0;
  const unit = 10 ** (Math.floor(Math.log10(value)) - 1);
  return Number((Math.floor(value / unit + 1e-9) * unit).toPrecision(2));
}

/** Limits on metrics: `constraints` of a search, `limits` of a tolerance analysis. */
export function Limits({ study, list, title, about }: { study: OwnStudy; list: string; title: string; about: string }) {
  const all = study.list(list);
  const put = (index: number, to: Table | null) => study.put(list, replaced(all, index, to));
  return (
    <fieldset>
      <legend>
        {title} <small>{about}</small>
      </legend>
      {all.map((one, i) => {
        const metric = String(one["metric"] ?? "");
        return (
          <div class="controls axis" key={`${i} ${metric}`}>
            <MetricPicker label={`Metric of limit ${i + 1}`} names={metricNames()} chosen={metric} choose={(name) => put(i, { ...one, metric: name })} />
            <label>
              at least{" "}
              <NumberBox label={`Least value of ${labelText(metric)}`} value={number(one["at_least"])} put={(value) => put(i, withKey(one, "at_least", value))} />
            </label>
            <label>
              at most{" "}
              <NumberBox label={`Largest value of ${labelText(metric)}`} value={number(one["at_most"])} put={(value) => put(i, withKey(one, "at_most", value))} />
            </label>
            {typeof one["condition"] === "string" && <small>in {one["condition"]}</small>}
            <button type="button" onClick={() => put(i, null)} aria-label={`Remove limit ${i + 1}`}>
              Remove
            </button>
          </div>
        );
      })}
      <MetricPicker label={`Add a limit: ${title.toLowerCase()}`} names={metricNames()} chosen="" choose={(metric) => study.put(list, [...all, { metric, at_least: nearValue(metric) }])}>
        Add a limit
      </MetricPicker>
    </fieldset>
  );
}
