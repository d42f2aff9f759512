// The tabs and diagrams show the correct numbers: angles, all directions, energy balance, spectra, sweeps.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { example, figure, saved, settled, type Stage, stage, tool } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

test("metric against viewing angle equals the summary at the shown view", async () => {
  const page = await on.visit();
  await tool(page, "angles");
  await settled(page);
  await page.locator("#tab-panel .u-over").scrollIntoViewIfNeeded();
  const box = (await page.locator("#tab-panel .u-over").boundingBox())!;
  // From -80 to 80 deg; the view is at 8.
  await page.mouse.move(box.x + (box.width * 88) / 160, box.y + box.height / 2);
  assert.equal(await page.locator(".read b").innerText(), "8°");
  assert.equal(await page.locator(".read output").first().innerText(), await figure(page, "Contrast : 1"));
  await page.locator("#angle-metric").selectOption("L_star");
  assert.equal(await page.locator(".read output").count(), 8);
  assert.deepEqual(on.complaints, []);
});

test("maps over all directions are shown", async () => {
  const page = await on.visit();
  await tool(page, "cone");
  const map = page.locator("#tab-panel img.drawn").first();
  await map.waitFor({ timeout: 60_000 });
  assert.ok(await map.evaluate((img: HTMLImageElement) => img.decode().then(() => img.naturalWidth > 500)));
  assert.deepEqual(on.complaints, []);
});

test("readability is that of the described reader in any light", async () => {
  const page = await on.visit();
  await tool(page, "reading");
  const panel = page.locator("#tab-panel");
  const level = async (): Promise<number> =>
    Number(
      (await panel.locator("tr", { hasText: "Visibility level" }).locator("td").first().innerText()).split(" ")[0],
    );
  assert.match(await panel.innerText(), /A reader of 25 years/);
  const young = await level();
  assert.ok(young > 1, String(young));
  await panel.getByRole("button", { name: "Set age of the reader" }).click();
  await page.locator("#f-viewer\\.age_years").fill("70");
  await settled(page);
  assert.match(await panel.innerText(), /A reader of 70 years/);
  const old = await level();
  // The age factors of Adrian (1989): 1.0067 at 25 years, 2.9739 at 70.
  assert.ok(Math.abs(young / old / (2.9739 / 1.0067) - 1) < 0.01, `${young} ${old}`);
  assert.deepEqual(on.complaints, []);
});

test("fractions of every energy balance sum to 100 %", async () => {
  const page = await on.visit();
  await tool(page, "energy");
  for (const row of await page.locator(".ledger tbody tr").all()) {
    const fractions = (await row.locator("td:not(.bar-cell)").allInnerTexts()).map(Number);
    assert.ok(Math.abs(fractions.reduce((sum, fraction) => sum + fraction, 0) - 100) < 0.03, fractions.join());
  }
});

test("values of the spectra are shown at the pointer", async () => {
  const page = await on.visit();
  await settled(page);
  await page.locator(".spectra .u-over").hover();
  assert.match(await page.locator(".spectra figcaption").innerText(), /at \d+ nm/);
  const values = (await page.locator(".spectra output").allInnerTexts()).map(Number);
  assert.ok(values.length === 8 && values.every((value) => value > 0 && value < 1.5), values.join());
});

test("sweep over one key ends at the live result, and over two keys is drawn as a map", async () => {
  const page = await on.visit();
  await tool(page, "sweep");
  await page.getByLabel("Key of axis 1").selectOption("display.diffuser.haze");
  const axis = page.locator(".controls.axis").first();
  await axis.getByLabel("from").fill("0.5");
  await axis.getByLabel("to").fill("0.78");
  await axis.getByLabel("count").fill("4");
  await axis.getByLabel("count").press("Enter");
  await page.getByRole("button", { name: "Sweep 4 points" }).click();
  await page.locator('[data-phase="done"]').waitFor();
  const last = /value at the last point: (\d+\.\d+)/.exec(await page.locator("#tab-panel").innerText())![1]!;
  assert.equal(Number(last).toFixed(2), await figure(page, "Gamut % sRGB"));

  await page.getByRole("button", { name: "Add axis 2" }).click();
  await page.getByRole("button", { name: /Sweep \d+ points/ }).click();
  await page.locator('[data-phase="running"]').waitFor();
  await page.locator('[data-phase="done"]').waitFor({ timeout: 60_000 });
  assert.ok((await page.locator(".map-plot rect").count()) > 40);
  assert.deepEqual(on.complaints, []);
});

test("sweep of a metric of pixels has the value of the tab of fine detail", async () => {
  const page = await on.visit();
  await example(page, "matrix");
  await tool(page, "sweep");
  await page.getByLabel("Key of axis 1").selectOption("display.glass.thickness_mm");
  const axis = page.locator(".controls.axis").first();
  await axis.getByLabel("from").fill("0.3");
  await axis.getByLabel("to").fill("0.5");
  await axis.getByLabel("count").fill("2");
  await axis.getByLabel("count").press("Enter");
  await page.locator("#sweep-metric").click();
  await page.getByRole("combobox", { name: /search by words/ }).fill("white half");
  await page.locator('[data-metric="white.f50_x_per_mm"]').click();
  await page.getByRole("button", { name: "Sweep 2 points" }).click();
  await page.locator('[data-phase="done"]').waitFor({ timeout: 60_000 });
  const panel = page.locator("#tab-panel");
  const last = /value at the last point: (\d+\.\d+)/.exec(await panel.innerText())![1]!;
  await tool(page, "detail");
  const row = panel.locator("tr", { hasText: "Frequency of half the modulation along x" });
  await row.first().waitFor({ timeout: 60_000 });
  const white = Number(await row.first().locator("td").first().innerText());
  assert.ok(Math.abs(Number(last) / white - 1) < 2e-3, `${last} ${white}`);
  assert.deepEqual(on.complaints, []);
});

test("fine detail shows the numbers and figures of sharpness and crosstalk, or what is missing", async () => {
  const page = await on.visit();
  await tool(page, "detail");
  const panel = page.locator("#tab-panel");
  await panel.getByRole("alert").first().waitFor();
  const missing = (await panel.getByRole("alert").allInnerTexts()).join("\n");
  assert.match(missing, /gap_mm.* is missing/);
  assert.match(missing, /thickness_mm.* is missing/);
  // The request that was refused.
  assert.equal(on.complaints.splice(0).filter((words) => !words.includes("status of 422")).length, 0);
  // A button adds what is missing.
  await panel.getByRole("button", { name: "Add no gap below the front, 0.5 mm of glass" }).click();
  await panel.locator("img.drawn").first().waitFor({ timeout: 60_000 });
  assert.match(await saved(page), /thickness_mm = 0\.5/);
  await example(page, "matrix");
  await panel.locator("img.drawn").first().waitFor({ timeout: 60_000 });
  const row = panel.locator("tr", { hasText: "Modulation transfer at Nyquist along x" });
  const white = Number(await row.locator("td").first().innerText());
  assert.ok(white > 0.1 && white < 1, String(white));
  await page.locator("#detail-kind").selectOption("crosstalk");
  const own = panel.locator("tr", { hasText: "Share of the own sub-pixel in what is seen" }).locator("td");
  assert.match(await own.innerText(), /^0\.44/);
  assert.deepEqual(on.complaints, []);
});

test("fine detail without a thickness offers the glass; slow ones have progress and are cancelled", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await example(page, "six-ink");
  await settled(page);
  await tool(page, "detail");
  await page.getByText("the key `display.glass.thickness_mm` is missing").first().waitFor();
  await page.getByRole("button", { name: "Add 0.5 mm of glass" }).click();
  await page.locator("#tab-panel table.numbers").first().waitFor({ timeout: 120_000 });
  assert.match(await saved(page), /\[display\.glass\]\s+thickness_mm = 0\.5|glass = \{ thickness_mm = 0\.5 \}|glass\.thickness_mm = 0\.5/);
  await example(page, "antiglare");
  await settled(page);
  await tool(page, "detail");
  await page.locator("#detail-kind").selectOption("sparkle");
  const work = page.locator('#tab-panel [data-phase="running"]');
  await work.locator("progress[value]").waitFor({ timeout: 60_000 });
  await work.getByRole("button", { name: "Cancel" }).click();
  await page.locator('#tab-panel [data-phase="cancelled"]').getByRole("button", { name: "Compute" }).click();
  await work.waitFor();
  on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((one) => !/422/.test(one)));
  assert.deepEqual(on.complaints, []);
});

test("angles have a first answer with its error, and the exact one is cancelled", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await example(page, "hazy-face");
  await tool(page, "angles");
  await page.locator("#tab-panel .u-over").waitFor({ timeout: 90_000 });
  await page.getByText(/^First answer ±[\d.]+ %\. The exact one is being computed/).waitFor({ timeout: 60_000 });
  await page.locator("#tab-panel").getByRole("button", { name: "Cancel" }).click();
  await page.getByRole("button", { name: "Compute the exact one" }).waitFor();
  assert.deepEqual(on.complaints, []);
});

test("ends of a range of views are dragged, and a click on a direction between shows its view", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "TOML" }).click();
  const scenario = await page.locator("#source").inputValue();
  await page.locator("#source").fill(`${scenario.replace(/\[viewer\][^[]*/, "")}\n[viewer]\ntheta_deg = { from = 0, to = 60, step = 10 }\n`);
  await settled(page);
  await page.getByRole("button", { name: "Drawing" }).click();
  await page.locator("circle.seen").nth(2).click();
  await page.locator(".views", { hasText: "30" }).waitFor();
  await page.waitForFunction(() => document.querySelector<HTMLSelectElement>(".views select")?.selectedOptions[0]?.textContent?.includes("30"));
  await page.locator('[data-handle="viewer.theta_deg.to"]').focus();
  await page.keyboard.press("PageUp");
  await settled(page);
  assert.match(await saved(page), /theta_deg = \{ from = 0, to = 70, step = 10 \}/);
  assert.deepEqual(on.complaints, []);
});

test("sparkle has a first answer with its errors while the exact one is computed", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await example(page, "antiglare");
  await tool(page, "detail");
  await page.locator("#detail-kind").selectOption("sparkle");
  const panel = page.locator("#tab-panel");
  await panel.locator('.age-mark[data-age="first"]').waitFor({ timeout: 120_000 });
  const [value, error] = (await panel.locator("table.numbers td").first().innerText()).split("\u00b1").map(Number);
  assert.ok(value! > 0 && error! > 0.02 * value! && error! < 0.5 * value!, `${value} ${error}`);
  await panel.getByRole("button", { name: "Cancel" }).click();
  await panel.locator('[data-phase="cancelled"]').waitFor();
  assert.deepEqual(on.complaints, []);
});
