// Comparison: pin a design, change the current one, check the differences, and swap the two.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { changed, figure, settled, stage, type Stage, tool, type } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

test("pinned design is compared, swapped and restored after a reload", async () => {
  const page = await on.visit();
  const first = await figure(page, "Contrast : 1");
  await page.getByRole("button", { name: "Keep this version" }).click();
  await type(page, "display.diffuser.haze", "0.5");
  const second = await changed(page, "Contrast : 1", first);
  const difference = await page.locator('[data-figure="Contrast : 1"] .difference').innerText();
  assert.match(difference, new RegExp(`^[+−][\\d.]+ from ${first.replace(".", "\\.")}$`));
  await tool(page, "compare");
  const row = page.locator("#tab-panel tbody tr");
  assert.equal(await row.count(), 1);
  assert.equal((await row.first().innerText()).split(/\s+/)[0], "display.diffuser.haze");
  await page.getByRole("region", { name: "Versions" }).getByRole("button", { name: "Compared", exact: true }).waitFor();
  assert.doesNotMatch(await page.locator("body").innerText(), /\bpin/i, "one word for one thing");
  await page.getByRole("button", { name: "Swap" }).click();
  assert.equal(await changed(page, "Contrast : 1", second), first);
  // The design is still pinned after a reload.
  await page.waitForTimeout(200);
  await page.reload();
  await page.locator('[data-figure="Contrast : 1"] .difference').filter({ hasText: second }).waitFor();
  assert.deepEqual(on.complaints, []);
});

test("version with its own file is compared after the server lost the file", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  const lamp = (peak: number) => Buffer.from(`wavelength_nm,value\n380,1\n555,${peak}\n780,1\n`);
  await page.locator("input[type=file]").first().setInputFiles({ name: "lamp.csv", mimeType: "text/csv", buffer: lamp(5) });
  await page.getByRole("button", { name: "Use as the light's spectrum" }).click();
  await settled(page);
  await page.getByRole("button", { name: "Keep this version" }).click();
  await page.locator("[data-version]").waitFor();
  const first = await figure(page, "Contrast : 1");
  // Another file with the same name replaces it in the design.
  await page.locator("input[type=file]").first().setInputFiles({ name: "lamp.csv", mimeType: "text/csv", buffer: lamp(900) });
  const second = await changed(page, "Contrast : 1", first);
  await page.getByRole("button", { name: "Stop comparing" }).click();
  await on.restart();
  await page.locator("[data-version]").getByRole("button", { name: "Compare", exact: true }).click();
  await page.locator('[data-figure="Contrast : 1"] .difference', { hasText: `from ${first}` }).waitFor({ timeout: 20_000 });
  assert.notEqual(first, second);
});
