// Jobs: commands of the program that run on the server and go on when the page is closed. The page looks at them while any is
// running, or while they are shown.

import { computed, effect, signal } from "@preact/signals";

import { get, post, postForBlob, Refused } from "../api/client.ts";
import type { Edit, Job, JobCommand, JobList, Problem } from "../api/types.ts";
import { text, title } from "./design.ts";
import { add, fileIds, sendAgain } from "./files.ts";
import { open } from "./open.ts";
import { ready } from "./ready.ts";
import { said } from "./said.ts";
import { gone } from "./server.ts";

/** Time between two looks, while a job is running and otherwise, ms. */
const LOOK_MS = 700;
const REST_MS = 5000;

export const jobs = signal<readonly Job[]>([]);
/** Whether the server runs jobs; null before it has answered. */
export const isAvailable = signal<boolean | null>(null);
export const commands = signal<readonly JobCommand[]>([]);

export const isEnded = ({ phase }: Job): boolean => phase !== "running" && phase !== "waiting";
/** The number of jobs that have not ended. */
export const unfinished = computed(() => jobs.value.filter((job) => !isEnded(job)).length);

/** Number of components that show jobs. */
const viewers = signal(0);
let timer: ReturnType<typeof setTimeout> | undefined;

async function look(): Promise<void> {
  clearTimeout(timer);
  try {
    const before = jobs.value.filter((job) => !isEnded(job));
    const { is_available, jobs: now } = await post<JobList>("jobs", {});
    isAvailable.value = is_available;
    if (JSON.stringify(now) !== JSON.stringify(jobs.value)) jobs.value = now;
    for (const { id, line } of before) {
      const ended = now.find((job) => job.id === id);
      if (ended && isEnded(ended)) said.value = `${line}: ${ended.phase}`;
    }
  } catch {
    // The next look is later.
  }
  if (unfinished.value > 0 || viewers.value > 0) timer = setTimeout(() => void look(), unfinished.value > 0 ? LOOK_MS : REST_MS);
}

/** Looks at the jobs once, for those of an earlier visit, and again when the server is back. */
export function beginJobs(): void {
  effect(() => {
    if (!gone.value) void look();
  });
}

/** Keeps the list up to date; returns a function that ends it. */
export function watchJobs(): () => void {
  viewers.value += 1;
  void look();
  if (commands.value.length === 0) void get<JobCommand[]>("jobs/commands").then((all) => (commands.value = all), () => undefined);
  return () => void (viewers.value -= 1);
}

export const startProblems = signal<readonly Problem[]>([]);

export interface WantedJob {
  readonly command: string;
  readonly options?: Readonly<Record<string, string>>;
  /** The text that is computed, instead of the design. */
  readonly scenario?: string;
  /** Edits of the design, which are not applied to it. */
  readonly edits?: readonly Edit[];
  readonly inputs?: readonly string[];
  /** Further files by name. */
  readonly files?: Readonly<Record<string, string>>;
}

const slug = (name: string): string => name.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "scenario";

/** Starts a job of the current design. Returns whether the server has taken it. */
export async function startJob({ command, options = {}, scenario, edits = [], inputs = [], files = {} }: WantedJob): Promise<boolean> {
  if (scenario === undefined && !(await ready("started"))) return false;
  startProblems.value = [];
  try {
    let whole = scenario ?? text.value;
    if (edits.length > 0) whole = (await post<{ scenario: string }>("edit", { scenario: whole, edits })).scenario;
    const request = { command, options, scenario: whole, name: slug(title.value), title: title.value, inputs };
    const send = () => post<Job>("jobs/start", { ...request, files: { ...fileIds.value, ...files } });
    let job: Job;
    try {
      job = await send();
    } catch (why) {
      if (!(why instanceof Refused && (await sendAgain(why)))) throw why;
      job = await send();
    }
    jobs.value = [job, ...jobs.value];
    said.value = `${job.line} runs as a job; it goes on when this page is closed.`;
    void look();
    return true;
  } catch (why) {
    startProblems.value = why instanceof Refused ? why.problems : [{ message: String(why) }];
    said.value = startProblems.value[0]?.message ?? "The job was not started.";
    return false;
  }
}

async function ask(what: "cancel" | "remove", id: string): Promise<void> {
  try {
    await post(`jobs/${what}`, { id });
  } catch (why) {
    said.value = why instanceof Error ? why.message : String(why);
  }
  await look();
}
export const cancelJob = (id: string): Promise<void> => ask("cancel", id);
export const removeJob = (id: string): Promise<void> => ask("remove", id);

export const jobFile = (id: string, name: string): Promise<Blob> => postForBlob("jobs/file", { id, name });

/** Opens a scenario that a job has written as the design. */
export async function openResult(id: string, name: string): Promise<void> {
  const whole = await (await jobFile(id, name)).text();
  if (await open(whole, name)) said.value = `${name} is open. Undo restores the previous design.`;
}

/** Adds a file that a job has written to the files of the design. */
export async function addResult(id: string, name: string): Promise<void> {
  const short = name.split("/").at(-1)!;
  if (await add(short, await jobFile(id, name))) said.value = `${short} is under Files, and can be used in the design.`;
}
