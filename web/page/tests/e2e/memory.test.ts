// Memory of the server while a user clicks through all examples and tools: at most 700 MB, and 400 MB at rest.

import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { example, ROOT, stage, tool, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

/** Most memory at any time, and at rest, MB. */
const PEAK_MB = 700;
const REST_MB = 400;
/** Longest time for an example, and time of rest, ms. */
const PATIENCE_MS = 15_000;
const REST_MS = 45_000;
const TOOLS = ["stage", "angles", "energy", "pixel"];

test("server needs little memory, also after all examples and tools", { timeout: 1_800_000 }, async () => {
  const page = await on.visit();
  const names = readdirSync(join(ROOT, "scenarios")).flatMap((file) => (file.endsWith(".toml") ? [file.slice(0, -5)] : []));
  let [peak, peakAt, now] = [0, "", ""];
  const watch = setInterval(() => {
    const memory = on.memory();
    if (memory > peak) [peak, peakAt] = [memory, now];
  }, 100);
  for (const name of names) {
    now = name;
    await example(page, name);
    for (const id of TOOLS) {
      now = `${name}, ${id}`;
      await tool(page, id);
      await page.waitForLoadState("networkidle", { timeout: PATIENCE_MS }).catch(() => undefined);
    }
  }
  await page.close();
  await new Promise((resolve) => setTimeout(resolve, REST_MS));
  clearInterval(watch);
  const rest = on.memory();
  const words = `${peak.toFixed(0)} MB at most (${peakAt}), ${rest.toFixed(0)} MB at rest`;
  console.log(words);
  assert.ok(peak <= PEAK_MB && rest <= REST_MB, words);
});
