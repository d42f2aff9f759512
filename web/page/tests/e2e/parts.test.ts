// Everything that the page offers to add or to choose computes: layers, lights, models, rooms, states.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { choose, itemsOf, saved, stage, type, type Stage } from "./stage.ts";

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
  await choose(page, "Examples", "indoor");
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
    for (const what of await itemsOf(page, menu)) {
      await anew(page);
      await choose(page, menu, what);
      await computes(page, what);
    }
  }
  assert.deepEqual(on.complaints, []);
});

test("a source that is taken away leaves its share to the others", async () => {
  const page = await on.visit();
  await choose(page, "Add light", "ring");
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
  for (const room of await itemsOf(page, /^Room (or|preset)/)) {
    await choose(page, /^Room (or|preset)/, room);
    await computes(page, room);
  }
  // A light that only the room's preset gives is moved like any other.
  await page.locator('[data-handle^="lighting.directed.0"]').focus();
  await page.keyboard.press("ArrowLeft");
  await computes(page, "a preset's light");
  assert.match(await saved(page), /theta_deg = 29/);
  assert.deepEqual(on.complaints, []);
});

/** Where something of the drawing is, from the middle of its foot. */
async function placeOf(page: Page, selector: string): Promise<[number, number]> {
  return page
    .locator(selector)
    .first()
    .evaluate((e) => {
      const of = (e as SVGGraphicsElement).getBBox();
      const { e: x, f: y } = (e as SVGGraphicsElement).transform.baseVal.consolidate()?.matrix ?? {
        e: of.x + of.width / 2,
        f: of.y + of.height / 2,
      };
      return [x - 230, 168 - y] as [number, number];
    });
}

test("a lamp is drawn where it is, whichever way its direction is named", async () => {
  const page = await on.visit();
  const lamp = '[data-handle="lighting.directed.0.theta_deg"]';
  const close = (a: [number, number], b: [number, number]) =>
    assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) < 0.1, `${a.join()} and ${b.join()}`);
  const named = async (theta: number, phi: number) => {
    await page.getByRole("button", { name: "TOML" }).click();
    const text = await page.locator("#source").inputValue();
    const table = /(\[\[lighting\.directed\]\]\n)(?:(?:theta|phi)_deg.*\n)+/;
    await page.locator("#source").fill(text.replace(table, `$1theta_deg = ${theta}\nphi_deg = ${phi}\n`));
    await computes(page, `${theta}, ${phi}`);
    assert.match(await saved(page), new RegExp(`theta_deg = ${theta}\nphi_deg = ${phi}\n`));
    await page.getByRole("button", { name: "Drawing" }).click();
    return { lamp: await placeOf(page, lamp), mirror: await placeOf(page, "circle.mirror") };
  };
  const [sine, cosine] = [140 * Math.sin((40 * Math.PI) / 180), 140 * Math.cos((40 * Math.PI) / 180)];
  const left = await named(-40, 0);
  close(left.lamp, [-sine, cosine]);
  close(left.mirror, [sine, cosine]);
  const turned = await named(40, 180);
  close(turned.lamp, left.lamp);
  close(turned.mirror, left.mirror);
  // An arrow to the right moves it to the right.
  await page.locator(lamp).focus();
  await page.keyboard.press("ArrowRight");
  await computes(page, "moved");
  assert.match(await saved(page), /theta_deg = 39\nphi_deg = 180/);
  // Outside the plane of drawing it is seen within the half circle, before or behind its mirror image.
  const across = await named(40, 90);
  close(across.lamp, [0, cosine]);
  close(across.mirror, [0, cosine]);
  const slanted = await named(40, 120);
  close(slanted.lamp, [-sine / 2, cosine]);
  close(slanted.mirror, [sine / 2, cosine]);
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
