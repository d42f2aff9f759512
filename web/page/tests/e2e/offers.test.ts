// What the page offers: the file's sweep, a measured panel, buttons for refused changes, downloads, the way back to a
// server that was restarted, phones.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { TOOLS } from "../../src/model/tools.ts";
import { changed, choose, downloaded, example, figure, ROOT, saved, settled, stage, type Stage, tool, type } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const GAMUT = "Gamut % sRGB";
const HAZE = "display.diffuser.haze";
const TRANSMITTANCE = "display.diffuser.total_transmittance";

/** Removes the messages of refused requests, and of a busy server, which is asked again; there must be no others. */
function onlyRefusals(): void {
  const others = on.complaints.splice(0).filter((words) => !/status of 422/.test(words));
  assert.deepEqual(others, []);
}

async function openExample(page: Page, name: string, title: string): Promise<void> {
  await example(page, name);
  await page.waitForFunction((title) => document.querySelector<HTMLInputElement>(".title")?.value === title, title);
}

test("sweep of the file runs as it is, becomes stale, and a point is applied", async () => {
  const page = await on.visit();
  await openExample(page, "sweep", "Haze and the room");
  await tool(page, "sweep");
  assert.equal(await page.getByLabel("Key of axis 1, key 2").inputValue(), "lighting.directed.0.share");
  assert.equal(await page.getByLabel("Values of axis 2").inputValue(), "list");
  await page.getByRole("button", { name: "Sweep 35 points" }).click();
  await page.locator('[data-phase="done"]').waitFor({ timeout: 120_000 });
  const [csv] = await files(page, "Download sweep", ["csv"]);
  const rows = csv!.text.trim().split(/\r?\n/);
  assert.equal(rows.length, 1 + 35 * 8);
  assert.match(rows[0]!, /^point,lighting\.diffuse,lighting\.directed\.0\.share,display\.diffuser\.haze,/);
  const mark = page.locator("#tab-panel .age-mark");
  assert.equal(await mark.getAttribute("data-age"), "current");
  // A click on a cell selects its point; the fourth column is a haze of 0.6, the third row half diffuse light.
  await page.locator('[data-cell="3 2"]').click();
  const line = page.locator(".chosen-point", { hasText: "Selected" });
  const value = /Contrast ratio ([\d.]+)/.exec(await line.innerText())![1]!;
  await line.getByRole("button", { name: "Apply" }).click();
  await page.waitForFunction(
    (value) => Math.abs(Number(document.querySelector('[data-figure="Contrast : 1"] b')?.textContent) - value) < 0.006,
    Number(value),
  );
  assert.match(await saved(page), /haze = 0\.6\b/);
  // The points are of every design that differs in the swept keys alone.
  assert.equal(await mark.getAttribute("data-age"), "current");
  await page.locator('[data-part="display.glass"]').click();
  await type(page, "display.glass.index", "1.52");
  await page.locator('#tab-panel .age-mark[data-age="earlier"]').waitFor();
  assert.deepEqual(on.complaints, []);
});

test("sweep over a list of materials is drawn, and one with two keys per axis is written to the scenario", async () => {
  const page = await on.visit();
  await tool(page, "sweep");
  await page.getByLabel("Key of axis 1").selectOption("display.pixel.film.2.material");
  await page.getByLabel("values", { exact: true }).fill("SiO2, MgF2, Al2O3");
  await page.getByLabel("values", { exact: true }).press("Enter");
  await page.getByRole("button", { name: "Sweep 3 points" }).click();
  await page.locator('[data-phase="done"]').waitFor({ timeout: 60_000 });
  const [svg] = await files(page, "Download sweep", ["svg"]);
  for (const word of ["SiO2", "MgF2", "Al2O3", "(% of sRGB)"]) assert.ok(svg!.text.includes(word), word);
  await page.getByRole("button", { name: "Add a key" }).click();
  await page.getByLabel("Key of axis 1, key 2").selectOption("display.pixel.film.2.thickness_nm");
  await page.getByRole("button", { name: "Add to the scenario" }).click();
  await page.getByText("The sweep of the scenario").waitFor();
  await settled(page);
  const scenario = await saved(page);
  assert.match(scenario, /\[sweep\]|\[\[sweep\.axes\]\]|sweep = /);
  assert.match(scenario, /film\.2\.material"? = \["SiO2", "MgF2", "Al2O3"\]/);
  assert.deepEqual(on.complaints, []);
});

test("measured panel is compared with the design and follows it", async () => {
  const page = await on.visit();
  await openExample(page, "overcast", "Under an overcast sky");
  await page.locator("input[type=file]").first().setInputFiles(join(ROOT, "scenarios/data/synthetic-panel.csv"));
  await page.getByRole("button", { name: "Compare with the design" }).click();
  const row = page.locator(".measured tbody tr").first();
  await row.waitFor({ timeout: 60_000 });
  const first = await row.innerText();
  assert.match(first, /^white\s+0\.\d+ \/ 0\.\d+/);
  assert.ok((await page.locator(".measured img.drawn").count()) >= 2);
  const [csv] = await files(page, "Download comparison", ["csv"]);
  assert.match(csv!.text, /^theta_deg,phi_deg,state,X_simulated,X_measured/);
  await type(page, HAZE, "0.6");
  await page.waitForFunction(
    (first) => (document.querySelector(".measured tbody tr") as HTMLElement | null)?.innerText !== first,
    first,
  );
  // Metrics alone, with z.
  const metrics = "metric,theta_deg,value,standard_deviation\ncontrast_ratio,8,20,1\nwhite.Y,8,0.4,0.01\n";
  await page
    .locator(".measured input[type=file]")
    .setInputFiles({ name: "metrics.csv", mimeType: "text/csv", buffer: Buffer.from(metrics) });
  await page.locator(".measured select").selectOption("metrics.csv");
  const rows = page.getByRole("region", { name: "Metrics, simulated and measured" }).locator("tbody tr");
  await rows.nth(1).waitFor({ timeout: 60_000 });
  assert.match(await rows.first().innerText(), /20\.00 ± 1\.0\s+[+−]?\d+\.\d\d$/);
  await page.getByText("z of 2 numbers with a standard deviation").waitFor();
  assert.deepEqual(on.complaints, []);
});

test("refused change does not move the slider, and a button sets the value that is accepted", async () => {
  const page = await on.visit();
  const slider = page.locator(`.field[data-path="${HAZE}"] input[type=range]`);
  const box = (await slider.boundingBox())!;
  await page.mouse.move(box.x + 0.78 * box.width, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width + 30, box.y + box.height / 2, { steps: 5 });
  await page.locator(".refusal").waitFor();
  assert.deepEqual(await slider.boundingBox(), box, "while the button is down");
  await page.mouse.up();
  await settled(page);
  assert.deepEqual(await slider.boundingBox(), box);
  // A lobe has the haze at the end of the slider: only another key refuses it.
  assert.equal(await page.locator(`[id="f-${HAZE}"]`).inputValue(), "0.99");
  assert.equal(await page.locator(".seen-from .age-mark").innerText(), "of the last valid design");
  await page.getByRole("button", { name: /Set total transmittance.* to 0\.\d+/ }).click();
  await page.locator(".refusal").waitFor({ state: "detached" });
  await settled(page);
  const scenario = await saved(page);
  assert.match(scenario, /haze = 0\.99\b/);
  assert.doesNotMatch(scenario, /total_transmittance = 0\.90/);
  onlyRefusals();
});

test("design that adding refuses is computed with Monte Carlo", { timeout: 180_000 }, async () => {
  const page = await on.visit();
  await example(page, "rough-glass");
  await page.locator('[data-part="display.layers.0"]').waitFor({ timeout: 60_000 });
  await settled(page);
  await page.locator('[data-part="display.layers.0"]').click();
  await type(page, "display.layers.0.alpha", "0.003");
  await page.getByRole("button", { name: "Compute with Monte Carlo" }).first().click({ timeout: 60_000 });
  await page.locator(".trace", { hasText: "monte-carlo" }).waitFor({ timeout: 120_000 });
  assert.match(await saved(page).catch(() => "alpha = 0.003"), /alpha = 0\.003/);
  onlyRefusals();
});

test("page continues by itself when the server is back", async () => {
  const page = await on.visit();
  const first = await figure(page, GAMUT);
  await on.kill();
  await type(page, HAZE, "0.5");
  await page.locator(".offline").waitFor();
  await on.revive();
  await changed(page, GAMUT, first);
  await page.locator(".offline").waitFor({ state: "detached" });
  assert.match(await saved(page), /haze = 0\.5\b/);
  on.complaints.splice(0);
});

test("Ctrl+Z in the box of a number is the undo of the design", async () => {
  const page = await on.visit();
  const first = await figure(page, GAMUT);
  await type(page, HAZE, "0.5");
  await changed(page, GAMUT, first);
  await type(page, TRANSMITTANCE, "0.8");
  await settled(page);
  await page.keyboard.press("Control+z");
  const shows = (path: string, value: string) =>
    page.waitForFunction(([id, value]) => (document.getElementById(id) as HTMLInputElement | null)?.value === value, [
      `f-${path}`,
      value,
    ] as const);
  await shows(TRANSMITTANCE, "0.9");
  await settled(page);
  await page.keyboard.press("Control+z");
  await page.waitForFunction(
    (first) => document.querySelector('[data-figure="Gamut % sRGB"] b')?.textContent === first,
    first,
  );
  // What is no number is reported and never applied.
  for (const [typed, words] of [
    ["", /Empty: the value stays 0\.78/],
    ["0x1F", /0x1F is not a number/],
  ] as const) {
    await type(page, HAZE, typed);
    assert.match(await page.locator(`[data-path="${HAZE}"] .error`).innerText(), words);
    await page.locator(`[id="f-${HAZE}"]`).press("Control+z");
    assert.equal(await page.locator(`[id="f-${HAZE}"]`).inputValue(), "0.78");
  }
  assert.deepEqual(on.complaints, []);
});

test("state under the pointer is highlighted in patches, diagram, legend and table", async () => {
  const page = await on.visit();
  const hovered = () =>
    page.evaluate(() => [
      document.querySelectorAll('.patch.hovered[data-state="green"]').length,
      document.querySelectorAll(".mark-name.hovered").length,
      document.querySelectorAll(".curve-key li.hovered").length,
      document.querySelectorAll('tr.hovered[data-state="green"]').length,
    ]);
  for (const part of [
    '.patch[data-state="green"]',
    '.state-mark[data-state="green"] circle',
    'tr[data-state="green"]',
  ]) {
    await page.locator(part).hover();
    assert.deepEqual(await hovered(), [1, 1, 1, 1], part);
  }
  await page.mouse.move(5, 5);
  assert.deepEqual(await hovered(), [0, 0, 0, 0]);
});

test("errors of the text are marked at their lines, and a button goes there", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "TOML" }).click();
  const source = page.locator("#source");
  const text = await source.inputValue();
  const line = text.slice(0, text.indexOf("haze = ")).split("\n").length;
  await source.fill(text.replace("haze = ", "hase = "));
  await page.locator(".wrong-line").waitFor();
  assert.match(await page.locator(".wrong-line").innerText(), new RegExp(`^${line}\\s*hase`));
  await page.getByRole("button", { name: `Go to line ${line}` }).click();
  const caret = await source.evaluate(
    (e: HTMLTextAreaElement) => e.value.slice(0, e.selectionStart).split("\n").length,
  );
  assert.equal(caret, line);
  onlyRefusals();
});

test("label of the lighting preset says whether it was changed", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "Light: indoor" }).waitFor();
  await choose(page, "Light:", "sunny");
  await page.getByRole("button", { name: "Light: sunny", exact: true }).waitFor();
  await page.locator('[data-handle="lighting.directed.0.theta_deg"]').focus();
  await page.keyboard.press("ArrowLeft");
  await page.getByRole("button", { name: "Light: sunny, changed" }).waitFor();
});

/** Saves items of a download menu. */
async function files(page: Page, menu: string, items: readonly string[]) {
  const all = [];
  for (const item of items)
    all.push(
      await downloaded(page, async () => {
        await page.getByRole("button", { name: menu, exact: true }).first().click();
        await page.locator(`.menu [data-item="${item}"]`).click();
      }),
    );
  return all;
}

test("every figure and every table can be saved", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "Keep this version" }).click();
  await type(page, HAZE, "0.7");
  await settled(page);
  let count = 0;
  for (const tab of ["states", "angles", "cone", "energy", "walk", "compare"]) {
    await tool(page, tab);
    if (tab === "walk") {
      await page.locator("#walk-aim").selectOption("0.01");
      await page.getByRole("button", { name: "Run Monte Carlo" }).click();
      await page.locator('[data-phase="done"]').waitFor({ timeout: 120_000 });
    }
    if (tab === "cone") await page.locator("#tab-panel img.drawn").first().waitFor({ timeout: 60_000 });
    await settled(page);
    await page.locator("#tab-panel .download").first().waitFor({ timeout: 60_000 });
    await page.waitForFunction(() => !document.querySelector('#tab-panel :is([data-age="before"], [data-age="settings"])'));
    const menus = await page.locator(tab === "states" ? ".download" : "#tab-panel .download").all();
    assert.ok(menus.length > 0, tab);
    for (const menu of menus) {
      const name = (await menu.getAttribute("aria-label"))!;
      await menu.click();
      const items = await page
        .locator(".menu [data-item]")
        .evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["item"]!));
      await page.keyboard.press("Escape");
      for (const item of items) {
        const file = await downloaded(page, async () => {
          await menu.click();
          await page.locator(`.menu [data-item="${item}"]`).click();
        });
        count += 1;
        if (item === "csv") assert.ok(file.text.split("\n").length > 1 && file.text.includes(","), name);
        if (item === "svg") assert.match(file.text, /^<svg [\s\S]*<\/svg>\s*$/, name);
        if (item === "png") assert.equal(file.bytes.subarray(1, 4).toString(), "PNG", name);
      }
    }
  }
  assert.ok(count >= 20, String(count));
  onlyRefusals();
});

test("phone reaches a field and sees the result change", async () => {
  const page = await on.visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await page.getByRole("button", { name: "Got it" }).tap();
  const first = await figure(page, GAMUT);
  await page.getByRole("button", { name: "Layers and light" }).tap();
  const slider = page.locator(`.field[data-path="${HAZE}"] input[type=range]`);
  await slider.scrollIntoViewIfNeeded();
  const box = (await slider.boundingBox())!;
  assert.ok(box.x >= 0 && box.x + box.width <= 390 && box.width > 100, JSON.stringify(box));
  await page.touchscreen.tap(box.x + 0.5 * box.width, box.y + box.height / 2);
  await changed(page, GAMUT, first);
  // The numbers and the patches are still in view.
  for (const part of [`[data-figure="${GAMUT}"]`, '.patch[data-state="yellow"]']) {
    const seen = (await page.locator(part).boundingBox())!;
    assert.ok(
      seen.y >= 0 && seen.y + seen.height <= 844 && seen.x + seen.width <= 391,
      `${part} ${JSON.stringify(seen)}`,
    );
  }
  await page.getByRole("button", { name: "Diagrams" }).tap();
  assert.ok((await page.locator(".chromaticity svg").first().boundingBox())!.width > 280);
  await page.getByRole("button", { name: "Stage and tools" }).tap();
  await page.getByRole("button", { name: "Improve" }).tap();
  await page.locator("#tab-sweep").tap();
  await page.getByRole("button", { name: /Sweep \d+ points/ }).waitFor();
  await page.getByRole("button", { name: "Layers and light" }).tap();
  assert.deepEqual(await tooSmall(page), []);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  onlyRefusals();
});

/** Controls of less than 32 px, which fingers miss. A check box is touched with its label. */
const tooSmall = (page: Page): Promise<string[]> =>
  page.evaluate(() =>
    [...document.querySelectorAll('button, select, summary, input:not([type="file"]):not(.box input), .box, [data-part], .handle .target')]
      .map((e) => [e.outerHTML.slice(0, 80), (e.matches('[type="checkbox"], [type="radio"]') ? e.closest("label")! : e).getBoundingClientRect()] as const)
      .filter(([, box]) => box.width > 0 && (box.height < 31.5 || box.width < 31.5))
      .map(([html, box]) => `${html} ${box.width} x ${box.height}`),
  );

test("tools on a phone have controls for fingers, and none is wider than the window", { timeout: 180_000 }, async () => {
  const page = await on.visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await page.getByRole("button", { name: "Got it" }).tap();
  await example(page, "matrix");
  for (const { id } of TOOLS) {
    await tool(page, id);
    await settled(page);
    assert.deepEqual(await tooSmall(page), [], id);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390, id);
  }
  onlyRefusals();
});

test("result needs no scrolling in usual windows", async () => {
  for (const [width, height] of [
    [1440, 900],
    [1920, 1080],
  ] as const) {
    const page = await on.visit({ viewport: { width, height } });
    await page.getByRole("button", { name: "Got it" }).click();
    await settled(page);
    const below = await page.evaluate(() =>
      [...document.querySelectorAll(".patch, .chromaticity svg, .spectra .u-over, .numbers tbody tr, .trace")]
        .map((e) => e.getBoundingClientRect().bottom)
        .filter((bottom) => bottom > innerHeight + 1),
    );
    assert.deepEqual(below, [], `${width} x ${height}`);
    await page.close();
  }
});

test("example being opened is named at once, and the old design cannot be edited meanwhile", async () => {
  const page = await on.visit();
  await page.route("**/api/v1/live", async (route) => {
    await new Promise((resolve) => setTimeout(resolve, 900));
    await route.continue();
  });
  await example(page, "epaper");
  assert.equal(await page.locator(".title").inputValue(), "Opening epaper…");
  assert.ok(await page.locator(".design").evaluate((e) => (e as HTMLElement).inert));
  await page.waitForFunction(() => !document.querySelector<HTMLInputElement>(".title")!.value.startsWith("Opening"));
  assert.ok(!(await page.locator(".design").evaluate((e) => (e as HTMLElement).inert)));
});

test("keyboard skips to the result, and focusing a source does not select it", async () => {
  const page = await on.visit();
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement?.textContent?.trim()), "Skip to the result");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement?.id), "result");
  const heading = () => page.locator(".editor h2").innerText();
  const before = await heading();
  await page.locator('[data-handle="lighting.directed.0.theta_deg"]').focus();
  assert.equal(await heading(), before);
  await page.keyboard.press("Enter");
  assert.equal(await heading(), "Source 1");
});

test("drawing states that it is not to scale, and shows gaps in nm, the inactive part, rays and the lobe", async () => {
  const page = await on.visit();
  const words = (await page.locator("svg.section").textContent()) ?? "";
  for (const part of ["not to scale", "275.9 nm", "192.3 nm", "inactive"]) assert.ok(words.includes(part), part);
  assert.equal(await page.locator(".ray").count(), 3);
  /** The area of the lobe in the drawing, which is proportional to its width. */
  const width = () =>
    page.locator(".lobe").evaluate((lobe) => {
      const points = [...lobe.getAttribute("d")!.matchAll(/(-?[\d.]+) (-?[\d.]+)/g)].map(
        ([, x, y]) => [+x!, +y!] as const,
      );
      return Math.abs(
        points.reduce((sum, [x, y], i) => {
          const [nx, ny] = points[(i + 1) % points.length]!;
          return sum + (x * ny - nx * y) / 2;
        }, 0),
      );
    });
  const before = await width();
  const gamut = await figure(page, GAMUT);
  await type(page, HAZE, "0.88");
  await changed(page, GAMUT, gamut);
  assert.ok((await width()) > 1.2 * before, "a wider lobe is drawn wider");
});

test("refused change survives a reload beside the design without it", async () => {
  const page = await on.visit();
  await type(page, HAZE, "0.95");
  await page.getByRole("button", { name: /Set total transmittance.* to 0\.8573/ }).waitFor();
  await page.reload();
  await page.locator(".bench").waitFor();
  const first = await figure(page, GAMUT);
  await page.getByRole("button", { name: /Set total transmittance.* to 0\.8573/ }).click();
  await changed(page, GAMUT, first);
  assert.match(await saved(page), /haze = 0\.95[\s\S]*total_transmittance = 0\.8573/);
  onlyRefusals();
});
