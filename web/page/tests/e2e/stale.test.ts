// Nothing that belongs to a design before is shown as the current one: with slow answers of the server, all of it is marked.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { changed, choose, downloaded, example, figure, stage, type Stage, tool, type } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const HAZE = "display.diffuser.haze";
const WHITE = "White % Y";

/** Makes answers slow, ms by the end of their path; the others stay as quick as they are. */
async function slow(page: Page, delays: Readonly<Record<string, number>>): Promise<void> {
  // The compiler of the tests wraps functions in calls of this name.
  await page.evaluate("globalThis.__name = (of) => of");
  await page.unrouteAll();
  for (const [path, delay] of Object.entries(delays))
    await page.route(`**/api/v1/${path}`, async (route) => {
      await new Promise((resolve) => setTimeout(resolve, delay));
      await route.continue().catch(() => undefined);
    });
}

/** The ages of all contents, and whether they are drawn faded. */
const ages = (page: Page): Promise<Record<string, string>> =>
  page.evaluate(() => {
    const faded = (at: string) => document.querySelector(at)?.matches(".faded, .faded *, :has(> .faded)") ?? null;
    const age = (at: string) => (document.querySelector(at) as HTMLElement | null)?.dataset["age"] ?? "none";
    return {
      numbers: `${age(".seen-from .age-mark")} ${faded(".summary")}`,
      patches: `${age(".seen-from .age-mark")} ${faded(".patches")}`,
      chromaticity: `${age(".chromaticity .age-mark")} ${faded(".chromaticity")}`,
      spectra: `${age(".spectra .age-mark")} ${faded(".spectra")}`,
      notes: `${age(".notes .age-mark")} ${faded(".notes")}`,
      tab: `${age("#tab-panel .age-mark")} ${document.querySelector("#tab-panel .faded") !== null}`,
    };
  });

/** Waits until nothing on the page is marked. */
const allCurrent = (page: Page): Promise<unknown> =>
  page.waitForFunction(
    () => [...document.querySelectorAll(".age-mark")].every((mark) => mark.textContent === ""),
    undefined,
    { timeout: 60_000 },
  );

test("every number, plot and table is marked until the answer to a change is there", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  let haze = 0.6;
  for (const tab of ["states", "angles", "cone", "energy", "reading"]) {
    await slow(page, {});
    await tool(page, tab);
    await page.locator("#tab-panel :is(table, .u-over, img.drawn)").first().waitFor({ timeout: 60_000 });
    await allCurrent(page);
    await slow(page, { live: 1500, angles: 1500, cone: 1500 });
    const before = await figure(page, WHITE);
    await type(page, HAZE, String((haze += 0.02)));
    const while_ = await ages(page);
    for (const [what, age] of Object.entries(while_)) assert.equal(age, "before true", `${what} in tab ${tab}`);
    assert.equal(await figure(page, WHITE), before);
    assert.match(await page.locator("#tab-panel .age-mark").innerText(), /of the design before; computing/);
    await changed(page, WHITE, before);
    // The answers of the tab come later than those of the numbers.
    if (tab === "angles" || tab === "cone") assert.equal((await ages(page))["tab"], "before true", tab);
    await allCurrent(page);
  }
  // What is saved while the answer is on its way is that of the new design.
  await slow(page, { live: 1000 });
  await tool(page, "energy");
  const old = await page.locator(".ledger tbody td").nth(1).innerText();
  await type(page, HAZE, "0.3");
  const { text } = await downloaded(page, () => choose(page, "Download energy-balance", "csv"));
  await allCurrent(page);
  const now = await page.locator(".ledger tbody td").nth(1).innerText();
  const [head, first] = text.split("\n").map((line) => line.split(","));
  const saved = 100 * Number(first![head!.indexOf("returned")]);
  assert.notEqual(now, old);
  assert.ok(Math.abs(saved - Number.parseFloat(now)) < 0.006, `${saved}: ${now}`);
  assert.deepEqual(on.complaints.splice(0), []);
});

test("picture of the design before is marked until its own is there", { timeout: 120_000 }, async () => {
  const page = await on.visit({}, "?");
  const caption = page.locator(".seen-display figcaption");
  await caption.getByText("prepared for this light and view").waitFor({ timeout: 30_000 });
  await slow(page, { image: 3000 });
  await example(page, "six-ink");
  await page.waitForFunction(
    () => document.querySelector<HTMLInputElement>("input.title")?.value === "Six-ink electronic paper",
  );
  // The numbers are those of the new design already.
  await page.waitForFunction(() => document.querySelector(".seen-from .age-mark")?.textContent === "");
  const display = page.locator(".seen-display");
  assert.equal(await display.getAttribute("data-age"), "before");
  assert.match((await display.getAttribute("class")) ?? "", /faded/);
  assert.match(await caption.innerText(), /of the design before; computing/);
  assert.doesNotMatch(await caption.innerText(), /prepared for/);
  assert.match(await page.locator(".seen .remark").first().innerText(), /of the design before/);
  await caption.getByText("prepared for this light and view").waitFor({ timeout: 60_000 });
  assert.equal(await display.getAttribute("data-age"), "current");
  // Another halftone of the same design.
  await page.getByLabel("Halftone").selectOption("ordered");
  assert.equal(await display.getAttribute("data-age"), "settings");
  await caption.getByText("prepared for this light and view").waitFor({ timeout: 60_000 });
  assert.deepEqual(on.complaints.splice(0), []);
});

test("view that is not computed yet has no numbers of another view", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  await example(page, "hazy-face");
  await page.locator("#view").waitFor({ timeout: 60_000 });
  await allCurrent(page);
  await slow(page, { live: 1500 });
  await page.locator('[data-part="display.pixel.film.0"]').click();
  await type(page, "display.pixel.film.0.thickness_nm", "56.5");
  await page.locator("#view").selectOption("1");
  assert.match((await ages(page))["numbers"]!, /^(before|settings) true$/);
  await allCurrent(page);
  assert.deepEqual(on.complaints.splice(0), []);
});

test("surface that is refused has no fields and numbers of the surface before", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  const panel = page.locator("#tab-panel");
  await tool(page, "surface");
  await panel.getByText(/a preview, 20 \d{3} for each inclination/).waitFor({ timeout: 120_000 });
  // A change that is refused: the numbers are those of the surface without it, which their mark says.
  await page.locator("#surface-pitch_um").fill("4");
  await panel.locator('[data-path="microgeometry.pitch_um"] .error').waitFor();
  assert.equal(await panel.locator(".age-mark").innerText(), "of the last valid surface");
  await panel.getByRole("button", { name: "Discard the change" }).click();
  await allCurrent(page);
  // A surface that cannot be read.
  await panel.getByText("Text (TOML)").click();
  await panel.getByLabel("Text of the surface").fill('[microgeometry]\nsurface = "hemispheres"\npitch_um = "wide"\n');
  await panel.getByLabel("Text of the surface").blur();
  await panel.locator(".refusal").waitFor();
  assert.equal(await page.locator("#surface-pitch_um").count(), 0, "fields of the surface before");
  assert.equal(await panel.locator("table.numbers").count(), 0, "numbers of the surface before");
  assert.match(await panel.locator(".refusal").innerText(), /cannot be measured/);
  // Another surface, while its measurement is on its way.
  await choose(page, "Example surfaces", "hemispheres");
  await allCurrent(page);
  await slow(page, { gonio: 1500 });
  await choose(page, "Example surfaces", "etched");
  await panel.locator(".surface-name", { hasText: "etched.toml" }).waitFor();
  assert.equal(await panel.locator(".age-mark").innerText(), "of the surface before; computing…");
  assert.equal(await page.locator("#surface-pitch_um").count(), 0, "fields of the surface before");
  await slow(page, {});
  assert.deepEqual(
    on.complaints.splice(0).filter((words) => !/status of 4/.test(words)),
    [],
  );
});
