// Monte Carlo runs: their errors decrease, they agree with adding, and they can be cancelled immediately.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { example, settled, stage, type Stage, tool, type } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

test("Monte Carlo run reports decreasing errors and is cancelled immediately", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "Computation" }).click();
  await page.locator('[id="f-solver.sampler"]').selectOption("random");
  await settled(page);
  await tool(page, "walk");
  await page.locator("#walk-aim").selectOption("0.000001");
  await page.getByRole("button", { name: "Run Monte Carlo" }).click();
  await page.locator(".walk tbody tr").first().waitFor();
  const early = Number(/error ([\d.]+) %/.exec(await page.locator("[data-phase]").innerText())![1]);
  await page.waitForFunction(
    (early) => Number(/error ([\d.]+) %/.exec(document.querySelector("[data-phase]")!.textContent!)![1]) < early,
    early,
  );
  const started = Date.now();
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.locator('[data-phase="cancelled"]').waitFor();
  assert.ok(Date.now() - started < 500, "cancelled immediately");
  assert.deepEqual(on.complaints, []);
});

test("finished Monte Carlo run agrees with adding, and reports a change of the design", async () => {
  const page = await on.visit();
  await tool(page, "walk");
  await page.getByRole("button", { name: "Run Monte Carlo" }).click();
  await page.locator('[data-phase="done"]').waitFor({ timeout: 60_000 });
  const verdicts = await page.locator(".walk tbody .words").allInnerTexts();
  assert.equal(verdicts.length, 8);
  assert.ok(
    verdicts.every((words) => words.includes("✓ agrees")),
    verdicts.join(),
  );
  await page.locator('[data-part="display.diffuser"]').click();
  await type(page, "display.diffuser.haze", "0.6");
  await page.locator('#tab-panel .age-mark[data-age="earlier"]').waitFor();
  assert.deepEqual(on.complaints, []);
});

test("scenario that asks for Monte Carlo says that the page shows adding, and runs it", async () => {
  const page = await on.visit();
  const note = page.locator(".notes", { hasText: "asks for Monte Carlo" });
  assert.equal(await note.count(), 0);
  await example(page, "sampling");
  await note.waitFor({ timeout: 60_000 });
  await note.getByRole("button", { name: "Run Monte Carlo" }).click();
  await page.locator(".walk tbody tr").first().waitFor({ timeout: 60_000 });
  assert.deepEqual(on.complaints, []);
});
