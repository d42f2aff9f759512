// Surfaces: the preview follows the fields, its numbers are those of papilio gonio, and the surface becomes a layer of the display.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { changed, choose, downloaded, example, figure, PAPILIO, saved, settled, stage, type Stage, tool } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const panel = (page: Page) => page.locator("#tab-panel");
const cell = (page: Page, column: number): Promise<string> =>
  panel(page)
    .getByRole("region", { name: "Where the light of an inclination goes" })
    .locator("tbody tr")
    .first()
    .locator("td")
    .nth(column)
    .innerText();

/** Opens the tab, and waits for the fine preview. */
async function surface(page: Page): Promise<void> {
  await tool(page, "surface");
  await fine(page);
}

async function fine(page: Page): Promise<void> {
  await panel(page).getByText("a preview, 20 000 for each inclination").waitFor({ timeout: 120_000 });
  await settled(page);
}

test(
  "preview follows the fields, and the full measurement is that of papilio gonio",
  { timeout: 300_000 },
  async () => {
    const page = await on.visit();
    await surface(page);
    assert.match(await panel(page).locator(".verdict").innerText(), /^✓ Rays obey reciprocity .* none lost/);
    const reflected = Number((await cell(page, 0)).split(" ")[0]);
    assert.ok(Math.abs(reflected - 2.5) < 0.3, `docs/gonio.md says 2.5 % go back: ${reflected}`);

    // A refused value is explained at its field, and the numbers stay.
    await page.locator("#surface-pitch_um").fill("4");
    await panel(page).locator('[data-path="microgeometry.pitch_um"] .error', { hasText: "overlap" }).waitFor();
    await panel(page).getByRole("button", { name: "Discard the change" }).click();
    await fine(page);

    // Random heights by both roads.
    await page.locator("#surface-kind").selectOption("gaussian");
    await page.locator("#surface-rms_nm").fill("100");
    await page.locator("#surface-correlation_um").fill("4");
    await panel(page).getByText("How it is measured").click();
    await page.locator("#surface-road").selectOption("both");
    await page.locator("#surface-rays").fill("640");
    await panel(page).getByText("a preview, 640 for each inclination").waitFor({ timeout: 120_000 });
    await panel(page).getByText("Validity: waves hold").waitFor({ timeout: 120_000 });
    await panel(page).getByRole("button", { name: "Measure with all rays" }).click();
    await panel(page).getByText("all 640 for each inclination").waitFor({ timeout: 120_000 });
    const { name, text } = await downloaded(page, () =>
      panel(page).getByRole("button", { name: "Download for papilio gonio" }).click(),
    );
    assert.equal(name, "hemispheres.toml");
    const file = join(mkdtempSync(join(tmpdir(), "papilio-")), name);
    writeFileSync(file, text);
    const audit = JSON.parse(execFileSync(PAPILIO, ["gonio", file, "--json"], { encoding: "utf8" })) as {
      waves: { wavelength_nm: number; haze: number }[];
    };
    const shown = await panel(page)
      .getByRole("region", { name: "Waves by wavelength" })
      .locator("tbody tr")
      .first()
      .locator("td")
      .nth(1)
      .innerText();
    assert.ok(
      Math.abs(Number(shown.split(" ")[0]) - 100 * audit.waves[0]!.haze) < 0.006,
      `${shown}: ${audit.waves[0]!.haze}`,
    );
    assert.deepEqual(
      on.complaints.splice(0).filter((words) => !/status of 422/.test(words)),
      [],
    );
  },
);

test("surface becomes the face of the display, and is found again in its layer", { timeout: 300_000 }, async () => {
  const page = await on.visit();
  const before = await figure(page, "Contrast : 1");
  await surface(page);
  await choose(page, "Use in the display", "On the glass, in place of the diffuser");
  await changed(page, "Contrast : 1", before);
  assert.match(await saved(page), /model = "microgeometry"[\s\S]*surface = "hemispheres\.toml"/);
  await page.locator('[data-part="display.diffuser"]').click();
  assert.match(await page.locator('[data-part="display.diffuser"]').innerHTML(), /Surface[\s\S]*hemispheres\.toml/);
  await tool(page, "states");
  await page.getByRole("button", { name: "Show this surface" }).click();
  await panel(page).getByRole("button", { name: "hemispheres.toml (the diffuser)" }).waitFor();
  await fine(page);

  // The surface of an example, with the key of its layer.
  await example(page, "etched-face");
  await settled(page);
  await panel(page).getByRole("button", { name: "etched.toml (layer 1)" }).click();
  await panel(page).locator(".surface-name", { hasText: "etched.toml" }).waitFor();
  assert.equal(await page.locator("#surface-correlation_um").inputValue(), "10");
  assert.deepEqual(on.complaints, []);
});

test("dropped heights are measured", { timeout: 300_000 }, async () => {
  const page = await on.visit();
  const rows = Array.from({ length: 32 }, (_, y) =>
    Array.from({ length: 32 }, (_, x) => 0.2 * Math.sin(x / 5) * Math.cos(y / 4)).join(","),
  );
  await page
    .locator("input[type=file]")
    .first()
    .setInputFiles({ name: "waves.csv", mimeType: "text/csv", buffer: Buffer.from(rows.join("\n")) });
  await page.getByRole("button", { name: "Use as a surface" }).click();
  // The file does not state the distance of its heights.
  await panel(page).locator(".refusal .error, .field .error", { hasText: "pixel_um" }).first().waitFor();
  await page.locator("#surface-pixel_um").fill("1");
  await page.locator("#surface-pixel_um").press("Enter");
  await fine(page);
  assert.match(await panel(page).getByLabel("Statistics of the heights").innerText(), /rms height \(nm\)\s+\d+/);
  on.complaints.splice(0);
});
