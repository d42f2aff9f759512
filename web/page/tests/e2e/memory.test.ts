// Memory of the server: every example as a visitor's page requests it, several rounds, and then rest.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { stage, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

/** Limits of docs/web.md, MB. */
const [PEAK_MB, REST_MB] = [700, 400];
/** The server releases displays 20 s after the last request, and checks every 5 s. */
const REST_MS = 40_000;

/** Sends a request to the server; its answer may be a refusal, which must not cost memory either. */
async function post(path: string, body: unknown): Promise<number> {
  const response = await fetch(`${on.url}api/v1/${path}`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
    signal: AbortSignal.timeout(60_000),
  });
  await response.arrayBuffer();
  return response.status;
}

const get = async <T>(path: string): Promise<T> => (await (await fetch(`${on.url}api/v1/${path}`)).json()) as T;

test("memory stays below its limits while all examples are used, and at rest", { timeout: 1_200_000 }, async () => {
  const names = (await get<{ name: string }[]>("examples")).map(({ name }) => name);
  assert.ok(names.length > 50, `${names.length} examples`);
  let most = 0;
  for (const round of ["as it is", "from another side"])
    for (const name of names) {
      const { scenario } = await get<{ scenario: string }>(`examples/${name}`);
      const work = { scenario, files: {} };
      const edits = round === "as it is" ? [] : [{ op: "set", path: "viewer.theta_deg", value: 12 }];
      for (const [accuracy, view] of [["first", 0], ["exact", 0], ["exact", null]] as const)
        await post("live", { ...work, edits, accuracy, view });
      await post("image", { ...work, theta_deg: 20, phi_deg: 0 });
      await post("cone", { ...work, step_deg: 15 });
      most = Math.max(most, on.memory().peak);
    }
  const busy = on.memory().now;
  await new Promise((resolve) => setTimeout(resolve, REST_MS));
  const { now } = on.memory();
  console.log(`memory of the server: peak ${most.toFixed(0)} MB, after the last request ${busy.toFixed(0)} MB, at rest ${now.toFixed(0)} MB`);
  assert.ok(most <= PEAK_MB, `peak ${most} MB`);
  assert.ok(now <= REST_MB, `at rest ${now} MB`);
});
