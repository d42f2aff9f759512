// Sharpness, crosstalk, sparkle and gloss, as by `papilio mtf`, `crosstalk`, `sparkle` and `gloss`: numbers, and figures drawn by the
// same code as on the command line.

import type { Detailed } from "../api/types.ts";
import { digits, NONE } from "../model/format.ts";
import { Drawn } from "../plots/figure.tsx";
import { detailCommand } from "../state/choices.ts";
import { detailNow } from "../state/commands.ts";
import { states } from "../state/design.ts";
import { useFollowed } from "../state/follow.ts";
import { startJob } from "../state/jobs.ts";
import { labelText } from "../state/labels.ts";
import { Aged } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { AsJob } from "./jobs.tsx";
import { Addition, Problems } from "./problems.tsx";

/** Time without changes after which the figures are requested, ms. */
const REST_MS = 300;

interface Kind {
  readonly command: string;
  readonly name: string;
  readonly about: string;
}

const KINDS: readonly Kind[] = [
  {
    command: "mtf",
    name: "Sharpness",
    about: "Light returns beside where it entered: modulation transfer, profiles of edges, and the spread of a point.",
  },
  {
    command: "crosstalk",
    name: "Crosstalk",
    about: "Which sub-pixel lights which, and the gamut and contrast of stripes, lines and text.",
  },
  {
    command: "sparkle",
    name: "Sparkle",
    about: "Random brightness of equal pixels below an antiglare face, which the table [sparkle] describes.",
  },
  {
    command: "gloss",
    name: "Gloss",
    about: "What a glossmeter reads at 20, 60 and 85 deg (ISO 2813), and how distinct mirror images are.",
  },
];

type Numbered = Detailed["numbers"][number];

/** A number with its error, if the error is not negligible. */
function Value({ of }: { of: Numbered | undefined }) {
  if (!of) return <td>{NONE}</td>;
  const { value, error } = of;
  const isSeen = typeof error === "number" && typeof value === "number" && error >= 5e-4 * Math.abs(value);
  return (
    <td>
      {digits(value, 4)}
      {isSeen && <small> ± {digits(error, 2)}</small>}
    </td>
  );
}

function Numbers({ numbers, name }: { numbers: readonly Numbered[]; name: string }) {
  const known = numbers.filter(({ value }) => typeof value === "number");
  const ofView = known.filter(({ state }) => !state);
  const names = states.value.map(([state]) => state).filter((state) => known.some((one) => one.state === state));
  const metrics = [...new Set(known.filter(({ state }) => state).map(({ metric }) => metric))];
  return (
    <>
      {ofView.length > 0 && (
        <table class="numbers" aria-label={name}>
          <tbody>
            {ofView.map((one) => (
              <tr key={one.metric}>
                <th scope="row">{labelText(one.metric)}</th>
                <Value of={one} />
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {metrics.length > 0 && (
        <div class="scroll" tabindex={0} role="region" aria-label={`${name} of the states`}>
          <table class="numbers">
            <thead>
              <tr>
                <th scope="col">quantity</th>
                {names.map((state) => (
                  <th scope="col" key={state}>
                    {state}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              {metrics.map((metric) => (
                <tr key={metric}>
                  <th scope="row">{labelText(metric)}</th>
                  {names.map((state) => (
                    <Value key={state} of={known.find((one) => one.metric === metric && one.state === state)} />
                  ))}
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
    </>
  );
}

function Shown({ of, kind }: { of: Detailed; kind: Kind }) {
  return (
    <>
      {of.warnings.map((warning) => (
        <p class="remark warning" key={warning}>
          Warning: {warning}
        </p>
      ))}
      {of.figures.map(({ name, svg }) => (
        <Drawn key={name} name={name} svg={svg} label={`${kind.name}: ${name.replaceAll("_", " ")}`} />
      ))}
      <Numbers numbers={of.numbers} name={kind.name} />
      <p class="remark">
        {of.tables.map(({ name, csv }) => (
          <span key={name}>
            {name}.csv <Downloads name={name} table={() => csv} />{" "}
          </span>
        ))}
      </p>
    </>
  );
}

function Follow({ kind }: { kind: Kind }) {
  const now = useFollowed<Detailed>("detail/follow", { command: kind.command }, REST_MS, undefined, { streams: true });
  const isWaiting = (!now.value || now.age !== "current") && now.problems.length === 0;
  return (
    <>
      <Problems of={now.problems} />
      <Addition of={now.problems} />
      {isWaiting && (
        <p class="controls" role="status" data-phase={now.isCancelled ? "cancelled" : "running"}>
          {now.isCancelled ? (
            <>
              cancelled{" "}
              <button type="button" class="run" onClick={now.restart}>
                Compute
              </button>
            </>
          ) : (
            <>
              computing…{" "}
              <progress aria-label={`Progress of ${kind.name}`} max={1} {...(now.fraction === null ? {} : { value: now.fraction })} />
              <button type="button" onClick={now.cancel}>
                Cancel
              </button>
              <AsJob start={() => startJob({ command: kind.command })} />
            </>
          )}
        </p>
      )}
      {now.value && (
        <Aged age={now.age} count={now.count}>
          <Shown of={now.value} kind={kind} />
        </Aged>
      )}
    </>
  );
}

export function DetailPanel() {
  const kind = KINDS.find((one) => one.command === detailNow()) ?? KINDS[0]!;
  return (
    <section aria-label="Fine detail">
      <div class="controls">
        <label for="detail-kind">Effect</label>
        <select id="detail-kind" value={kind.command} onChange={(event) => (detailCommand.value = event.currentTarget.value)}>
          {KINDS.map((one) => (
            <option key={one.command} value={one.command}>
              {one.name}
            </option>
          ))}
        </select>
        <span class="remark">{kind.about}</span>
      </div>
      <Follow key={kind.command} kind={kind} />
    </section>
  );
}
