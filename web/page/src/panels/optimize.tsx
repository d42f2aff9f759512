// A search for better designs, as by `papilio optimize`: variables and goals, its progress, and the best design or the Pareto front.

import type { OptimizeDone } from "../api/types.ts";
import { digits, NONE } from "../model/format.ts";
import { isTable, listAt, type Json, type Table } from "../model/json.ts";
import { AIMS, aimOf, keyOf, replaced, type Aim } from "../model/study.ts";
import { shown } from "../model/axes.ts";
import { Drawn } from "../plots/figure.tsx";
import { Scatter, type Dot } from "../plots/scatter.tsx";
import { labelText } from "../state/labels.ts";
import {
  addObjective,
  addTargets,
  addVariable,
  age,
  done,
  found,
  hasTargets,
  keys,
  progress,
  run,
  search,
  selectedDesign,
  study,
  take,
  variableFor,
} from "../state/optimize.ts";
import { said } from "../state/said.ts";
import { Aged } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { fileName } from "./file-name.ts";
import { KeySelect } from "./key-select.tsx";
import { MetricPicker } from "./metric-picker.tsx";
import { Problems } from "./problems.tsx";
import { save } from "./save.ts";
import { Limits, metricNames, NumberBox, Start } from "./study-parts.tsx";

type Report = OptimizeDone["report"];

/** What the scenario says of a variable besides its key and bounds. */
function remarkOf(variable: Table): string {
  const all = listAt(variable, "keys");
  return [
    ...(all.length > 1 ? [`with ${all.slice(1).join(", ")}`] : []),
    ...(typeof variable["compensated_by"] === "string" ? [`compensated by ${variable["compensated_by"]}`] : []),
  ].join("; ");
}

function VariableFields({ variable, index }: { variable: Table; index: number }) {
  const all = study.list("variables");
  const put = (to: Table | null) => study.put("variables", replaced(all, index, to));
  const [from, to] = listAt(variable, "bounds") as number[];
  const key = keyOf(variable);
  const choices = listAt(variable, "choices");
  const bound = (end: 0 | 1, value: number | null) =>
    value !== null && put({ ...variable, bounds: end === 0 ? [value, to ?? value] : [from ?? value, value] });
  return (
    <div class="controls axis">
      {choices.length > 0 || remarkOf(variable) !== "" ? (
        <span class="key-select">
          <code>{key}</code>
          <small>{labelText(key)}</small>
        </span>
      ) : (
        <KeySelect label={`Key of variable ${index + 1}`} value={key} keys={keys.value} change={(to) => put(variableFor(to))} />
      )}
      {choices.length > 0 ? (
        <span>one of {choices.map((choice) => shown(choice)).join(", ")}</span>
      ) : (
        <>
          <label>
            from <NumberBox label={`Smallest value of variable ${index + 1}`} value={from} put={(value) => bound(0, value)} />
          </label>
          <label>
            to <NumberBox label={`Largest value of variable ${index + 1}`} value={to} put={(value) => bound(1, value)} />
          </label>
        </>
      )}
      <button type="button" onClick={() => put(null)} aria-label={`Remove variable ${index + 1}`}>
        Remove
      </button>
      {remarkOf(variable) && <small>{remarkOf(variable)}</small>}
    </div>
  );
}

function ObjectiveFields({ objective, index }: { objective: Table; index: number }) {
  const all = study.list("objectives");
  const put = (to: Table | null) => study.put("objectives", replaced(all, index, to));
  const metric = String(objective["metric"] ?? "");
  const aim = aimOf(objective);
  const target = isTable(objective["aim"]) ? objective["aim"]["target"] : undefined;
  const aimed = (to: Aim): Table => ({ ...objective, aim: to === "target" ? { target: 0 } : to });
  return (
    <div class="controls axis">
      <select aria-label={`Aim of objective ${index + 1}`} value={aim} onChange={(event) => put(aimed(event.currentTarget.value as Aim))}>
        {AIMS.map((one) => (
          <option key={one} value={one}>
            {one === "target" ? "bring near" : one}
          </option>
        ))}
      </select>
      <MetricPicker
        label={`Metric of objective ${index + 1}`}
        names={metricNames()}
        chosen={metric}
        choose={(name) => put({ ...objective, metric: name })}
      />
      {aim === "target" && (
        <NumberBox
          label={`Target of objective ${index + 1}`}
          value={typeof target === "number" ? target : undefined}
          put={(value) => value !== null && put({ ...objective, aim: { target: value } })}
        />
      )}
      <button type="button" onClick={() => put(null)} aria-label={`Remove objective ${index + 1}`}>
        Remove
      </button>
    </div>
  );
}

/** The numbers of the effort. */
function Effort() {
  const count = (key: string, label: string, least: number, help: string) => (
    <label title={help}>
      {label}{" "}
      <NumberBox
        label={label}
        value={typeof study.table.value[key] === "number" ? (study.table.value[key] as number) : undefined}
        put={(value) => value !== null && value >= least && study.put(key, Math.round(value))}
      />
    </label>
  );
  return (
    <div class="controls axis">
      {count("starts", "starts", 1, "Number of searches from different points: that they find the same design is a sign that it is the best")}
      {count("evaluations", "designs", 10, "Number of designs that may be evaluated, in all searches together")}
      {study.list("objectives").length > 1 && count("points", "points of the front", 2, "Number of designs of the Pareto front")}
    </div>
  );
}

/** Names of the quantities of the objectives, as the report has them. */
const objectivesOf = (report: Report): string[] =>
  Object.keys(report.scenario.quantities).filter((name) =>
    study.list("objectives").some((one) => name === one["metric"] || name.endsWith(`.${one["metric"]}`) || name.startsWith(`${one["metric"]}`)),
  );

function Front() {
  const names = study.list("objectives").map((one) => String(one["metric"] ?? ""));
  const [xName, yName] = names;
  if (xName === undefined || yName === undefined) return null;
  const report = done.value?.report;
  const dot = (of: Readonly<Record<string, number | null>>, kind: Dot["kind"], title: string, index?: number): Dot[] => {
    const [x, y] = [of[xName], of[yName]];
    return typeof x === "number" && typeof y === "number"
      ? [{ x, y, kind, title: `${title}: ${digits(x, 4)}, ${digits(y, 4)}`, ...(index === undefined ? {} : { index }) }]
      : [];
  };
  const dots = [
    ...found.value.flatMap((one) => (one.missed <= 1e-5 ? dot(one.quantities, "found", "A design that was found") : [])),
    ...(report ? dot(report.scenario.quantities, "own", "The scenario") : []),
    ...(report?.designs.flatMap((one, i) => dot(one.quantities, "front", `Design ${i + 1}`, i)) ?? []),
  ];
  return (
    <Scatter
      dots={dots}
      xName={labelText(xName)}
      yName={labelText(yName)}
      label={`Pareto front of ${labelText(xName)} and ${labelText(yName)}`}
      selected={selectedDesign.value}
      pick={(index) => (selectedDesign.value = index)}
    />
  );
}

const valueText = (value: unknown): string =>
  typeof value === "number" ? digits(value, 6) : value === undefined || value === null ? NONE : shown(value as Json);

/** The selected design next to that of the scenario. */
function DesignTable({ report }: { report: Report }) {
  const design = report.designs[Math.min(selectedDesign.value, report.designs.length - 1)];
  if (!design) return <p class="remark">No design could be evaluated: its metrics are undefined.</p>;
  const goals = objectivesOf(report);
  return (
    <div class="scroll" tabindex={0} role="region" aria-label="The design that was found">
      <table class="numbers">
        <thead>
          <tr>
            <th scope="col">variable or metric</th>
            <th scope="col">scenario</th>
            <th scope="col">result</th>
          </tr>
        </thead>
        <tbody>
          {Object.keys(design.set).map((key) => (
            <tr key={key} data-key={key}>
              <th scope="row" title={key}>
                {labelText(key)}
                {design.at_end.includes(key) && " (at its end)"}
              </th>
              <td>{valueText(report.scenario.set[key])}</td>
              <td>{valueText(design.set[key])}</td>
            </tr>
          ))}
          {Object.keys(design.quantities).map((name) => (
            <tr key={name} data-metric={name} class={goals.includes(name) ? "chosen" : ""}>
              <th scope="row" title={name}>
                {labelText(name)}
              </th>
              <td>{valueText(report.scenario.quantities[name])}</td>
              <td>{valueText(design.quantities[name])}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function Result({ of }: { of: OptimizeDone }) {
  const { report, scenarios } = of;
  const index = Math.min(selectedDesign.value, report.designs.length - 1);
  const file = scenarios[index];
  const isFeasible = report.designs.some(({ meets_limits }) => meets_limits);
  return (
    <>
      <h3>
        {report.designs.length > 1
          ? `Design ${index + 1} of ${report.designs.length} on the front`
          : isFeasible
            ? "The best design"
            : "The nearest design"}
        <small> {report.evaluations} designs evaluated</small>
      </h3>
      {!isFeasible && <p class="remark warning">No design meets all limits; this one violates them least.</p>}
      <div class="controls">
        <button type="button" class="run" onClick={() => take(index)} disabled={age.value !== "current" || index < 0}>
          Take this design
        </button>
        {file && (
          <button
            type="button"
            onClick={() => {
              save(`${fileName()}-${file.name}`, new Blob([file.text], { type: "application/toml" }));
              said.value = `${file.name} is saved.`;
            }}
          >
            Download {file.name}
          </button>
        )}
        <Downloads name="optimize" table={() => of.csv} />
      </div>
      <DesignTable report={report} />
      {report.warnings.map((warning) => (
        <p class="remark warning" key={warning}>
          Warning: {warning}
        </p>
      ))}
      {of.notes.map((note) => (
        <p class="remark" key={note}>
          Note: {note}
        </p>
      ))}
      {of.figures.map(({ name, svg }) => (
        <Drawn key={name} name={name} svg={svg} label={name === "front" ? "Pareto front" : "Progress of the searches"} />
      ))}
    </>
  );
}

export function OptimizePanel() {
  const [variables, objectives] = [study.list("variables"), study.list("objectives")];
  const missing =
    variables.length === 0 ? "Add a variable first." : objectives.length === 0 ? "Add an objective first." : "";
  const now = progress.value;
  const course = now ? `${now.designs} designs; ${now.searches[0]} of ${now.searches[1]} searches` : "";
  return (
    <div class="study">
      <div>
        <p class="remark">
          Which design is best? Choose what may vary and what is wanted; <i>Vary</i> beside a field and <i>Maximise</i> at a number
          add to these lists. Two objectives give a Pareto front.
        </p>
        <Start
          of={search}
          study={study}
          table="optimize"
          words="Search"
          missing={missing}
          run={run}
          fraction={now?.fraction ?? 0}
          course={course}
        />
        {age.value === "current" && <Problems of={search.problems.value} />}
      </div>
      <details open={done.value === null}>
        <summary>Variables and goals</summary>
        <div class="axes">
          <fieldset>
            <legend>
              Variables <small>with bounds</small>
            </legend>
            {variables.map((variable, i) => (
              <VariableFields key={`${i} ${keyOf(variable)}`} variable={variable} index={i} />
            ))}
            <button type="button" class="quiet" onClick={() => addVariable()}>
              Add a variable
            </button>
          </fieldset>
          <fieldset>
            <legend>
              Objectives <small>one or more</small>
            </legend>
            {objectives.map((objective, i) => (
              <ObjectiveFields key={`${i} ${String(objective["metric"])}`} objective={objective} index={i} />
            ))}
            <MetricPicker label="Add an objective" names={metricNames()} chosen="" choose={(metric) => addObjective(metric)}>
              Add an objective
            </MetricPicker>
          </fieldset>
          <Limits study={study} list="constraints" title="Constraints" about="limits that a design must meet" />
          {hasTargets.value && (
            <button type="button" onClick={addTargets}>
              Take the targets of the numbers as constraints
            </button>
          )}
          <Effort />
        </div>
      </details>
      <div>
        <Front />
        {done.value && (
          <Aged age={age.value}>
            <Result of={done.value} />
          </Aged>
        )}
      </div>
    </div>
  );
}
