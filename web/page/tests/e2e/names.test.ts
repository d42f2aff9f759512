// States and sub-pixels whose names have points and blanks: edited, undone, swept, searched and saved under their keys in quotes.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { withValue } from "../../src/model/toml-set.ts";
import { changed, commandLine, figure, ROOT, saved, settled, stage, tool, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const CONTRAST = "Contrast : 1";
const RED = 'display.pixel.gap_nm."r 1.5"';

test("state and sub-pixel with points in their names are edited, swept, searched and saved", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  const text = readFileSync(join(ROOT, "scenarios/indoor.toml"), "utf8")
    .replaceAll("red = ", '"r 1.5" = ')
    .replace("fill_factor", 'states = { white = { "r 1.5" = 1, green = 1, blue = 1 }, black = {} }\nfill_factor');
  await page
    .locator("input[type=file]")
    .first()
    .setInputFiles({ name: "points.toml", mimeType: "application/toml", buffer: Buffer.from(text) });
  await page.locator('.patch[data-state="red"]').waitFor({ state: "detached" });
  await settled(page);
  const opened = await figure(page, CONTRAST);

  await page.getByRole("button", { name: "Pixel", exact: true }).click();
  await type(page, RED, "250");
  const moved = await changed(page, CONTRAST, opened);
  assert.match(await saved(page), /"r 1.5" = 250\b/);

  await page.getByRole("button", { name: "Drive states" }).click();
  await page.getByLabel("New state").fill("a.b");
  await page.getByRole("button", { name: "Add", exact: true }).click();
  const patch = page.locator('.patch[data-state="a.b"]');
  await patch.waitFor();
  assert.equal(await page.getByLabel("State", { exact: true }).inputValue(), "a.b");
  await page.getByLabel("r 1.5", { exact: true }).first().fill("0.25");
  await settled(page);
  const scenario = await saved(page);
  assert.match(scenario, /"a\.b" = \{ green = 0\.5, "r 1\.5" = 0\.25 \}/);
  const { states } = commandLine(scenario).views[0]!;
  assert.match(await patch.innerText(), new RegExp(`Y ${(100 * states["a.b"]!.Y).toFixed(1)} %`));

  // Undo restores the value of this state, and then that of the gap.
  await page.getByRole("button", { name: "Undo" }).click();
  await settled(page);
  assert.match(await saved(page), /"a\.b" = \{ green = 0\.5 \}/);

  // The key in quotes is an axis of a sweep, a variable of a search and a key of a tolerance analysis.
  await page.getByRole("button", { name: "Pixel", exact: true }).click();
  for (const [id, run] of [["sweep", /^Sweep \d+ points/], ["tolerance", "Analyse"]] as const) {
    await tool(page, id);
    await page.locator(`[data-path='${RED}'] .vary`).click();
    await page.getByRole("button", { name: run }).click();
    await page.locator('#tab-panel [data-phase="done"]').waitFor({ timeout: 60_000 });
  }
  await tool(page, "sweep");
  await page.getByRole("button", { name: "Apply to the design" }).first().click();
  const applied = await changed(page, CONTRAST, moved);
  await settled(page);
  const now = await saved(page);
  assert.equal(commandLine(now).views[0]!.contrast_ratio.toFixed(2), applied);

  // Without the server the page writes the value itself.
  await on.kill();
  await type(page, RED, "222");
  assert.equal(await saved(page), withValue(now, RED, 222));
  assert.match(withValue(now, RED, 222)!, /"r 1\.5" = 222\b/);
  await on.revive();
});
