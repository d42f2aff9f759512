// The daily tests: drag a source and edit a film, and compare the gamut with the command line; and one failure of each
// kind, which must not lose a change.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { play } from "./lost.ts";
import { changed, commandLine, drag, figure, saved, settled, stage, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

test("gamut after dragging a source and editing a film equals that of papilio run", async () => {
  const page = await on.visit();
  assert.match(await page.locator(".welcome").innerText(), /reflective display/);
  const first = await figure(page, "Gamut % sRGB");
  assert.equal(first, commandLine(await saved(page)).views[0]!.gamut_percent_srgb.toFixed(2));

  await drag(page, "lighting.directed.0.theta_deg", -30, 25);
  const dragged = await changed(page, "Gamut % sRGB", first);

  await page.locator('[data-part="display.pixel.film.1"]').click();
  await type(page, "display.pixel.film.1.thickness_nm", "10.5");
  await changed(page, "Gamut % sRGB", dragged);
  await settled(page);

  const scenario = await saved(page);
  assert.match(scenario, /thickness_nm = 10\.5/);
  assert.match(scenario, /# Indoor reading: the reference interferometric/, "comments are preserved");
  const run = commandLine(scenario).views[0]!;
  assert.equal(await figure(page, "Gamut % sRGB"), run.gamut_percent_srgb.toFixed(2));
  assert.equal(await figure(page, "Contrast : 1"), run.contrast_ratio.toFixed(2));
  assert.deepEqual(on.complaints, []);
});

test("pending change is saved, and one failure of each kind loses no change", { timeout: 180_000 }, async () => {
  const page = await on.visit();
  await type(page, "display.diffuser.haze", "0.61");
  assert.match(await saved(page), /haze = 0\.61\b/);
  await page.close();
  await play(on, 1, 8);
});

test("refused change offers the accepted value, and a phone shows the numbers beside the fields", async () => {
  const page = await on.visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const first = await figure(page, "Gamut % sRGB");
  await page.getByRole("button", { name: "Layers and light" }).tap();
  await type(page, "display.diffuser.haze", "0.95");
  await page.getByRole("button", { name: /Set total transmittance.* to 0\.8573/ }).tap();
  await changed(page, "Gamut % sRGB", first);
  const box = (await page.locator('[data-figure="Gamut % sRGB"]').boundingBox())!;
  assert.ok(box.y >= 0 && box.y + box.height <= 844 && box.x + box.width <= 390, JSON.stringify(box));
  assert.match(await saved(page), /haze = 0\.95[\s\S]*total_transmittance = 0\.8573/);
  assert.deepEqual(
    on.complaints.splice(0).filter((words) => !/status of 422/.test(words)),
    [],
  );
});
