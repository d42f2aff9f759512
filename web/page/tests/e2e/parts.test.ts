// Everything that the page offers to add or to choose computes: layers, lights, models, rooms, states.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { saved, stage, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

/** Waits for the answer to what was just done, and fails in the words of a refusal. */
async function computes(page: Page, what: string): Promise<void> {
  await page.waitForTimeout(150);
  await page.locator('.picture[aria-busy="false"]').waitFor({ timeout: 30_000 });
  await page.waitForLoadState("networkidle");
  const refusal = page.locator(".refusal");
  assert.equal(await refusal.count(), 0, `${what}: ${(await refusal.allInnerTexts()).join()}`);
}

async function anew(page: Page): Promise<void> {
  await page.getByLabel("Examples").selectOption("indoor");
  await computes(page, "indoor");
  await page.locator('[data-part="display.diffuser"]').click();
}

const options = (page: Page, name: string): Promise<string[]> =>
  page
    .getByLabel(name)
    .locator("option")
    .evaluateAll((all) => all.map((one) => (one as HTMLOptionElement).value).filter(Boolean));

test("every layer and every light that can be added", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  for (const menu of ["Add layer", "Add light"]) {
    for (const what of await options(page, menu)) {
      await anew(page);
      await page.getByLabel(menu).selectOption(what);
      await computes(page, what);
    }
  }
  assert.deepEqual(on.complaints, []);
});

test("a source that is taken away leaves its share to the others", async () => {
  const page = await on.visit();
  await page.getByLabel("Add light").selectOption("ring");
  await computes(page, "ring");
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  await computes(page, "removed");
  assert.match(await saved(page), /diffuse = 0\.5\b/);
});

test("every model of diffuser and pixel, every room", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  for (const model of await options(page, "Model")) {
    await page.locator('[id="f-display.diffuser-model"]').selectOption(model);
    await computes(page, model);
  }
  await page.getByRole("navigation").getByRole("button", { name: "Pixel" }).click();
  for (const model of ["uniform", "film"]) {
    await page.locator('[id="f-display.pixel-model"]').selectOption(model);
    await computes(page, model);
  }
  for (const room of await options(page, "Room preset")) {
    await page.getByLabel("Room preset").selectOption(room);
    await computes(page, room);
  }
  // A light that only the room's preset gives is moved like any other.
  await page.locator('[data-handle^="lighting.directed.0"]').focus();
  await page.keyboard.press("ArrowLeft");
  await computes(page, "a preset's light");
  assert.match(await saved(page), /theta_deg = 29/);
  assert.deepEqual(on.complaints, []);
});

test("a state of one's own, with an analogue gap", async () => {
  const page = await on.visit();
  await page.getByRole("navigation").getByRole("button", { name: "Drive states" }).click();
  await page.locator("#f-new-state").fill("orange");
  await page.getByRole("button", { name: "Add", exact: true }).click();
  await page.locator(".patch", { hasText: "orange" }).waitFor();
  await page.getByLabel("green: driven by").selectOption("gap");
  await type(page, "state-green", "210");
  await computes(page, "gap");
  assert.match(await saved(page), /gap_nm = 210/);
});

test("one refused value does not hold up the change after it", async () => {
  const page = await on.visit();
  await type(page, "display.diffuser.haze", "7");
  await page.locator(".field .error").waitFor();
  await page.locator('[data-handle="viewer.theta_deg"]').focus();
  await page.keyboard.press("ArrowRight");
  await page.getByText("was put back").waitFor();
  await computes(page, "the viewer");
  const scenario = await saved(page);
  assert.match(scenario, /haze = 0\.78/);
  assert.match(scenario, /theta_deg = 9/);
});
