// Jobs: they equal the command line, go on when the page is closed, survive a kill of the server by their journals, and are cancelled.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { unzipSync } from "fflate";
import type { Page } from "playwright-core";

import { downloaded, example, PAPILIO, ROOT, saved, settled, stage, tool, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const H65 = join(ROOT, "scenarios/data/H65.bsdf");

const ended = (page: Page, command: string, timeout = 120_000) =>
  page.locator(`[data-job="${command}"][data-phase="done"]`).first().waitFor({ timeout });

/** Opens the results of the newest job of a command. */
const openJob = (page: Page, command: string) => page.locator(`[data-job="${command}"] .fold`).first().click();

const option = (page: Page, name: string) =>
  page.locator(".job-form label", { has: page.locator("code").getByText(name, { exact: true }) });

test("BRDF equals papilio brdf, and goes on while no page is open", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  const scenario = await saved(page);
  await tool(page, "brdf");
  await option(page, "--format").locator("select").selectOption("csv");
  await option(page, "--states").locator("input").fill("white");
  await option(page, "--step").locator("input").fill("30");
  assert.match(await page.locator(".job-form code").last().innerText(), /^papilio brdf [\w-]+\.toml --format=csv --states=white --step=30$/);
  await page.getByRole("button", { name: "Start the job" }).click();
  await page.locator('[data-job="brdf"]').waitFor();
  await page.getByRole("button", { name: "1 job" }).waitFor();
  await page.close();
  const again = await on.visit();
  await tool(again, "jobs");
  await ended(again, "brdf");
  await openJob(again, "brdf");
  const folder = mkdtempSync(join(tmpdir(), "papilio-"));
  writeFileSync(join(folder, "s.toml"), scenario);
  execFileSync(PAPILIO, ["brdf", join(folder, "s.toml"), "--out", join(folder, "out"), "--format=csv", "--states=white", "--step=30"], { stdio: "ignore" });
  const zip = await downloaded(again, () => again.getByRole("button", { name: "Save all files (zip)" }).click());
  const files = unzipSync(zip.bytes);
  for (const name of ["display-white.csv", "reflection.csv"])
    assert.deepEqual(Buffer.from(files[name]!), readFileSync(join(folder, "out", name)), name);
  await again.getByRole("button", { name: /^Remove papilio brdf/ }).click();
  await again.locator('[data-job="brdf"]').waitFor({ state: "detached" });
  assert.deepEqual(on.complaints, []);
});

test("sweep as a job survives a kill of the server by its journal", { timeout: 300_000 }, async () => {
  const page = await on.visit();
  // Enough points that the server is killed among them.
  const axes = '\n[sweep]\nfigures = ["white.Y"]\n\n[[sweep.axes]]\ndisplay.pixel.film.1.thickness_nm = { from = 5, to = 25, step = 0.01 }\n';
  const scenario = (await saved(page)) + axes;
  await page.locator("input[type=file]").first().setInputFiles({ name: "long.toml", mimeType: "", buffer: Buffer.from(scenario) });
  await settled(page);
  await tool(page, "sweep");
  await page.getByRole("button", { name: "Run as a job" }).click();
  await tool(page, "jobs");
  await page.waitForFunction(() => /[1-9]\d* of 2001 points/.test(document.querySelector('[data-job="sweep"]')?.textContent ?? ""), undefined, { timeout: 60_000 });
  assert.equal(await page.locator('[data-job="sweep"]').first().getAttribute("data-phase"), "running");
  await on.restart();
  await ended(page, "sweep", 240_000);
  await openJob(page, "sweep");
  const [, computed] = /2001 points, (\d+) computed/.exec(await page.locator(".job-results").innerText())!;
  assert.ok(Number(computed) > 0 && Number(computed) < 2001, computed);
  const csv = await downloaded(page, () => page.getByRole("button", { name: "Save sweep.csv" }).click());
  const folder = mkdtempSync(join(tmpdir(), "papilio-"));
  writeFileSync(join(folder, "s.toml"), await saved(page));
  execFileSync(PAPILIO, ["sweep", join(folder, "s.toml"), "--out", join(folder, "out")], { stdio: "ignore" });
  assert.equal(csv.text, readFileSync(join(folder, "out/sweep.csv"), "utf8"));
  on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((one) => !/ERR_|410/.test(one)));
  assert.deepEqual(on.complaints, []);
});

test("job is cancelled from the list, and a waiting one, too; failures say why", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  await tool(page, "study");
  await option(page, "--paths").locator("input").fill("100000000");
  await page.getByRole("button", { name: "Start the job" }).click();
  await page.locator('[data-job="study sampling"][data-phase="running"]').waitFor({ timeout: 30_000 });
  await page.getByRole("button", { name: "Start the job" }).click();
  const both = page.locator('[data-job="study sampling"]');
  await page.locator('[data-job="study sampling"][data-phase="waiting"]').getByRole("button", { name: "Cancel" }).click();
  await page.locator('[data-job="study sampling"][data-phase="cancelled"]').first().waitFor();
  await page.locator('[data-job="study sampling"][data-phase="running"]').getByRole("button", { name: "Cancel" }).click();
  await page.locator('[data-job="study sampling"][data-phase="running"]').waitFor({ state: "detached", timeout: 30_000 });
  assert.equal(await both.count(), 2);
  await tool(page, "jobs");
  await page.getByLabel("Command", { exact: true }).selectOption("sweep");
  await page.getByRole("button", { name: "Start the job" }).click();
  await page.locator('[data-job="sweep"][data-phase="failed"]').waitFor({ timeout: 30_000 });
  await openJob(page, "sweep");
  await page.locator(".job-results .refused", { hasText: "sweep" }).waitFor();
  // A value that is none is refused before anything starts.
  await page.getByLabel("Command", { exact: true }).selectOption("brdf");
  await option(page, "--step").locator("input").fill("../x");
  await page.getByRole("button", { name: "Start the job" }).click();
  await page.getByText("--step: `../x` is not a value of this option").first().waitFor();
  on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((one) => !/400/.test(one)));
  assert.deepEqual(on.complaints, []);
});

test("measured diffuser is fitted, converted, calibrated; a simulated measurement becomes a file of the design", { timeout: 300_000 }, async () => {
  const page = await on.visit();
  await page.locator("input[type=file]").first().setInputFiles(H65);
  await page.locator(".file .words").waitFor({ timeout: 60_000 });
  await tool(page, "diffuser");
  const command = page.getByLabel("Command", { exact: true });
  await command.selectOption("diffuser fit");
  await option(page, "--model").locator("select").selectOption("k-correlation");
  await page.getByRole("button", { name: "Start the job" }).click();
  await command.selectOption("diffuser convert");
  await option(page, "--format").locator("select").selectOption("csv");
  await page.getByRole("button", { name: "Start the job" }).click();
  await command.selectOption("diffuser calibrate");
  await page.getByLabel("measurement of the white").selectOption("H65.bsdf");
  await page.getByRole("button", { name: "Start the job" }).click();
  await ended(page, "diffuser calibrate");
  await ended(page, "diffuser fit");
  await openJob(page, "diffuser fit");
  await page.locator('[data-job="diffuser fit"] .words', { hasText: "k-correlation" }).first().waitFor();
  await page.locator('[data-job="diffuser fit"] img.drawn').first().waitFor();
  await openJob(page, "diffuser convert");
  const folder = mkdtempSync(join(tmpdir(), "papilio-"));
  execFileSync(PAPILIO, ["diffuser", "convert", H65, join(folder, "H65.csv"), "--format=csv"], { stdio: "ignore" });
  const csv = await downloaded(page, () => page.getByRole("button", { name: "Save H65.csv" }).click());
  assert.equal(csv.text, readFileSync(join(folder, "H65.csv"), "utf8"));
  // A scenario with an instrument: its measurement becomes a file, which the design can use.
  await example(page, "virtual-instrument");
  await settled(page);
  await tool(page, "diffuser");
  await command.selectOption("diffuser measure");
  await page.getByRole("button", { name: "Start the job" }).click();
  await ended(page, "diffuser measure");
  await openJob(page, "diffuser measure");
  await page.locator('[data-job="diffuser measure"]').getByRole("button", { name: "Add to the files" }).click();
  await page.locator(".said", { hasText: "is under Files" }).waitFor({ timeout: 60_000 });
  await command.selectOption("diffuser steps");
  await example(page, "measured-diffused");
  await settled(page);
  await tool(page, "diffuser");
  await command.selectOption("diffuser steps");
  await page.getByRole("button", { name: "Start the job" }).click();
  await ended(page, "diffuser steps", 200_000);
  assert.deepEqual(on.complaints, []);
});

/** Commands that the page offers as jobs beside its own tools, or with more options, and a file that they write; null: it is long. */
const AS_JOBS: readonly (readonly [example: string, command: string, option: readonly [string, string] | null, file: string | null])[] = [
  ["indoor", "pixel", ["--phi", "30"], "pixel.csv"],
  ["matrix", "crosstalk", ["--solver", "monte-carlo"], "crosstalk.csv"],
  ["antiglare", "gloss", null, "gloss.csv"],
  ["etched-grades", "run", null, "states.csv"],
  ["optimize", "optimize", ["--seed", "3"], "best.toml"],
  ["tolerance", "tolerance", null, null],
];

test("commands with their options run as jobs, and write the files of the program", { timeout: 900_000 }, async () => {
  const page = await on.visit();
  for (const [name, command, given, file] of AS_JOBS) {
    await example(page, name);
    await settled(page);
    await tool(page, "jobs");
    await page.getByLabel("Command", { exact: true }).selectOption(command);
    if (given) {
      const field = option(page, given[0]).locator("select, input");
      if ((await field.evaluate((one) => one.tagName)) === "SELECT") await field.selectOption(given[1]);
      else await field.fill(given[1]);
    }
    await page.getByRole("button", { name: "Start the job" }).click();
    await ended(page, command, 200_000);
    if (file === null) continue;
    await openJob(page, command);
    const text = (await downloaded(page, () => page.locator(`[data-job="${command}"]`).first().getByRole("button", { name: `Save ${file}` }).click())).text;
    const folder = mkdtempSync(join(tmpdir(), "papilio-"));
    writeFileSync(join(folder, "s.toml"), await saved(page));
    const more = given ? [given.join("=")] : [];
    execFileSync(PAPILIO, [command, join(folder, "s.toml"), "--out", join(folder, "out"), ...more], { stdio: "ignore", cwd: ROOT });
    assert.equal(text, readFileSync(join(folder, "out", file), "utf8"), command);
  }
  await tool(page, "jobs");
  await page.getByLabel("Command", { exact: true }).selectOption("validate");
  await page.getByRole("button", { name: "Start the job" }).click();
  await ended(page, "validate", 200_000);
  assert.deepEqual(on.complaints, []);
});

/** Options that jobs have not: the page has them elsewhere, or they are for scripts and clusters, or name further files. */
const ELSEWHERE: Readonly<Record<string, readonly string[]>> = {
  // Files, folders, threads and the words on a terminal are those of the server; keys are set in the design; figures are saved as PNG by ⤓.
  "": ["out", "set", "json", "quiet", "threads", "png", "allow-long", "help"],
  sweep: ["axis", "shard"],
  optimize: ["shard", "merge"],
  tolerance: ["shard", "merge"],
  image: ["on", "light", "since"],
  "diffuser inspect": ["transmission"],
  "diffuser steps": ["beside"],
  validate: ["measured"],
};

test("jobs offer every option of their commands, but for those that are elsewhere", async () => {
  const commands = (await (await fetch(`${on.url}api/v1/jobs/commands`)).json()) as { name: string; options: { name: string }[] }[];
  assert.ok(commands.length > 15);
  for (const { name, options } of commands) {
    const help = execFileSync(PAPILIO, [...name.split(" "), "--help"], { encoding: "utf8" });
    const all = [...help.matchAll(/^ +(?:-\w, )?--([\w-]+)/gm)].map(([, option]) => option!);
    const elsewhere = [...ELSEWHERE[""]!, ...(ELSEWHERE[name] ?? [])];
    const offered = options.map((option) => option.name);
    assert.deepEqual([...new Set(all)].filter((one) => !elsewhere.includes(one)).sort(), [...offered].sort(), name);
  }
});
