// Jobs: a form that starts a command of the program, and the list of jobs with their progress, reports, figures and files.

import { useEffect } from "preact/hooks";
import { useSignal } from "@preact/signals";

import type { CommandOption, Job, JobCommand } from "../api/types.ts";
import { zipped } from "../model/zip.ts";
import { Drawn } from "../plots/figure.tsx";
import { files } from "../state/files.ts";
import {
  addResult,
  cancelJob,
  commands,
  isAvailable,
  isEnded,
  jobFile,
  jobs,
  openResult,
  removeJob,
  startJob,
  startProblems,
  watchJobs,
} from "../state/jobs.ts";
import { said } from "../state/said.ts";
import { FileButton } from "./choose.tsx";
import { Command, scenarioFile } from "./command.tsx";
import { Problems } from "./problems.tsx";
import { save } from "./save.ts";

const size = (bytes: number): string =>
  bytes < 1e5 ? `${(bytes / 1e3).toFixed(1)} kB` : bytes < 1e9 ? `${(bytes / 1e6).toFixed(1)} MB` : `${(bytes / 1e9).toFixed(1)} GB`;

const duration = (seconds: number): string =>
  seconds < 100 ? `${seconds.toFixed(seconds < 10 ? 1 : 0)} s` : seconds < 6000 ? `${(seconds / 60).toFixed(0)} min` : `${(seconds / 3600).toFixed(1)} h`;

type Values = Readonly<Record<string, string>>;

function OptionField({ of, value, put }: { of: CommandOption; value: string | undefined; put: (value: string | null) => void }) {
  const label = `--${of.name}`;
  if (of.kind === "flag")
    return (
      <label title={of.about}>
        <input type="checkbox" checked={value !== undefined} onChange={(event) => put(event.currentTarget.checked ? "" : null)} />
        <code>{label}</code> <small>{of.about}</small>
      </label>
    );
  return (
    <label title={of.about}>
      <code>{label}</code>
      {of.kind === "choice" ? (
        <select value={value ?? ""} onChange={(event) => put(event.currentTarget.value || null)}>
          <option value="">default</option>
          {of.choices.map((one) => (
            <option key={one} value={one}>
              {one}
            </option>
          ))}
        </select>
      ) : (
        <input
          inputMode={of.kind === "number" ? "decimal" : "text"}
          placeholder="default"
          value={value ?? ""}
          onInput={(event) => put(event.currentTarget.value.trim() || null)}
        />
      )}
      <small>{of.about}</small>
    </label>
  );
}

/** Returns the command as it is typed in a shell. */
function lineOf({ name, has_scenario: hasScenario, writes_file: writesFile }: JobCommand, inputs: readonly string[], options: Values): string {
  const all = Object.entries(options).map(([key, value]) => (value === "" ? `--${key}` : `--${key}=${value}`));
  const out = writesFile ? [`OUT.${{ csv: "csv", klems: "xml", papilio: "npz" }[options["format"] ?? ""] ?? "bsdf"}`] : [];
  return ["papilio", name, ...(hasScenario ? [scenarioFile()] : []), ...inputs, ...out, ...all].join(" ");
}

function Form({ of }: { of: JobCommand }) {
  const options = useSignal<Values>({});
  const inputs = useSignal<readonly string[]>([]);
  const starting = useSignal(false);
  const names = files.value.filter(({ audit }) => audit).map(({ name }) => name);
  const wanted = of.inputs.map((_, i) => inputs.value[i] ?? names[i] ?? "");
  const more = of.is_last_repeated ? inputs.value.slice(of.inputs.length) : [];
  const all = [...wanted, ...more].filter((name) => name !== "");
  const put = (i: number, name: string) => {
    const next = [...wanted, ...more];
    next[i] = name;
    inputs.value = next;
  };
  const start = async () => {
    starting.value = true;
    await startJob({ command: of.name, options: options.value, inputs: all, ...(of.has_scenario ? {} : { scenario: "" }) });
    starting.value = false;
  };
  const isMissing = all.length < of.inputs.length;
  return (
    <form
      class="job-form"
      aria-label={`papilio ${of.name}`}
      onSubmit={(event) => {
        event.preventDefault();
        void start();
      }}
    >
      <p class="remark">
        {of.about}. {of.continues ? "It goes on from its journal after a restart of the server." : ""}
      </p>
      {of.inputs.map((what, i) => (
        <label key={what}>
          {what}
          <select value={wanted[i]} onChange={(event) => put(i, event.currentTarget.value)}>
            {wanted[i] === "" && <option value="">drop or choose a file</option>}
            {names.map((name) => (
              <option key={name} value={name}>
                {name}
              </option>
            ))}
          </select>
        </label>
      ))}
      {of.inputs.length > 0 && (
        <span>
          <FileButton label="Choose files" stays />
        </span>
      )}
      {of.options.map((one) => (
        <OptionField
          key={one.name}
          of={one}
          value={options.value[one.name]}
          put={(value) => {
            const { [one.name]: _, ...others } = options.value;
            options.value = value === null ? others : { ...others, [one.name]: value };
          }}
        />
      ))}
      <div class="controls">
        <button type="submit" class="run" disabled={isMissing || starting.value}>
          Start the job
        </button>
        {isMissing && <span class="remark">It needs a file: {of.inputs.join(" and ")}.</span>}
      </div>
      <Problems of={startProblems.value} />
      <Command line={lineOf(of, all, options.value)} />
    </form>
  );
}

/** A figure of a job, loaded when it is shown. */
function Figure({ job, name }: { job: Job; name: string }) {
  const svg = useSignal("");
  useEffect(() => void jobFile(job.id, name).then(async (blob) => (svg.value = await blob.text()), () => undefined), [job.id, name]);
  return svg.value ? <Drawn svg={svg.value} label={`${job.line}: ${name}`} /> : null;
}

/** Number of figures that are shown. */
const MOST_FIGURES = 8;

async function saveAll(job: Job): Promise<void> {
  said.value = "Collecting the files…";
  try {
    const found = new Map<string, Uint8Array>();
    for (const { name } of job.files) found.set(name, new Uint8Array(await (await jobFile(job.id, name)).arrayBuffer()));
    save(`${job.command.replace(/ /g, "-")}.zip`, await zipped(found));
    said.value = `${found.size} files are saved.`;
  } catch (why) {
    said.value = why instanceof Error ? why.message : String(why);
  }
}

async function saveOne(job: Job, name: string): Promise<void> {
  try {
    save(name.split("/").at(-1)!, await jobFile(job.id, name));
  } catch (why) {
    said.value = why instanceof Error ? why.message : String(why);
  }
}

/** Files that the design can use. */
const USABLE = /\.(bsdf|csv|npz|xml)$/;

function Results({ job }: { job: Job }) {
  const figures = job.files.filter(({ name }) => name.endsWith(".svg")).slice(0, MOST_FIGURES);
  return (
    <div class="job-results">
      {job.message && <pre class="words refused">{job.message}</pre>}
      {job.report.trim() && (
        <pre class="words" tabindex={0} aria-label={`Report of ${job.line}`}>
          {job.report.trim()}
        </pre>
      )}
      {job.notes.trim() && job.phase !== "failed" && <pre class="words notes-of-job">{job.notes.trim()}</pre>}
      {figures.map(({ name }) => (
        <Figure key={name} job={job} name={name} />
      ))}
      {job.files.length > 0 && (
        <>
          <table class="numbers job-files">
            <tbody>
              {job.files.map(({ name, bytes }) => (
                <tr key={name} data-file={name}>
                  <th scope="row">{name}</th>
                  <td>{size(bytes)}</td>
                  <td>
                    <button type="button" onClick={() => void saveOne(job, name)} aria-label={`Save ${name}`}>
                      Save
                    </button>
                    {name.endsWith(".toml") && (
                      <button type="button" onClick={() => void openResult(job.id, name)}>
                        Open as the design
                      </button>
                    )}
                    {job.command.startsWith("diffuser") && USABLE.test(name) && (
                      <button type="button" onClick={() => void addResult(job.id, name)}>
                        Add to the files
                      </button>
                    )}
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
          <button type="button" onClick={() => void saveAll(job)}>
            Save all files (zip)
          </button>
        </>
      )}
    </div>
  );
}

/** The fraction of a line of progress: "34 % done", "12 of 40 points". */
function fractionOf(progress: string): number | null {
  const percent = /^(\d+) %/.exec(progress);
  if (percent) return Number(percent[1]) / 100;
  const count = /^(\d+) of (\d+)/.exec(progress);
  return count ? Number(count[1]) / Math.max(1, Number(count[2])) : null;
}

function JobRow({ job }: { job: Job }) {
  const isOpen = useSignal(false);
  const fraction = fractionOf(job.progress);
  return (
    <li class="job" data-job={job.command} data-phase={job.phase}>
      <div class="job-head">
        <button type="button" class="fold" aria-expanded={isOpen.value} disabled={!isEnded(job)} onClick={() => (isOpen.value = !isOpen.value)}>
          {job.line}
        </button>
        <small>
          {job.title}, {new Date(job.started_ms).toLocaleTimeString(undefined, { hour: "2-digit", minute: "2-digit" })}
        </small>
        {job.phase === "running" && (
          <progress aria-label={`Progress of ${job.line}`} max={1} {...(fraction === null ? {} : { value: fraction })} />
        )}
        <span class={job.phase === "failed" ? "disagrees" : ""}>
          {job.phase === "running" ? job.progress || "running" : job.phase}
          {job.phase !== "waiting" && <small> {duration(job.seconds)}</small>}
        </span>
        {isEnded(job) ? (
          <button type="button" onClick={() => void removeJob(job.id)} aria-label={`Remove ${job.line}`} title="Remove it with its results">
            ×
          </button>
        ) : (
          <button type="button" onClick={() => void cancelJob(job.id)}>
            Cancel
          </button>
        )}
      </div>
      {isOpen.value && isEnded(job) && <Results job={job} />}
    </li>
  );
}

/** The jobs of some commands, or all. */
function List({ of }: { of: readonly string[] }) {
  const shown = jobs.value.filter(({ command }) => of.includes(command));
  if (shown.length === 0) return null;
  return (
    <ul class="jobs" aria-label="Jobs">
      {shown.map((job) => (
        <JobRow key={job.id} job={job} />
      ))}
    </ul>
  );
}

/** Commands that start here, and their jobs. `names` are their words after `papilio`; without them, all. */
export function JobsPanel({ names }: { names?: readonly string[] }) {
  useEffect(() => watchJobs(), []);
  // Surfaces are measured in their own tool.
  const all = commands.value.filter(({ name }) => (names ? names.includes(name) : name !== "gonio"));
  const chosen = useSignal("");
  const of = all.find(({ name }) => name === chosen.value) ?? all[0];
  if (isAvailable.value === false)
    return <p class="remark">This server runs no jobs: start it with the program `papilio serve`, or use the command line.</p>;
  return (
    <section class="jobs-panel" aria-label="Jobs">
      <p class="remark">A job runs on the server: it goes on when this page is closed, and continues when the server starts again.</p>
      {all.length > 1 && (
        <label class="job-command">
          Command{" "}
          <select aria-label="Command" value={of?.name} onChange={(event) => (chosen.value = event.currentTarget.value)}>
            {all.map(({ name }) => (
              <option key={name} value={name}>
                {name}
              </option>
            ))}
          </select>
        </label>
      )}
      {of && <Form key={of.name} of={of} />}
      <List of={names ?? commands.value.map(({ name }) => name)} />
    </section>
  );
}

/** A button of a tool that runs its command as a job instead. */
export function AsJob({ start }: { start: () => Promise<boolean> }) {
  if (isAvailable.value !== true) return null;
  return (
    <button type="button" onClick={() => void start()} title="On the server: it goes on when this page is closed, and is listed under Improve, Jobs">
      Run as a job
    </button>
  );
}
