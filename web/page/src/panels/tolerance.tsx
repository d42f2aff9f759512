// A tolerance analysis, as by `papilio tolerance`: distributions of keys in production, and the yield, spreads and sensitivities that follow.

import type { ToleranceDone } from "../api/types.ts";
import { digits, fixed, NONE, plain } from "../model/format.ts";
import { at, listAt, type Table } from "../model/json.ts";
import { keyOf, replaced, SPREADS, spreadOf, withSpread } from "../model/study.ts";
import { Drawn } from "../plots/figure.tsx";
import { fields } from "../state/design.ts";
import { labelOf, labelText } from "../state/labels.ts";
import { hasTargets } from "../state/optimize.ts";
import { addKey, addOfSearch, addTargets, age, analysis, done, keyFor, keys, ofSearch, progress, run, study } from "../state/tolerance.ts";
import { Aged } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { KeySelect } from "./key-select.tsx";
import { Problems } from "./problems.tsx";
import { Limits, NumberBox, Start } from "./study-parts.tsx";

type Report = ToleranceDone["report"];

/** The distribution of a key that the page cannot edit, in words. */
function distribution(key: Table): string {
  const kinds = ["normal", "uniform", "triangular", "lognormal", "choices"].filter((kind) => kind in key);
  return kinds.length > 0 ? `${kinds[0]}, as in the scenario` : "as in the scenario";
}

/** Returns the value of a key without its sign; 0 if it has none. */
const sizeOf = (key: string): number => {
  const value = at(fields.value, key);
  return typeof value === "number" ? Math.abs(value) : 0;
};

type Spread = NonNullable<ReturnType<typeof spreadOf>>;

/** Returns the same tolerance with a width relative to the value of the key, or in its unit. */
const relative = (of: Table, { kind, width }: Spread, key: string): Table =>
  withSpread({ ...of, relative: true }, kind, sizeOf(key) > 0 ? Number((width / sizeOf(key)).toPrecision(3)) : width);
const absolute = (of: Table, { kind, width }: Spread, key: string): Table =>
  withSpread({ ...of, relative: false }, kind, sizeOf(key) > 0 ? Number((width * sizeOf(key)).toPrecision(3)) : width);

function KeyFields({ of, index }: { of: Table; index: number }) {
  const all = study.list("keys");
  const put = (to: Table | null) => study.put("keys", replaced(all, index, to));
  const [key, spread, others] = [keyOf(of), spreadOf(of), listAt(of, "keys")];
  const isRelative = of["relative"] === true;
  return (
    <div class="controls axis">
      {others.length > 1 ? (
        <span class="key-select">
          <code>{others.join(", ")}</code>
          <small>{labelText(key)}</small>
        </span>
      ) : (
        <KeySelect label={`Key of tolerance ${index + 1}`} value={key} keys={keys.value} change={(to) => put(keyFor(to))} />
      )}
      {spread ? (
        <>
          <select
            aria-label={`Distribution of tolerance ${index + 1}`}
            value={spread.kind}
            onChange={(event) => put(withSpread(of, event.currentTarget.value, spread.width))}
          >
            {Object.entries(SPREADS).map(([kind, { name }]) => (
              <option key={kind} value={kind}>
                {name}
              </option>
            ))}
          </select>
          <NumberBox
            label={`Width of tolerance ${index + 1}`}
            value={spread.width}
            put={(value) => value !== null && value > 0 && put(withSpread(of, spread.kind, value))}
          />
          {!isRelative && <span>{labelOf(key).unit}</span>}
          <label>
            <input
              type="checkbox"
              checked={isRelative}
              onChange={(event) => put(event.currentTarget.checked ? relative(of, spread, key) : absolute(of, spread, key))}
            />{" "}
            relative{isRelative && `, ${plain(100 * spread.width, 3)} %`}
          </label>
        </>
      ) : (
        <span>{distribution(of)}</span>
      )}
      <button type="button" onClick={() => put(null)} aria-label={`Remove tolerance ${index + 1}`}>
        Remove
      </button>
    </div>
  );
}

const percent = ({ value, standard_error: se }: { value: number; standard_error: number }): string =>
  `${fixed(100 * value, 2)} ± ${fixed(100 * se, 2)} %`;

function Yield({ report }: { report: Report }) {
  if (report.limits.length === 0) return null;
  return (
    <>
      <p class="yield">
        Yield <b data-figure="yield">{percent(report.verdict.yield_share)}</b>
      </p>
      <table class="numbers">
        <thead>
          <tr>
            <th scope="col">limit</th>
            <th scope="col">at least</th>
            <th scope="col">at most</th>
            <th scope="col">fails</th>
            <th scope="col">fails alone</th>
          </tr>
        </thead>
        <tbody>
          {report.limits.map((limit, i) => (
            <tr key={limit.metric}>
              <th scope="row">{labelText(limit.metric)}</th>
              <td>{limit.at_least ?? NONE}</td>
              <td>{limit.at_most ?? NONE}</td>
              <td>{percent(report.verdict.failing[i]!.share)}</td>
              <td>{percent(report.verdict.failing[i]!.alone)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </>
  );
}

/** Returns the label of a key of the analysis by its name there. */
function inWords(name: string): string {
  const key = study.list("keys").find((one) => one["name"] === name);
  return key ? labelText(keyOf(key)).replace(/ \([^)]*\)$/, "") : name;
}

/** The percentiles that are shown: 5, 50 and 95 %. */
const SHOWN = [1, 3, 5];

function Spreads({ report }: { report: Report }) {
  return (
    <table class="numbers">
      <thead>
        <tr>
          <th scope="col">metric</th>
          <th scope="col">mean</th>
          <th scope="col">std. dev.</th>
          <th scope="col">5 %</th>
          <th scope="col">50 %</th>
          <th scope="col">95 %</th>
          <th scope="col">main causes</th>
        </tr>
      </thead>
      <tbody>
        {report.metrics.map(({ name, spread, indices }) => {
          const worst = indices
            .map((one, i) => ({ i, total: one?.total.value ?? 0 }))
            .sort((a, b) => b.total - a.total)
            .filter(({ total }) => total >= 0.05)
            .slice(0, 2);
          return (
            <tr key={name} data-metric={name}>
              <th scope="row">{labelText(name)}</th>
              <td>{digits(spread?.mean.value, 5)}</td>
              <td>{digits(spread?.deviation.value, 3)}</td>
              {SHOWN.map((k) => (
                <td key={k}>{digits(spread?.percentiles[k]?.value, 5)}</td>
              ))}
              <td class="words">
                {worst.map(({ i, total }) => `${report.groups[i]!.map(inWords).join(" + ")} ${fixed(100 * total, 0)} %`).join(", ")}
              </td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

function Result({ of }: { of: ToleranceDone }) {
  const { report } = of;
  return (
    <>
      <Yield report={report} />
      <h3>
        Distributions <small>{report.samples} displays</small>
      </h3>
      <div class="scroll" tabindex={0} role="region" aria-label="Distributions of the metrics">
        <Spreads report={report} />
      </div>
      <p class="figure-tools">
        {of.tables.map(({ name, csv }) => (
          <Downloads key={name} name={name} table={() => csv} isNamed />
        ))}
      </p>
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
        <Drawn key={name} name={name} svg={svg} label={name.replaceAll("_", " ")} />
      ))}
    </>
  );
}

export function TolerancePanel() {
  const all = study.list("keys");
  const now = progress.value;
  const samples = study.table.value["samples"];
  return (
    <div class="study">
      <div>
        <p class="remark">
          How many displays of a production meet the limits, and which key causes their spread? <i>Vary</i> beside a field adds its key.
        </p>
        <Start
          of={analysis}
          study={study}
          table="tolerance"
          words="Analyse"
          missing={all.length === 0 ? "Add a key first." : ""}
          run={run}
          fraction={now ? now.done / Math.max(1, now.of) : 0}
          course={now ? `${now.done} of ${now.of} displays` : ""}
        />
        {age.value === "current" && <Problems of={analysis.problems.value} />}
      </div>
      <details open={done.value === null}>
        <summary>Keys and limits</summary>
        <div class="axes">
          <fieldset>
            <legend>
              Keys <small>with their distribution in production</small>
            </legend>
            {all.map((one, i) => (
              <KeyFields key={`${i} ${keyOf(one)}`} of={one} index={i} />
            ))}
            <button type="button" class="quiet" onClick={() => addKey()}>
              Add a key
            </button>
          </fieldset>
          <Limits study={study} list="limits" title="Limits" about="what a good display meets" />
          {hasTargets.value && (
            <button type="button" onClick={addTargets}>
              Take the targets of the numbers as limits
            </button>
          )}
          {ofSearch.value.isNew && (
            <button type="button" onClick={addOfSearch}>
              Take variables and constraints of the search
            </button>
          )}
          <div class="controls axis">
            <label>
              displays{" "}
              <NumberBox
                label="Number of displays"
                value={typeof samples === "number" ? samples : undefined}
                put={(value) => value !== null && value >= 16 && study.put("samples", Math.round(value))}
              />
            </label>
          </div>
        </div>
      </details>
      {done.value && (
        <Aged age={age.value}>
          <Result of={done.value} />
        </Aged>
      )}
    </div>
  );
}
