// The six steps: gallery and new displays, the stage, chosen numbers, versions, searches, tolerances, the pixel, published samples, commands.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { changed, downloaded, example, figure, PAPILIO, ROOT, saved, settled, stage, tool, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const GAMUT = "Gamut % sRGB";

/** Runs a command of the program on a scenario; returns the folder of its files. */
function run(command: string, scenario: string, more: readonly string[]): string {
  const folder = mkdtempSync(join(tmpdir(), "papilio-"));
  const file = join(folder, "scenario.toml");
  writeFileSync(file, scenario);
  execFileSync(PAPILIO, [command, file, "--out", join(folder, "out"), "-q", ...more], { stdio: ["ignore", "ignore", "ignore"] });
  return join(folder, "out");
}

/** Types words into the open list of metrics, and takes one. */
async function pick(page: Page, words: string, metric: string): Promise<void> {
  await page.getByRole("combobox", { name: /search by words/ }).fill(words);
  await page.locator(`[data-metric="${metric}"]`).click();
}

const done = (page: Page) => page.locator('#tab-panel [data-phase="done"]').waitFor({ timeout: 120_000 });

test("steps, gallery and new display lead to the stage", async () => {
  const page = await on.visit();
  await page.getByRole("navigation", { name: "Steps" }).getByRole("button", { name: "Start" }).click();
  await page.getByLabel("Search").fill("six ink paper");
  const found = await page.locator("[data-example]").allInnerTexts();
  assert.ok(found.length >= 1 && found.length < 10, found.join());
  await page.locator('[data-example="six-ink"]').click();
  await page.locator('.middle[data-tool="stage"]').waitFor();
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>(".title")?.value === "Six-ink electronic paper");
  await tool(page, "new");
  await page.locator('[data-kind="bwry"]').click();
  await page.locator('[data-preset="office"]').click();
  await page.locator('.middle[data-tool="stage"]').waitFor();
  await page.locator('.patch[data-state="yellow"]').waitFor({ timeout: 30_000 });
  assert.match(await saved(page), /title = "bwry, office"/);
  assert.deepEqual(on.complaints, []);
});

test("eye and source of the room are handles, and the tilted display moves the eye of the design", async () => {
  const page = await on.visit();
  await tool(page, "stage");
  const first = await figure(page, GAMUT);
  await page.locator('[data-stage-handle="lighting.directed.0.theta_deg"]').focus();
  await page.keyboard.press("Shift+ArrowLeft");
  const moved = await changed(page, GAMUT, first);
  await page.locator('[data-stage-handle="viewer.theta_deg"]').focus();
  await page.keyboard.press("Shift+ArrowRight");
  await changed(page, GAMUT, moved);
  await page.locator(".seen-display canvas").focus();
  await page.keyboard.press("ArrowRight");
  await page.locator(".views", { hasText: "seen from 14°" }).waitFor();
  await settled(page);
  const scenario = await saved(page);
  assert.match(scenario, /theta_deg = -25/);
  assert.match(scenario, /theta_deg = 14/);
  // Several views: tilting shows another one, which can become the only one.
  await page.getByRole("button", { name: "TOML" }).click();
  await page.locator("#source").fill(scenario.replace(/(\[viewer\][^[]*?)theta_deg = 14/, "$1theta_deg = [0, 8, 30]"));
  await page.getByText("The design has several views").waitFor();
  await page.locator(".seen-display canvas").focus();
  await page.keyboard.press("ArrowRight");
  await page.getByRole("button", { name: /its only view/ }).click();
  await page.getByText("The design has several views").waitFor({ state: "detached" });
  assert.deepEqual(on.complaints, []);
});

test("numbers are found by words, have targets, and become constraints; borders are kept", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "Add a number" }).click();
  await pick(page, "red l*", "red.L_star");
  await page.locator('[data-figure="red.L_star"]').waitFor();
  const contrast = page.locator('[data-figure="Contrast : 1"]');
  await contrast.getByRole("button", { name: "Contrast" }).click();
  await contrast.getByLabel("Target of Contrast", { exact: true }).fill("30");
  await contrast.getByRole("button", { name: "Set", exact: true }).click();
  await contrast.getByText("✗ at least 30").waitFor();
  await tool(page, "optimize");
  await page.getByRole("button", { name: "Take the targets of the numbers as constraints" }).click();
  assert.equal(await page.getByLabel(/Least value of Contrast ratio/).inputValue(), "30");
  const border = page.getByRole("separator", { name: "Width of the design" });
  await border.focus();
  await page.keyboard.press("ArrowRight");
  const width = await page.locator(".design").evaluate((e) => (e as HTMLElement).offsetWidth);
  await page.reload();
  await page.locator(".bench").waitFor();
  assert.equal(await page.locator(".design").evaluate((e) => (e as HTMLElement).offsetWidth), width);
  await page.locator('[data-figure="red.L_star"]').waitFor();
  await page.locator('[data-figure="Contrast : 1"]', { hasText: "at least 30" }).waitFor();
  assert.deepEqual(on.complaints, []);
});

test("version is kept with its picture, renamed, compared, opened again, and there after a reload", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "Keep this version" }).click();
  const card = page.locator("[data-version]");
  await card.waitFor();
  await type(page, "display.diffuser.haze", "0.6");
  await page.locator('[data-figure="Contrast : 1"] .difference', { hasText: "from 23.65" }).waitFor();
  await card.getByRole("textbox").fill("Before");
  await card.getByRole("textbox").press("Enter");
  await page.reload();
  await page.locator('[data-version="Before"]').waitFor();
  assert.match((await page.locator('[data-version="Before"] img').getAttribute("src"))!, /^data:image\/png;base64,/);
  await page.getByRole("button", { name: "Show Before" }).click();
  await page.locator(".said", { hasText: "“Before” is open" }).waitFor();
  await settled(page);
  assert.match(await saved(page), /haze = 0\.78/);
  await page.getByRole("button", { name: "Remove Before" }).click();
  await page.locator("[data-version]").waitFor({ state: "detached" });
  assert.deepEqual(on.complaints, []);
});

test("search set up by clicks finds a front, a point of which is taken; it equals papilio optimize", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await tool(page, "optimize");
  await page.locator('[data-part="display.pixel.film.1"]').click();
  await page.getByRole("button", { name: /^Vary Thickness/ }).click();
  const gamut = page.locator(`[data-figure="${GAMUT}"]`);
  await gamut.getByRole("button", { name: /Gamut/ }).click();
  await gamut.getByRole("button", { name: "Maximise" }).click();
  await page.getByRole("button", { name: "Add an objective" }).click();
  await pick(page, "white luminance factor", "white.Y");
  await page.getByLabel("starts").fill("1");
  await page.getByLabel("starts").press("Enter");
  await page.getByLabel("designs", { exact: true }).fill("20");
  await page.getByLabel("designs", { exact: true }).press("Enter");
  await page.getByRole("button", { name: "Add to the scenario" }).click();
  await page.getByText("That of the scenario, [optimize].").waitFor();
  await page.getByRole("button", { name: "Search", exact: true }).click();
  await done(page);
  const scenario = await saved(page);
  const [csv] = [
    await downloaded(page, async () => {
      await page.getByRole("button", { name: "Download optimize" }).click();
      await page.locator('.menu [data-item="csv"]').click();
    }),
  ];
  assert.equal(csv.text, readFileSync(join(run("optimize", scenario, ["--no-check"]), "optimize.csv"), "utf8"));
  const points = page.locator("[data-design]");
  assert.ok((await points.count()) >= 2);
  await page.locator('[data-design="1"]').click();
  const thickness = await page.locator('#tab-panel tr[data-key="display.pixel.film.1.thickness_nm"] td').nth(1).innerText();
  await page.getByRole("button", { name: "Take this design" }).click();
  await settled(page);
  const taken = /"Cr:Johnson"[^}]*?thickness_nm = ([\d.]+)/.exec(await saved(page));
  assert.ok(taken && Math.abs(Number(taken[1]) - Number(thickness)) < 1e-4, `${taken?.[1]} ${thickness}`);
  // Another point of the same front can be taken after it; not after another change.
  await page.locator('[data-design="0"]').click();
  await page.getByRole("button", { name: "Take this design" }).click();
  await settled(page);
  assert.notEqual(/"Cr:Johnson"[^}]*?thickness_nm = ([\d.]+)/.exec(await saved(page))?.[1], taken[1]);
  await page.locator('[data-part="display.glass"]').click();
  await type(page, "display.glass.index", "1.52");
  await page.locator('#tab-panel .age-mark[data-age="earlier"]').waitFor();
  assert.ok(await page.getByRole("button", { name: "Take this design" }).isDisabled());
  assert.deepEqual(on.complaints, []);
});

test("search can be cancelled", async () => {
  const page = await on.visit();
  await example(page, "optimize");
  await tool(page, "optimize");
  await page.getByRole("button", { name: "Search", exact: true }).click();
  await page.getByText(/\d+ designs; \d+ of \d+ searches/).waitFor({ timeout: 30_000 });
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.locator('#tab-panel [data-phase="cancelled"]').waitFor();
  assert.deepEqual(on.complaints, []);
});

test("tolerance analysis shows the yield and who is to blame; its table is that of papilio tolerance", { timeout: 180_000 }, async () => {
  const page = await on.visit();
  await example(page, "tolerance");
  await tool(page, "tolerance");
  await page.getByRole("button", { name: "Analyse", exact: true }).click();
  await done(page);
  const yields = await page.locator('[data-figure="yield"]').innerText();
  const folder = run("tolerance", await saved(page), []);
  const report = JSON.parse(readFileSync(join(folder, "tolerance.json"), "utf8")) as { verdict: { yield_share: { value: number } } };
  assert.ok(yields.startsWith((100 * report.verdict.yield_share.value).toFixed(2)), yields);
  await page.locator('#tab-panel tr[data-metric="contrast_ratio"] .words', { hasText: "%" }).waitFor();
  assert.ok((await page.locator("#tab-panel img.drawn").count()) >= 3);
  assert.deepEqual(on.complaints, []);
});

test("pixel alone equals papilio pixel, with the absorptance of its layers", async () => {
  const page = await on.visit();
  await tool(page, "pixel");
  await page.getByLabel("absorptance of each layer").check();
  await page.locator("#tab-panel img.drawn").nth(1).waitFor({ timeout: 30_000 });
  const folder = run("pixel", await saved(page), ["--absorption"]);
  for (const name of ["pixel", "absorption", "sub-pixels"]) {
    const file = await downloaded(page, async () => {
      await page.getByRole("button", { name: `Download ${name}`, exact: true }).first().click();
      await page.locator('.menu [data-item="csv"]').click();
    });
    assert.equal(file.text, readFileSync(join(folder, `${name}.csv`), "utf8"), name);
  }
  assert.deepEqual(on.complaints, []);
});

test("published sample is predicted, and rooms show the page in other light", { timeout: 180_000 }, async () => {
  const page = await on.visit();
  await tool(page, "validate");
  await page.getByRole("button", { name: "Predict ptfe" }).click();
  await page.locator('[data-sample="ptfe"] .agrees').waitFor({ timeout: 60_000 });
  await page.getByRole("img", { name: "ptfe: predicted and measured" }).waitFor();
  await tool(page, "rooms");
  await page.locator('[data-room="sunny"] figcaption', { hasText: /^sunny 100\s000 lx, white Y [\d.]+ %, contrast/ }).waitFor({ timeout: 120_000 });
  await page.locator('[data-room="sunny"]').getByRole("button", { name: "Take this light" }).click();
  await page.getByRole("button", { name: "Light: sunny", exact: true }).waitFor();
  assert.deepEqual(on.complaints, []);
});

test("every tool but those of the page alone shows its command, which the program has", async () => {
  const page = await on.visit();
  await tool(page, "commands");
  const lines = await page.locator(".commands code").allInnerTexts();
  const known = execFileSync(PAPILIO, ["--help"], { encoding: "utf8" });
  assert.ok(lines.length >= 12);
  for (const line of lines) assert.match(known, new RegExp(`^  ${line.split(" ")[1]} `, "m"), line);
  await tool(page, "sweep");
  assert.match(await page.locator(".tool-command code").innerText(), /^papilio sweep [\w-]+\.toml$/);
  const missing = page.locator(".tool-command", { hasText: "reads [sweep] of the scenario" });
  await missing.waitFor();
  await page.getByRole("button", { name: "Add to the scenario" }).click();
  await missing.waitFor({ state: "detached" });
});

test("commands have what is chosen in their tools, and run", { timeout: 180_000 }, async () => {
  const page = await on.visit();
  const folder = mkdtempSync(join(tmpdir(), "papilio-"));
  writeFileSync(join(folder, "indoor-reading.toml"), await saved(page));
  copyFileSync(join(ROOT, "scenarios/data/chelsea.png"), join(folder, "my picture.png"));
  /** Runs the command of the open tool. */
  const runs = async (id: string, pattern: RegExp): Promise<void> => {
    const line = await page.locator(".tool-command code").first().innerText();
    assert.match(line, pattern, id);
    const here = line.replace("PRESET", "office").replace("PICTURE.png", "'my picture.png'").replace(/^papilio/, '"$PAPILIO"');
    execFileSync("bash", ["-c", `${here} -q`], { cwd: folder, env: { ...process.env, PAPILIO }, stdio: ["ignore", "ignore", "inherit"] });
  };
  await tool(page, "new");
  await page.locator('[data-kind="epaper"]').click();
  await runs("new", /^papilio new --display epaper --light PRESET epaper\.toml$/);
  assert.ok(existsSync(join(folder, "epaper.toml")));
  await tool(page, "rooms");
  for (const room of await page.locator(".room-choice label").all())
    await room.getByRole("checkbox").setChecked(/^(sunny|office)$/.test((await room.innerText()).trim()));
  await runs("rooms", /^papilio image indoor-reading\.toml PICTURE\.png --rooms (office,sunny|sunny,office)$/);
  await tool(page, "angles");
  await page.locator("#angle-phi").fill("30");
  await runs("angles", /^papilio run indoor-reading\.toml --set 'viewer\.theta_deg=\{from=-80,to=80,step=2\}' --set viewer\.phi_deg=30$/);
  await tool(page, "detail");
  await page.getByLabel("Effect").selectOption("gloss");
  await runs("detail", /^papilio gloss indoor-reading\.toml$/);
  await tool(page, "pixel");
  await page.getByLabel("Angles in").selectOption("glass");
  await page.getByLabel("absorptance of each layer").check();
  await runs("pixel", /^papilio pixel indoor-reading\.toml --angles glass --absorption$/);
  await tool(page, "walk");
  await page.getByLabel("until the relative error is").selectOption("0.01");
  await runs("walk", /^papilio run indoor-reading\.toml --solver monte-carlo --set solver\.relative_error=0\.01$/);
  await tool(page, "image");
  await page.locator("input[type=file]").first().setInputFiles(join(folder, "my picture.png"));
  await page.getByLabel("Halftone").selectOption("error-diffusion");
  await page.locator(".tool-command code", { hasText: "my picture" }).waitFor();
  await runs("image", /^papilio image indoor-reading\.toml 'my picture\.png' --set 'image\.halftone="error-diffusion"'$/);
  await tool(page, "commands");
  const lines = await page.locator(".commands code").allInnerTexts();
  assert.ok(lines.includes("papilio pixel indoor-reading.toml --angles glass --absorption"));
  assert.deepEqual(on.complaints, []);
});

test("versions are side by side: pictures, differences coloured by targets, spectra; the choice is there after a reload", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  const first = await figure(page, "Contrast : 1");
  await page.getByRole("button", { name: "Keep this version" }).click();
  await page.locator("[data-version]").waitFor();
  await type(page, "display.diffuser.haze", "0.5");
  const second = await changed(page, "Contrast : 1", first);
  await page.getByRole("button", { name: "Keep this version" }).click();
  await page.locator("[data-version]").nth(1).waitFor();
  for (const one of await page.getByRole("textbox", { name: /^Name of the version/ }).all()) {
    await one.fill((await one.inputValue()).endsWith(" 2") ? "Hazy" : "First");
    await one.press("Enter");
  }
  await page.getByRole("button", { name: "Side by side" }).first().click();
  const cell = (metric: string, column: number) => page.locator(`[data-row="${metric}"] td`).nth(column);
  await page.locator('[data-column="First"][aria-busy="false"]').waitFor({ timeout: 30_000 });
  await page.locator('[data-column="Hazy"][aria-busy="false"]').waitFor({ timeout: 30_000 });
  // Columns: the current design, which is the newest version, the newest, the oldest.
  assert.match(await cell("Contrast : 1", 0).innerText(), new RegExp(`^${second.replace(".", "\\.")}`));
  assert.equal((await cell("Contrast : 1", 2).innerText()).trim(), first);
  const difference = (Number(second) - Number(first)).toFixed(2).replace("-", "−").replace(/^(\d)/, "+$1");
  assert.match(await cell("Contrast : 1", 1).innerText(), new RegExp(`\\${difference}$`));
  assert.equal(await cell("Contrast : 1", 1).locator(".agrees, .disagrees").count(), 0);
  // A target tells which difference is better, and which design meets it.
  const contrast = page.locator('[data-figure="Contrast : 1"]');
  await contrast.getByRole("button", { name: "Contrast" }).click();
  await contrast.getByLabel("Kind of target of Contrast").selectOption("at_most");
  await contrast.getByLabel("Target of Contrast", { exact: true }).fill(String((Number(first) + Number(second)) / 2));
  await contrast.getByRole("button", { name: "Set", exact: true }).click();
  await cell("Contrast : 1", 1).locator(Number(second) < Number(first) ? "small.agrees" : "small.disagrees").waitFor();
  // ΔE of white from the oldest version is that of the numbers of both.
  assert.match(await cell("ΔE00 white", 2).innerText(), /–/);
  assert.ok(Number(await cell("ΔE00 white", 1).innerText()) > 0);
  assert.equal(await cell("ΔE00 white", 0).innerText(), await cell("ΔE00 white", 1).innerText());
  await page.getByRole("checkbox", { name: "Hazy" }).uncheck();
  await page.locator('[data-column="Hazy"]').waitFor({ state: "detached" });
  await page.getByRole("radio", { name: /Differences from Indoor/ }).check();
  await page.reload();
  await page.locator(".bench").waitFor();
  await tool(page, "side");
  await page.locator('[data-column="First"][aria-busy="false"]').waitFor({ timeout: 30_000 });
  assert.equal(await page.locator("[data-column]").count(), 2);
  assert.equal(await page.getByRole("radio", { name: /Differences from Indoor/ }).isChecked(), true);
  assert.ok(await page.locator('[data-column="First"] canvas').evaluate((e) => {
    const { data } = (e as HTMLCanvasElement).getContext("2d")!.getImageData(0, 0, 400, 300);
    return new Set(data).size > 20;
  }));
  assert.deepEqual(on.complaints, []);
});
