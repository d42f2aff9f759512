// The result of a design that adding refuses, by Monte Carlo: computed on request and shown like a live result.

import { computed, signal } from "@preact/signals";

import { post } from "../api/client.ts";
import type { Edit, Live, WalkProgress } from "../api/types.ts";
import { numberAt } from "../model/json.ts";
import { draft, fields, pending, text } from "./design.ts";
import { editsOf } from "./edits.ts";
import { fileIds, keptIds } from "./files.ts";
import { adopt } from "./live.ts";
import { long } from "./work.ts";

/** The relative error of Y at which the run ends; the scenario's own one, if that is larger. */
const COARSE = 0.01;

export const rescue = long();
export const progress = signal<WalkProgress | null>(null);

const wanted = computed(() => JSON.stringify([draft.value ?? text.value, pending.value]));
/** The design for which it was started last. */
const startedFor = signal("");
/** Whether what it says is about the design that is refused now. */
export const isOfNow = computed(() => startedFor.value === wanted.value);

export async function computeByMonteCarlo(): Promise<void> {
  const [base, sent] = [draft.value, pending.value];
  const whole = base ?? text.value;
  const [files, kept] = [fileIds.value, keptIds.value];
  progress.value = null;
  startedFor.value = wanted.value;
  const scenario =
    sent.length > 0 ? (await post<{ scenario: string }>("edit", { scenario: whole, edits: editsOf(sent) })).scenario : whole;
  const target = Math.max(COARSE, numberAt(fields.value, "solver.relative_error") ?? 0);
  const edits: Edit[] = [{ op: "set", path: "solver.relative_error", value: target }];
  await rescue.start("walk", { scenario, files }, edits, (event, data) => {
    if (event === "progress") progress.value = data as WalkProgress;
    if (event !== "done" || draft.value !== base || pending.value !== sent) return;
    const { result, fields, seconds } = data as Pick<Live, "result" | "fields"> & { seconds: number };
    const { warnings, solver } = result;
    const accuracy = { is_final: true, relative_error: solver.relative_error_reached };
    const all = { views: result.views.map(({ theta_deg, phi_deg }) => ({ theta_deg, phi_deg })), view: null };
    const unknown = { preset: null, lobes: [] };
    adopt({ scenario, fields, result, warnings, ...all, ...accuracy, ...unknown, cost_ms: 1e3 * seconds }, sent, kept, []);
  });
}
