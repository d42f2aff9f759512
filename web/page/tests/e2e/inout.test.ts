// In and out: save and open, link, undo, reload, exports.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { changed, commandLine, downloaded, drag, figure, saved, settled, stage, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const GAMUT = "Gamut % sRGB";

test("what is saved and opened again is the same, to the byte", async () => {
  const page = await on.visit();
  const first = await figure(page, GAMUT);
  await type(page, "display.diffuser.haze", "0.61");
  const then = await changed(page, GAMUT, first);
  await settled(page);
  const scenario = await saved(page);
  const other = await on.visit();
  await other
    .locator("input[type=file]")
    .first()
    .setInputFiles({ name: "again.toml", mimeType: "application/toml", buffer: Buffer.from(scenario) });
  assert.equal(await changed(other, GAMUT, first), then);
  await settled(other);
  assert.equal(await saved(other), scenario);
});

test("a link holds the whole scenario", async () => {
  const page = await on.visit();
  await type(page, "display.diffuser.haze", "0.44");
  const then = await changed(page, GAMUT, await figure(page, GAMUT));
  await settled(page);
  await page.getByRole("button", { name: "Link" }).click();
  await page.waitForFunction(() => location.hash.startsWith("#s="));
  const other = await on.visit({}, new URL(page.url()).hash);
  await settled(other);
  assert.equal(await figure(other, GAMUT), then);
  assert.equal(await saved(other), await saved(page));
});

test("undo and redo: a drag is one step", async () => {
  const page = await on.visit();
  const first = await figure(page, GAMUT);
  const before = await saved(page);
  await drag(page, "lighting.directed.0.theta_deg", -40, 30);
  const dragged = await changed(page, GAMUT, first);
  await settled(page);
  const moved = await saved(page);
  await page.keyboard.press("Control+z");
  await page.waitForFunction(
    (first) => document.querySelector('[data-figure="Gamut % sRGB"] b')?.textContent === first,
    first,
  );
  await settled(page);
  assert.equal(await saved(page), before);
  assert.ok(await page.getByRole("button", { name: "Undo" }).isDisabled());
  await page.keyboard.press("Control+Shift+z");
  await settled(page);
  assert.equal(await saved(page), moved);
  assert.notEqual(dragged, first);
});

test("what was on screen survives a reload, and a server that was killed", async () => {
  const page = await on.visit();
  await type(page, "display.diffuser.haze", "0.33");
  const then = await changed(page, GAMUT, await figure(page, GAMUT));
  await settled(page);
  const scenario = await saved(page);
  await on.restart();
  await page.reload();
  await page.locator(".bench").waitFor();
  assert.equal(await figure(page, GAMUT), then);
  assert.equal(await saved(page), scenario);
});

test("exports are the command line's", async () => {
  const page = await on.visit();
  const scenario = await saved(page);
  const take = (what: string) => downloaded(page, () => page.getByLabel("Export").selectOption(what));
  const result = JSON.parse((await take("result.json")).text) as { views: unknown };
  assert.deepEqual(result.views, commandLine(scenario).views);
  assert.match((await take("states.csv")).text, /^theta_deg,phi_deg,state,/);
  assert.match((await take("spectra.csv")).text, /^theta_deg,phi_deg,state,wavelength_nm,/);
  assert.match((await take("overview.svg")).text, /^<svg /);
  assert.equal((await take("overview.png")).bytes.subarray(1, 4).toString(), "PNG");
  const report = (await take("report.html")).text;
  assert.match(report, /<html/);
  assert.doesNotMatch(report, /(src|href)="https?:/, "a report needs no other host");
});

test("layers are added, moved and taken away, and the text follows", async () => {
  const page = await on.visit();
  await page.locator('[data-part="display.front.0"]').click();
  await page.getByLabel("Add layer").selectOption("sheet");
  await page.locator('[data-part="display.front.1"]').waitFor();
  await page.locator('[data-part="display.glass"]').click();
  await page.getByLabel("Add layer").selectOption("coating");
  await page.locator('[data-part="display.layers.4"]').waitFor();
  await settled(page);
  assert.match(await saved(page), /kind = "coating"/);
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  await settled(page);
  assert.doesNotMatch(await saved(page), /kind = "coating"/);
  await page.locator('[data-part="display.pixel.film.2"]').click();
  await page.getByRole("button", { name: "Up", exact: true }).click();
  await settled(page);
  assert.match(await saved(page), /SiO2[\s\S]*Cr:Johnson/);
  assert.deepEqual(on.complaints, []);
});
