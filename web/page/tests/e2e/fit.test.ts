// Fits: the variables of a scenario or chosen ones, measured files, the numbers of papilio fit, and what the data cannot tell apart.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { downloaded, example, PAPILIO, ROOT, saved, settled, stage, type Stage, tool } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const MEASURED = join(ROOT, "scenarios/data/synthetic-film.csv");
const RED = "display.pixel.gap_nm.red";

const panel = (page: Page) => page.locator("#tab-panel");

/** Opens the example of fits with its measurement. */
async function opened(page: Page): Promise<void> {
  await example(page, "fit");
  await page.waitForFunction(
    () => document.querySelector<HTMLInputElement>("input.title")?.value === "A panel from production",
  );
  await settled(page);
  await tool(page, "fit");
  await panel(page).locator("input[type=file]").setInputFiles(MEASURED);
  await panel(page).getByLabel("synthetic-film.csv").waitFor();
}

const onlyRefusals = (): void => assert.deepEqual(on.complaints.splice(0).filter((words) => !/status of 422/.test(words)), []);

async function fitted(page: Page, count: string): Promise<void> {
  await panel(page).getByRole("button", { name: `Fit ${count}` }).click();
  await panel(page).locator('[data-phase="done"]').waitFor({ timeout: 120_000 });
}

test("fit has the numbers of papilio fit, and the design takes them", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await opened(page);
  await fitted(page, "8 variables");
  const out = mkdtempSync(join(tmpdir(), "papilio-"));
  const told = execFileSync(PAPILIO, ["fit", join(ROOT, "scenarios/fit.toml"), MEASURED, "--json", "--out", out], {
    encoding: "utf8",
    stdio: ["ignore", "pipe", "ignore"],
  });
  const report = JSON.parse(told) as { chi_square: number; variables: { key: string; value: number; interval_95: number[] }[] };
  for (const { key, value, interval_95: ends } of report.variables) {
    const cells = await panel(page).locator(`[data-key="${key}"] td`).allInnerTexts();
    const decimals = cells[2]!.split(".")[1]!.length;
    assert.equal(cells[1], value.toFixed(decimals).replace("-", "−"), key);
    assert.equal(cells[4], ends.map((end) => end.toFixed(decimals)).join(" to "), key);
  }
  const words = await panel(page).locator('[data-figure="chi-square"]').innerText();
  assert.match(words, new RegExp(`^chi-square ${report.chi_square.toFixed(1)}, 130 degrees of freedom`));
  assert.equal(await panel(page).locator("img.drawn").count(), 2);

  const file = await downloaded(page, () => panel(page).getByRole("button", { name: "Download fitted.toml" }).click());
  const own = readFileSync(join(out, "fitted.toml"), "utf8");
  assert.equal(file.name, "a-panel-from-production-fitted.toml");
  assert.equal(file.text, own);
  await panel(page).getByRole("button", { name: "Take the fitted values" }).click();
  await settled(page);
  const red = report.variables.find(({ key }) => key === RED)!.value;
  const taken = Number(/gap_nm = \{ red = ([\d.]+)/.exec(await saved(page))![1]);
  assert.ok(Math.abs(taken - red) < 1e-6, `${taken}: ${red}`);
  assert.deepEqual(on.complaints.splice(0), []);
});

test("measured file says at once why it cannot be compared, offers its states, and is read again when it is chosen again", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  await opened(page);
  const folder = mkdtempSync(join(tmpdir(), "papilio-fit-"));
  const path = join(folder, "panel 7.csv");
  const measured = readFileSync(join(ROOT, "scenarios/data/synthetic-film.csv"), "utf8");
  const choose = async (text: string) => {
    writeFileSync(path, text);
    const chooser = page.waitForEvent("filechooser");
    await panel(page).getByRole("button", { name: "Choose a measurement" }).click();
    await (await chooser).setFiles(path);
  };
  const file = panel(page).locator(".measured-file", { hasText: "panel 7.csv" });
  await choose(measured.replaceAll(/^(\w+),8,/gm, "R_$1,8,"));
  await file.getByText("no measured state has a counterpart").waitFor();
  await file.getByRole("button", { name: /^Read R_\w+, R_\w+, R_\w+, R_\w+ as / }).click();
  await file.getByText(/ΔE00 of the design: white \d/).waitFor();
  // The command of the tool works with the file that is saved here; that of the instrument has states that the design lacks.
  const renamed = await downloaded(page, () => file.getByRole("button", { name: "Save panel 7.csv with its new states" }).click());
  assert.deepEqual([renamed.name, renamed.text], ["panel 7.csv", measured]);
  const compare = (text: string) => {
    writeFileSync(path, text);
    return execFileSync(PAPILIO, ["compare", join(ROOT, "scenarios/fit.toml"), path, "--out", folder], { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
  };
  assert.match(compare(renamed.text), /white/);
  assert.throws(() => compare(measured.replaceAll(/^(\w+),8,/gm, "R_$1,8,")), /counterpart/);
  // Compare offers the same.
  await choose(measured.replaceAll(/^(\w+),8,/gm, "Q_$1,8,"));
  await tool(page, "compare");
  await page.getByRole("button", { name: /^Read Q_\w+, Q_\w+, Q_\w+, Q_\w+ as / }).click();
  await page.getByText(/simulated \/ measured$/).first().waitFor();
  await page.getByRole("button", { name: "Save panel 7.csv with its new states" }).waitFor();
  await tool(page, "fit");
  await choose("state,theta_deg,X,Y,Z\nred,8,0.1,0.08,0.05\n");
  await file.getByText(/ΔE00 of the design: red \d+\.\d\. Note/).waitFor();
  onlyRefusals();
});

test("variables are chosen on the page, and what the data cannot tell apart has no numbers", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await opened(page);
  // Two numbers of one colour determine no two variables.
  await panel(page).getByLabel("synthetic-film.csv").uncheck();
  const metrics = "metric,value,standard_deviation\nwhite.Y,0.2,0.002\nwhite.L_star,51.8,0.3\n";
  await panel(page)
    .locator("input[type=file]")
    .setInputFiles({ name: "metrics.csv", mimeType: "text/csv", buffer: Buffer.from(metrics) });
  await panel(page).getByLabel("metrics.csv").waitFor();
  for (let i = 0; i < 8; i++) await panel(page).getByRole("button", { name: "Remove variable 1" }).click();
  assert.ok(await panel(page).getByRole("button", { name: "Fit 0 variables" }).isDisabled());
  for (const [number, key] of [
    [0, "display.pixel.fill_factor"],
    [1, "display.pixel.film.1.thickness_nm"],
  ] as const) {
    await panel(page).getByRole("button", { name: "Add a variable" }).click();
    await panel(page).getByLabel(`Key of variable ${number + 1}`).selectOption(key);
  }
  await panel(page).getByLabel("Smallest value of variable 1").fill("1.5");
  await panel(page).getByLabel("Smallest value of variable 1").press("Enter");
  await panel(page).getByText("the smaller bound must come first").waitFor();
  await panel(page).getByLabel("Smallest value of variable 1").fill("0.7");
  await panel(page).getByLabel("Largest value of variable 1").fill("0.95");
  await panel(page).getByLabel("Largest value of variable 1").press("Enter");
  await fitted(page, "2 variables");
  await panel(page).getByText("The data cannot tell apart: ").waitFor();
  const cells = await panel(page).locator('[data-key="display.pixel.fill_factor"] td').allInnerTexts();
  assert.deepEqual(cells.slice(1), ["not determined", "–", "–", "–"]);

  // The variables belong to the scenario if they are added to it.
  await panel(page).getByRole("button", { name: "Replace the scenario's fit" }).click();
  await panel(page).getByText("The fit of the scenario, [fit].").waitFor();
  await settled(page);
  const text = await saved(page);
  assert.match(text, /starts = 4/);
  assert.match(text, /key = "display\.pixel\.film\.1\.thickness_nm"/);
  assert.doesNotMatch(text, /gap_nm\.red/);
  assert.deepEqual(on.complaints.splice(0), []);
});

test("fit without a measurement, with a wrong one and for many minutes", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await tool(page, "fit");
  await panel(page).getByRole("button", { name: "Add a variable" }).click();
  assert.ok(await panel(page).getByRole("button", { name: "Fit 1 variable" }).isDisabled());
  await panel(page)
    .locator("input[type=file]")
    .setInputFiles({ name: "grey.csv", mimeType: "text/csv", buffer: Buffer.from("state,X,Y,Z\ngrey,0.2,0.2,0.2\n") });
  await panel(page).getByLabel("grey.csv").waitFor();
  await panel(page).getByRole("button", { name: "Fit 1 variable" }).click();
  await panel(page).locator(".measured-file .error", { hasText: "no such state: grey" }).waitFor();
  await panel(page).locator(".error", { hasText: "no such state: grey" }).nth(1).waitFor({ timeout: 60_000 });

  await opened(page);
  await panel(page).getByRole("button", { name: "Back to the scenario's fit" }).click();
  await page.getByRole("button", { name: "TOML" }).click();
  const source = page.locator("textarea").first();
  await source.fill((await source.inputValue()).replace("starts = 4", "starts = 1000"));
  await settled(page);
  await panel(page).getByLabel("grey.csv").uncheck();
  await panel(page).getByRole("button", { name: "Fit 8 variables" }).click();
  await panel(page).getByRole("button", { name: "Cancel" }).click();
  await panel(page).locator('[data-phase="cancelled"]').waitFor();
  onlyRefusals();
});
