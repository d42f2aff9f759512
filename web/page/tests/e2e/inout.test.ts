// Save and open, links, undo, reloads, exports.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { unpacked } from "../../src/state/link.ts";
import { changed, choose, commandLine, downloaded, drag, figure, itemsOf, saved, settled, stage, type Stage, tool, type } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const GAMUT = "Gamut % sRGB";

test("saved and reopened scenario is equal to the byte", async () => {
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

test("link contains the whole scenario", async () => {
  const page = await on.visit(CLIPBOARD);
  const first = await figure(page, GAMUT);
  await type(page, "display.diffuser.haze", "0.44");
  const then = await changed(page, GAMUT, first);
  const other = await on.visit({}, new URL(await copied(page)).hash);
  await settled(other);
  assert.equal(await figure(other, GAMUT), then);
  assert.equal(await saved(other), await saved(page));
  assert.equal(new URL(page.url()).hash, "", "the address does not change if the link is in the clipboard");
});

const CLIPBOARD = { permissions: ["clipboard-read", "clipboard-write"] };

/** Clicks Link and returns the link from the clipboard. */
async function copied(page: Page): Promise<string> {
  await tool(page, "export");
  await page.getByRole("button", { name: "Copy the link" }).click();
  await page.getByText("The link is copied").waitFor();
  return page.evaluate(() => navigator.clipboard.readText());
}

test("change after a link survives a reload, and undo restores the design before the link", async () => {
  const page = await on.visit();
  await type(page, "display.diffuser.haze", "0.7");
  await page.evaluate('Object.defineProperty(navigator, "clipboard", { value: undefined })');
  await tool(page, "export");
  await page.getByRole("button", { name: "Copy the link" }).click();
  await page.waitForFunction(() => location.hash.startsWith("#s="));
  const { hash } = new URL(page.url());
  // A reload keeps the link and adds no undo step.
  await page.reload();
  await page.locator(".bench").waitFor();
  assert.equal(new URL(page.url()).hash, hash);
  await type(page, "display.diffuser.haze", "0.55");
  await page.waitForFunction(() => location.hash === "");
  await page.reload();
  await page.locator(".bench").waitFor();
  assert.match(await saved(page), /haze = 0\.55/);
  await page.getByRole("button", { name: "Undo" }).click();
  assert.match(await saved(page), /haze = 0\.7\b/);

  // The same link is opened over another design.
  await type(page, "display.diffuser.haze", "0.6");
  await settled(page);
  await page.goto("about:blank");
  await page.goto(on.url + hash);
  await page.getByText("Undo restores").waitFor();
  assert.match(await saved(page), /haze = 0\.7\b/);
  await page.getByRole("button", { name: "Undo" }).click();
  assert.match(await saved(page), /haze = 0\.6\b/);
});

/** Saves a file of the step Share. */
async function exported(page: Page, what: string) {
  await tool(page, "export");
  return downloaded(page, () => page.locator(`[data-export="${what}"]`).click());
}

/** Delays live results. */
async function slow(page: Page, ms: number): Promise<void> {
  await page.route("**/api/v1/live", async (route) => {
    await new Promise((resolve) => setTimeout(resolve, ms));
    await route.continue();
  });
}

test("Save, link, export, versions and Monte Carlo include a pending change", async () => {
  const page = await on.visit(CLIPBOARD);
  await slow(page, 700);
  const haze = (value: string) => type(page, "display.diffuser.haze", value);
  await haze("0.51");
  assert.match(await saved(page), /haze = 0\.51\b/);
  await haze("0.52");
  assert.match((await unpacked(new URL(await copied(page)).hash)) ?? "", /haze = 0\.52\b/);
  await haze("0.53");
  const result = (await exported(page, "result.json")).text;
  assert.equal(
    (JSON.parse(result) as { scenario: { display: { diffuser: { haze: number } } } }).scenario.display.diffuser.haze,
    0.53,
  );
  await haze("0.54");
  await page.getByRole("button", { name: "Keep this version" }).click();
  await page.getByRole("button", { name: "Stop comparing" }).waitFor();
  const kept = await page.evaluate(() => JSON.parse(sessionStorage.getItem("papilio.tab")!) as { pinned: string });
  assert.match(kept.pinned, /haze = 0\.54\b/);
  await haze("0.55");
  const asked = page.waitForRequest("**/api/v1/walk");
  await tool(page, "walk");
  await page.getByRole("button", { name: "Run Monte Carlo" }).click();
  assert.match((await asked).postData() ?? "", /haze = 0\.55\b/);
  await page.getByRole("button", { name: "Cancel" }).click();
});

test("Save, link, export, versions and Monte Carlo after a refused value show a message and do nothing", async () => {
  const page = await on.visit(CLIPBOARD);
  await type(page, "display.diffuser.haze", "7");
  await page.locator(".field .error").waitFor();
  let taken = 0;
  page.on("download", () => (taken += 1));
  page.on("request", (request) => /export|walk/.test(request.url()) && (taken += 1));
  for (const [button, done] of [
    ["Save", "saved"],
    ["Copy the link", "linked"],
    ["Keep this version", "kept"],
    ["Run Monte Carlo", "run"],
  ] as const) {
    if (done === "linked") await tool(page, "export");
    if (done === "run") await tool(page, "walk");
    await page.getByRole("button", { name: button, exact: true }).click();
    await page.locator(".said", { hasText: `Not ${done}` }).waitFor();
  }
  await tool(page, "export");
  await page.locator('[data-export="report.html"]').click();
  const said = page.locator(".said", { hasText: "Not exported" });
  await said.waitFor();
  assert.match(
    await said.innerText(),
    /haze = 7 was refused[\s\S]*out of range[\s\S]*has display\.diffuser\.haze = 0\.78/,
  );
  assert.equal(taken, 0);
  await page.getByRole("button", { name: "Discard" }).click();
  assert.match(await saved(page), /haze = 0\.78/);
  const refusals = on.complaints.splice(0);
  assert.ok(
    refusals.every((words) => /status of 422/.test(words)),
    refusals.join(),
  );
});

test("typed text includes a pending change, and is restored by redo after it was discarded", async () => {
  const page = await on.visit();
  await slow(page, 700);
  await type(page, "display.diffuser.haze", "0.66");
  await page.getByRole("button", { name: "TOML" }).click();
  const source = page.locator("#source");
  await page.waitForFunction(() => /haze = 0\.66/.test(document.querySelector<HTMLTextAreaElement>("#source")!.value));
  await source.fill(`# mine\n${await source.inputValue()}`);
  assert.match(await saved(page), /^# mine\n[\s\S]*haze = 0\.66/);
  await source.fill("broken =");
  await page.locator("#source-errors .error").first().waitFor();
  await page.getByRole("button", { name: "Drawing" }).click();
  await page.getByRole("button", { name: "Discard" }).click();
  assert.match(await saved(page), /^# mine\n/);
  await page.getByRole("button", { name: "Redo" }).click();
  await page.getByRole("button", { name: "TOML" }).click();
  await page.waitForFunction(() => document.querySelector<HTMLTextAreaElement>("#source")?.value === "broken =");
  await page.locator("#source-errors .error").first().waitFor();
  const refusals = on.complaints.splice(0);
  assert.ok(
    refusals.every((words) => /status of 422/.test(words)),
    refusals.join(),
  );
});

test("undo and redo survive a reload", async () => {
  const page = await on.visit();
  await type(page, "display.diffuser.haze", "0.61");
  await settled(page);
  await type(page, "display.diffuser.total_transmittance", "0.8");
  await settled(page);
  await page.getByRole("button", { name: "Undo" }).click();
  await settled(page);
  await page.reload();
  await page.locator(".bench").waitFor();
  assert.match(await saved(page), /haze = 0\.61/);
  await page.getByRole("button", { name: "Undo" }).click();
  assert.match(await saved(page), /haze = 0\.78/);
  await page.getByRole("button", { name: "Redo" }).click();
  await page.getByRole("button", { name: "Redo" }).click();
  assert.match(await saved(page), /total_transmittance = 0\.8\b/);
  assert.ok(await page.getByRole("button", { name: "Redo" }).isDisabled());
});

test("two tabs keep two designs, and the design of a closed tab is under Earlier", async () => {
  const one = await on.visit();
  const two = await one.context().newPage();
  await two.goto(on.url);
  await two.locator(".bench").waitFor();
  await type(one, "display.diffuser.haze", "0.6");
  await settled(one);
  await two.locator(".title").fill("The other one");
  await type(two, "display.diffuser.haze", "0.82");
  await settled(two);
  await one.reload();
  await one.locator(".bench").waitFor();
  assert.match(await saved(one), /haze = 0\.6\b/);
  await two.close();
  await one.getByRole("button", { name: "Earlier" }).click();
  await one.locator(".menu [data-item]", { hasText: "The other one" }).click();
  await one.getByText("is open again").waitFor();
  assert.match(await saved(one), /haze = 0\.82/);
  await one.getByRole("button", { name: "Undo" }).click();
  await settled(one);
  assert.doesNotMatch(await saved(one), /haze = 0\.82/);
  // Undo made this a separate design; the other one is an earlier design now.
  await one.reload();
  await one.locator(".bench").waitFor();
  assert.equal((await itemsOf(one, "Earlier")).length, 1);
  assert.deepEqual(on.complaints, []);
});

test("drag is one step of undo and redo", async () => {
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

test("design survives a reload and a kill of the server", async () => {
  const page = await on.visit();
  const first = await figure(page, GAMUT);
  await type(page, "display.diffuser.haze", "0.33");
  const then = await changed(page, GAMUT, first);
  await settled(page);
  const scenario = await saved(page);
  await on.restart();
  await page.reload();
  await page.locator(".bench").waitFor();
  assert.equal(await figure(page, GAMUT), then);
  assert.equal(await saved(page), scenario);
});

test("exports equal those of the command line", async () => {
  const page = await on.visit();
  const scenario = await saved(page);
  const take = (what: string) => exported(page, what);
  const result = JSON.parse((await take("result.json")).text) as { views: unknown };
  assert.deepEqual(result.views, commandLine(scenario).views);
  assert.match((await take("states.csv")).text, /^theta_deg,phi_deg,state,/);
  assert.match((await take("spectra.csv")).text, /^theta_deg,phi_deg,state,wavelength_nm,/);
  assert.match((await take("overview.svg")).text, /^<svg /);
  assert.equal((await take("overview.png")).bytes.subarray(1, 4).toString(), "PNG");
  const report = (await take("report.html")).text;
  assert.match(report, /<html/);
  assert.doesNotMatch(report, /(src|href)="https?:/, "the report refers to no other host");
  // A program without the feature "png" answers 501, and the browser draws the picture.
  on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((words) => !/status of 501/.test(words)));
});

test("adding, moving and removing layers changes the text", async () => {
  const page = await on.visit();
  await page.locator('[data-part="display.front.0"]').click();
  await choose(page, "Add layer", "component");
  await page.locator('[data-part="display.front.1"]').waitFor();
  await page.locator('[data-part="display.glass"]').click();
  await choose(page, "Add layer", "coating");
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

test("old name of a key is read, with a note of its present name", async () => {
  const page = await on.visit();
  const scenario = await saved(page);
  await page.getByRole("button", { name: "TOML" }).click();
  await page.locator("#source").fill(scenario.replace("haze = 0.78", "haze = 0.78\nstraight_through = 0.02"));
  await page.locator(".notes", { hasText: /straight_through.*regular_fraction/ }).waitFor({ timeout: 30_000 });
  assert.equal(await page.locator(".problems, .refusal").count(), 0);
  assert.deepEqual(on.complaints, []);
});
